//! What will happen, found out on copies: when balls next meet, and where a ball that is thrown will fly.

use glam::DVec2;

use crate::simulation::{Ball, Simulation, Solver};

/// The first look ahead for an impact, s; each next one is twice as long.
const FIRST_LOOK: f64 = 1.0 / 1024.0;
/// The most looks ahead: where they are cut short, as between thousands of balls, they reach less far.
const MOST_LOOKS: u32 = 100;
/// How well the time of an impact is found, s: half as well as frames are shown.
const IMPACT_KNOWN: f64 = 1.0 / (1_u64 << 47) as f64;
/// The path of a throw is shown for so long, s, in so many parts.
const PATH: f64 = 1.0;
const PATH_PARTS: u32 = 240;
/// With more balls than this, only the walls and fixed balls bend a path.
const MOST_IN_PATH: usize = 500;
/// Looks at the watch in the search for a path: where balls are too crowded for it, the path ends early.
const PATH_LOOKS: u32 = 64;

/// The seconds until just behind the next impact; `None` where there is none for `most` seconds. Where that takes too long
/// to find out, the seconds up to which there is none.
pub(super) fn next_impact(simulation: &Simulation, most: f64) -> Option<f64> {
    let met = |other: &Simulation| {
        let (before, now) = (simulation.tally(), other.tally());
        (before.impacts, before.wall_hits) != (now.impacts, now.wall_hits)
    };
    // By the first look at the watch something may have met: in a jam, thousands of impacts are in a moment.
    let ahead_of = |here: &Simulation, seconds: f64| {
        let mut ahead = here.clone();
        let done = ahead.advance_while(seconds, || false).ok()?;
        Some((ahead, done))
    };
    let (mut here, mut passed, mut look) = (simulation.clone(), 0.0, FIRST_LOOK);
    for _ in 0..MOST_LOOKS {
        let (ahead, done) = ahead_of(&here, look)?;
        if met(&ahead) {
            let (mut low, mut high) = (0.0, done);
            while high - low > IMPACT_KNOWN {
                let middle = low.midpoint(high);
                if met(&ahead_of(&here, middle)?.0) {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            return Some(passed + high + IMPACT_KNOWN);
        }
        here = ahead;
        passed += done;
        if passed >= most {
            return None;
        }
        look *= 2.0;
    }
    Some(passed)
}

/// Where a ball that is added now will fly, px, from its centre on: exactly, with its first impacts.
pub(super) fn path(simulation: &Simulation, ball: Ball) -> Vec<DVec2> {
    let mut path = vec![ball.position()];
    let all = simulation.balls();
    let mut balls = if all.len() > MOST_IN_PATH {
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

    #[test]
    fn the_next_impact_is_found_where_free_fall_ends() {
        let mut simulation = boxed(1000.0);
        let seconds = next_impact(&simulation, 10.0).unwrap();
        let fall = (2.0_f64 * 100.0 / 1000.0).sqrt();
        assert!((seconds - fall).abs() < 1e-13, "{seconds} for {fall}");
        simulation.advance(seconds).unwrap();
        assert_eq!(simulation.tally().wall_hits, 1);
        let again = next_impact(&simulation, 10.0).unwrap();
        assert!((again - 2.0 * fall).abs() < 1e-12);
    }

    #[test]
    fn where_nothing_moves_there_is_no_impact() {
        assert_eq!(next_impact(&boxed(0.0), 10.0), None);
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
}
