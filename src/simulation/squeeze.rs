//! Squeezes balls into a world that has become smaller, all as one: what walls push ball by ball crushes itself where it lies dense,
//! since those behind have no way out but far off, where the pile ends.
//!
//! A pile between walls that come nearer rises everywhere, as a liquid would. So places are mapped along one axis after the other: what
//! was in front of another stays so, and lengths shrink evenly, but nowhere to less than what lies there needs. Across gravity comes
//! first; what lies there then needs more height. Overlaps that are left are between neighbours, and few sweeps take them apart
//! (`separate`). Where there is no room for all, they come to lie in each other everywhere alike.

use std::f64::consts::PI;

use glam::DVec2;

use super::ball::Ball;
use super::within;
use super::world::World;

/// Balls need so much of an area that they fill this part of it, somewhat less than in a pile.
const FILLED: f64 = 0.8;
/// What lies denser needs no more than its own area, and so many times of what that is narrowed by: without more, few sweeps do not
/// take it apart; with much more, a pile is raised by each step of a wall, and falls.
const LOOSENED: f64 = 1.05;
/// Slices across an axis, at most.
const SLICES: f64 = 1024.0;
/// Halvings that find a length to rounding.
const HALVINGS: u32 = 60;

/// Maps places of balls between walls of a world as large as `from` to a world.
pub(super) fn squeeze(world: &World, from: DVec2, balls: &mut [Ball]) {
    let gravity = world.gravity.unwrap_or_default().abs();
    let along = usize::from(gravity.y >= gravity.x);
    let (mut size, mut narrowed) = (from, 1.0);
    for axis in [1 - along, along] {
        Slices::across(axis, size, balls, narrowed).map_to(world.size[axis], axis, balls);
        narrowed = (from[axis] / world.size[axis]).max(1.0);
        size[axis] = world.size[axis];
    }
    for ball in balls {
        ball.position = within(ball.position, ball.radius, world.size);
    }
}

/// A world in slices across an axis.
struct Slices {
    /// How thick each is, px.
    thickness: f64,
    /// How thick each has to be for what lies in it, px.
    needed: Vec<f64>,
}

impl Slices {
    /// Those of a world of this size, which is so many times as narrow as it was when balls lay in it as they do along the axis.
    fn across(axis: usize, size: DVec2, balls: &[Ball], narrowed: f64) -> Self {
        let widest = balls.iter().map(|ball| 2.0 * ball.radius).fold(0.0, f64::max);
        let count = (size[axis] / widest).floor().clamp(1.0, SLICES);
        let thickness = size[axis] / count;
        let mut needed = vec![0.0; count as usize];
        for &Ball { position, radius, .. } in balls {
            // As if it were a square: slices are thicker than it.
            let share = 0.5 * PI * radius / (FILLED * size[1 - axis]);
            let [low, high] = [-radius, radius].map(|by| (position[axis] + by).clamp(0.0, size[axis]));
            let first = ((low / thickness) as usize).min(needed.len() - 1);
            let slices =
                (first..).zip(&mut needed[first..]).map(|(slice, needed)| (thickness * slice as f64, needed));
            for (begin, needed) in slices.take_while(|&(begin, _)| begin < high) {
                *needed += share * (high.min(begin + thickness) - low.max(begin));
            }
        }
        let most = thickness * (1.0 + LOOSENED * (narrowed - 1.0));
        for needed in &mut needed {
            *needed = needed.min(most);
        }
        Self { thickness, needed }
    }

    /// Maps places along the axis so that all are as long together as this.
    fn map_to(&self, length: f64, axis: usize, balls: &mut [Ball]) {
        let Self { thickness, needed } = self;
        // As thick as each is at least.
        let (mut least, mut too_thick) = (0.0, 2.0 * length.max(*thickness));
        let total = |least: f64| needed.iter().map(|needed| needed.max(least)).sum::<f64>();
        for _ in 0..HALVINGS {
            let middle = 0.5 * (least + too_thick);
            if total(middle) > length { too_thick = middle } else { least = middle }
        }
        // Less than they need, where there is no room.
        let part = length / total(least);
        let mut begins = vec![0.0];
        begins.extend(needed.iter().scan(0.0, |end, needed| {
            *end += part * needed.max(least);
            Some(*end)
        }));
        for ball in balls {
            let place = (ball.position[axis] / thickness).clamp(0.0, needed.len() as f64);
            let slice = (place as usize).min(needed.len() - 1);
            let [begin, end] = [begins[slice], begins[slice + 1]];
            ball.position[axis] = begin + (end - begin) * (place - slice as f64);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn world(width: f64, height: f64, gravity: DVec2) -> World {
        World::new(DVec2::new(width, height)).unwrap().with_gravity(gravity).unwrap().with_walls(1.0).unwrap()
    }

    /// Rows of 41 balls of 10 px, which lie dense, on a floor of 400 px that is so far below the ceiling; and one alone under that.
    fn pile(rows: u32, floor: f64) -> Vec<Ball> {
        let place =
            |k: u32| DVec2::new(5.0 + 9.75 * f64::from(k % 41), floor - 5.0 - 10.0 * f64::from(k / 41));
        let places = (0..41 * rows).map(place).chain([DVec2::new(200.0, 5.0)]);
        places.map(|place| Ball::new(place, 5.0).unwrap()).collect()
    }

    /// How far places reach along an axis.
    fn reach(balls: &[Ball], axis: usize) -> [f64; 2] {
        let along = |ball: &Ball| ball.position[axis];
        [balls.iter().map(along).fold(f64::INFINITY, f64::min), balls.iter().map(along).fold(0.0, f64::max)]
    }

    #[test]
    fn a_pile_between_walls_half_as_far_apart_is_twice_as_high_whichever_way_it_falls() {
        for lies in [false, true] {
            let turn = |place: DVec2| if lies { DVec2::new(place.y, place.x) } else { place };
            let (mut balls, gravity) = (pile(10, 400.0), turn(DVec2::new(0.0, 980.0)));
            for ball in &mut balls {
                ball.position = turn(ball.position);
            }
            let before = balls.clone();
            let size = turn(DVec2::new(200.0, 400.0));
            squeeze(&world(size.x, size.y, gravity), DVec2::splat(400.0), &mut balls);
            let (across, along) = (usize::from(lies), usize::from(!lies));
            for (ball, was) in balls.iter().zip(&before) {
                let middle = was.position[across] / 2.0;
                assert!((ball.position[across] - middle).abs() < 5.0, "{ball:?} was at {}", was.position);
            }
            let (pile, high) = (&balls[..410], balls[410].position[along]);
            let height = 400.0 - reach(pile, along)[0];
            // Of centres, which lay in 95 px.
            assert!(
                (185.0..200.0).contains(&height) && high < 10.0,
                "{height} px, and {high} from the ceiling"
            );
        }
    }

    #[test]
    fn a_pile_on_a_floor_that_rises_keeps_its_shape() {
        let mut balls = pile(10, 400.0);
        squeeze(&world(400.0, 150.0, DVec2::new(0.0, 980.0)), DVec2::splat(400.0), &mut balls);
        for (ball, was) in balls[..410].iter().zip(pile(10, 150.0)) {
            let moved = ball.position.distance(was.position);
            assert!(moved < 1e-9, "{moved} px");
        }
    }

    #[test]
    fn where_there_is_no_room_for_all_they_lie_everywhere_alike() {
        let mut balls = pile(20, 400.0);
        squeeze(&world(400.0, 50.0, DVec2::new(0.0, 980.0)), DVec2::splat(400.0), &mut balls);
        for part in 0..4 {
            let [low, high] = [part, part + 1].map(|k| 12.5 * f64::from(k));
            let there = balls.iter().filter(|ball| (low..high).contains(&ball.position.y)).count();
            assert!((150..=280).contains(&there), "{there} of 821 from {low} to {high} px");
        }
    }

    #[test]
    fn what_flies_in_a_window_made_smaller_is_nowhere_pressed_together() {
        let place = |k: u32| DVec2::new(10.0 + 20.0 * f64::from(k % 20), 10.0 + 20.0 * f64::from(k / 20));
        let mut balls: Vec<Ball> = (0..400).map(|k| Ball::new(place(k), 5.0).unwrap()).collect();
        squeeze(&world(200.0, 400.0, DVec2::ZERO), DVec2::splat(400.0), &mut balls);
        for (ball, k) in balls.iter().zip(0..) {
            let moved = ball.position.distance(place(k) * DVec2::new(0.5, 1.0));
            assert!(moved < 1e-9, "{moved} px");
        }
    }
}
