//! What `contact` does where nothing is ever pressed against anything: with elastic balls without gravity.
//!
//! They need no substeps. Their impacts are taken one after the other, as `exact` takes them, which is exact and costs less
//! than half. Where there are more than can be followed, as among balls that are wedged in, substeps go on from there, in
//! each of which so much may happen and no more: it begins with the balls as they were within it.

use super::ball::Ball;
use super::contact::{Contact, can_rest};
use super::exact::Exact;
use super::grid::Grid;
use super::invariants::max_overlap;
use super::solver::{Advance, Frame, Part, Tuning};
use super::world::{Pairs, World};

/// Balls that overlap by more than this part of a radius at the beginning are what substeps part: gently, and however many.
const TOUCH: f64 = 1e-9;

/// Elastic balls without gravity.
#[derive(Debug, Clone)]
pub(super) struct Elastic {
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

impl Elastic {
    /// The solver, if it suits these balls, and no number of substeps was asked for.
    pub(super) fn new(world: &World, balls: &[Ball], tuning: Tuning) -> Option<Self> {
        let elastic = world.pairs == Some(Pairs::Impulse) && !can_rest(world, balls);
        if !elastic || balls.len() < 2 || tuning.substeps.is_some() {
            return None;
        }
        let apart = max_overlap(&mut Grid::new(balls, world.size), balls) <= TOUCH;
        let events = || Exact::new(world, balls, tuning.rest_speed).while_it_keeps_up();
        apart.then(|| Self { tuning, way: Way::Events(Box::new(events())) })
    }
}

impl Advance for Elastic {
    fn advance(&mut self, frame: &mut Frame<'_>, seconds: f64, go_on: &mut dyn FnMut() -> bool) -> f64 {
        let mut done = 0.0;
        if let Way::Events(exact) = &mut self.way {
            done = exact.advance(frame, seconds, go_on);
            if !exact.is_outrun() {
                return done;
            }
            let contact = Contact::new(frame.world, frame.balls, self.tuning).starting_at(exact.clock());
            self.way = Way::Substeps(Box::new(contact));
        }
        let Way::Substeps(contact) = &mut self.way else { return done };
        done + contact.advance(frame, seconds - done, go_on)
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
    fn balls_that_begin_in_each_other_are_parted_in_substeps() {
        let world = World::new(DVec2::splat(100.0)).unwrap().with_walls(1.0).unwrap();
        let at = |x: f64| Ball::new(DVec2::new(x, 50.0), 10.0).unwrap();
        for (apart, events) in [(20.0, true), (15.0, false)] {
            let balls = vec![at(30.0), at(30.0 + apart)];
            let simulation =
                Simulation::new(world.with_pairs(Pairs::Impulse), balls, Solver::Contact).unwrap();
            assert_eq!(simulation.parts().contains(&Part::Events), events);
        }
    }
}
