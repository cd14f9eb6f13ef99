//! Random balls that overlap nothing: how large, how fast and how heavy they are. Where they are, `places` decides.
//!
//! All comes from `ChaCha8` seeded by the fill's seed, through + − × ÷ √ alone: the same seed gives the same balls on
//! every machine.

use std::f64::consts::PI;

use glam::DVec2;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::places::{Room, lay_out, random_direction, throw};
use crate::simulation::limits::{MASS, OutOfRange};
use crate::simulation::{Ball, World};

/// A number of random balls.
#[derive(Debug, Clone, PartialEq)]
pub struct Fill {
    /// How many.
    pub(crate) count: usize,
    /// The range that radii come from, px.
    pub(crate) radius: (f64, f64),
    /// The range that speeds come from, px/s; directions are random.
    pub(crate) speed: (f64, f64),
    pub(crate) material: Material,
    pub(crate) restitution: f64,
    pub(crate) seed: u64,
    /// The corners of the region that the balls lie in wholly; `None` for the whole world.
    pub(crate) region: Option<(DVec2, DVec2)>,
    /// Where the fill stands in its file.
    pub(crate) offset: Option<usize>,
}

/// What random balls weigh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Material {
    /// All the same.
    Mass(f64),
    /// By area, mass per px².
    Density(f64),
}

impl Material {
    /// The mass of a ball of this material. A density at the end of its range may make a mass beyond a ball's: the
    /// nearest mass will do.
    fn mass(self, radius: f64) -> f64 {
        match self {
            Self::Mass(mass) => mass,
            Self::Density(density) => (density * PI * radius * radius).clamp(MASS.low, MASS.high),
        }
    }
}

impl Fill {
    /// As many of the fill's balls as find room among `present` in `world`; `stream` sets fills of one seed apart.
    pub(crate) fn place(&self, world: &World, present: &[Ball], stream: u64) -> Vec<Ball> {
        let (room, mut rng, radii) = self.draw(world, stream);
        // Balls that would cover more than the room need no second trial.
        let covered: f64 = radii.iter().map(|radius| PI * radius * radius).sum();
        // Where they cover more than chance can place, they are thrown all the same: what a lattice draws comes after
        // that in the stream of random numbers, and a seed keeps its balls.
        let mut places = throw(&mut rng, &room, &radii, present);
        if places.len() < self.count && covered < room.area() {
            let on_lattice = lay_out(&mut rng, &room, &radii, self.radius.1, present);
            if on_lattice.len() == self.count {
                places = on_lattice;
            }
        }
        // The largest were placed first; the scene's order is the one in which they were drawn.
        places.sort_unstable_by_key(|&(index, _)| index);
        self.balls(&mut rng, &radii, places)
    }

    /// The same, at random places only.
    pub(crate) fn place_at_random(&self, world: &World, present: &[Ball], stream: u64) -> Vec<Ball> {
        let (room, mut rng, radii) = self.draw(world, stream);
        let places = throw(&mut rng, &room, &radii, present);
        self.balls(&mut rng, &radii, places)
    }

    /// The room for the balls, their radii, and what to draw the rest from.
    fn draw(&self, world: &World, stream: u64) -> (Room, ChaCha8Rng, Vec<f64>) {
        let (low, high) = self.region.unwrap_or((DVec2::ZERO, world.size()));
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(stream);
        let radii = (0..self.count).map(|_| between(&mut rng, self.radius)).collect();
        (Room { low, high: high.min(world.size()) }, rng, radii)
    }

    /// Balls of these radii at these places.
    fn balls(&self, rng: &mut ChaCha8Rng, radii: &[f64], places: Vec<(usize, DVec2)>) -> Vec<Ball> {
        let ball = |(index, position): (usize, DVec2)| {
            let radius = radii[index];
            let velocity = random_direction(rng) * between(rng, self.speed);
            let ball =
                Ball::new(position, radius)?.with_velocity(velocity)?.with_restitution(self.restitution)?;
            ball.with_mass(self.material.mass(radius))
        };
        let balls: Result<Vec<Ball>, _> = places.into_iter().map(ball).collect();
        balls.expect("a fill's ranges are checked when it is made")
    }
}

/// Seeds that are independent of each other, the same for the same `seed`.
pub(super) fn seeds(seed: u64) -> impl Iterator<Item = u64> {
    ChaCha8Rng::seed_from_u64(seed).random_iter()
}

/// Random balls for a world, of the material of its last free ball, small enough to find room: what `--balls` and the
/// window's keys add.
pub(crate) fn filling(count: usize, world: &World, balls: &[Ball], seed: u64) -> Fill {
    let area = world.size().x * world.size().y;
    // Radii from R/2 to R have a mean square of 7/12 R².
    let widest = (ADDED_AREA * area / (count.max(1) as f64 * PI * 7.0 / 12.0)).sqrt();
    let widest = widest.min(ADDED_RADIUS).min(world.size().min_element() / 2.0);
    let (material, restitution) = material_of_the_last(balls);
    Fill {
        count,
        radius: (widest / 2.0, widest),
        speed: (0.0, ADDED_SPEED),
        material,
        restitution,
        seed,
        region: None,
        offset: None,
    }
}

/// `ball`, made of the material of the last of `balls` that is not fixed.
///
/// # Errors
/// [`OutOfRange`] where `ball` is fixed, which takes no mass.
pub(crate) fn like_the_last(balls: &[Ball], ball: Ball) -> Result<Ball, OutOfRange> {
    let (material, restitution) = material_of_the_last(balls);
    ball.with_restitution(restitution)?.with_mass(material.mass(ball.radius()))
}

/// Density and restitution of the last ball that is not fixed; where there is none, an elastic ball of mass 1.
fn material_of_the_last(balls: &[Ball]) -> (Material, f64) {
    balls.iter().rfind(|ball| !ball.is_fixed()).map_or((Material::Mass(1.0), 1.0), |ball| {
        (Material::Density(ball.mass() / (PI * ball.radius() * ball.radius())), ball.restitution())
    })
}

/// The share of the world that added balls cover at most.
const ADDED_AREA: f64 = 0.25;
/// The largest radius of an added ball, px.
const ADDED_RADIUS: f64 = 24.0;
/// The highest speed of an added ball, px/s.
const ADDED_SPEED: f64 = 400.0;

/// A number from a closed range.
fn between(rng: &mut ChaCha8Rng, (low, high): (f64, f64)) -> f64 {
    (low + (high - low) * rng.random::<f64>()).min(high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::grid::Grid;
    use crate::simulation::invariants::{max_overlap, max_wall_overlap};

    fn fill(count: usize, radius: (f64, f64)) -> Fill {
        Fill {
            count,
            radius,
            speed: (10.0, 200.0),
            material: Material::Density(1.0),
            restitution: 0.7,
            seed: 1,
            region: None,
            offset: None,
        }
    }

    fn world(width: f64, height: f64) -> World {
        World::new(DVec2::new(width, height)).unwrap().with_walls(1.0).unwrap()
    }

    fn assert_sound(world: &World, balls: &[Ball]) {
        assert!(max_overlap(&mut Grid::new(balls, world.size()), balls) < 1e-9);
        assert!(max_wall_overlap(world, balls) < 1e-9);
    }

    #[test]
    fn filled_balls_overlap_nothing_and_keep_to_their_ranges() {
        let world = world(1280.0, 720.0);
        let present = [Ball::new(DVec2::new(600.0, 300.0), 250.0).unwrap()];
        let balls = fill(1000, (3.0, 6.0)).place(&world, &present, 0);
        assert_eq!(balls.len(), 1000);
        for ball in &balls {
            assert!((3.0..=6.0).contains(&ball.radius()));
            assert!((10.0 - 1e-9..=200.0 + 1e-9).contains(&ball.velocity().length()));
            assert_eq!(ball.restitution(), 0.7);
        }
        assert_sound(&world, &[&present[..], &balls].concat());
    }

    #[test]
    fn a_fill_too_dense_for_chance_stands_on_a_lattice() {
        // 0.75 of the area: random places jam near 0.547.
        let world = world(1000.0, 1000.0);
        let count = (0.75 * 1e6 / (PI * 25.0)) as usize;
        let balls = fill(count, (5.0, 5.0)).place(&world, &[], 0);
        assert_eq!(balls.len(), count);
        assert_sound(&world, &balls);
    }

    #[test]
    fn what_cannot_fit_is_left_out_and_counted() {
        let balls = fill(1000, (20.0, 20.0)).place(&world(300.0, 200.0), &[], 0);
        assert!(balls.len() < 40 && balls.len() > 10, "{}", balls.len());
        let tiny = fill(10, (20.0, 20.0)).place(&world(30.0, 30.0), &[], 0);
        assert!(tiny.is_empty());
    }

    #[test]
    fn fills_that_can_never_fit_are_given_up_soon() {
        let world = world(1280.0, 720.0);
        assert!(fill(1_000_000, (5.0, 5.0)).place(&world, &[], 0).len() < 10_000);
        // A grain where a large ball leaves no place: a lattice of its size would have 10¹⁵ sites.
        let large = [Ball::new(DVec2::new(640.0, 360.0), 360.0).unwrap()];
        let region = Some((DVec2::new(600.0, 300.0), DVec2::new(700.0, 400.0)));
        let grain = Fill { region, ..fill(1, (1e-6, 1e-6)) };
        assert!(grain.place(&world, &large, 0).is_empty());
    }

    #[test]
    fn one_seed_gives_the_same_balls_and_another_gives_others() {
        let world = world(800.0, 600.0);
        let fill = fill(50, (3.0, 6.0));
        assert_eq!(fill.place(&world, &[], 0), fill.place(&world, &[], 0));
        assert_ne!(fill.place(&world, &[], 0), fill.place(&world, &[], 1));
        let other = Fill { seed: 2, ..fill.clone() };
        assert_ne!(fill.place(&world, &[], 0), other.place(&world, &[], 0));
    }

    #[test]
    fn seed_1_means_these_balls_for_ever() {
        let ball = fill(1, (3.0, 6.0)).place(&world(800.0, 600.0), &[], 0)[0];
        let state =
            [ball.position().x, ball.position().y, ball.radius(), ball.velocity().x, ball.velocity().y];
        assert_eq!(state, SEED_1);
    }

    const SEED_1: [f64; 5] = [
        67.838_002_138_622_76,
        357.123_562_944_260_87,
        4.207_456_990_994_544,
        -114.862_922_191_464_35,
        -88.521_933_353_434_95,
    ];
}
