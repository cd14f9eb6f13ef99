/dev/fd/3: line 39: run: command not found
