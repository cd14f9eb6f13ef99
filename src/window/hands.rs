//! The mouse: what the pointer is on, and what it does to balls.

use glam::DVec2;

use crate::session::{CLICK_RADIUS, Change, CommandError, Session};

/// Velocity of a thrown ball per px that it was dragged, 1/s.
const THROW: f64 = 4.0;
/// Dragging less far than this is a click, px.
const CLICK: f64 = 4.0;
/// By how much a notch of the wheel changes the next ball's radius.
const NOTCH: f64 = 1.1;
/// The smallest and the largest radius that the wheel sets, px.
const RADII: (f64, f64) = (2.0, 300.0);

/// The pointer, and what it holds.
#[derive(Debug)]
pub(super) struct Hands {
    /// Where the pointer is, px of the world; none where it is not over the window.
    pointer: Option<DVec2>,
    /// The radius of the next ball, px.
    radius: f64,
    grip: Grip,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Grip {
    Nothing,
    /// A ball that is about to be added, and thrown from here.
    New(DVec2),
    Ball {
        index: usize,
        /// From the pointer to the ball's centre.
        offset: DVec2,
        /// Where the hand last wanted it.
        wanted: DVec2,
        /// Where it was last put down while time stood still.
        put: DVec2,
    },
}

/// What the hands are about to do, to be shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Gesture {
    /// A ball would be added at the pointer, with this radius; smaller where there is less room, none where there is
    /// none.
    Aim { at: DVec2, wished: f64, fits: Option<f64> },
    /// A ball will be thrown.
    Throw { from: DVec2, to: DVec2, velocity: DVec2, radius: Option<f64> },
    /// The pointer is over this ball.
    Over(usize),
    /// This ball is held.
    Hold(usize),
}

impl Hands {
    pub(super) fn new() -> Self {
        Self { pointer: None, radius: CLICK_RADIUS, grip: Grip::Nothing }
    }

    /// Takes note that the pointer is here, px of the world, and tells whether it was moved here: not where it has just
    /// come into the window, or the window under it.
    pub(super) fn point_at(&mut self, pointer: DVec2) -> bool {
        self.pointer.replace(pointer).is_some_and(|before| before != pointer)
    }

    /// The pointer has left the window. What it holds stays in hand: the button is still down.
    pub(super) fn leave(&mut self) {
        self.pointer = None;
    }

    /// Where the pointer is, px of the world; none where it is not over the window.
    pub(super) fn pointer(&self) -> Option<DVec2> {
        self.pointer
    }

    /// The left button went down at `place`, where the pointer may be no longer: takes the ball there, or else begins to
    /// throw a new one.
    pub(super) fn press(&mut self, place: DVec2, session: &Session) -> Result<(), CommandError> {
        let Some(index) = session.ball_at(place) else {
            self.grip = Grip::New(place);
            return Ok(());
        };
        let ball = &session.simulation().balls()[index];
        if ball.is_fixed() {
            return Err(CommandError::Fixed);
        }
        let offset = ball.position() - place;
        // As it will be computed for a hand that has not moved.
        let at = place + offset;
        self.grip = Grip::Ball { index, offset, wanted: at, put: at };
        Ok(())
    }

    /// The left button went up at `place`: a held ball flies on, once it was brought along where the hand has moved since
    /// the last frame; a new one is added, at rest after a click, and thrown the faster the longer the line after a drag.
    pub(super) fn release(&mut self, place: Option<DVec2>, session: &Session) -> Option<Change> {
        match std::mem::replace(&mut self.grip, Grip::Nothing) {
            Grip::New(position) => {
                let velocity = place.map_or(DVec2::ZERO, |to| thrown(position, to));
                Some(Change::AddBall { position, velocity, radius: self.radius })
            }
            Grip::Ball { index, offset, wanted, .. } => {
                let to = place? + offset;
                (to != wanted).then(|| bring(index, to, session))
            }
            Grip::Nothing => None,
        }
    }

    /// Lets go of a ball: it may not be there any more.
    pub(super) fn let_go(&mut self) {
        if let Grip::Ball { .. } = self.grip {
            self.grip = Grip::Nothing;
        }
    }

    /// Lets go of a ball, and throws none that is about to be.
    pub(super) fn drop_all(&mut self) {
        self.grip = Grip::Nothing;
    }

    /// What the hand does to the ball that it holds before a frame: pulls it along, or, while time stands still, puts
    /// it elsewhere.
    pub(super) fn hold(&mut self, session: &Session) -> Option<Change> {
        let (Grip::Ball { index, offset, wanted, put }, Some(pointer)) = (&mut self.grip, self.pointer)
        else {
            return None;
        };
        let to = pointer + *offset;
        *wanted = to;
        let is_there = !session.is_moving() && std::mem::replace(put, to) == to;
        (!is_there).then(|| bring(*index, to, session))
    }

    /// The right button went down at `place`: the ball that is to go. Where one is about to be thrown, it is not, and
    /// that is all.
    pub(super) fn pick(&mut self, place: Option<DVec2>, session: &Session) -> Option<usize> {
        if let Grip::New(_) = self.grip {
            self.drop_all();
            return None;
        }
        session.ball_at(place?)
    }

    /// The wheel: the next ball grows by so many notches, or shrinks. Its new radius, px.
    pub(super) fn turn(&mut self, notches: f64) -> f64 {
        let radius = self.radius * NOTCH.powf(notches);
        // What is not a number changes nothing.
        if radius.is_finite() {
            self.radius = radius.max(RADII.0).min(RADII.1);
        }
        self.radius
    }

    /// Whether a ball is held or about to be thrown.
    pub(super) fn are_busy(&self) -> bool {
        self.grip != Grip::Nothing
    }

    /// What is about to be done; `None` where the pointer is elsewhere.
    pub(super) fn gesture(&self, session: &Session) -> Option<Gesture> {
        match (self.grip, self.pointer) {
            (Grip::Ball { index, .. }, _) => Some(Gesture::Hold(index)),
            (Grip::New(from), Some(to)) => {
                let radius = session.room_at(from, self.radius);
                Some(Gesture::Throw { from, to, velocity: thrown(from, to), radius })
            }
            (Grip::Nothing, Some(at)) => Some(match session.ball_at(at) {
                Some(index) => Gesture::Over(index),
                None => Gesture::Aim { at, wished: self.radius, fits: session.room_at(at, self.radius) },
            }),
            (_, None) => None,
        }
    }
}

/// What brings a ball to where the hand wants it: it is pulled along, or, while time stands still, put there.
fn bring(ball: usize, to: DVec2, session: &Session) -> Change {
    if session.is_moving() { Change::Carry { ball, to } } else { Change::Place { ball, at: to } }
}

/// The velocity of a ball that is thrown by a line from here to there, px/s.
fn thrown(from: DVec2, to: DVec2) -> DVec2 {
    let line = to - from;
    if line.length() < CLICK { DVec2::ZERO } else { line * THROW }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::session::Command;

    fn session() -> Session {
        let mut session = Session::new(&Scene::load("gravity").unwrap(), 1).unwrap();
        session.advance(0.0).unwrap();
        session
    }

    const FREE: DVec2 = DVec2::new(900.0, 400.0);

    #[test]
    fn a_click_adds_a_ball_at_rest_and_a_drag_throws_it_along_its_line() {
        let (mut hands, session) = (Hands::new(), session());
        for (dragged, velocity) in
            [(DVec2::new(2.0, 1.0), DVec2::ZERO), (DVec2::new(50.0, -20.0), DVec2::new(200.0, -80.0))]
        {
            hands.press(FREE, &session).unwrap();
            let added = Change::AddBall { position: FREE, velocity, radius: CLICK_RADIUS };
            assert_eq!(hands.release(Some(FREE + dragged), &session), Some(added));
            assert_eq!(hands.release(Some(FREE), &session), None);
        }
    }

    #[test]
    fn a_ball_is_held_where_it_was_taken_carried_in_time_and_put_down_out_of_it() {
        let (mut hands, mut session) = (Hands::new(), session());
        let centre = session.simulation().balls()[2].position();
        let inside = DVec2::new(5.0, -7.0);
        hands.point_at(centre + inside);
        assert_eq!(hands.gesture(&session), Some(Gesture::Over(2)));
        hands.press(centre + inside, &session).unwrap();
        hands.point_at(FREE + inside);
        assert_eq!(hands.hold(&session), Some(Change::Carry { ball: 2, to: FREE }));
        hands.leave();
        assert_eq!(hands.hold(&session), None);
        hands.point_at(FREE + inside);
        session.apply(Command::TogglePause).unwrap();
        assert_eq!(hands.hold(&session), Some(Change::Place { ball: 2, at: FREE }));
        assert_eq!(hands.hold(&session), None, "nothing to do until the pointer moves");
        assert_eq!(hands.release(Some(FREE + inside), &session), None);
        assert!(!hands.are_busy());
    }

    #[test]
    fn a_ball_that_was_moved_since_the_last_frame_is_brought_there_when_it_is_let_go() {
        let (mut hands, mut session) = (Hands::new(), session());
        let at = session.simulation().balls()[2].position() + DVec2::new(5.3, -7.1);
        let mut release = |session: &Session, place: DVec2| {
            hands.press(at, session).unwrap();
            hands.release(Some(place), session)
        };
        let moved = at + DVec2::new(300.0, 100.0);
        assert!(matches!(release(&session, moved), Some(Change::Carry { ball: 2, .. })));
        assert_eq!(release(&session, at), None, "a click changes nothing");
        session.apply(Command::TogglePause).unwrap();
        assert!(matches!(release(&session, moved), Some(Change::Place { ball: 2, .. })));
        assert_eq!(release(&session, at), None);
    }

    #[test]
    fn the_right_button_is_for_the_ball_at_its_place_or_against_a_throw() {
        let (mut hands, session) = (Hands::new(), session());
        let ball = session.simulation().balls()[2].position();
        assert_eq!(hands.pick(Some(FREE), &session), None);
        assert_eq!(hands.pick(Some(ball), &session), Some(2));
        hands.press(FREE, &session).unwrap();
        assert_eq!(hands.pick(Some(ball), &session), None);
        assert_eq!(hands.release(Some(FREE), &session), None);
    }

    #[test]
    fn the_wheel_sets_the_next_radius_within_bounds() {
        let (mut hands, session) = (Hands::new(), session());
        assert!((hands.turn(1.0) / CLICK_RADIUS - NOTCH).abs() < 1e-12);
        for notches in [1e6, -1e6, f64::NAN] {
            let radius = hands.turn(notches);
            assert!((RADII.0..=RADII.1).contains(&radius), "{radius}");
        }
        hands.turn(100.0);
        hands.point_at(FREE + DVec2::new(0.0, 200.0));
        let Some(Gesture::Aim { wished, fits, .. }) = hands.gesture(&session) else { panic!() };
        assert!(wished == RADII.1 && fits.unwrap() < wished, "walls leave less room");
    }
}
