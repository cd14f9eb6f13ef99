//! Rows of balls along a wall that are longer than the room that they have.
//!
//! In a crash balls are driven in between others that cannot give way so soon. Equal ones lie on one line then, along which what
//! would part them cancels: however hard they are pressed, none is ever pushed off the wall, and two may lie in one place. So one
//! of two that lie deep in each other is moved off the wall, a little in each substep, until what presses on it pushes it
//! out of the row, as a bar that is pressed too hard buckles (Euler 1744).

use glam::DVec2;

use super::super::lesser::lesser;
use super::super::within;
use super::near::Near;
use super::sleep::{DEEP, Rest};
use super::wake::wake_if_asleep;
use super::{Body, Contact, Setting};

/// Whether any row is too long is looked at after so many of the shortest substeps, eight beats; and then in each until none is, ...
const PERIOD: u64 = 32;
/// ... or so many are over: there may be no room above it either. Then it waits as long, and twice as long each time after, so
/// that what cannot part comes to rest.
const PATIENCE: u64 = 960;
/// ... but no more often than so many times: there may be rows elsewhere that can.
const DOUBLINGS: u32 = 4;
/// A ball is in the row where it is no farther from the wall than this part of its radius.
const OFF: f64 = 0.5;
/// Balls press on each other where they are no farther apart than this part of the smaller radius.
const APART: f64 = 1e-3;
/// A ball is moved off the wall at this part of the speed with which overlaps are taken away at most. With half of that, what lies on
/// it keeps it down. In a substep by no more than is deep.
const LIFTED: f64 = 0.6;
/// Where the opposite wall is no farther away than this, in radii, there is no other way to go.
const NARROW: f64 = 4.0;

/// Rows of balls along walls.
#[derive(Debug, Clone, Default)]
pub(super) struct Rows {
    /// In how many substeps in a row balls were moved.
    tries: u64,
    /// How often that was in vain, and until which step it waits.
    waits: u32,
    until: u64,
    /// The row that is looked at, and the bodies that are to be moved off their walls.
    row: Vec<Link>,
    lifted: Vec<(usize, Wall)>,
}

/// A wall, by the axis that it is across, at its high or its low end.
#[derive(Debug, Clone, Copy)]
struct Wall {
    axis: usize,
    high: bool,
}

/// A ball of a row.
#[derive(Debug, Clone, Copy)]
struct Link {
    at: usize,
    place: DVec2,
    radius: f64,
    moves: bool,
}

impl Contact {
    /// Moves balls off walls along which they are squeezed.
    pub(super) fn part_rows(&mut self) {
        // What flies through others is squeezed by none.
        let Self { setting, bodies, rests, near: Some(near), substeps, steps, rows, pairs: true, .. } = self
        else {
            return;
        };
        let looks = rows.tries > 0 || steps.is_multiple_of(PERIOD * substeps.shortest());
        if !looks || *steps < rows.until || setting.walls.is_none() || setting.kick == DVec2::ZERO {
            return;
        }
        let Rows { tries, waits, until, row, lifted } = rows;
        lifted.clear();
        for wall in Wall::ALL {
            wall.find_row(setting, bodies, rests, near, row);
            lifted.extend(wall.squeezed(setting, row).map(|at| (at, wall)));
        }
        if lifted.is_empty() {
            // Soon after a wait, or in the midst of tries, none may lie too deep by chance.
            let idle = std::mem::take(tries) == 0;
            if idle && *steps >= *until + PATIENCE * substeps.shortest() {
                *waits = 0;
            }
            return;
        }
        *tries += 1;
        if *tries > PATIENCE {
            *until = *steps + (PATIENCE << *waits) * substeps.shortest();
            (*tries, *waits) = (0, (*waits + 1).min(DOUBLINGS));
            return;
        }
        near.link_pairs(bodies.len());
        let stripes = &mut near.all();
        for &(at, wall) in &*lifted {
            let around: Vec<_> = stripes.around(at).collect();
            for ball in std::iter::once(at).chain(around) {
                wake_if_asleep(ball, setting.kick, bodies, rests, stripes);
            }
            let body = &mut bodies[at];
            let far = lesser(LIFTED * setting.mending * setting.substep * 2.0, DEEP) * body.radius;
            body.position = within(body.position + wall.inward() * far, body.radius, setting.size);
        }
        self.wake_unbalanced();
    }
}

impl Wall {
    const ALL: [Self; 4] = [
        Self { axis: 0, high: false },
        Self { axis: 0, high: true },
        Self { axis: 1, high: false },
        Self { axis: 1, high: true },
    ];

    /// The direction away from it.
    fn inward(self) -> DVec2 {
        DVec2::AXES[self.axis] * if self.high { -1.0 } else { 1.0 }
    }

    /// How far away a place is, px.
    fn distance(self, setting: &Setting, place: DVec2) -> f64 {
        let along = place[self.axis];
        if self.high { setting.size[self.axis] - along } else { along }
    }

    /// Finds the balls along it, in their order.
    fn find_row(self, setting: &Setting, bodies: &[Body], rests: &[Rest], near: &Near, row: &mut Vec<Link>) {
        row.clear();
        let links = near.beside().map(|(at, _)| {
            let Body { position, radius, .. } = bodies[at];
            // What is unlike those around it may bear many times what it weighs, and would lift that, too.
            let narrow = setting.size[self.axis] < NARROW * radius;
            let moves = !rests[at].unlike.differs() && !narrow;
            Link { at, place: position, radius, moves }
        });
        row.extend(links.filter(|link| self.distance(setting, link.place) < (1.0 + OFF) * link.radius));
        let along = 1 - self.axis;
        row.sort_unstable_by(|one, other| {
            one.place[along].total_cmp(&other.place[along]).then(one.at.cmp(&other.at))
        });
    }

    /// Those of its row that are to be moved: of two that lie deep in each other the one farther off, which is pressed from its
    /// other side, too, and none beside another one.
    fn squeezed(self, setting: &Setting, row: &[Link]) -> impl Iterator<Item = usize> {
        let along = 1 - self.axis;
        let gap = |one: &Link, other: &Link| {
            let apart = one.place.distance(other.place) - one.radius - other.radius;
            apart / one.radius.min(other.radius)
        };
        // What is before the first and behind the last is a wall. (Fixed balls are in no row: of two between such ones neither is moved.)
        let before = move |k: usize| match k.checked_sub(1) {
            Some(before) => gap(&row[before], &row[k]),
            None => row[k].place[along] / row[k].radius - 1.0,
        };
        let behind = move |k: usize| match row.get(k + 1) {
            Some(behind) => gap(&row[k], behind),
            None => (setting.size[along] - row[k].place[along]) / row[k].radius - 1.0,
        };
        let mut last = None;
        (1..row.len()).filter_map(move |second| {
            let first = second - 1;
            if before(second) > -DEEP || last == Some(first) {
                return None;
            }
            let first_may =
                row[first].moves && before(first) < APART && (first == 0 || last != Some(first - 1));
            let second_may = row[second].moves && behind(second) < APART;
            let far = |k: usize| self.distance(setting, row[k].place) - row[k].radius;
            let moved = match (first_may, second_may) {
                (true, true) if far(second) > far(first) => second,
                (true, _) => first,
                (false, true) => second,
                (false, false) => return None,
            };
            last = Some(moved);
            Some(row[moved].at)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::ball::Ball;
    use super::super::Tally;
    use super::super::testing::{TUNING, boxed_world};
    use super::*;

    /// Balls of radius 10 at these places in a box.
    fn boxed(size: DVec2, places: impl Iterator<Item = DVec2>) -> Contact {
        let balls: Vec<Ball> = places.map(|place| Ball::new(place, 10.0).unwrap()).collect();
        Contact::new(&boxed_world(size), &balls, TUNING)
    }

    /// The same on the floor of one of this width, at these places along it.
    fn lying(width: f64, along: &[f64]) -> Contact {
        boxed(DVec2::new(width, 400.0), along.iter().map(|&x| DVec2::new(x, 390.0)))
    }

    /// Six of them between walls that leave room for five and a half.
    fn squeezed() -> Contact {
        lying(110.0, &[10.0, 28.0, 46.0, 64.0, 82.0, 100.0])
    }

    /// How far the balls are off the floor after a substep, by their order along it.
    fn off_floor(mut contact: Contact) -> Vec<f64> {
        contact.step(&mut Tally::default());
        contact.rows.tries = 1;
        contact.part_rows();
        let mut balls: Vec<_> = contact.bodies.iter().map(|body| body.position).collect();
        balls.sort_by(|one, other| one.x.total_cmp(&other.x));
        balls.iter().map(|place| 390.0 - place.y).collect()
    }

    #[test]
    fn of_a_row_that_has_no_room_every_other_ball_is_moved_off_the_wall() {
        let off = off_floor(squeezed());
        assert!(off.iter().step_by(2).all(|&off| off > 0.1), "{off:?}");
        assert!(off.iter().skip(1).step_by(2).all(|&off| off.abs() < 1e-9), "{off:?}");
    }

    #[test]
    fn balls_with_room_beside_them_stay_on_the_wall_however_deep_they_lie_in_each_other() {
        let off = off_floor(lying(400.0, &[100.0, 108.0, 250.0, 270.0, 290.0]));
        assert!(off.iter().all(|&off| off.abs() < 1e-9), "{off:?}");
    }

    #[test]
    fn what_flies_through_others_stays_on_the_wall() {
        let off = off_floor(Contact { pairs: false, near: Some(Near::new(false)), ..squeezed() });
        assert!(off.iter().all(|&off| off.abs() < 1e-9), "{off:?}");
    }

    #[test]
    fn of_two_that_are_squeezed_the_one_farther_off_the_wall_is_moved() {
        let contact = lying(110.0, &[10.0]);
        let link = |at: usize, x: f64, off: f64| Link {
            at,
            place: DVec2::new(x, 390.0 - off),
            radius: 10.0,
            moves: true,
        };
        let row = [link(0, 10.0, 0.0), link(1, 27.0, 0.0), link(2, 44.0, 2.0), link(3, 62.0, 0.0)];
        let floor = Wall { axis: 1, high: true };
        let moved: Vec<usize> = floor.squeezed(&contact.setting, &row[1..3]).collect();
        assert!(moved.is_empty(), "there is room beside both: {moved:?}");
        let setting = Setting { size: DVec2::new(71.0, 400.0), ..contact.setting };
        assert_eq!(floor.squeezed(&setting, &row).collect::<Vec<_>>(), [0, 2]);
        let setting = Setting { size: DVec2::new(54.0, 400.0), ..contact.setting };
        let two = [link(0, 9.0, 0.0), link(1, 26.0, 2.0), link(2, 43.0, 0.0)];
        assert_eq!(floor.squeezed(&setting, &two).collect::<Vec<_>>(), [1]);
    }

    #[test]
    fn what_has_no_room_off_the_wall_either_is_moved_ever_more_seldom() {
        // Too many between the walls, and a ceiling that is just above them.
        let size = DVec2::new(100.0, 45.0);
        let place = |k: u32| 10.0 + DVec2::new(80.0 / 6.0 * f64::from(k % 7), 25.0 * f64::from(k / 7));
        let mut contact = boxed(size, (0..14).map(place));
        let mut moved = 0;
        while contact.steps < 60 * u64::from(contact.substeps.rate) {
            contact.step(&mut Tally::default());
            moved += u64::from(contact.rows.tries > 0);
            let inside = |body: &Body| within(body.position, body.radius, size) == body.position;
            assert!(contact.bodies.iter().all(inside));
        }
        assert!(moved > 0 && moved < 6 * PATIENCE, "{moved}");
    }

    #[test]
    fn equal_balls_on_a_floor_that_is_too_short_for_all_come_to_rest_on_each_other() {
        // Sixty, of which fifty have room: more than few.
        let along: Vec<f64> = (0..60).map(|k| 10.0 + 980.0 / 59.0 * f64::from(k)).collect();
        let mut contact = lying(1000.0, &along);
        while contact.steps < 10 * u64::from(contact.substeps.rate) {
            contact.step(&mut Tally::default());
        }
        assert!(contact.all_asleep);
        let deepest =
            contact.near.as_ref().unwrap().pairs().map(|(one, other)| {
                20.0 - contact.bodies[one].position.distance(contact.bodies[other].position)
            });
        let deepest = deepest.fold(0.0, f64::max);
        assert!(deepest < 0.5, "{deepest}");
    }
}
