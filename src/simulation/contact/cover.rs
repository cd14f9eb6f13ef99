//! Single balls that go where the last search for pairs does not cover them: their pairs alone are looked for.

use glam::DVec2;

use super::find::{Beside, FEW, Hold, Home, Near, Pair, is_clear};
use super::{Body, Setting};

/// All pairs are searched anew where more than one in so many balls would have to be covered anew ...
const MANY: usize = 24;
/// ... or pairs have become more by one in so many.
const MORE: usize = 4;

impl Near {
    /// Covers all balls in a substep in which nothing hits them, if few are not covered yet. Whether that could be done.
    pub(super) fn keep_up(&mut self, bodies: &[Body], setting: &Setting) -> bool {
        let many = bodies.len() / MANY;
        if self.homes.len() != bodies.len()
            || self.moved.len() > many
            || self.pairs.len() > self.found + self.found / MORE + FEW
        {
            return false;
        }
        let covers = |(home, body): (&Home, &Body)| home.covers(body.end(setting.substep));
        let left = self.homes.iter().zip(bodies).filter(|&ball| !covers(ball)).count() + self.strays.len();
        if left == 0 {
            return true;
        }
        if bodies.len() <= FEW || left > many {
            return false;
        }
        for at in 0..bodies.len() {
            if !covers((&self.homes[at], &bodies[at])) {
                self.cover_anew(at, bodies, setting);
            }
        }
        while let Some(at) = self.strays.pop() {
            self.cover_anew(at as usize, bodies, setting);
        }
        true
    }

    /// Covers a ball that was hit so that it goes as far as `end` in this substep, if it is not covered there. Whether
    /// that has found new pairs.
    pub(super) fn widen(&mut self, at: usize, end: DVec2, bodies: &[Body], setting: &Setting) -> bool {
        let home = self.homes[at];
        let far = end.distance(home.position);
        if far <= home.reach {
            return false;
        }
        // Twice as far, since it may be hit again.
        self.change_home(at, Home { reach: 2.0 * far, ..home }, bodies, setting)
    }

    /// Covers a ball from where it is now.
    fn cover_anew(&mut self, at: usize, bodies: &[Body], setting: &Setting) {
        let home = self.cover(bodies.len(), setting)(&bodies[at]);
        self.change_home(at, home, bodies, setting);
    }

    /// Gives a ball another home. Whether that has found new pairs.
    fn change_home(&mut self, at: usize, home: Home, bodies: &[Body], setting: &Setting) -> bool {
        self.link_pairs(bodies.len());
        let count = self.pairs.len();
        self.homes[at] = home;
        if self.seeks_pairs {
            self.find_more_pairs(at, bodies, setting);
        }
        let beside_wall = setting.walls.is_some()
            && !is_clear(home.position, bodies[at].radius + home.reach, setting.size)
            && bodies[at].inverse_mass > 0.0;
        if beside_wall && self.place_beside(at as u32).is_none() {
            self.beside.push(Beside { body: at as u32, push: DVec2::ZERO });
        }
        self.pairs.len() > count
    }

    /// Adds the pairs of a ball that it does not have yet.
    fn find_more_pairs(&mut self, at: usize, bodies: &[Body], setting: &Setting) {
        let Self { pairs, holds, held, idle, close, homes, grid, discs, moved, links, .. } = self;
        let (ball, home) = (&bodies[at], homes[at]);
        let up = -setting.kick;
        let mut consider = |other: usize| {
            let (body, its) = (&bodies[other], &homes[other]);
            let reach = ball.radius + home.reach + body.radius + its.reach;
            let give = ball.inverse_mass + body.inverse_mass;
            if other == at || give == 0.0 || its.position.distance_squared(home.position) > reach * reach {
                return;
            }
            let is_known =
                |place: usize| pairs[place].first == other as u32 || pairs[place].second == other as u32;
            if links.of(at as u32).any(is_known) {
                return;
            }
            let upper = (ball.position - body.position).dot(up) >= 0.0;
            let (first, second) = if upper { (at, other) } else { (other, at) };
            pairs.push(Pair { first: first as u32, second: second as u32 });
            idle.push(false);
            close.push(true);
            if setting.rests {
                holds.push(Hold { mass: give.recip(), ..Hold::NONE });
                held.push(false);
            }
        };
        match grid {
            Some((grid, _)) if bodies.len() > FEW => {
                // The cells know the others as they were when they were sorted.
                let is_as_sorted = |other: usize| {
                    let (disc, its) = (&discs[other], &homes[other]);
                    disc.centre == its.position && disc.radius == bodies[other].radius + its.reach
                };
                grid.for_each_near(home.position, ball.radius + home.reach, |other| {
                    if is_as_sorted(other as usize) {
                        consider(other as usize);
                    }
                });
                for &other in &*moved {
                    consider(other as usize);
                }
                if !moved.contains(&(at as u32)) {
                    moved.push(at as u32);
                }
            }
            _ => (0..bodies.len()).for_each(consider),
        }
        links.link(pairs, bodies.len());
    }
}
