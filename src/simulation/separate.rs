//! Takes apart balls that were pushed into each other: by a wall that was moved, or by whoever put them there.
//!
//! A wall that comes nearer moves what it meets, and that what is behind it: places change, velocities do not. Left in each
//! other, balls would have to part by themselves, and the energy for that would come from nowhere.

use std::ops::Range;

use glam::{BVec2, DVec2};

use super::ball::Ball;
use super::grid::Grid;
use super::impulse::any_offset;
use super::solver::Solver;
use super::squeeze::squeeze;
use super::within;
use super::world::{Pairs, World};

/// Sweeps over all pairs that overlap, at most, where a wall has moved by a step, and at the end: what is not apart by then
/// is left to the solver. Of more balls there are fewer sweeps, down to the last number.
const SWEEPS_OF_STEP: u32 = 8;
const SWEEPS: u32 = 256;
const FEWEST_SWEEPS: u32 = 64;
/// So many balls are swept over at the end in all, at most, unless that would be fewer sweeps than that.
const SWEPT: usize = 160_000;
/// In so many of the first, what is behind gives way to what is nearer to the walls; then each of a pair goes half of the way.
const DIRECTED: u32 = 16;
/// After so many, balls do not give way straight on any more, but to the side, too, by this part of that: a row between two walls
/// has no room along itself, and never would leave it.
const STRAIGHT: u32 = 2;
const ASIDE: f64 = 0.3;
/// A ball is beside a wall that is no farther away than so many of its radii.
const BESIDE: f64 = 2.0;
/// A wall moves in steps of the smallest radius, but in so many at most.
const STEPS: f64 = 128.0;
/// Balls are apart where they overlap by less than this part of the distance at which they touch: solvers take that for
/// rounding.
const APART: f64 = 1e-9;
/// ... and are moved apart by this part more: few sweeps do then, and what flies has room, or a heap would have impacts without
/// end.
const FARTHER: f64 = 1e-2;
/// ... but by no more than so many times what they overlap by: what hardly does is not seen to move.
const FARTHER_AT_MOST: f64 = 4.0;
/// More than this part of the world is not filled without overlaps: balls of one size fill 0.84 of it at random.
const FULLEST: f64 = 0.84;
/// What walls push is crushed where balls come to overlap by more than this part of the smaller radius in the end ...
const CRUSHED: f64 = 0.3;
/// ... or by more than this on the way.
const CRUSHED_ON_THE_WAY: f64 = 1.0;
/// Up to this part of the world filled, balls that are brought in part from the others, wherever they come to.
const ROOMY: f64 = 0.5;
/// Where there are more pairs than so many a ball, they lie in one heap, which takes too long.
const PAIRS: usize = 32;

/// Brings balls into a world whose walls were those of a world of another size, and, where that `gives_way`, what they are
/// pushed into out of their way, as far as there is room; whether any was moved. Where that crushes them, all are squeezed together
/// instead, unless any are fixed: what these fence in stays there.
pub(super) fn bring_in(world: &World, from: DVec2, balls: &mut [Ball], gives_way: bool) -> bool {
    let inside =
        |ball: &Ball| ball.is_fixed() || within(ball.position, ball.radius, world.size) == ball.position;
    if balls.iter().all(inside) {
        return false;
    }
    let gives_way = gives_way && world.pairs == Some(Pairs::Impulse);
    let fits = has_room(world, balls);
    let come_nearer = world.size.cmplt(from).any();
    if !(gives_way && come_nearer) || balls.iter().any(Ball::is_fixed) {
        push_in(world, from, balls, gives_way && fits, None);
        return true;
    }
    if fits {
        let before = [CRUSHED_ON_THE_WAY, CRUSHED].map(|depth| deep_pairs(world, balls, depth));
        let begun = balls.to_vec();
        if push_in(world, from, balls, true, Some(before)) == Push::Moves {
            return true;
        }
        balls.copy_from_slice(&begun);
    }
    squeeze(world, from.max(world.size), balls);
    if fits {
        // None of them is in front of another any more.
        take_apart_in(world, balls, BVec2::FALSE, DIRECTED..DIRECTED + most_sweeps(balls));
    }
    true
}

/// What walls that push balls do to these.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Push {
    Moves,
    /// They come to lie in each other too deeply, and are left on their way.
    Crushes,
}

/// Has walls that move from where they are in a world of one size push balls, and these others, where that `gives_way`, as long as no
/// more pairs than so many are crushed on the way, and in the end, if that counts.
fn push_in(
    world: &World,
    from: DVec2,
    balls: &mut [Ball],
    gives_way: bool,
    most: Option<[usize; 2]>,
) -> Push {
    let smallest = balls.iter().map(|ball| ball.radius).fold(f64::INFINITY, f64::min);
    let far = if gives_way { (from - world.size).max_element() / smallest } else { 0.0 };
    let steps = far.ceil().clamp(1.0, STEPS) as u32;
    for step in 1..=steps {
        let size = from.lerp(world.size, f64::from(step) / f64::from(steps)).max(world.size);
        let world = World { size, ..*world };
        let mut pushed = false;
        for ball in balls.iter_mut().filter(|ball| !ball.is_fixed()) {
            let inside = within(ball.position, ball.radius, size);
            pushed |= inside != ball.position;
            ball.position = inside;
        }
        if pushed && gives_way {
            let last = step == steps;
            let (sweeps, depth) =
                if last { (most_sweeps(balls), CRUSHED) } else { (SWEEPS_OF_STEP, CRUSHED_ON_THE_WAY) };
            take_apart_in(&world, balls, from.cmpgt(world.size), 0..sweeps);
            if most.is_some_and(|most| deep_pairs(&world, balls, depth) > most[usize::from(last)]) {
                return Push::Crushes;
            }
        }
    }
    Push::Moves
}

/// Brings balls that stand outside of the walls in, as if these had come from beyond them, and returns whether there are any.
/// `canvas` does so itself, in the demo's way. Where there is little room for them all they are left outside: pressed into each other,
/// they would have impacts without end.
pub(super) fn bring_strays_in(world: &World, balls: &mut [Ball], solver: Solver) -> bool {
    let strays = |ball: &Ball| {
        let outside = within(ball.position, ball.radius, world.size) - ball.position;
        !ball.is_fixed() && outside.abs().max_element() > APART * ball.radius
    };
    // What flies through each other needs no room.
    let fit = world.pairs != Some(Pairs::Impulse) || filled(world, balls) <= ROOMY;
    let may = world.walls.is_some() && solver != Solver::Canvas && fit;
    let found = may && balls.iter().any(strays);
    if found {
        let free = balls.iter().filter(|ball| !ball.is_fixed());
        let from = free.fold(world.size, |size, ball| size.max(ball.position + ball.radius));
        push_in(world, from, balls, true, None);
    }
    found
}

/// How many pairs overlap by more than this part of the smaller radius; of a crowd few are looked at.
fn deep_pairs(world: &World, balls: &[Ball], depth: f64) -> usize {
    let mut count = 0;
    Grid::new(balls, world.size).for_each_of_few(balls, |one, other| {
        let (one, other) = (&balls[one as usize], &balls[other as usize]);
        let reach = one.radius + other.radius - depth * one.radius.min(other.radius);
        count += usize::from(one.position.distance_squared(other.position) < reach * reach);
    });
    count
}

/// Moves balls that overlap apart, none of them through a wall, as far as there is room; fixed ones stay.
pub(super) fn take_apart(world: &World, balls: &mut [Ball]) {
    if has_room(world, balls) {
        take_apart_in(world, balls, BVec2::FALSE, 0..most_sweeps(balls));
    }
}

/// How many sweeps there are over these balls at most.
fn most_sweeps(balls: &[Ball]) -> u32 {
    ((SWEPT / balls.len().max(1)) as u32).clamp(FEWEST_SWEEPS, SWEEPS)
}

/// Whether the world may hold these balls without overlaps.
fn has_room(world: &World, balls: &[Ball]) -> bool {
    world.walls.is_none() || filled(world, balls) <= FULLEST
}

/// The part of the world that balls would fill without overlaps.
fn filled(world: &World, balls: &[Ball]) -> f64 {
    let area: f64 = balls.iter().map(|ball| std::f64::consts::PI * ball.radius * ball.radius).sum();
    area / (world.size.x * world.size.y)
}

/// The same in these sweeps at most: away from the walls that have moved along these axes, as long as that helps; or from all.
fn take_apart_in(world: &World, balls: &mut [Ball], moved: BVec2, sweeps: Range<u32>) {
    // Walls move at the right and below.
    let counts = if moved.any() { moved } else { BVec2::TRUE };
    let far = |ball: &Ball| DVec2::select(counts, world.size - ball.position, DVec2::INFINITY).min_element();
    let mut grid = Grid::new(balls, world.size);
    let mut pairs = Vec::new();
    for sweep in sweeps {
        if !grid.find_up_to(PAIRS * balls.len(), balls) {
            return;
        }
        // From the walls inwards: what is behind those that were moved gives way to them in the same sweep.
        pairs.clear();
        pairs.extend(grid.touching().iter().map(|&(one, other)| {
            let (one, other) = (one as usize, other as usize);
            let (near, behind) = (far(&balls[one]), far(&balls[other]));
            if near <= behind { (near, one, other) } else { (behind, other, one) }
        }));
        pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        // What is between two that are both nearer to the walls would be moved to and fro for ever.
        let share = if sweep < DIRECTED { 1.0 } else { 0.5 };
        let aside = if sweep < STRAIGHT { 0.0 } else { ASIDE };
        let parts =
            |&&(_, near, behind): &&(f64, usize, usize)| part(world, balls, (near, behind), share, aside);
        let parted = pairs.iter().filter(parts).count();
        if parted == 0 {
            return;
        }
    }
}

/// Moves two balls apart, a part of that to the side: the one behind by its share, if it can be, and the one nearer to the walls by
/// the rest. Whether they overlapped.
fn part(world: &World, balls: &mut [Ball], (near, behind): (usize, usize), share: f64, aside: f64) -> bool {
    let offset = balls[behind].position - balls[near].position;
    let (distance, reach) = (offset.length(), balls[near].radius + balls[behind].radius);
    if distance >= (1.0 - APART) * reach || (balls[near].is_fixed() && balls[behind].is_fixed()) {
        return false;
    }
    let straight = if distance > 0.0 { offset / distance } else { any_offset(near, behind, 1.0) };
    // The other goes the opposite way: both to one side, they would stay in each other.
    let (moved, along) = if balls[behind].is_fixed() { (near, -straight) } else { (behind, straight) };
    let Ball { position, radius, .. } = balls[moved];
    let inward = (0.5 * world.size - position).dot(along.perp());
    // Beside a wall there is no other side, and elsewhere all to the middle would make a mountain of a level pile.
    let gap = (position - radius).min(world.size - radius - position).min_element();
    let side = if gap < BESIDE * radius || moved.is_multiple_of(2) { inward } else { -inward };
    let way = (straight + straight.perp() * aside.copysign(side)).normalize();
    let depth = reach - distance;
    let mut left = depth + (FARTHER * reach).min(FARTHER_AT_MOST * depth);
    for (index, way, share) in [(behind, way, share), (near, -way, 1.0), (behind, way, 1.0)] {
        let ball = &mut balls[index];
        if !ball.is_fixed() && left > 0.0 {
            let (from, to) = (ball.position, ball.position + way * (share * left));
            ball.position = if world.walls.is_some() { within(to, ball.radius, world.size) } else { to };
            left -= (ball.position - from).dot(way);
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::super::invariants::max_overlap;
    use super::*;

    fn world(width: f64, height: f64) -> World {
        World::new(DVec2::new(width, height)).unwrap().with_walls(1.0).unwrap().with_pairs(Pairs::Impulse)
    }

    fn ball(x: f64, y: f64, radius: f64) -> Ball {
        Ball::new(DVec2::new(x, y), radius).unwrap()
    }

    fn overlap(world: &World, balls: &[Ball]) -> f64 {
        max_overlap(&mut Grid::new(balls, world.size), balls)
    }

    /// The deepest overlap before was that which could not be exceeded, wherever it was.
    #[test]
    fn two_balls_in_one_place_far_off_do_not_have_a_pile_crushed() {
        let row = |k: u32| ball(5.0 + 10.1 * f64::from(k % 39), 595.0 - 10.1 * f64::from(k / 39), 5.0);
        let mut balls: Vec<Ball> = (0..780).map(row).chain([ball(30.0, 30.0, 5.0); 2]).collect();
        let world = world(200.0, 600.0).with_gravity(DVec2::new(0.0, 980.0)).unwrap();
        assert!(bring_in(&world, DVec2::new(400.0, 600.0), &mut balls, true));
        assert!(overlap(&world, &balls[..780]) < 0.3, "{}", overlap(&world, &balls[..780]));
    }

    #[test]
    fn what_overlaps_is_apart_after_and_nothing_else_has_moved() {
        let world = world(100.0, 60.0);
        let mut balls = vec![
            ball(10.0, 10.0, 10.0),
            ball(15.0, 10.0, 5.0),
            ball(50.0, 30.0, 5.0),
            ball(53.0, 30.0, 5.0).fixed(),
            ball(80.0, 30.0, 4.0),
            ball(80.0, 30.0, 4.0),
            ball(80.0, 45.0, 4.0),
        ];
        let before = balls.clone();
        take_apart(&world, &mut balls);
        assert!(overlap(&world, &balls) < 1e-8, "{}", overlap(&world, &balls));
        assert_eq!([before[3], before[6]], [balls[3], balls[6]]);
        let held = balls.iter().all(|ball| within(ball.position, ball.radius, world.size) == ball.position);
        assert!(held, "{balls:?}");
    }

    #[test]
    fn what_begins_outside_of_the_walls_is_brought_in_and_pushes_what_is_in_its_way() {
        let world = world(100.0, 60.0);
        let begun = [
            ball(500.0, 30.0, 5.0),
            ball(92.0, 30.0, 5.0),
            ball(-3.0, 70.0, 5.0),
            ball(200.0, 30.0, 9.0).fixed(),
        ];
        for solver in [Solver::Exact, Solver::Contact] {
            let mut balls = begun;
            assert!(bring_strays_in(&world, &mut balls, solver));
            assert!(overlap(&world, &balls) < 1e-8, "{balls:?}");
            assert_eq!(balls[0].position.x, 95.0);
            assert_eq!(balls[2].position, DVec2::new(5.0, 55.0));
            assert_eq!(balls[3], begun[3]);
            assert!(!bring_strays_in(&world, &mut balls, solver));
        }
        let mut left = begun;
        assert!(!bring_strays_in(&world, &mut left, Solver::Canvas));
        assert_eq!(left, begun);
    }

    #[test]
    fn a_row_that_is_too_long_for_its_walls_gives_way_to_the_side() {
        // The last of ten on the floor is brought in where the row before was full, each time.
        let mut balls: Vec<Ball> = (0..10).map(|k| ball(11.0 + 22.0 * f64::from(k), 290.0, 10.0)).collect();
        for width in (160..220).rev().step_by(2) {
            let from = DVec2::new(f64::from(width + 2), 300.0);
            let world = world(f64::from(width), 300.0);
            bring_in(&world, from, &mut balls, true);
            let deepest = overlap(&world, &balls);
            assert!(deepest < 1e-8, "{width} px wide: {deepest}");
        }
        assert!(balls.iter().all(|ball| ball.position.y > 240.0), "no higher than they must: {balls:?}");
    }

    #[test]
    fn a_pile_that_a_wall_is_drawn_over_is_not_pressed_into_itself_where_there_is_room_above() {
        // Rows of twenty that touch as good as, twenty high, under as much room again.
        let place = |k: u32| (5.0 + 10.1 * f64::from(k % 20), 395.0 - 10.1 * f64::from(k / 20));
        let mut balls: Vec<Ball> = (0..400).map(place).map(|(x, y)| ball(x, y, 5.0)).collect();
        let mut deepest: f64 = 0.0;
        for width in (160..202).rev() {
            let (from, world) = (DVec2::new(f64::from(width + 1), 400.0), world(f64::from(width), 400.0));
            bring_in(&world, from, &mut balls, true);
            deepest = deepest.max(overlap(&world, &balls));
        }
        assert!(deepest < 0.5, "{deepest}");
    }

    #[test]
    fn balls_give_way_to_a_wall_in_whatever_order_they_are_listed() {
        let (free, post) = (ball(390.0, 290.0, 10.0), ball(370.0, 290.0, 10.0).fixed());
        for order in [[free, post], [post, free]] {
            let mut balls = order.to_vec();
            for width in (390..400).rev().step_by(2) {
                let from = DVec2::new(f64::from(width + 2), 300.0);
                bring_in(&world(f64::from(width), 300.0), from, &mut balls, true);
            }
            let deepest = overlap(&world(390.0, 300.0), &balls);
            assert!(deepest < 1e-8, "{order:?}: {deepest}");
        }
    }

    #[test]
    fn where_there_is_no_room_balls_are_left_as_they_are() {
        let balls: Vec<Ball> = (0..50).map(|k| ball(5.0 + f64::from(k % 10), 5.0, 5.0)).collect();
        let mut crowd = balls.clone();
        take_apart(&world(30.0, 30.0), &mut crowd);
        assert_eq!(crowd, balls);
    }
}
