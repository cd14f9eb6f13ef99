//! Scene files that are watched.

use super::super::super::overlay::Direction;
use super::*;

/// The text of a scene of so many balls.
fn text(balls: u32) -> String {
    let ball = |index| format!("[[ball]]\nposition = [{}, 200]\nradius = 10\n", 50 + 40 * index);
    (0..balls).map(ball).collect()
}

/// An application that watches this file, in which a ball is.
fn watching(path: &Path) -> App {
    std::fs::write(path, text(1)).unwrap();
    let scene = Scene::load(path.to_str().unwrap()).unwrap();
    let options = Options { watch: true, ..OPTIONS };
    App::new(&scene, &options, Session::new(&scene, 1).unwrap())
}

#[test]
fn a_file_that_is_saved_while_the_list_of_scenes_is_open_is_what_its_card_plays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    let mut app = watching(&path);
    open_list(&mut app);
    std::fs::write(&path, text(2)).unwrap();
    look(&mut app);
    app.open_selected();
    assert_eq!(count(&app), 2);
    // Saved after the last look: told after the choice.
    open_list(&mut app);
    std::fs::write(&path, text(3)).unwrap();
    app.open_selected();
    look(&mut app);
    assert_eq!(count(&app), 3);
}

#[test]
fn a_built_in_scene_ends_the_watch_however_it_is_chosen() {
    let folder = tempfile::tempdir().unwrap();
    for command in [Command::Scene(1), Command::NextScene, Command::PreviousScene] {
        let mut app = watching(&folder.path().join("mine.toml"));
        hold(&mut app, Action::Do(Command::Step), false);
        assert!(app.watch.is_some());
        hold(&mut app, Action::Do(command), false);
        assert!(app.watch.is_none(), "{command:?}");
    }
}

#[test]
fn a_file_that_was_played_stays_in_the_list_of_scenes_and_is_watched_again_from_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    let mut app = watching(&path);
    // As it was loaded last.
    std::fs::write(&path, text(2)).unwrap();
    look(&mut app);
    hold(&mut app, Action::Do(Command::NextScene), false);
    open_list(&mut app);
    let browser = app.browser.as_mut().unwrap();
    (0..20).for_each(|_| browser.step(Direction::Left));
    assert_eq!(browser.selected().unwrap().name(), "mine");
    app.open_selected();
    assert_eq!((count(&app), app.session.name()), (2, "mine"));
    std::fs::write(&path, text(3)).unwrap();
    look(&mut app);
    assert_eq!(count(&app), 3);
}

#[test]
fn to_watch_a_scene_without_a_file_is_told_to_do_nothing() {
    let scene = Scene::load("draw").unwrap();
    for watch in [false, true] {
        let options = Options { watch, ..OPTIONS };
        let app = App::new(&scene, &options, Session::new(&scene, 1).unwrap());
        let message = app.messages.shown(Instant::now()).unwrap();
        assert_eq!(message.text.contains("built in"), watch, "{}", message.text);
    }
}
