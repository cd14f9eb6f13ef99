//! Keys that are held, and Escape.

use super::*;

#[test]
fn time_runs_back_no_longer_than_the_key_is_held_however_busy_the_session_was() {
    let mut app = app("gravity");
    hold(&mut app, Action::Rewind, false);
    assert_eq!(app.rewinding, Rewinding::Back);
    begin_work(&mut app);
    for _ in 0..20 {
        hold(&mut app, Action::Rewind, true);
    }
    app.stop_rewinding();
    end_work(&mut app);
    assert_eq!(app.rewinding, Rewinding::No);
    // Pressed while the session is busy, and still held when its turn comes.
    for (released, rewinding) in [(false, Rewinding::Back), (true, Rewinding::No)] {
        begin_work(&mut app);
        hold(&mut app, Action::Rewind, false);
        assert_eq!(app.rewinding, Rewinding::No);
        if released {
            app.lose_focus();
        }
        end_work(&mut app);
        assert_eq!(app.rewinding, rewinding);
        app.stop_rewinding();
    }
}

#[test]
fn a_key_that_is_held_leaves_nothing_to_do_after_it() {
    let mut app = app("gravity");
    begin_work(&mut app);
    let add = Action::Do(Change::AddRandom(1).into());
    hold(&mut app, add, false);
    for _ in 0..20 {
        hold(&mut app, add, true);
    }
    end_work(&mut app);
    assert_eq!(app.session.simulation().balls().len(), 16);
}

#[test]
fn time_that_ran_back_to_the_start_stands_there_until_the_key_is_released() {
    let mut app = app("elastic");
    let size = app.session.simulation().world().size();
    let mut now = Instant::now();
    let mut frame = |app: &mut App| {
        now += Duration::from_millis(50);
        app.advance(now, size).unwrap();
        app.session.simulation().time()
    };
    frame(&mut app);
    hold(&mut app, Action::Rewind, false);
    while frame(&mut app) > 0.0 {}
    for count in 0..20 {
        // Keys repeat less often than frames come.
        if count % 3 == 2 {
            hold(&mut app, Action::Rewind, true);
        }
        assert_eq!(frame(&mut app), 0.0);
    }
    app.stop_rewinding();
    frame(&mut app);
    assert!(frame(&mut app) > 0.0, "time runs on");
}

#[test]
fn escape_waits_for_nothing_and_what_waits_before_it_is_forgotten() {
    let mut app = app("draw");
    for open in [false, true] {
        begin_turn(&mut app);
        if open {
            strike(&mut app, &letter("m"));
        }
        end_turn(&mut app);
        for key in [letter("m"), Key::Named(NamedKey::Enter), letter("a")] {
            strike(&mut app, &key);
        }
        assert!(!app.leave(Instant::now()));
        assert!(app.waiting.is_empty() && app.browser.is_none());
    }
    assert_eq!(count(&app), 1);
}

#[test]
fn escape_ends_the_program_only_where_nothing_else_is_to_be_left() {
    let mut app = app("draw");
    let now = Instant::now();
    begin_throw(&mut app);
    assert!(!app.leave(now) && !app.hands.are_busy());
    app.help = true;
    assert!(!app.leave(now) && !app.help);
    begin_work(&mut app);
    assert!(!app.leave(now) && !app.session.is_working());
    // It comes just after what it was to stop has ended.
    app.busy = Some(now);
    assert!(!app.leave(now + Duration::from_millis(500)));
    assert!(app.leave(now + Duration::from_secs(1)));
}
