//! Tells the program which compiler made it: what its report measures depends on that.

use std::env;
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let compiler = env::var_os("RUSTC").and_then(|rustc| Command::new(rustc).arg("--version").output().ok());
    let version = compiler.and_then(|output| String::from_utf8(output.stdout).ok());
    println!("cargo:rustc-env=CAROM_COMPILER={}", version.as_deref().unwrap_or("unknown").trim());
}
