//! Balls that were put into each other part without energy from nowhere.
//!
//! What holds balls apart goes on doing so in the next substep, which is right for a load, and not for an overlap: that is to
//! go away, with what was given for it, and balls deep in many others would be shot out of these. So for half a second after
//! balls were put somewhere, those that lie deep in others are let go of after each substep. Then most have parted, and those
//! that have not are held as if they lay on each other. Until all have, or others are added, they gain no energy (`energy`).
//! Which balls that is is found with all pairs, now and then.

use super::Contact;
use super::prepare::let_go;

/// For so long after balls were put somewhere those that lie deep in others are let go of, s.
const TIME: f64 = 0.5;
/// Balls lie deep in each other from this part of the smaller radius on: in piles they do as a rule nowhere ...
const DEEP: f64 = 0.1;
/// ... or, where one of them did when pairs were last searched, from this one.
const APART: f64 = 0.02;

/// Which balls are to part.
#[derive(Debug, Clone)]
pub(super) struct Parting {
    /// How much longer those that lie deep in others are let go of, s.
    left: f64,
    /// The first of the balls that were put somewhere: all whose numbers in the simulation are no smaller were; none, once
    /// they have parted.
    first: Option<u32>,
    /// Those that lay deep in others when pairs were searched last, in the order of their bodies.
    deep: Vec<usize>,
    /// Their numbers in the simulation, which stay theirs when bodies are put in another order.
    known: Vec<u32>,
}

impl Parting {
    /// Of balls that were just put where they are.
    pub(super) fn new() -> Self {
        Self { left: TIME, first: Some(0), deep: Vec::new(), known: Vec::new() }
    }

    /// Looks for such balls again: those from this one on were just added. Where others are still let go of, these part with
    /// them, in what is left of their time: where balls are added all the time, none that a load presses would be held.
    pub(super) fn begin_again(&mut self, first: u32) {
        if self.left <= 0.0 {
            (self.left, self.first) = (TIME, Some(first));
            // Those that have not parted in their time carry something: they are not let go of again.
            self.known.clear();
        } else {
            // None but those that were put elsewhere may have been looked for until now.
            self.first = self.first.map(|before| before.min(first));
        }
    }

    /// Looks for those of these numbers, too, which were put elsewhere.
    pub(super) fn put(&mut self, ids: impl IntoIterator<Item = u32>) {
        let mut ids = ids.into_iter().peekable();
        if ids.peek().is_none() {
            return;
        }
        self.begin_again(u32::MAX);
        self.known.extend(ids);
        self.known.sort_unstable();
        self.known.dedup();
    }

    /// Forgets the one of this number, which is taken away: those after it move up.
    pub(super) fn forget(&mut self, gone: u32) {
        self.first = self.first.map(|first| first - u32::from(first > gone && first < u32::MAX));
        self.known.retain(|&id| id != gone);
        self.known.iter_mut().filter(|id| **id > gone).for_each(|id| *id -= 1);
    }

    /// Whether any balls lie deep in each other since they were put somewhere.
    pub(super) fn goes_on(&self) -> bool {
        !self.deep.is_empty()
    }

    fn end(&mut self) {
        (self.left, self.first) = (0.0, None);
        self.deep.clear();
        self.known.clear();
    }
}

impl Contact {
    /// Finds the balls that are to part, after all pairs were searched. Where there are none, none will be.
    pub(super) fn find_parting(&mut self) {
        let Self { bodies, ids, near: Some(near), parting, .. } = self else { return };
        let Some(put) = parting.first else { return };
        let deep = near.pairs().filter(|&(first, second)| {
            let overlap = |part: f64| bodies[first].overlaps(&bodies[second], part);
            let [one, other] = [first, second].map(|at| ids[at]);
            if [one, other].iter().any(|id| parting.known.binary_search(id).is_ok()) {
                overlap(APART)
            } else {
                parting.left > 0.0 && one.max(other) >= put && overlap(DEEP)
            }
        });
        let mut deep: Vec<usize> = deep.flat_map(|(first, second)| [first, second]).collect();
        deep.retain(|&at| bodies[at].inverse_mass > 0.0);
        if deep.is_empty() {
            parting.end();
            return;
        }
        deep.sort_unstable();
        deep.dedup();
        parting.known.clear();
        parting.known.extend(deep.iter().map(|&at| ids[at]));
        parting.known.sort_unstable();
        parting.deep = deep;
    }

    /// Lets go of balls that lie deep in others. Before those that are thrown are let go of: that slows balls down, where something
    /// may carry them.
    pub(super) fn let_go_of_deep(&mut self) {
        let Self { setting, bodies, near: Some(near), parting, .. } = self else { return };
        if parting.left <= 0.0 || parting.deep.is_empty() {
            return;
        }
        near.link_pairs(bodies.len());
        near.all().let_go_of_all(
            parting.deep.clone(),
            bodies,
            let_go,
            |_| setting.most_thrown(),
            |_, body, _| body.velocity,
        );
        parting.left -= setting.substep;
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::super::ball::Ball;
    use super::super::super::world::{Pairs, World};
    use super::super::testing::TUNING;
    use super::*;

    /// A world with gravity, and in it two balls that lie deep in each other, and two that only touch.
    fn two_pairs() -> (World, Vec<Ball>) {
        let world = World::new(DVec2::splat(400.0)).unwrap().with_gravity(DVec2::new(0.0, 980.0)).unwrap();
        let ball = |x: f64| Ball::new(DVec2::new(x, 100.0), 10.0).unwrap();
        (world.with_pairs(Pairs::Impulse), [100.0, 110.0, 200.0, 219.5].map(ball).to_vec())
    }

    #[test]
    fn balls_that_only_touch_are_let_go_of_nowhere_while_others_part() {
        let (world, balls) = two_pairs();
        let mut contact = Contact::new(&world, &balls, TUNING);
        contact.find();
        for _ in 0..2 {
            let ids = contact.parting.deep.iter().map(|&at| contact.ids[at]).collect::<Vec<_>>();
            assert_eq!((&contact.parting.known[..], ids.len()), (&[0, 1][..], 2));
            contact.find_parting();
        }
    }

    #[test]
    fn balls_that_are_added_give_no_time_to_those_that_part_and_forget_none() {
        let (world, mut balls) = two_pairs();
        let mut contact = Contact::new(&world, &balls, TUNING);
        for x in [300.0, 310.0] {
            balls.push(Ball::new(DVec2::new(x, 300.0), 10.0).unwrap());
            assert!(contact.add(&world, &balls));
        }
        contact.find();
        assert_eq!(contact.parting.known, [0, 1, 4, 5]);
        contact.parting.left = 0.1;
        balls.push(Ball::new(DVec2::new(310.0, 300.0), 10.0).unwrap());
        assert!(contact.add(&world, &balls));
        contact.find();
        assert_eq!((&contact.parting.known[..], contact.parting.left), (&[0, 1, 4, 5, 6][..], 0.1));
    }

    #[test]
    fn what_has_not_parted_in_its_time_is_guarded_until_others_are_added_and_not_let_go_of_again() {
        let (world, mut balls) = two_pairs();
        let mut contact = Contact::new(&world, &balls, TUNING);
        contact.find();
        contact.parting.left = 0.0;
        contact.find_parting();
        assert_eq!((&contact.parting.known[..], contact.parting.goes_on()), (&[0, 1][..], true));
        balls.extend([300.0, 310.0].map(|x| Ball::new(DVec2::new(x, 300.0), 10.0).unwrap()));
        assert!(contact.add(&world, &balls));
        contact.find();
        assert_eq!((&contact.parting.known[..], contact.parting.left), (&[4, 5][..], TIME));
    }
}
