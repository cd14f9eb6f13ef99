//! What the window says: its title, and what each command did.

use glam::DVec2;

use crate::session::{Change, Command, Session, Working};

/// Scene, solver, balls, and how time runs.
pub(super) fn title(session: &Session, frames_per_second: Option<f64>) -> String {
    let scale = session.time_scale();
    let mut title = format!("carom – {}", shown(session));
    if scale != 1.0 {
        title += &format!(" · {}", speed(scale));
    }
    match frames_per_second {
        _ if session.is_paused() => title += " · paused",
        Some(rate) => title += &format!(" · {rate:.0} fps"),
        None => {}
    }
    title
}

/// Scene, solver and balls.
pub(super) fn shown(session: &Session) -> String {
    let simulation = session.simulation();
    let count = simulation.balls().len();
    format!("{} · {} · {}", session.name(), simulation.solver(), balls(count))
}

/// What a command that succeeded did, where that is not plain to see.
pub(super) fn done(command: Command, session: &Session) -> Option<String> {
    let simulation = session.simulation();
    Some(match command {
        Command::TogglePause if session.is_paused() => "paused".to_owned(),
        Command::TogglePause => "time runs".to_owned(),
        Command::Slower | Command::Faster => speed(session.time_scale()),
        Command::NextSolver => format!("solver {}", simulation.solver()),
        Command::Scene(_) | Command::NextScene | Command::PreviousScene => scene(session),
        Command::Reseed => "other random balls".to_owned(),
        Command::ToggleComparison if session.truth().is_some() => {
            "compared with the exact solver from now on".to_owned()
        }
        Command::ToggleComparison => "no longer compared".to_owned(),
        Command::Change(Change::Reset) => "reset".to_owned(),
        Command::Change(Change::AddRandom(count)) if count > 1 => {
            format!("{count} balls more: {}", simulation.balls().len())
        }
        Command::Change(Change::ToggleGravity | Change::TiltGravity(_)) => {
            gravity(simulation.world().gravity())
        }
        Command::Step | Command::StepToImpact | Command::Back | Command::Change(_) => return None,
    })
}

/// A scene's name, and what it shows.
pub(super) fn scene(session: &Session) -> String {
    let about = session.scene().about();
    if about.is_empty() { session.name().to_owned() } else { format!("{}: {about}", session.name()) }
}

/// What time does other than run on: something is looked for, or the present is in the past, and what to do about it. A world
/// that was larger then than what is `seen` of it now, px, is told, too: balls may be where nobody sees them.
pub(super) fn past(session: &Session, rewinding: bool, seen: DVec2) -> Option<String> {
    let how = match session.working() {
        Some(Working::Impact) => return Some("looking for the next impact … · Esc: stop".to_owned()),
        Some(Working::Back) if !rewinding => return Some("going back … · Esc: stop".to_owned()),
        Some(Working::Back) => "← rewinding",
        None if !session.is_in_the_past() => return None,
        _ if rewinding => "← rewinding",
        _ if session.is_paused() => "Space: play on",
        _ => "playing again",
    };
    let ago = session.seconds_ago();
    // Where it takes long to go back by a frame, nothing seems to happen: not "0 ms ago".
    let nothing_yet = rewinding && ago < SHOWN;
    let told = if nothing_yet { format!("{how} …") } else { format!("{} ago · {how}", duration(ago)) };
    let size = session.simulation().world().size();
    let hidden = session.is_in_the_past() && size.cmpgt(seen + 0.5).any();
    Some(if hidden {
        told + &format!(" · the world was {}×{} then", size.x.round(), size.y.round())
    } else {
        told
    })
}

/// Less than this, s, is shown as no time.
const SHOWN: f64 = 5e-4;

/// A time, s, to a tenth of a second; a shorter one in milliseconds.
fn duration(seconds: f64) -> String {
    if seconds < 0.1 { format!("{:.0} ms", 1e3 * seconds) } else { format!("{seconds:.1} s") }
}

fn balls(count: usize) -> String {
    if count == 1 { "1 ball".to_owned() } else { format!("{count} balls") }
}

fn speed(scale: f64) -> String {
    let slower = 1.0 / scale;
    let divides = scale < 1.0 && slower == slower.round();
    if divides { format!("speed 1/{slower}") } else { format!("speed {scale}") }
}

/// Gravity as it is now, in whole px/s².
fn gravity(gravity: Option<DVec2>) -> String {
    let Some(gravity) = gravity else { return "gravity off".to_owned() };
    // Adding 0 makes a 0 of -0.
    let DVec2 { x, y } = gravity.round() + DVec2::ZERO;
    format!("gravity ({x}, {y}) px/s²")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::session::STEP;

    const SIZE: DVec2 = DVec2::new(1280.0, 720.0);

    fn played(frames: u32) -> Session {
        let mut session = Session::new(&Scene::load("elastic").unwrap(), 1).unwrap();
        (0..frames).for_each(|_| session.advance(STEP).unwrap());
        session
    }

    #[test]
    fn it_is_said_at_once_that_time_runs_back_however_long_the_first_step_takes() {
        let mut session = played(40);
        assert_eq!(past(&session, true, SIZE), None);
        let mut looks = 0;
        session.rewind_while(STEP, || {
            looks += 1;
            looks < 2
        });
        assert!(session.is_working() && !session.is_in_the_past());
        assert_eq!(past(&session, true, SIZE).as_deref(), Some("← rewinding …"));
        assert_eq!(past(&session, false, SIZE).as_deref(), Some("going back … · Esc: stop"));
    }

    #[test]
    fn a_world_that_was_larger_than_what_is_seen_is_told_in_the_past() {
        let mut session = played(40);
        let seen = DVec2::new(700.0, 400.0);
        session.resize(seen).unwrap();
        session.advance(STEP).unwrap();
        (0..30).for_each(|_| assert!(session.rewind(STEP)));
        let said = |seen| past(&session, false, seen).unwrap();
        assert_eq!(said(SIZE), "0.5 s ago · playing again");
        assert_eq!(said(seen), "0.5 s ago · playing again · the world was 1280×720 then");
        assert_eq!(past(&played(2), false, seen), None, "now, it is as large as the balls need");
    }

    #[test]
    fn a_speed_is_a_fraction_where_it_is_one_of_a_whole_number() {
        for (scale, said) in [(1.0, "1"), (16.0, "16"), (0.25, "1/4"), (0.3, "0.3"), (1.5, "1.5")] {
            assert_eq!(speed(scale), format!("speed {said}"));
        }
    }

    #[test]
    fn a_step_back_is_told_from_none() {
        for (seconds, said) in [(0.0, "0 ms"), (1.0 / 60.0, "17 ms"), (0.1, "0.1 s"), (12.34, "12.3 s")] {
            assert_eq!(duration(seconds), said);
        }
    }

    #[test]
    fn the_notice_gives_gravity_in_whole_numbers_without_a_minus_before_0() {
        assert_eq!(gravity(None), "gravity off");
        assert_eq!(gravity(Some(DVec2::new(98.0, 980.0))), "gravity (98, 980) px/s²");
        assert_eq!(gravity(Some(DVec2::new(-0.3, -97.6))), "gravity (0, -98) px/s²");
    }
}
