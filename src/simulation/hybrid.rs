//! What `contact` does where nothing presses anything together: with balls without gravity, and with few that fall, bounce and
//! slide on walls.
//!
//! They need no substeps. Their impacts are taken one after the other, as `exact` takes them, which is exact, and costs less
//! than half where balls are elastic, and down to a twentieth where they are not. Where there are more than can be followed, as
//! among balls that are wedged in, or balls come to lie on each other, substeps go on from there, in each of which so much may
//! happen and no more. Few balls that fall go back to events once nothing has pressed any for a while.

use super::ball::Ball;
use super::clock::Clock;
use super::contact::{Contact, can_rest, is_few};
use super::exact::{Exact, Pace};
use super::grid::Grid;
use super::invariants::{free, max_overlap};
use super::separate::take_apart;
use super::solver::{Advance, Frame, Part, Tuning};
use super::world::{Pairs, World};

/// Balls that overlap by more than this part of a radius at the beginning are moved apart before, or are left to substeps
/// where there is no room.
const TOUCH: f64 = 1e-9;

/// Where more pairs overlap than one in so many balls, and these, balls that can rest are no gas but a heap: there is hardly room
/// to move them apart, and substeps hold it as well.
const HEAPED: (usize, usize) = (4, 16);

/// Balls are near that are no farther from each other than this part of the distance at which they touch, ...
const NEAR: f64 = 1e-3;
/// ... and lean on each other if they are slower against each other than so many times the rest speed.
const LEANS: f64 = 8.0;

/// Balls that go from impact to impact as long as they can.
#[derive(Debug, Clone)]
pub(super) struct Hybrid {
    tuning: Tuning,
    way: Way,
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
        let suits = world.pairs == Some(Pairs::Impulse) && balls.len() > 1 && tuning.substeps.is_none();
        if !suits {
            return None;
        }
        if world.gravity.is_none() {
            let way = Way::Events(without_gravity(world, balls, tuning, Pace::default())?);
            return Some(Self { tuning, way });
        }
        is_few(balls).then(|| {
            let contact = || Way::Substeps(Box::new(Contact::new(world, balls, tuning).that_hands_back()));
            let way = falling(world, balls, tuning, Clock::default()).map_or_else(contact, Way::Events);
            Self { tuning, way }
        })
    }

    /// Begins anew with what was changed from outside, and returns whether events suit it.
    fn begin_anew(&mut self, world: &World, balls: &[Ball], so_far: Pace) -> bool {
        let anew = if world.gravity.is_some() {
            is_few(balls).then(|| falling(world, balls, self.tuning, Clock::default())).flatten()
        } else {
            without_gravity(world, balls, self.tuning, so_far)
        };
        let Some(exact) = anew else { return false };
        self.way = Way::Events(exact);
        true
    }

    /// Goes over from events to substeps, or back, if it is time; whether it did.
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
                let moves = |ball: &Ball| ball.velocity.length() > LEANS * self.tuning.rest_speed;
                let any_moves = balls.iter().any(moves);
                match any_moves.then(|| falling(world, balls, self.tuning, clock)).flatten() {
                    Some(exact) => self.way = Way::Events(exact),
                    None => contact.stay_on(),
                }
                true
            }
            Way::Events(_) => false,
        }
    }
}

/// Events for balls without gravity, where impacts have kept pace so far as this says, if they suit them.
fn without_gravity(world: &World, balls: &[Ball], tuning: Tuning, so_far: Pace) -> Option<Box<Exact>> {
    let mut apart = Vec::new();
    let mut balls = balls;
    if overlap(world, balls) > TOUCH {
        if can_rest(world, balls) && are_heaped(world, balls) {
            return None;
        }
        // Nothing else would: there is nothing that presses them apart, and what parts takes its energy from nowhere.
        apart.extend_from_slice(balls);
        take_apart(world, &mut apart);
        balls = &apart;
        if overlap(world, balls) > TOUCH {
            return None;
        }
    }
    let exact = unjammed(world, balls, tuning)?;
    let pace = so_far.where_impacts_take(can_rest(world, balls));
    Some(Box::new(exact.while_it_keeps_pace(pace)))
}

/// Events for few balls that fall, from this time on, if they suit them.
fn falling(world: &World, balls: &[Ball], tuning: Tuning, clock: Clock) -> Option<Box<Exact>> {
    if any_lean(balls, tuning.rest_speed) {
        return None;
    }
    let rate = Contact::new(world, balls, tuning).substeps().map(|[_, most]| most)?;
    let exact = unjammed(world, balls, tuning)?.starting_at(clock);
    Some(Box::new(exact.while_it_keeps_pace(Pace::IN_FALL).while_nothing_presses(rate, tuning.rest_speed)))
}

/// Whether any balls overlap, or touch, or nearly so, and hardly move against each other: one may press the other.
fn any_lean(balls: &[Ball], rest_speed: f64) -> bool {
    balls.iter().enumerate().any(|(place, one)| {
        balls[..place].iter().any(|other| {
            let (offset, velocity) = (one.position - other.position, one.velocity - other.velocity);
            let reach = one.radius + other.radius;
            let distance = offset.length();
            let leans = || velocity.dot(offset).abs() < LEANS * rest_speed * distance;
            !(one.is_fixed() && other.is_fixed())
                && (distance < reach * (1.0 - TOUCH) || (distance < reach * (1.0 + NEAR) && leans()))
        })
    })
}

/// The solver of events, unless balls have no room between walls: it would lay them to rest.
fn unjammed(world: &World, balls: &[Ball], tuning: Tuning) -> Option<Exact> {
    let exact = Exact::new(world, balls, tuning.rest_speed);
    let jams = |ball: &Ball| (0..2).any(|axis| exact.jams(ball.radius, axis));
    (!free(balls).any(jams)).then_some(exact)
}

/// The deepest overlap, in radii.
fn overlap(world: &World, balls: &[Ball]) -> f64 {
    max_overlap(&mut Grid::new(balls, world.size), balls)
}

/// Whether so many overlap that they lie in heaps.
fn are_heaped(world: &World, balls: &[Ball]) -> bool {
    let (one_in, more) = HEAPED;
    !Grid::new(balls, world.size).find_up_to(balls.len() / one_in + more, balls)
}

impl Advance for Hybrid {
    fn advance(&mut self, frame: &mut Frame<'_>, seconds: f64, go_on: &mut dyn FnMut() -> bool) -> f64 {
        let mut done = 0.0;
        let mut touched = Vec::new();
        loop {
            let left = seconds - done;
            let more = match &mut self.way {
                Way::Events(exact) => exact.advance(frame, left, go_on),
                Way::Substeps(contact) => contact.advance(frame, left, go_on),
            };
            // Their sum may be rounded.
            done = if more == left { seconds } else { (done + more).min(seconds) };
            for (touching, &touched) in frame.touching.iter_mut().zip(&touched) {
                *touching |= touched;
            }
            if !self.go_over(frame) || done == seconds {
                return done;
            }
            touched = frame.touching.to_vec();
        }
    }

    fn add(&mut self, world: &World, balls: &[Ball]) -> bool {
        match &mut self.way {
            Way::Events(exact) => {
                let so_far = exact.pace();
                self.begin_anew(world, balls, so_far)
            }
            Way::Substeps(contact) => contact.add(world, balls),
        }
    }

    fn set_velocity(&mut self, world: &World, balls: &[Ball], index: usize) -> bool {
        match &mut self.way {
            Way::Events(exact) => {
                let so_far = exact.pace();
                self.begin_anew(world, balls, so_far)
            }
            Way::Substeps(contact) => contact.set_velocity(world, balls, index),
        }
    }

    fn substeps(&self) -> Option<[u32; 2]> {
        match &self.way {
            Way::Events(_) => None,
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
mod tests {
    use glam::DVec2;

    use super::super::{Simulation, Solver};
    use super::*;

    /// A light ball between a wall and one of so many times its mass, which comes nearer.
    fn squeezed(mass: f64) -> Simulation {
        let world = World::new(DVec2::new(400.0, 100.0)).unwrap().with_walls(1.0).unwrap();
        let at = |x: f64| Ball::new(DVec2::new(x, 50.0), 10.0).unwrap();
        let heavy = at(350.0).with_mass(mass).unwrap().with_velocity(DVec2::new(-200.0, 0.0)).unwrap();
        Simulation::new(world.with_pairs(Pairs::Impulse), vec![at(30.0), heavy], Solver::Contact).unwrap()
    }

    fn energy(simulation: &Simulation) -> f64 {
        super::super::invariants::kinetic_energy(simulation.balls())
    }

    #[test]
    fn impacts_are_taken_in_substeps_once_there_are_more_than_can_be_followed() {
        for (mass, many) in [(1e8, false), (1e18, true)] {
            let mut simulation = squeezed(mass);
            let start = energy(&simulation);
            for frame in 0..240 {
                simulation.advance(1.0 / 60.0).unwrap();
                let [light, heavy] = simulation.balls() else { panic!("two balls") };
                assert!(
                    light.position.x < heavy.position.x,
                    "frame {frame}: the light one was passed through"
                );
                assert!((energy(&simulation) / start - 1.0).abs() < 1e-9, "frame {frame}");
            }
            assert_eq!(!simulation.parts().contains(&Part::Events), many, "{mass:e}");
        }
    }

    /// A world in elastic walls, and these balls in it.
    fn boxed(width: f64, height: f64, balls: Vec<Ball>) -> Simulation {
        let world = World::new(DVec2::new(width, height)).unwrap().with_walls(1.0).unwrap();
        Simulation::new(world.with_pairs(Pairs::Impulse), balls, Solver::Contact).unwrap()
    }

    fn moving(x: f64, y: f64, velocity: DVec2) -> Ball {
        Ball::new(DVec2::new(x, y), 10.0).unwrap().with_velocity(velocity).unwrap()
    }

    #[test]
    fn balls_that_fill_a_box_keep_their_energy() {
        for (columns, rows) in [(2, 1), (3, 1), (10, 1), (3, 3), (6, 6)] {
            let at = |k: u32| DVec2::new(f64::from(k % columns), f64::from(k / columns)) * 20.0 + 10.0;
            let speed = |k: u32| DVec2::new(f64::from(k * 7 % 11) - 5.0, f64::from(k * 5 % 7) - 3.0) * 10.0;
            let balls = (0..columns * rows).map(|k| moving(at(k).x, at(k).y, speed(k))).collect();
            let mut full = boxed(20.0 * f64::from(columns), 20.0 * f64::from(rows).max(1.5), balls);
            let start = energy(&full);
            for frame in 0..120 {
                full.advance(1.0 / 60.0).unwrap();
                let kept = energy(&full) / start;
                assert!((kept - 1.0).abs() < 1e-9, "{columns} times {rows}, frame {frame}: {kept}");
            }
        }
    }

    #[test]
    fn a_ball_as_high_as_the_world_loses_nothing() {
        let balls =
            vec![moving(30.0, 10.0, DVec2::new(50.0, 30.0)), moving(100.0, 10.0, DVec2::new(-20.0, 10.0))];
        let mut channel = boxed(200.0, 20.0, balls);
        let start = energy(&channel);
        for _ in 0..120 {
            channel.advance(1.0 / 60.0).unwrap();
            assert!((energy(&channel) / start - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn others_do_not_notice_that_substeps_take_over() {
        let mut simulation = squeezed(1e18);
        let world = simulation.world().with_size(DVec2::new(4000.0, 400.0)).unwrap();
        let mut balls = simulation.balls().to_vec();
        // One flies, and two meet, 1.595 s after the beginning.
        balls.push(moving(200.0, 300.0, DVec2::new(977.0, 0.0)));
        balls.push(moving(1000.0, 200.0, DVec2::new(100.0, 0.0)));
        balls.push(moving(1020.0 + 159.5, 200.0, DVec2::ZERO));
        simulation = Simulation::new(world, balls, Solver::Contact).unwrap();
        let (mut events, mut met) = (true, false);
        for frame in 1..=200 {
            let was = events;
            simulation.advance(0.01).unwrap();
            events = simulation.parts().contains(&Part::Events);
            met |= simulation.touching()[4];
            if !events && was {
                assert_eq!(frame, 160);
                assert!(simulation.touching()[3] && simulation.touching()[4]);
            }
            let flown = simulation.balls()[2].position().x - 200.0;
            assert!((flown - 9.77 * f64::from(frame)).abs() < 1e-6, "frame {frame}: {flown} px");
        }
        assert!(!events && met);
    }

    #[test]
    fn substeps_take_over_though_balls_come_and_are_thrown_in_every_frame() {
        for adds in [false, true] {
            let fixed = |x: f64| moving(x, 50.0, DVec2::ZERO).fixed();
            let rattler = moving(120.0, 50.0, DVec2::new(200.0, 0.0));
            let far = moving(30.0, 300.0, DVec2::ZERO);
            let mut rattling = boxed(4000.0, 400.0, vec![fixed(100.0), fixed(140.0 + 1e-6), rattler, far]);
            let mut frames = 0;
            while rattling.parts().contains(&Part::Events) {
                // So much as a frame of a window has time for.
                let mut looks = 0;
                let go_on = || {
                    looks += 1;
                    looks < 100
                };
                rattling.advance_while(1.0 / 60.0, go_on).unwrap();
                let at = 100.0 + 25.0 * f64::from(frames);
                if adds {
                    rattling.add(&[moving(at, 300.0, DVec2::ZERO)]).unwrap();
                } else {
                    rattling.set_velocity(3, DVec2::new(f64::from(frames % 2), 0.0)).unwrap();
                }
                frames += 1;
                assert!(frames < 100, "adds: {adds}");
            }
        }
    }

    #[test]
    fn when_that_is_does_not_depend_on_frames() {
        let after = |rate: f64| {
            let mut simulation = squeezed(1e18);
            let mut left = 2.0_f64;
            while left > 1e-12 {
                // Some frames are cut short.
                let mut looks = 0;
                let mut go_on = || {
                    looks += 1;
                    looks < 5
                };
                left -= simulation.advance_while(left.min(1.0 / rate), &mut go_on).unwrap();
            }
            assert!(!simulation.parts().contains(&Part::Events));
            simulation.balls().to_vec()
        };
        let once = after(60.0);
        for rate in [24.0, 144.0, 240.0, 1000.0] {
            for (one, other) in once.iter().zip(after(rate)) {
                assert!(
                    one.position.distance(other.position) < 1e-6,
                    "{rate} frames a second: {one:?} {other:?}"
                );
            }
        }
    }

    #[test]
    fn balls_that_begin_in_each_other_are_moved_apart_where_there_is_room() {
        for (side, apart, events) in [
            (100.0, 20.0, true),
            (100.0, 20.0 - 1e-12, true),
            (100.0, 15.0, true),
            (100.0, 0.0, true),
            (25.0, 3.0, false),
        ] {
            let at = |x: f64| Ball::new(DVec2::new(x, 0.5 * side), 10.0).unwrap();
            let balls = vec![at(10.0), at(10.0 + apart)];
            let mut simulation = boxed(side, side, balls);
            assert_eq!(simulation.parts().contains(&Part::Events), events, "{apart} px in {side} px");
            simulation.advance(1.0 / 60.0).unwrap();
            let [one, other] = simulation.balls() else { panic!("two balls") };
            let distance = one.position().distance(other.position());
            assert!(!events || distance > 20.0 - 1e-9, "{distance} px from {apart}");
            assert_eq!(energy(&simulation), 0.0);
        }
    }

    const EARTH: DVec2 = DVec2::new(0.0, 980.0);
    const FRAME: f64 = 1.0 / 60.0;

    /// Balls that fall in walls of this restitution, and take energy of each other; the first lies on the floor.
    fn falling_balls(count: u32, walls: f64, solver: Solver) -> Simulation {
        let world = World::new(DVec2::new(600.0, 400.0)).unwrap().with_walls(walls).unwrap();
        let world = world.with_gravity(EARTH).unwrap().with_pairs(Pairs::Impulse);
        let falls = |k: u32| {
            let at = DVec2::new(60.0 + 95.0 * f64::from(k % 6), 380.0 - 80.0 * f64::from(k / 6));
            let ball = Ball::new(at, 20.0 + f64::from(k * 7 % 5)).unwrap().with_restitution(0.7).unwrap();
            let speed = DVec2::new(f64::from(k * 7 % 11) - 5.0, f64::from(k * 5 % 7) - 3.0) * 60.0;
            if k == 0 { ball } else { ball.with_velocity(speed).unwrap() }
        };
        Simulation::new(world, (0..count).map(falls).collect(), solver).unwrap()
    }

    fn has_events(simulation: &Simulation) -> bool {
        simulation.parts().contains(&Part::Events)
    }

    #[test]
    fn few_that_fall_do_as_with_exact_as_long_as_nothing_presses_any() {
        // Where walls take energy, too, it bounces off them more slowly than `exact`.
        let [mut contact, mut exact] =
            [Solver::Contact, Solver::Exact].map(|solver| falling_balls(15, 1.0, solver));
        while has_events(&contact) && contact.time() < 5.0 {
            assert_eq!(contact.balls(), exact.balls(), "{} s", contact.time());
            assert_eq!(contact.tally(), exact.tally(), "{} s", contact.time());
            contact.advance(FRAME).unwrap();
            exact.advance(FRAME).unwrap();
        }
        assert!(contact.tally().impacts > 20, "{:?} in {} s", contact.tally(), contact.time());
    }

    #[test]
    fn when_balls_that_fall_go_over_and_back_does_not_depend_on_frames() {
        let after = |rate: f64, stops: bool| {
            let mut simulation = falling_balls(12, 0.8, Solver::Contact);
            let mut turns = 0;
            while simulation.time() < 8.0 {
                let mut looks = 0;
                let go_on = || {
                    looks += 1;
                    !stops || looks % 2 == 1
                };
                let was = has_events(&simulation);
                let left = (8.0 - simulation.time()).min(1.0 / rate);
                simulation.advance_while(left, go_on).unwrap();
                turns += u32::from(has_events(&simulation) != was);
            }
            (simulation.balls().to_vec(), turns)
        };
        let (once, turns) = after(60.0, false);
        assert!(turns > 1, "{turns}");
        for (rate, stops) in [(24.0, false), (24.0, true), (144.0, true), (997.0, false)] {
            assert_eq!(after(rate, stops).0, once, "{rate} frames a second");
        }
    }

    #[test]
    fn balls_that_lie_on_each_other_take_substeps_until_nothing_presses_any() {
        let world = World::new(DVec2::new(1600.0, 400.0)).unwrap().with_walls(0.5).unwrap();
        let world = world.with_gravity(EARTH).unwrap().with_pairs(Pairs::Impulse);
        let at = |x: f64, y: f64| Ball::new(DVec2::new(x, y), 20.0).unwrap().with_restitution(0.5).unwrap();
        // One rolls off the other; a third slides.
        let off = at(800.0, 380.0).position + 40.0 * DVec2::from_angle(-1.2);
        let slides = at(100.0, 380.0).with_velocity(DVec2::new(30.0, 0.0)).unwrap();
        let mut balls = vec![at(800.0, 380.0), at(off.x, off.y), slides];
        let mut parting = Simulation::new(world, balls.clone(), Solver::Contact).unwrap();
        assert!(!has_events(&parting));
        let least = |simulation: &Simulation| energy(simulation) - EARTH.y * height(simulation);
        let mut last = least(&parting);
        for frame in 0..180 {
            parting.advance(FRAME).unwrap();
            let now = least(&parting);
            assert!(now < last + 1e-3 * EARTH.y * 40.0, "frame {frame}: {now} after {last}");
            last = now;
        }
        assert!(has_events(&parting));
        assert!(parting.balls().iter().all(|ball| (ball.position.y - 380.0).abs() < 1e-9));
        // Upright it stays there, and where all that moves is slow, too.
        balls[1] = at(800.0, 340.0);
        let mut standing = Simulation::new(world, balls.clone(), Solver::Contact).unwrap();
        balls[1] = at(900.0, 380.0);
        balls[2] = balls[2].with_velocity(DVec2::new(0.5, 0.0)).unwrap();
        let mut slow = Simulation::new(world, balls, Solver::Contact).unwrap();
        standing.advance(3.0).unwrap();
        slow.advance(3.0).unwrap();
        assert!(!has_events(&standing) && has_events(&slow));
    }

    /// The sum of how far down balls are, px, by their masses.
    fn height(simulation: &Simulation) -> f64 {
        simulation.balls().iter().map(|ball| ball.mass * ball.position.y).sum()
    }
}
