//! What covers a ball: the disc in which the last search for pairs has looked. Where single balls leave theirs, their pairs
//! alone are looked for.

use std::mem::take;

use glam::DVec2;

use super::super::grid::Disc;
use super::constraints::Pair;
use super::find::{FEW_IN_ALL, in_cells, is_clear};
use super::layout::{Layer, Layout};
use super::near::{Cells, Near};
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
        if count <= FEW_IN_ALL || self.found <= near * count {
            return false;
        }
        let overlap = |&(first, second): &(usize, usize)| bodies[first].overlaps(&bodies[second], 0.0);
        self.pairs().filter(overlap).count() > overlapping * count
    }

    /// Covers all balls in a substep in which nothing hits them, if few are not covered yet; whether it could.
    pub(super) fn keep_up(&mut self, bodies: &[Body], setting: &Setting, team: &Team) -> bool {
        let many = bodies.len() / MANY;
        let added = self.pair_count() - self.found;
        if self.homes.len() != bodies.len() || self.moved > many || added > self.found / MORE + FEW_IN_ALL {
            return false;
        }
        let covers = |(home, body): (&Home, &Body)| home.covers(body.end(setting.substep));
        let layout = self.layout;
        let balls = layout.share_read(Layer::Own, &self.homes).zip(layout.share_read(Layer::Own, bodies));
        let shares = balls.zip(of_layer(&mut self.stripes, layout, Layer::Own));
        team.each(shares, |((homes, bodies), stripe)| {
            let Stripe { leaving, strays, .. } = stripe;
            leaving.clear();
            // Mostly there are none, and to count is faster than to gather.
            if homes.iter().zip(bodies).filter(|&ball| !covers(ball)).count() + strays.len() == 0 {
                return;
            }
            let is_covered = |at: u32| covers((&homes[at as usize], &bodies[at as usize]));
            leaving.extend((0..bodies.len() as u32).filter(|&at| !is_covered(at)));
            leaving.extend(strays.iter().filter(|&&at| is_covered(at)));
        });
        let left: usize = self.stripes.iter().map(|stripe| stripe.leaving.len()).sum();
        if left == 0 {
            return true;
        }
        if bodies.len() <= FEW_IN_ALL || left > many || self.crowd {
            return false;
        }
        let cover = self.cover(bodies.len(), setting);
        for number in layout.numbers(Layer::Own) {
            self.stripes[number].strays.clear();
            for place in 0..self.stripes[number].leaving.len() {
                let at = layout.start(number) + self.stripes[number].leaving[place] as usize;
                self.change_home(at, cover(&bodies[at]), bodies, setting);
            }
        }
        if self.seeks_pairs {
            let (around, stripes) = self.around(bodies, setting);
            let own = layout.share_stripes(Layer::Own, stripes);
            let changed = own.filter(|(_, stripes)| !stripes[0].leaving.is_empty());
            team.each(changed, |(number, stripes)| around.find_more_of(number, &mut stripes[0]));
            layout.numbers(Layer::Own).for_each(|number| self.add_across(number, bodies));
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
            self.rehome(at, home, bodies, setting);
        }
    }

    /// Covers a ball everywhere on a way. Pairs must be linked.
    pub(super) fn cover_way(
        &mut self,
        at: usize,
        (from, to): (DVec2, DVec2),
        bodies: &[Body],
        setting: &Setting,
    ) {
        if !(self.homes[at].covers(from) && self.homes[at].covers(to)) {
            let reach = 0.5 * from.distance(to) + self.skin(&bodies[at], setting);
            self.rehome(at, Home { position: from.midpoint(to), reach }, bodies, setting);
        }
    }

    /// Gives a ball another home, and finds its pairs there.
    fn rehome(&mut self, at: usize, home: Home, bodies: &[Body], setting: &Setting) {
        self.change_home(at, home, bodies, setting);
        if self.seeks_pairs {
            let (number, own) = self.layout.place_of(at);
            self.stripes[number].leaving.push(own);
            let (around, stripes) = self.around(bodies, setting);
            around.find_more_of(number, &mut stripes[number]);
            self.add_across(number, bodies);
        }
    }

    /// Gives a ball another home.
    fn change_home(&mut self, at: usize, home: Home, bodies: &[Body], setting: &Setting) {
        self.moved += usize::from(self.is_as_sorted(at, bodies));
        self.homes[at] = home;
        if let Some(Cells { grid, .. }) = &mut self.cells {
            let centre = in_cells(self.turned, home.position);
            grid.insert(at as u32, &Covered { centre, radius: bodies[at].radius + home.reach });
        }
        if setting.walls.is_some() && !is_clear(home.position, bodies[at].radius + home.reach, setting.size) {
            let (number, own) = self.layout.place_of(at);
            self.stripes[number].add_beside(own, DVec2::ZERO);
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

    /// What is around balls, and the stripes to which pairs are added.
    fn around<'a>(&'a mut self, bodies: &'a [Body], setting: &Setting) -> (Around<'a>, &'a mut [Stripe]) {
        let Self { layout, stripes, homes, cells, turned, .. } = self;
        let cells = cells.as_ref().filter(|_| bodies.len() > FEW_IN_ALL);
        let up = -setting.kick;
        (Around { layout: *layout, bodies, homes, cells, turned: *turned, up }, stripes)
    }

    /// Adds, and links, the pairs across the edges of a stripe that were gathered, as far as they are not there yet.
    fn add_across(&mut self, number: usize, bodies: &[Body]) {
        let Self { layout, stripes, crossing, .. } = self;
        let mut across = take(&mut stripes[number].across);
        for pair in across.drain(..) {
            let (first, second) = (pair.first as usize, pair.second as usize);
            let number = layout.of_pair(first, second);
            let (stripe, count) = (&mut stripes[number], layout.count(number, bodies.len()));
            let pair = pair.within(layout.start(number));
            stripe.link(count);
            let is_known =
                |at: usize| [stripe.pairs[at].first, stripe.pairs[at].second].contains(&pair.second);
            if stripe.links.of(pair.first).any(is_known) {
                continue;
            }
            stripe.add_pair(pair, bodies[first].inverse_mass, bodies[second].inverse_mass);
            stripe.link(count);
            for body in [first, second] {
                crossing[body] = layout.layer(number).max(crossing[body]);
            }
        }
        stripes[number].across = across;
    }
}

/// What is around balls with another home.
struct Around<'a> {
    layout: Layout,
    bodies: &'a [Body],
    homes: &'a [Home],
    cells: Option<&'a Cells>,
    turned: bool,
    /// The direction of height.
    up: DVec2,
}

impl Around<'_> {
    /// Adds, and links, the pairs within a stripe that its balls with another home do not have yet, and gathers those
    /// across its edges, had or not.
    fn find_more_of(&self, number: usize, stripe: &mut Stripe) {
        let (start, count) = (self.layout.start(number), self.layout.count(number, self.bodies.len()));
        let (mut leaving, mut known) = (take(&mut stripe.leaving), take(&mut stripe.known));
        stripe.link(count);
        for own in leaving.drain(..) {
            known.begin(count);
            for at in stripe.links.of(own) {
                known.add(stripe.pairs[at].first);
                known.add(stripe.pairs[at].second);
            }
            let at = start + own as usize;
            let before = stripe.pairs.len();
            self.for_each_near(at, |other| {
                let upper = (self.bodies[at].position - self.bodies[other].position).dot(self.up) >= 0.0;
                let (first, second) = if upper { (at, other) } else { (other, at) };
                let pair = Pair { first: first as u32, second: second as u32 };
                if self.layout.own_of(other) != number {
                    stripe.across.push(pair);
                } else if known.add((other - start) as u32) {
                    let [first, second] = [first, second].map(|body| self.bodies[body].inverse_mass);
                    stripe.add_pair(pair.within(start), first, second);
                }
            });
            if stripe.pairs.len() > before {
                stripe.link(count);
            }
        }
        (stripe.leaving, stripe.known) = (leaving, known);
    }

    /// Visits the balls whose covers touch that of one.
    fn for_each_near(&self, at: usize, mut visit: impl FnMut(usize)) {
        let (home, reach) = (&self.homes[at], self.bodies[at].radius + self.homes[at].reach);
        let mut consider = |other: usize| {
            let its = &self.homes[other];
            let both = reach + self.bodies[other].radius + its.reach;
            if other != at && its.position.distance_squared(home.position) <= both * both {
                visit(other);
            }
        };
        match self.cells {
            Some(Cells { grid, .. }) => {
                let place = in_cells(self.turned, home.position);
                grid.for_each_near(place, reach, |other| consider(other as usize));
            }
            None => (0..self.bodies.len()).for_each(consider),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Contact;
    use super::super::testing::TUNING;
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
        let mut contact = Contact::new(&world, &balls, TUNING);
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
