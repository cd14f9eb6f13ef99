//! What will happen, found out on copies: when balls next meet, and where a ball that is thrown will fly.

use glam::DVec2;

use crate::simulation::{Ball, Simulation, Solver};

/// The first look ahead for an impact, s; each next one is twice as long.
const FIRST_LOOK: f64 = 1.0 / 1024.0;
/// How well the time of an impact is found, s: to half the time between two at which frames are shown.
const IMPACT_KNOWN: f64 = 1.0 / (1_u64 << 47) as f64;
/// How much longer than that a step to an impact takes, s, to be past it: where the watch stops a look ahead in a jam, its clock stands
/// up to such a time before what it has seen.
const PAST: f64 = 4.0 * IMPACT_KNOWN;
/// The path of a throw is shown for so long, s ...
const PATH: f64 = 1.0;
/// ... in so many parts.
const PATH_PARTS: u32 = 240;
/// With more balls than this, only the walls and fixed balls bend a path.
const MOST_IN_PATH: usize = 500;
/// Balls lie deep in each other where they are nearer than this part of the distance at which they touch. Where there are
/// more such pairs than balls, as in a world that shrank, they bend no path either: it would take long to find.
const DEEP: f64 = 0.9;
/// Looks at the watch in the search for a path: where balls are too crowded for it, the path ends early.
const PATH_LOOKS: u32 = 64;

/// The search for the next impact, on copies, as far as it has come.
#[derive(Debug)]
pub(super) struct Search {
    /// A state up to which there is no impact, `passed` seconds after the start.
    here: Simulation,
    passed: f64,
    /// A copy of `here` on its way to `target` seconds after it, with `left` seconds to go.
    ahead: Simulation,
    target: f64,
    left: f64,
    /// The times after `here`, s, between which the impact is, once one was seen.
    between: Option<(f64, f64)>,
}

/// What a search has come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Found {
    /// The impact is just before so many seconds have passed.
    After(f64),
    /// There is none as far ahead as was looked.
    Nothing,
    /// Nothing yet: there was no time to look on.
    Unknown,
}

impl Search {
    pub(super) fn new(simulation: &Simulation) -> Self {
        Self {
            here: simulation.clone(),
            passed: 0.0,
            ahead: simulation.clone(),
            target: FIRST_LOOK,
            left: FIRST_LOOK,
            between: None,
        }
    }

    /// Looks on, up to `most` seconds ahead, for as long as `go_on` says so.
    pub(super) fn look_ahead(&mut self, most: f64, go_on: &mut dyn FnMut() -> bool) -> Found {
        loop {
            // No farther than to the first look at the watch: in a jam there are thousands of impacts in a moment.
            let Ok(done) = self.ahead.advance_while(self.left, || false) else { return Found::Nothing };
            let arrived = done == self.left;
            self.left -= done;
            if self.has_met() {
                let low = self.between.map_or(0.0, |(low, _)| low);
                self.between = Some((low, self.target - self.left));
            } else if !arrived {
                if !go_on() {
                    return Found::Unknown;
                }
                continue;
            } else if let Some((low, _)) = &mut self.between {
                *low = self.target;
            } else {
                self.passed += self.target;
                if self.passed >= most {
                    return Found::Nothing;
                }
                // `here` goes on from there; `ahead` is made anew from it.
                std::mem::swap(&mut self.here, &mut self.ahead);
            }
            self.target = match self.between {
                Some((low, high)) if high - low <= IMPACT_KNOWN => {
                    return Found::After(self.passed + high + PAST);
                }
                Some((low, high)) => low.midpoint(high),
                None => 2.0 * self.target,
            };
            self.left = self.target;
            self.ahead.clone_from(&self.here);
            if !go_on() {
                return Found::Unknown;
            }
        }
    }

    fn has_met(&self) -> bool {
        let (before, now) = (self.here.tally(), self.ahead.tally());
        (before.impacts, before.wall_hits) != (now.impacts, now.wall_hits)
    }
}

/// Where a ball that is added now will fly, px, from its centre on: exactly, with its first impacts.
pub(super) fn path(simulation: &Simulation, ball: Ball) -> Vec<DVec2> {
    let mut path = vec![ball.position()];
    let all = simulation.balls();
    let mut balls = if all.len() > MOST_IN_PATH || is_crowd(all) {
        all.iter().filter(|other| other.is_fixed()).copied().collect()
    } else {
        all.to_vec()
    };
    let index = balls.len();
    balls.push(ball);
    let Ok(mut ahead) = Simulation::new(*simulation.world(), balls, Solver::Exact) else { return path };
    let mut looks = PATH_LOOKS;
    let part = PATH / f64::from(PATH_PARTS);
    for _ in 0..PATH_PARTS {
        let done = ahead.advance_while(part, || {
            looks = looks.saturating_sub(1);
            looks > 0
        });
        path.push(ahead.balls()[index].position());
        if done != Ok(part) {
            break;
        }
    }
    path
}

/// Whether more pairs of balls lie deep in each other than there are balls.
fn is_crowd(balls: &[Ball]) -> bool {
    let is_deep = |first: &Ball, second: &Ball| {
        let near = DEEP * (first.radius() + second.radius());
        first.position().distance_squared(second.position()) < near * near
    };
    let others = |at: usize| balls[at + 1..].iter().filter(move |other| is_deep(&balls[at], other)).count();
    (0..balls.len()).map(others).sum::<usize>() > balls.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::World;

    fn boxed(gravity: f64) -> Simulation {
        let world = World::new(DVec2::splat(200.0)).unwrap().with_walls(1.0).unwrap();
        let world = world.with_gravity(DVec2::new(0.0, gravity)).unwrap();
        let ball = Ball::new(DVec2::new(100.0, 90.0), 10.0).unwrap();
        Simulation::new(world, vec![ball], Solver::Exact).unwrap()
    }

    fn found(simulation: &Simulation) -> f64 {
        match Search::new(simulation).look_ahead(10.0, &mut || true) {
            Found::After(seconds) => seconds,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_search_that_is_interrupted_finds_the_same() {
        let simulation = boxed(1000.0);
        let (mut search, mut looks) = (Search::new(&simulation), 0);
        let found_bit_by_bit = loop {
            // Each time there is time for one look at the watch, and no more.
            let mut left = 2;
            let found = search.look_ahead(10.0, &mut || {
                left -= 1;
                left > 0
            });
            looks += 1;
            if found != Found::Unknown {
                break found;
            }
        };
        assert!(looks > 10, "{looks}");
        assert_eq!(found_bit_by_bit, Found::After(found(&simulation)));
    }

    #[test]
    fn the_next_impact_is_found_where_free_fall_ends() {
        let mut simulation = boxed(1000.0);
        let seconds = found(&simulation);
        let fall = (2.0_f64 * 100.0 / 1000.0).sqrt();
        assert!((seconds - fall).abs() < 1e-13, "{seconds} for {fall}");
        simulation.advance(seconds).unwrap();
        assert_eq!(simulation.tally().wall_hits, 1);
        let again = found(&simulation);
        assert!((again - 2.0 * fall).abs() < 1e-12);
    }

    #[test]
    fn where_nothing_moves_there_is_no_impact() {
        assert_eq!(Search::new(&boxed(0.0)).look_ahead(10.0, &mut || true), Found::Nothing);
    }

    #[test]
    fn a_path_is_the_flight_with_its_bounces() {
        let simulation = boxed(0.0);
        let ball = Ball::new(DVec2::new(150.0, 50.0), 10.0).unwrap();
        let path = path(&simulation, ball.with_velocity(DVec2::new(100.0, 0.0)).unwrap());
        assert_eq!(path.len(), PATH_PARTS as usize + 1);
        assert_eq!(path[0], DVec2::new(150.0, 50.0));
        let right = path.iter().map(|place| place.x).fold(0.0, f64::max);
        assert!((right - 190.0).abs() < 0.5, "the wall turns it: {right}");
        assert!((path.last().unwrap().x - 130.0).abs() < 1e-9);
    }

    #[test]
    fn a_path_goes_through_a_crowd_and_not_through_balls_that_have_room() {
        let world = *boxed(1000.0).world();
        let world = world.with_pairs(crate::simulation::Pairs::Impulse);
        let thrown = Ball::new(DVec2::new(20.0, 68.0), 5.0).unwrap();
        let thrown = thrown.with_velocity(DVec2::new(400.0, -100.0)).unwrap();
        let among = |spacing: f64| {
            let place = |at: u32| DVec2::new(f64::from(at % 4), f64::from(at / 4)) * spacing + 60.0;
            let balls = (0..16).map(|at| Ball::new(place(at), 8.0).unwrap()).collect();
            path(&Simulation::new(world, balls, Solver::Contact).unwrap(), thrown)
        };
        let alone = path(&boxed(1000.0), thrown);
        // Without pairs nobody is in the way.
        assert_eq!(among(4.0), alone);
        assert_ne!(among(17.0), alone);
    }
}
