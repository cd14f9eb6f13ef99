//! Files that are dropped on the window.

use super::*;

/// A scene file of three balls in a folder.
fn file(folder: &Path) -> PathBuf {
    let ball = |index: u32| format!("[[ball]]\nposition = [{}, 200]\nradius = 10\n", 50 + 40 * index);
    let path = folder.join("mine.toml");
    std::fs::write(&path, (0..3).map(ball).collect::<String>()).unwrap();
    path
}

#[test]
fn a_file_that_is_dropped_takes_its_turn_among_keys_and_clicks() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path());
    for waits in [false, true] {
        let mut app = app("draw");
        begin_turn(&mut app);
        if waits {
            begin_work(&mut app);
        }
        strike(&mut app, &letter("a"));
        app.drop_file(path.clone());
        strike(&mut app, &letter("a"));
        app.hands.point_at(DVec2::new(900.0, 300.0));
        click(&mut app);
        assert_eq!(app.session.name(), if waits { "draw" } else { "mine" });
        end_work(&mut app);
        assert_eq!((app.session.name(), count(&app)), ("mine", 5), "{waits}");
    }
}

#[test]
fn a_key_that_begins_a_scene_after_a_file_was_dropped_begins_that_scene() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path());
    let mut app = app("draw");
    begin_work(&mut app);
    app.drop_file(path);
    strike(&mut app, &letter("2"));
    end_work(&mut app);
    assert_eq!(app.session.name(), "move");
}

#[test]
fn a_file_that_is_dropped_on_the_list_of_scenes_is_played_and_a_wrong_one_leaves_the_list_open() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path());
    let mut app = app("draw");
    open_list(&mut app);
    begin_turn(&mut app);
    app.drop_file(folder.path().join("none.toml"));
    assert_eq!((app.session.name(), app.browser.is_some()), ("draw", true));
    app.drop_file(path);
    assert_eq!((app.session.name(), app.browser.is_some()), ("mine", false));
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_whose_name_is_not_all_text_is_played_and_watched_and_what_is_wrong_with_it_is_told() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(OsStr::from_bytes(b"m\xefne.toml"));
    std::fs::rename(file(folder.path()), &path).unwrap();
    let mut app = App::new(
        &Scene::load("draw").unwrap(),
        &Options { watch: true, ..OPTIONS },
        Session::new(&Scene::load("draw").unwrap(), 1).unwrap(),
    );
    let said = |app: &App| app.messages.shown(Instant::now()).unwrap().text;
    begin_turn(&mut app);
    app.drop_file(path.clone());
    assert_eq!((app.session.name(), count(&app)), ("m\u{fffd}ne", 3), "{}", said(&app));
    // Where it was saved, too, it is still that file.
    std::fs::write(&path, "[[ball]]\nposition = [50, 200]\nradius = 10\n").unwrap();
    look(&mut app);
    assert_eq!((count(&app), app.own.as_ref().unwrap().file()), (1, Some(path.as_path())));
    std::fs::write(&path, "[[ball]]\nposition = [50, 200]\nradius = -1\n").unwrap();
    begin_turn(&mut app);
    app.drop_file(path);
    assert!(said(&app).contains("m\u{fffd}ne.toml:3: radius is -1"), "{}", said(&app));
}
