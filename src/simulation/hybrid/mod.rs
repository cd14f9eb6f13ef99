//! What `contact` does where nothing presses balls together: with balls without gravity, with any that do not notice each other,
//! and with few that fly, bounce and slide.
//!
//! They need no substeps. Their impacts are taken one after the other, as `exact` takes them, which is exact, and costs less
//! than half where balls are elastic, and down to a twentieth where they are not. Where there are more than can be followed, as
//! among balls that are wedged in, substeps go on from there, in each of which so much may happen and no more.
//!
//! Under gravity, if they notice each other, that goes for few balls alone. Once some lie on others these would hit each other
//! endlessly: then, too, substeps go on, from where the next would begin if all had been taken, so that whole numbers of them
//! are over where frames of a 60th of a second are. (Where impacts are outrun, from there on; the first is shorter.) When nothing
//! but walls has held any for a while, events take over again.

use super::ball::Ball;
use super::contact::{Contact, can_rest, is_few, most_substeps};
use super::exact::{Exact, Pace};
use super::flight::DEEP;
use super::grid::Grid;
use super::invariants::{free, max_overlap};
use super::separate::take_apart;
use super::solver::{Advance, Edit, Frame, Part, Tuning};
use super::world::{Pairs, World};

/// Balls that fall, and overlap by more than this part of a radius at the beginning, are left to substeps.
const TOUCH: f64 = 1e-9;

/// Where more pairs overlap than one in so many balls, and these, balls that can rest are no gas but a heap: there is hardly room
/// to move them apart, and substeps hold it as well.
const HEAPED: (usize, usize) = (4, 16);

/// Balls lie beside each other that are no farther apart than this part of the distance at which they touch, ...
const BESIDE: f64 = 1e-3;
/// ... and lean on each other if they are slower against each other than so many times the rest speed.
const LEAN: f64 = 8.0;
/// Where no ball is faster than so many times the rest speed, all may be about to sleep, which only substeps let them.
const AWAKE: f64 = 8.0;

/// Balls that go from impact to impact as long as they can.
#[derive(Debug, Clone)]
pub(super) struct Hybrid {
    tuning: Tuning,
    way: Way,
    /// The fewest and the most substeps in a second that it took when it last took any.
    taken: Option<[u32; 2]>,
}

/// How they are moved.
#[derive(Debug, Clone)]
enum Way {
    /// From impact to impact.
    Events(Box<Exact>),
    /// In substeps, once there were too many impacts, or something pressed.
    Substeps(Box<Contact>),
}

impl Hybrid {
    /// The solver, if it suits these balls, and no number of substeps was asked for.
    pub(super) fn new(world: &World, balls: &[Ball], tuning: Tuning) -> Option<Self> {
        let suits = world.pairs != Some(Pairs::Detect) && !balls.is_empty() && tuning.substeps.is_none();
        if !suits {
            return None;
        }
        let way = match events(world, balls, tuning, Pace::default()) {
            Some(exact) => Way::Events(Box::new(exact)),
            None if world.gravity.is_some() && is_few(balls) => {
                Way::Substeps(Box::new(Contact::new(world, balls, tuning).that_hands_back()))
            }
            None => return None,
        };
        Some(Self { tuning, way, taken: None })
    }

    /// Begins events anew with what was changed from outside, and returns whether they suit it.
    fn begin_anew(&mut self, world: &World, balls: &[Ball]) -> bool {
        let Way::Events(exact) = &self.way else { return false };
        let clock = exact.clock();
        let Some(anew) = events(world, balls, self.tuning, exact.pace()) else { return false };
        self.way = Way::Events(Box::new(anew.starting_at(clock)));
        true
    }

    /// Goes over from events to substeps, or back, if it is time; whether it was.
    fn go_over(&mut self, frame: &Frame<'_>) -> bool {
        let Frame { world, balls, .. } = frame;
        match &mut self.way {
            Way::Events(exact) if exact.is_outrun() => {
                let contact = Contact::new(world, balls, self.tuning).starting_at(exact.clock());
                let falls = world.gravity.is_some();
                self.way = Way::Substeps(Box::new(if falls { contact.that_hands_back() } else { contact }));
                true
            }
            Way::Substeps(contact) => {
                let Some(clock) = contact.calm_since() else { return false };
                // What hardly moves is about to sleep.
                let moves = |ball: &Ball| ball.velocity.length() > AWAKE * self.tuning.rest_speed;
                let any_moves = balls.iter().any(moves);
                self.taken = contact.substeps();
                match any_moves.then(|| falling(world, balls, self.tuning, Pace::default())).flatten() {
                    Some(exact) => self.way = Way::Events(Box::new(exact.starting_at(clock))),
                    None => contact.stay_on(),
                }
                true
            }
            Way::Events(_) => false,
        }
    }
}

/// Events, where impacts have kept pace so far as this says, if they suit balls that may be anyhow.
fn events(world: &World, balls: &[Ball], tuning: Tuning, so_far: Pace) -> Option<Exact> {
    if world.gravity.is_none() {
        without_gravity(world, balls, tuning, so_far)
    } else {
        let any_lean = || world.pairs.is_some() && any_lean(balls, tuning.rest_speed);
        falling(world, balls, tuning, so_far).filter(|_| !any_lean())
    }
}

/// Events for balls without gravity, where impacts have kept pace so far as this says, if they suit them.
fn without_gravity(world: &World, balls: &[Ball], tuning: Tuning, so_far: Pace) -> Option<Exact> {
    let mut apart = Vec::new();
    let mut balls = balls;
    if overlap(world, balls) > DEEP {
        if can_rest(world, balls) && are_heaped(world, balls) {
            return None;
        }
        // Nothing else would: there is nothing that presses them apart, and what parts takes its energy from nowhere. Events do so
        // from here on, of the distance at which balls touch: never of those that overlap by less than this part of a radius.
        apart.extend_from_slice(balls);
        take_apart(world, &mut apart);
        balls = &apart;
        if overlap(world, balls) > DEEP {
            return None;
        }
    }
    let exact = unjammed(world, balls, tuning)?;
    let pace = so_far.where_impacts_take(can_rest(world, balls));
    Some(exact.while_it_keeps_pace(pace))
}

/// Events for balls that fall, where impacts have kept pace so far as this says, if they suit them: if they are few, and none
/// overlap, or if they do not notice each other.
fn falling(world: &World, balls: &[Ball], tuning: Tuning, so_far: Pace) -> Option<Exact> {
    if world.pairs.is_none() {
        // Nothing but walls ever holds them.
        return Some(unjammed(world, balls, tuning)?.while_it_keeps_pace(so_far));
    }
    if !is_few(balls) || overlap(world, balls) > TOUCH {
        return None;
    }
    let rate = most_substeps(world, balls, tuning);
    let exact = unjammed(world, balls, tuning)?.while_it_keeps_pace(so_far.in_fall());
    Some(exact.while_nothing_presses(rate, tuning.rest_speed))
}

/// Whether any balls touch, or nearly so, and hardly move against each other: one may press the other. There may be thousands of fixed
/// ones: only those that can be moved are compared with all.
fn any_lean(balls: &[Ball], rest_speed: f64) -> bool {
    let numbered = || balls.iter().enumerate();
    numbered().filter(|(_, ball)| !ball.is_fixed()).any(|(at, one)| {
        numbered().any(|(place, other)| {
            let (offset, velocity) = (one.position - other.position, one.velocity - other.velocity);
            let reach = one.radius + other.radius;
            let distance = offset.length();
            let leans = || velocity.dot(offset).abs() < LEAN * rest_speed * distance;
            place != at && distance < reach * (1.0 + BESIDE) && leans()
        })
    })
}

/// The solver of events, unless balls have no room between walls: it would lay them to rest.
fn unjammed(world: &World, balls: &[Ball], tuning: Tuning) -> Option<Exact> {
    let exact = Exact::new(world, balls, tuning.rest_speed);
    let jams = |ball: &Ball| (0..2).any(|axis| exact.jams(ball.radius, axis));
    (!free(balls).any(jams)).then_some(exact)
}

/// The deepest overlap of balls that notice each other, in radii.
fn overlap(world: &World, balls: &[Ball]) -> f64 {
    world.pairs.map_or(0.0, |_| max_overlap(&mut Grid::new(balls, world.size), balls))
}

/// Whether so many overlap that they lie in heaps.
fn are_heaped(world: &World, balls: &[Ball]) -> bool {
    let (one_in, more) = HEAPED;
    !Grid::new(balls, world.size).find_up_to(balls.len() / one_in + more, balls)
}

impl Advance for Hybrid {
    fn advance(&mut self, frame: &mut Frame<'_>, seconds: f64, go_on: &mut dyn FnMut() -> bool) -> f64 {
        let (mut done, mut stopped, mut touched) = (0.0, false, Vec::new());
        loop {
            let mut go_on = || {
                let goes_on = go_on();
                stopped |= !goes_on;
                goes_on
            };
            let left = seconds - done;
            let more = match &mut self.way {
                Way::Events(exact) => exact.advance(frame, left, &mut go_on),
                Way::Substeps(contact) => contact.advance(frame, left, &mut go_on),
            };
            // Their sum may be rounded.
            done = if more == left { seconds } else { (done + more).min(seconds) };
            for (touching, &touched) in frame.touching.iter_mut().zip(&touched) {
                *touching |= touched;
            }
            if !self.go_over(frame) || done == seconds || stopped {
                return done;
            }
            touched = frame.touching.to_vec();
        }
    }

    fn take_up(&mut self, world: &World, balls: &[Ball], edit: Edit) -> bool {
        match &mut self.way {
            Way::Events(_) => self.begin_anew(world, balls),
            Way::Substeps(contact) => contact.take_up(world, balls, edit),
        }
    }

    fn substeps(&self) -> Option<[u32; 2]> {
        match &self.way {
            // What came of them is not exact any more.
            Way::Events(_) => self.taken,
            Way::Substeps(contact) => contact.substeps(),
        }
    }

    fn within_substep(&self) -> f64 {
        match &self.way {
            Way::Events(_) => 0.0,
            Way::Substeps(contact) => contact.within_substep(),
        }
    }

    fn parts(&self, world: &World) -> Vec<Part> {
        match &self.way {
            Way::Events(exact) => exact.parts(world),
            Way::Substeps(contact) => contact.parts(world),
        }
    }

    fn clone_boxed(&self) -> Box<dyn Advance> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests;
