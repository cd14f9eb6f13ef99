//! What balls ask of substeps by what they are, and by what pulls them: how short they must be, whatever happens.

use std::f64::consts::PI;

use glam::DVec2;

use super::super::ball::Ball;
use super::super::world::World;
use super::substeps::{BEATS, MOST};

/// Gravity moves a ball at rest by at most this part of the smallest radius in a substep of four a beat: else what falls within
/// one would count for more than what is held.
const SINKING: f64 = 0.01;
/// ... as long as substeps are not shortened more than so many times.
const MOST_SHORTENED: f64 = 1024.0;

/// A pile is deep where gravity would move all of its layers together by more than this part of a ball's size in a substep, if it
/// has so many balls: in four substeps, what crashes down comes to overlap by a tenth of a radius and more, gains energy as it parts,
/// and does not come to rest. In eight, slow balls count as moving for too long. For balls of 9 px under the demo's gravity these
/// are sixty layers.
const DEEP_LOAD: f64 = 0.11;
const DEEP_BALLS: usize = 500;
/// From this on, 110 of these layers, six a beat leave what lies deepest squeezed by a tenth of a radius, and it trembles: of piles of
/// nearly two hundred layers two of three did not come to rest within half a minute. In eight, most do.
const DEEPER_LOAD: f64 = 0.2;
/// The part of its room that a pile fills.
const PACKED: f64 = 0.84;

/// Balls are of one size where the radii of more than half of them differ from the middle one by no more than this ratio. They lie in
/// rows, as in a crystal, out of which hardly anything is pushed that was squeezed in between, and in long substeps it gets deeper:
/// where more than so many do, all substeps are short.
const ONE_SIZE: f64 = 1.015;
const MANY_OF_ONE_SIZE: usize = 1000;

/// How many times shorter than usual substeps are: the smallest ball asks for the shortest.
pub(super) fn shortened(world: &World, balls: &[Ball]) -> u32 {
    let smallest = balls.iter().map(|ball| ball.radius).fold(f64::INFINITY, f64::min);
    shortened_for(smallest, world.gravity.unwrap_or_default())
}

/// The same where all balls were of this radius.
pub(super) fn shortened_for(radius: f64, gravity: DVec2) -> u32 {
    let least = (gravity.length() / (SINKING * radius)).sqrt();
    (least / f64::from(BEATS * MOST)).ceil().clamp(1.0, MOST_SHORTENED) as u32
}

/// The radius of a ball of the mean area of those that move; infinite where none does.
pub(super) fn middle_radius(balls: &[Ball]) -> f64 {
    let (count, squares) = moving_squares(balls);
    if count > 0 { (squares / count as f64).sqrt() } else { f64::INFINITY }
}

/// How many balls move, and the sum of the squares of their radii.
fn moving_squares(balls: &[Ball]) -> (usize, f64) {
    let moving = balls.iter().filter(|ball| !ball.is_fixed());
    moving.fold((0, 0.0), |(count, sum), ball| (count + 1, sum + ball.radius * ball.radius))
}

/// Whether there are many balls, and most of those that move are of one size.
pub(super) fn are_many_of_one_size(balls: &[Ball]) -> bool {
    let mut radii: Vec<f64> = balls.iter().filter(|ball| !ball.is_fixed()).map(|ball| ball.radius).collect();
    if radii.len() <= MANY_OF_ONE_SIZE {
        return false;
    }
    let middle = radii.len() / 2;
    let (_, &mut size, _) = radii.select_nth_unstable_by(middle, f64::total_cmp);
    radii.iter().filter(|&&radius| size <= ONE_SIZE * radius && radius <= ONE_SIZE * size).count() > middle
}

/// How deep balls may lie beside their size and gravity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Depth {
    /// So that four substeps a beat suit them, ...
    Shallow,
    /// ... six ...
    Deep,
    /// ... or eight.
    Deeper,
}

impl Depth {
    /// Of these balls, in beats that are so many times shorter than usual.
    pub(super) fn of(world: &World, balls: &[Ball], shortened: u32) -> Self {
        match load(world, balls, shortened) {
            load if load > DEEPER_LOAD => Self::Deeper,
            load if load > DEEP_LOAD => Self::Deep,
            _ => Self::Shallow,
        }
    }
}

/// How far gravity would move all layers together that these balls may lie in, in a substep of beats that are so many times
/// shorter, in times a ball's size; 0 where they are few, or fall for ever.
fn load(world: &World, balls: &[Ball], shortened: u32) -> f64 {
    let (Some(gravity), Some(_)) = (world.gravity, world.walls) else { return 0.0 };
    let (count, squares) = moving_squares(balls);
    // The width of the floor times gravity.
    let pull_across = world.size.dot(gravity.perp().abs());
    if count < DEEP_BALLS || pull_across == 0.0 {
        return 0.0;
    }
    let area = PI * squares;
    let size = 2.0 * middle_radius(balls);
    let pull = gravity.length();
    let layers = area * pull / (PACKED * pull_across * size);
    let substep = 1.0 / f64::from(BEATS * shortened * MOST);
    layers * pull * substep * substep / size
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::Tuning;
    use super::super::substeps::Substeps;
    use super::super::testing::TUNING;
    use super::*;

    const GRAVITY: DVec2 = DVec2::new(0.0, 980.0);

    #[test]
    fn substeps_are_short_where_more_than_half_of_many_balls_are_of_one_size() {
        let world = World::new(DVec2::splat(1e4)).unwrap().with_gravity(GRAVITY).unwrap();
        // So many balls with radii between these, and so many more of this radius.
        let balls = |count: usize, radii: [f64; 2], more: usize, last: f64| -> Vec<Ball> {
            let radius = |k: usize| radii[0] + (radii[1] - radii[0]) * k as f64 / count as f64;
            let radii = (0..count).map(radius).chain(std::iter::repeat_n(last, more));
            radii.map(|radius| Ball::new(DVec2::splat(100.0), radius).unwrap()).collect()
        };
        let least = |balls: &[Ball]| Substeps::new(&world, balls, TUNING).range(GRAVITY)[0];
        for (balls, expected) in [
            (balls(MANY_OF_ONE_SIZE, [5.0, 5.0], 0, 9.0), 120),
            (balls(MANY_OF_ONE_SIZE + 1, [5.0, 5.0], 0, 9.0), 240),
            (balls(2000, [5.0, 5.14], 0, 9.0), 240),
            (balls(2000, [5.0, 6.0], 0, 9.0), 120),
            (balls(1500, [3.0, 6.0], 1400, 9.0), 120),
            (balls(1400, [3.0, 6.0], 1500, 9.0), 240),
        ] {
            assert_eq!(least(&balls), expected, "{} balls from {}", balls.len(), balls[0].radius);
        }
        let few = Substeps::new(&world, &balls(MANY_OF_ONE_SIZE, [5.0, 5.0], 0, 9.0), TUNING);
        let many = balls(MANY_OF_ONE_SIZE + 1, [5.0, 5.0], 0, 9.0);
        assert_eq!(few.with(&world, &many, TUNING).unwrap().range(GRAVITY), [240; 2]);
        let small = balls(MANY_OF_ONE_SIZE, [5.0, 5.0], 1, 0.5);
        assert!(few.with(&world, &small, TUNING).is_none(), "so small a ball asks for shorter beats");
    }

    #[test]
    fn substeps_are_shorter_where_many_balls_lie_deep_beside_their_size_and_gravity() {
        let range = |width: f64, gravity: DVec2, count: usize, times: f64, sleep: bool| {
            let world = World::new(DVec2::new(width, 5000.0)).unwrap().with_walls(0.5).unwrap();
            let world = world.with_gravity(gravity).unwrap();
            let ball = |size: f64| Ball::new(DVec2::splat(20.0), times * size).unwrap();
            let balls: Vec<Ball> = [3.0, 4.0, 5.0, 6.0].into_iter().cycle().take(count).map(ball).collect();
            Substeps::new(&world, &balls, Tuning { sleep, ..TUNING }).range(gravity)
        };
        // 4,000 of these fill 270,000 px² of the plane, and are 9.3 px high in the middle: 320 px wide, 108 layers; 640, 54.
        assert_eq!(range(320.0, GRAVITY, 4000, 1.0, true), [360; 2]);
        assert_eq!(range(320.0, -GRAVITY, 4000, 1.0, true), [360; 2]);
        assert_eq!(range(640.0, GRAVITY, 4000, 1.0, true), [120, 240]);
        // Of a larger or a smaller size, or under less gravity, they give way by another part of their size.
        assert_eq!(range(320.0, 0.5 * GRAVITY, 4000, 1.0, true), [120, 240]);
        assert_eq!(range(640.0, GRAVITY, 8000, 1.0, true), [360; 2]);
        assert_eq!(range(1280.0, GRAVITY, 8000, 2.0, true), [120, 240]);
        assert_eq!(range(300.0, GRAVITY, 4000, 1.0, true), [480; 2]);
        // What may not sleep becomes longer again where it lies still.
        assert_eq!(range(320.0, GRAVITY, 4000, 1.0, false), [120, 360]);
        assert_eq!(range(300.0, GRAVITY, 4000, 1.0, false), [120, 360]);
        // What falls to the side lies in few layers.
        assert_eq!(range(320.0, GRAVITY.perp(), 4000, 1.0, true), [120, 240]);
        assert_eq!(range(320.0, DVec2::ZERO, 4000, 1.0, true), [240; 2]);
        assert_eq!(range(40.0, GRAVITY, DEEP_BALLS - 1, 1.0, true), [120, 240]);
        assert_eq!(range(58.0, GRAVITY, DEEP_BALLS, 1.0, true), [360; 2]);
    }
}
