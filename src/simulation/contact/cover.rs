//! What covers a ball: the disc in which the last search for pairs has looked. Where single balls leave theirs, their pairs
//! alone are looked for.

use glam::DVec2;

use super::super::grid::Disc;
use super::find::{Cells, FEW, Near, in_cells, is_clear};
use super::holds::Pair;
use super::layout::Layer;
use super::stripes::{Stripe, of_layer};
use super::team::Team;
use super::{Body, Setting};

/// All pairs are searched anew where more than one in so many balls would have to be covered anew ...
const MANY: usize = 24;
/// ... or pairs have become more by one in so many.
const MORE: usize = 4;
/// Balls are a crowd where there are more pairs than so many for each, and of these more overlap than so many for each:
/// balls that lie beside each other touch in no more than three.
const CROWD: (usize, usize) = (32, 8);

/// The place around which a ball is covered, and how far from there it may go before it is covered anew, px.
#[derive(Debug, Clone, Copy)]
pub(super) struct Home {
    pub(super) position: DVec2,
    pub(super) reach: f64,
}

impl Home {
    /// The covered place nearest to `to`.
    pub(super) fn limit(&self, to: DVec2) -> DVec2 {
        self.position + (to - self.position).clamp_length_max(self.reach)
    }

    #[inline]
    pub(super) fn covers(&self, place: DVec2) -> bool {
        place.distance_squared(self.position) <= self.reach * self.reach
    }
}

/// The disc that a ball stays in while it is covered.
#[derive(Debug, Clone, Copy)]
pub(super) struct Covered {
    pub(super) centre: DVec2,
    pub(super) radius: f64,
}

impl Disc for Covered {
    fn centre(&self) -> DVec2 {
        self.centre
    }

    fn radius(&self) -> f64 {
        self.radius
    }
}

impl Near {
    /// Whether balls lie so deep in each other, as in a world that shrank, that what covers one covers most. Then none is
    /// covered anew: whoever leaves what covers it stops there until pairs are searched again.
    pub(super) fn are_crowd(&self, bodies: &[Body]) -> bool {
        let (count, (near, overlapping)) = (bodies.len(), CROWD);
        if count <= FEW || self.found <= near * count {
            return false;
        }
        let overlaps = |&(first, second): &(usize, usize)| {
            let (first, second) = (&bodies[first], &bodies[second]);
            let reach = first.radius + second.radius;
            first.position.distance_squared(second.position) < reach * reach
        };
        self.pairs().filter(overlaps).count() > overlapping * count
    }

    /// Covers all balls in a substep in which nothing hits them, if few are not covered yet; whether it could.
    pub(super) fn keep_up(&mut self, bodies: &[Body], setting: &Setting, team: &Team) -> bool {
        let many = bodies.len() / MANY;
        if self.homes.len() != bodies.len() || self.moved > many || self.added > self.found / MORE + FEW {
            return false;
        }
        let covers = |(home, body): (&Home, &Body)| home.covers(body.end(setting.substep));
        let layout = self.layout;
        let shares = layout.share_read(Layer::Own, &self.homes).zip(layout.share_read(Layer::Own, bodies));
        let shares = shares.zip(of_layer(&mut self.stripes, layout, Layer::Own));
        team.each(shares, |((homes, bodies), stripe)| {
            let leaving = homes.iter().zip(bodies).filter(|&ball| !covers(ball)).count();
            stripe.leaving = leaving + stripe.strays.len();
        });
        let leaving = |stripe: &Stripe| stripe.leaving;
        let left: usize = of_layer(&mut self.stripes, layout, Layer::Own).iter().map(leaving).sum();
        if left == 0 {
            return true;
        }
        if bodies.len() <= FEW || left > many || self.crowd {
            return false;
        }
        for number in 0..layout.numbers(Layer::Own).end {
            if self.stripes[number].leaving == 0 {
                continue;
            }
            let start = layout.start(number);
            for at in start..start + layout.count(number, bodies.len()) {
                if !covers((&self.homes[at], &bodies[at])) {
                    self.cover_anew(at, bodies, setting);
                }
            }
            while let Some(at) = self.stripes[number].strays.pop() {
                self.cover_anew(start + at as usize, bodies, setting);
            }
        }
        true
    }

    /// Covers a ball that was hit at `time` s into this substep on its way to the end of it, if it is not covered
    /// there.
    pub(super) fn widen(&mut self, at: usize, time: f64, bodies: &[Body], setting: &Setting) {
        let (body, end) = (&bodies[at], bodies[at].end(setting.substep));
        if !self.homes[at].covers(end) && !self.crowd {
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
        self.link_pairs_of(at, bodies.len());
        self.moved += usize::from(self.is_as_sorted(at, bodies));
        self.homes[at] = home;
        if let Some(Cells { grid, .. }) = &mut self.cells {
            let centre = in_cells(self.turned, home.position);
            grid.insert(at as u32, &Covered { centre, radius: bodies[at].radius + home.reach });
        }
        if self.seeks_pairs {
            self.find_more_pairs(at, bodies, setting);
        }
        if setting.walls.is_some() && !is_clear(home.position, bodies[at].radius + home.reach, setting.size) {
            let number = self.layout.own_of(at);
            let body = at - self.layout.start(number);
            self.stripes[number].add_beside(body as u32, DVec2::ZERO);
        }
    }

    /// Links the stripes of a ball, of so many in all, as far as they are not linked yet.
    fn link_pairs_of(&mut self, at: usize, count: usize) {
        for number in self.layout.of_body(at) {
            self.stripes[number].link(self.layout.count(number, count));
        }
    }

    /// Whether a ball is covered as it was when balls were last sorted into cells.
    fn is_as_sorted(&self, at: usize, bodies: &[Body]) -> bool {
        let home = &self.homes[at];
        let as_sorted = |disc: &Covered| {
            disc.centre == in_cells(self.turned, home.position)
                && disc.radius == bodies[at].radius + home.reach
        };
        self.discs.get(at).is_some_and(as_sorted)
    }

    /// Adds the pairs of a ball that it does not have yet.
    fn find_more_pairs(&mut self, at: usize, bodies: &[Body], setting: &Setting) {
        let place = in_cells(self.turned, self.homes[at].position);
        let Self { layout, stripes, crossing, homes, cells, known, added, .. } = self;
        known.begin(bodies.len());
        for number in layout.of_body(at) {
            let (stripe, start) = (&stripes[number], layout.start(number));
            for place in stripe.links.of((at - start) as u32) {
                let pair = stripe.pairs[place].from(start);
                known.add(pair.first);
                known.add(pair.second);
            }
        }
        let (ball, home) = (&bodies[at], homes[at]);
        let up = -setting.kick;
        let before = *added;
        let mut consider = |other: usize| {
            let (body, its) = (&bodies[other], &homes[other]);
            let reach = ball.radius + home.reach + body.radius + its.reach;
            let touches = its.position.distance_squared(home.position) <= reach * reach;
            if other == at || !touches || !known.add(other as u32) {
                return;
            }
            let upper = (ball.position - body.position).dot(up) >= 0.0;
            let (first, second) = if upper { (at, other) } else { (other, at) };
            let number = layout.of_pair(first, second);
            if number != layout.own_of(first) {
                (crossing[first], crossing[second]) = (true, true);
            }
            let start = layout.start(number);
            let pair = Pair { first: (first - start) as u32, second: (second - start) as u32 };
            stripes[number].add_pair(pair, ball.inverse_mass, body.inverse_mass);
            *added += 1;
        };
        match cells {
            Some(Cells { grid, .. }) if bodies.len() > FEW => {
                grid.for_each_near(place, ball.radius + home.reach, |other| consider(other as usize));
            }
            _ => (0..bodies.len()).for_each(consider),
        }
        if *added > before {
            self.link_pairs_of(at, bodies.len());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Contact, Tuning};
    use super::*;
    use crate::simulation::ball::Ball;
    use crate::simulation::world::{Pairs, World};

    /// Whether so many balls, `step` px apart, are a crowd, where one of them has this speed.
    fn are_crowd(count: u32, step: f64, radius: f64, speed: f64) -> bool {
        let side = f64::from(count).sqrt().ceil();
        let place = |k: u32| DVec2::new(f64::from(k) % side, (f64::from(k) / side).floor()) * step + 100.0;
        let ball = |k: u32| Ball::new(place(k), radius).unwrap();
        let mut balls: Vec<_> = (0..count).map(ball).collect();
        balls[0] = ball(0).with_velocity(DVec2::new(speed, 0.0)).unwrap();
        let world = World::new(DVec2::splat(4000.0)).unwrap().with_walls(1.0).unwrap();
        let world = world.with_pairs(Pairs::Impulse);
        let tuning = Tuning { rest_speed: 1.0, substeps: None, sleep: false, threads: 1 };
        let mut contact = Contact::new(&world, &balls, tuning);
        contact.find();
        let near = contact.near.unwrap();
        assert!(speed == 0.0 || near.found > CROWD.0 * balls.len(), "{} near pairs", near.found);
        near.crowd
    }

    #[test]
    fn balls_are_a_crowd_where_they_lie_in_each_other_and_not_where_a_fast_one_widens_the_search() {
        assert!(are_crowd(1000, 1.0, 6.0, 0.0));
        assert!(!are_crowd(1000, 12.01, 6.0, 3e5));
        assert!(!are_crowd(1000, 12.01, 6.0, 0.0));
    }
}
