//! The mouse, on balls and in the list of scenes, and keys among its clicks.

use super::*;

#[test]
fn after_the_list_of_scenes_was_closed_the_mouse_acts_where_the_pointer_is() {
    let mut app = app("draw");
    app.point_at(PhysicalPosition::new(200.0, 600.0));
    open_list(&mut app);
    app.point_at(PhysicalPosition::new(900.0, 300.0));
    app.close_browser();
    click(&mut app);
    assert_eq!(app.session.simulation().balls()[1].position(), DVec2::new(900.0, 300.0));
}

#[test]
fn a_double_click_on_a_card_plays_its_scene_and_adds_no_ball() {
    let mut app = app("draw");
    open_list(&mut app);
    // On the second card.
    app.point_at(PhysicalPosition::new(350.0, 150.0));
    click(&mut app);
    assert_eq!((app.session.name(), app.browser.is_some()), ("move", false));
    click(&mut app);
    assert_eq!(count(&app), 1);
    app.clicked = Instant::now().checked_sub(Duration::from_secs(1));
    click(&mut app);
    assert_eq!(count(&app), 2, "a click that is none of both");
}

#[test]
fn what_comes_after_the_list_of_scenes_was_asked_for_is_for_the_list_also_where_both_wait() {
    for waits in [false, true] {
        let open = |keys: &[Key]| {
            let mut app = app("draw");
            begin_turn(&mut app);
            if waits {
                end_turn(&mut app);
            }
            for key in keys {
                strike(&mut app, key);
            }
            assert_eq!(app.waiting.is_empty(), !waits);
            end_work(&mut app);
            (app.session.name().to_owned(), count(&app), app.browser.is_some())
        };
        let (m, a, r) = (letter("m"), letter("a"), letter("r"));
        let (right, enter) = (Key::Named(NamedKey::ArrowRight), Key::Named(NamedKey::Enter));
        let is = |scene: &str, balls, open| (scene.to_owned(), balls, open);
        assert_eq!(open(&[m.clone(), a.clone(), a.clone()]), is("draw", 1, true));
        assert_eq!(open(&[a.clone(), m.clone(), r]), is("draw", 2, true));
        assert_eq!(open(&[m.clone(), m.clone(), a]), is("draw", 2, false));
        let next = [m, right, enter];
        assert_eq!(open(&next), is("move", 1, false));
        assert_eq!(open(&[next.clone(), next].concat()), is("two", 2, false));
    }
}

#[test]
fn a_click_that_waits_is_for_what_is_open_when_its_turn_comes() {
    let mut app = app("draw");
    app.hands.point_at(DVec2::new(900.0, 300.0));
    begin_work(&mut app);
    strike(&mut app, &letter("m"));
    click(&mut app);
    end_work(&mut app);
    assert!(app.browser.is_some() && !app.hands.are_busy());
    assert_eq!(count(&app), 1);
}

#[test]
fn a_click_that_waits_is_where_the_pointer_was_and_as_large_as_the_wheel_had_said() {
    let mut app = app("draw");
    let [first, second] = [300.0, 500.0].map(|y| DVec2::new(900.0, y));
    begin_work(&mut app);
    app.hands.point_at(first);
    click(&mut app);
    app.turn_wheel(MouseScrollDelta::LineDelta(0.0, 1.0));
    app.hands.point_at(second);
    click(&mut app);
    app.hands.point_at(DVec2::ZERO);
    end_work(&mut app);
    let places: Vec<_> = app.session.simulation().balls()[1..]
        .iter()
        .map(|ball| (ball.position(), ball.radius().round()))
        .collect();
    assert_eq!(places, [(first, 20.0), (second, 22.0)]);
}

#[test]
fn a_wheel_that_turns_sideways_does_nothing() {
    let mut app = app("draw");
    let before = app.messages.shown(Instant::now()).unwrap().text;
    for delta in [
        MouseScrollDelta::LineDelta(1.0, 0.0),
        MouseScrollDelta::PixelDelta(PhysicalPosition::new(30.0, -0.0)),
    ] {
        begin_turn(&mut app);
        app.turn_wheel(delta);
        assert_eq!(app.messages.shown(Instant::now()).unwrap().text, before);
    }
}

#[test]
fn what_was_dropped_with_the_focus_is_not_taken_by_a_press_before_it() {
    let mut app = app("draw");
    begin_work(&mut app);
    app.hands.point_at(DVec2::new(900.0, 300.0));
    app.press(MouseButton::Left, ElementState::Pressed);
    app.lose_focus();
    end_work(&mut app);
    assert!(!app.hands.are_busy());
}

#[test]
fn right_clicks_take_the_balls_away_that_they_were_on_also_where_they_wait() {
    let mut app = app("gravity");
    begin_work(&mut app);
    for index in [1, 2, 13] {
        right_click(&mut app, index);
    }
    app.session.work_while(|| true).unwrap();
    let mut left = app.session.simulation().balls().to_vec();
    for index in [13, 2, 1] {
        left.remove(index);
    }
    end_work(&mut app);
    assert_eq!(app.session.simulation().balls(), left);
}

#[test]
fn a_ball_that_is_held_and_taken_away_is_not_held() {
    let mut app = app("gravity");
    app.hands.point_at(app.session.simulation().balls()[4].position());
    press(&mut app, MouseButton::Left, ElementState::Pressed);
    assert!(app.hands.are_busy());
    right_click(&mut app, 4);
    assert_eq!(app.session.simulation().balls().len(), 14);
    assert!(!app.hands.are_busy());
}

#[test]
fn a_ball_that_is_held_goes_where_it_is_let_go_also_where_no_frame_came_since_it_was_taken() {
    for (paused, speed) in [(true, 0.0), (false, 3000.0)] {
        let mut app = app("draw");
        if paused {
            app.session.apply(Command::TogglePause).unwrap();
        }
        let from = app.session.simulation().balls()[0].position();
        let to = from + DVec2::new(100.0, 0.0);
        app.point_at(PhysicalPosition::new(from.x, from.y));
        press(&mut app, MouseButton::Left, ElementState::Pressed);
        app.point_at(PhysicalPosition::new(to.x, to.y));
        press(&mut app, MouseButton::Left, ElementState::Released);
        let ball = app.session.simulation().balls()[0];
        let place = if paused { to } else { from };
        assert!(ball.position().distance(place) < 1e-9, "{}", ball.position());
        assert!((ball.velocity().length() - speed).abs() < 1e-6, "{}", ball.velocity());
    }
}

#[test]
fn a_throw_ends_where_its_release_would_not_be_seen() {
    let mut app = app("draw");
    begin_throw(&mut app);
    app.open_browser();
    press(&mut app, MouseButton::Left, ElementState::Released);
    app.close_browser();
    assert!(!app.hands.are_busy());
    begin_throw(&mut app);
    hold(&mut app, Action::ToggleHelp, false);
    press(&mut app, MouseButton::Left, ElementState::Released);
    assert_eq!(count(&app), 1);
    assert!(app.help);
    assert!(!app.leave(Instant::now()));
    assert!(!app.help, "there is nothing else to be left first");
    begin_throw(&mut app);
    end_turn(&mut app);
    app.lose_focus();
    assert!(!app.hands.are_busy() && !app.is_busy());
}

#[test]
fn a_click_on_the_help_closes_it_and_adds_no_ball_behind_it() {
    let mut app = app("draw");
    app.help = true;
    app.hands.point_at(DVec2::new(900.0, 300.0));
    click(&mut app);
    assert!(!app.help);
    assert_eq!(app.session.simulation().balls().len(), 1);
}
