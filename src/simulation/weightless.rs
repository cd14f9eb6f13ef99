//! What `contact` does where nothing presses anything together: with balls without gravity.
//!
//! They need no substeps. Their impacts are taken one after the other, as `exact` takes them, which is exact, and costs less
//! than half where balls are elastic, and down to a twentieth where they are not. Where there are more than can be followed, as
//! among balls that are wedged in, substeps go on from there, in each of which so much may happen and no more.

use super::ball::Ball;
use super::contact::{Contact, can_rest};
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

/// Balls without gravity.
#[derive(Debug, Clone)]
pub(super) struct Weightless {
    tuning: Tuning,
    way: Way,
}

/// How they are moved.
#[derive(Debug, Clone)]
enum Way {
    /// From impact to impact.
    Events(Box<Exact>),
    /// In substeps, once there were too many impacts.
    Substeps(Box<Contact>),
}

impl Weightless {
    /// The solver, if it suits these balls, and no number of substeps was asked for.
    pub(super) fn new(world: &World, balls: &[Ball], tuning: Tuning) -> Option<Self> {
        Self::keeping_pace(world, balls, tuning, Pace::default())
    }

    /// The same where impacts have kept pace so far as this says.
    fn keeping_pace(world: &World, balls: &[Ball], tuning: Tuning, so_far: Pace) -> Option<Self> {
        let suits = world.pairs == Some(Pairs::Impulse) && world.gravity.is_none();
        if !suits || balls.len() < 2 || tuning.substeps.is_some() {
            return None;
        }
        let overlap = |balls: &[Ball]| max_overlap(&mut Grid::new(balls, world.size), balls);
        let mut apart = Vec::new();
        let mut balls = balls;
        if overlap(balls) > TOUCH {
            if can_rest(world, balls) && are_heaped(world, balls) {
                return None;
            }
            // Nothing else would: there is nothing that presses them apart, and what parts takes its energy from nowhere.
            apart.extend_from_slice(balls);
            take_apart(world, &mut apart);
            balls = &apart;
            if overlap(balls) > TOUCH {
                return None;
            }
        }
        let exact = Exact::new(world, balls, tuning.rest_speed);
        // It would lay those to rest that have no room between walls.
        let jams = |ball: &Ball| (0..2).any(|axis| exact.jams(ball.radius, axis));
        let jammed = free(balls).any(jams);
        let pace = so_far.where_impacts_take(can_rest(world, balls));
        (!jammed).then(|| Self { tuning, way: Way::Events(Box::new(exact.while_it_keeps_pace(pace))) })
    }

    /// Begins anew with what was changed from outside, and returns whether events suit it.
    fn begin_anew(&mut self, world: &World, balls: &[Ball], so_far: Pace) -> bool {
        let Some(anew) = Self::keeping_pace(world, balls, self.tuning, so_far) else { return false };
        *self = anew;
        true
    }
}

/// Whether so many overlap that they lie in heaps.
fn are_heaped(world: &World, balls: &[Ball]) -> bool {
    let (one_in, more) = HEAPED;
    !Grid::new(balls, world.size).find_up_to(balls.len() / one_in + more, balls)
}

impl Advance for Weightless {
    fn advance(&mut self, frame: &mut Frame<'_>, seconds: f64, go_on: &mut dyn FnMut() -> bool) -> f64 {
        let exact = match &mut self.way {
            Way::Events(exact) => exact,
            Way::Substeps(contact) => return contact.advance(frame, seconds, go_on),
        };
        let done = exact.advance(frame, seconds, go_on);
        if !exact.is_outrun() {
            return done;
        }
        let touched = frame.touching.to_vec();
        let contact = Contact::new(frame.world, frame.balls, self.tuning);
        let mut contact = contact.starting_at(exact.clock());
        let left = seconds - done;
        let more = contact.advance(frame, left, go_on);
        self.way = Way::Substeps(Box::new(contact));
        for (touching, touched) in frame.touching.iter_mut().zip(touched) {
            *touching |= touched;
        }
        // Their sum may be rounded.
        if more == left { seconds } else { (done + more).min(seconds) }
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
}
