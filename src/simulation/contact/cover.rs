//! Single balls that go where the last search for pairs does not cover them: their pairs alone are looked for.

use glam::DVec2;

use super::find::{Beside, FEW, Hold, Home, Near, Pair, Reach, is_clear};
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

    /// Covers a ball that was hit at `time` s into this substep on its way to the end of it, if it is not covered there.
    pub(super) fn widen(&mut self, at: usize, time: f64, bodies: &[Body], setting: &Setting) {
        let (body, end) = (&bodies[at], bodies[at].end(setting.substep));
        if !self.homes[at].covers(end) {
            let way = 0.5 * body.velocity * (setting.substep - time);
            let home = Home { position: end - way, reach: way.length() + self.skin(body, setting) };
            self.change_home(at, home, bodies, setting);
        }
    }

    /// Covers a ball from where it is now.
    fn cover_anew(&mut self, at: usize, bodies: &[Body], setting: &Setting) {
        let home = self.cover(bodies.len(), setting)(&bodies[at]);
        self.change_home(at, home, bodies, setting);
    }

    /// Gives a ball another home, and links the pairs that it finds there.
    fn change_home(&mut self, at: usize, home: Home, bodies: &[Body], setting: &Setting) {
        self.link_pairs(bodies.len());
        if self.is_as_sorted(at, bodies) {
            self.moved.push(at as u32);
        }
        self.homes[at] = home;
        if self.seeks_pairs {
            self.find_more_pairs(at, bodies, setting);
        }
        let beside_wall =
            setting.walls.is_some() && !is_clear(home.position, bodies[at].radius + home.reach, setting.size);
        if beside_wall && self.place_beside(at as u32).is_none() {
            self.places_beside[at] = self.beside.len() as u32;
            self.beside.push(Beside { body: at as u32, push: DVec2::ZERO });
        }
    }

    /// Whether a ball is covered as it was when balls were last sorted into cells.
    fn is_as_sorted(&self, at: usize, bodies: &[Body]) -> bool {
        let home = &self.homes[at];
        let as_sorted =
            |disc: &Reach| disc.centre == home.position && disc.radius == bodies[at].radius + home.reach;
        self.discs.get(at).is_some_and(as_sorted)
    }

    /// Adds the pairs of a ball that it does not have yet.
    fn find_more_pairs(&mut self, at: usize, bodies: &[Body], setting: &Setting) {
        let Self { pairs, holds, held, idle, close, homes, grid, moved, links, known, .. } = self;
        known.begin(bodies.len());
        for place in links.of(at as u32) {
            known.add(pairs[place].first);
            known.add(pairs[place].second);
        }
        let (ball, home) = (&bodies[at], homes[at]);
        let up = -setting.kick;
        let mut consider = |other: usize| {
            let (body, its) = (&bodies[other], &homes[other]);
            let reach = ball.radius + home.reach + body.radius + its.reach;
            let give = ball.inverse_mass + body.inverse_mass;
            let touches = its.position.distance_squared(home.position) <= reach * reach;
            if other == at || !touches || !known.add(other as u32) {
                return;
            }
            let upper = (ball.position - body.position).dot(up) >= 0.0;
            let (first, second) = if upper { (at, other) } else { (other, at) };
            pairs.push(Pair { first: first as u32, second: second as u32 });
            idle.push(give == 0.0);
            close.push(true);
            if setting.rests {
                holds.push(Hold { mass: give.recip(), ..Hold::NONE });
                held.push(false);
            }
        };
        match grid {
            Some((grid, _)) if bodies.len() > FEW => {
                // The cells know the others as they were when they were sorted.
                grid.for_each_near(home.position, ball.radius + home.reach, |other| consider(other as usize));
                for &other in &*moved {
                    consider(other as usize);
                }
            }
            _ => (0..bodies.len()).for_each(consider),
        }
        links.link(pairs, bodies.len());
    }
}
