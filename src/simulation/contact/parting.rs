//! Balls that were put into each other part without energy from nowhere.
//!
//! What holds balls apart goes on doing so in the next substep, which is right for a load, and not for an overlap: that is to
//! go away, with what was given for it, and balls deep in many others would be shot out of these. So for half a second after
//! balls were put somewhere, those that lie deep in others are let go of after each substep, and all that touch these, or each
//! other around them, a *heap*, move against each other with no more energy, all together, than they had. Then most have parted,
//! and those that have not are held as if they lay on each other. Which balls that are is found with all pairs, now and then.

use glam::DVec2;

use super::prepare::let_go;
use super::sleep::Rest;
use super::{Body, Contact};

/// For so long after balls were put somewhere they may still lie in each other, s.
const TIME: f64 = 0.5;
/// Balls lie deep in each other from this part of the smaller radius on: in piles they do as a rule nowhere ...
const DEEP: f64 = 0.1;
/// ... or, where one of them did when pairs were last searched, from this one.
const APART: f64 = 0.02;

/// Which balls are to part.
#[derive(Debug, Clone)]
pub(super) struct Parting {
    /// How much longer such balls are looked for, s.
    left: f64,
    /// The first of the balls that were put somewhere: all whose numbers in the simulation are no smaller were.
    first: u32,
    /// Those that lay deep in others when pairs were searched last, in the order of their bodies.
    deep: Vec<usize>,
    /// Their numbers in the simulation, which stay theirs when bodies are put in another order.
    known: Vec<u32>,
    /// Those with all that touch them, directly or through others.
    heaps: Vec<Heap>,
}

/// Balls that touch each other, directly or through others.
#[derive(Debug, Clone, Default)]
struct Heap {
    balls: Vec<usize>,
    /// Whether one of them touches a ball that nothing moves: momentum goes to that, and walls may take some as well.
    is_anchored: bool,
    /// Twice the energy of their motion against each other, or against what anchors them, before anything held them.
    energy: f64,
}

impl Parting {
    /// Of balls that were just put where they are.
    pub(super) fn new() -> Self {
        Self { left: TIME, first: 0, deep: Vec::new(), known: Vec::new(), heaps: Vec::new() }
    }

    /// Looks for such balls again: those from this one on were just added. Where others are still looked for, these part with
    /// them, in what is left of their time: where balls are added all the time, none that a load presses would be held.
    pub(super) fn begin_again(&mut self, first: u32) {
        if self.left <= 0.0 {
            (self.left, self.first) = (TIME, first);
        }
    }

    fn end(&mut self) {
        self.left = 0.0;
        self.deep.clear();
        self.known.clear();
        self.heaps.clear();
    }
}

impl Contact {
    /// Finds the balls that are to part, after all pairs were searched. Where there are none, none will be.
    pub(super) fn find_heaps(&mut self) {
        let Self { bodies, ids, near: Some(near), parting, .. } = self else { return };
        if parting.left <= 0.0 {
            return;
        }
        let overlap = |&(first, second): &(usize, usize), part: f64| {
            let (first, second) = (&bodies[first], &bodies[second]);
            let least = first.radius + second.radius - part * first.radius.min(second.radius);
            first.position.distance_squared(second.position) < least * least
        };
        let deep = near.pairs().filter(|pair| {
            let [one, other] = [pair.0, pair.1].map(|at| ids[at]);
            if [one, other].iter().any(|id| parting.known.binary_search(id).is_ok()) {
                overlap(pair, APART)
            } else {
                one.max(other) >= parting.first && overlap(pair, DEEP)
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
        parting.heaps = heaps(bodies, near.pairs().filter(|pair| overlap(pair, 0.0)), &deep);
        parting.deep = deep;
    }

    /// Notes the energy of each heap's motion after its impacts, before anything holds it.
    pub(super) fn note_heaps(&mut self) {
        let Self { bodies, rests, parting, .. } = self;
        for heap in &mut parting.heaps {
            heap.energy = heap.motion(rests, |at| bodies[at].free).1;
        }
    }

    /// Slows heaps whose balls move faster against each other than they did, and lets go of those that lie deep in others.
    /// Before those that are thrown are let go of: that slows balls down against the walls, and a heap that falls as a whole.
    pub(super) fn slow_parting(&mut self) {
        let Self { setting, bodies, rests, near: Some(near), parting, .. } = self else { return };
        if parting.heaps.is_empty() {
            return;
        }
        for heap in &parting.heaps {
            let (common, energy) = heap.motion(rests, |at| bodies[at].velocity);
            if energy > heap.energy {
                let kept = (heap.energy / energy).sqrt();
                for &at in &heap.balls {
                    let body = &mut bodies[at];
                    // One may have fallen asleep since pairs were searched.
                    if body.inverse_mass > 0.0 {
                        // As if an impact had: what holds it goes on.
                        let slower = (body.velocity - common) * (kept - 1.0);
                        body.velocity += slower;
                        body.free += slower;
                    }
                }
            }
        }
        near.let_go_of_all(
            parting.deep.clone(),
            bodies,
            let_go,
            |_| setting.most_thrown(),
            |body, _| body.velocity,
        );
        parting.left -= setting.substep;
        if parting.left <= 0.0 {
            parting.end();
        }
    }
}

impl Heap {
    /// The velocity that its balls have in common, and twice the energy of their motion against that.
    fn motion(&self, rests: &[Rest], velocity: impl Fn(usize) -> DVec2) -> (DVec2, f64) {
        // What they weigh, whatever they count with.
        let weighed = |&at: &usize| (rests[at].own.recip(), velocity(at));
        let common = if self.is_anchored {
            DVec2::ZERO
        } else {
            let parts = self.balls.iter().map(weighed);
            let (mass, momentum) = parts.fold((0.0, DVec2::ZERO), |(mass, momentum), (own, velocity)| {
                (mass + own, momentum + velocity * own)
            });
            momentum / mass
        };
        let energies =
            self.balls.iter().map(weighed).map(|(own, velocity)| own * velocity.distance_squared(common));
        (common, energies.sum())
    }
}

/// The heaps that these pairs make, of which some of the `deep` are.
fn heaps(bodies: &[Body], pairs: impl Iterator<Item = (usize, usize)>, deep: &[usize]) -> Vec<Heap> {
    // Each ball points to another one of its heap, or to itself (disjoint sets; Galler & Fischer 1964).
    let mut towards: Vec<usize> = (0..bodies.len()).collect();
    let mut anchored = Vec::new();
    for (first, second) in pairs {
        match [first, second].map(|at| bodies[at].inverse_mass > 0.0) {
            [true, true] => {
                let (one, other) = (root(&mut towards, first), root(&mut towards, second));
                towards[one.max(other)] = one.min(other);
            }
            [true, false] => anchored.push(first),
            [false, true] => anchored.push(second),
            [false, false] => (),
        }
    }
    // The place of each ball's heap, by its root.
    let mut places = vec![None; bodies.len()];
    let mut heaps = Vec::new();
    for &at in deep {
        places[root(&mut towards, at)].get_or_insert_with(|| {
            heaps.push(Heap::default());
            heaps.len() - 1
        });
    }
    for at in 0..bodies.len() {
        if let Some(place) = places[root(&mut towards, at)] {
            heaps[place].balls.push(at);
        }
    }
    for at in anchored {
        if let Some(place) = places[root(&mut towards, at)] {
            heaps[place].is_anchored = true;
        }
    }
    heaps
}

/// The ball that stands for a ball's heap.
fn root(towards: &mut [usize], mut at: usize) -> usize {
    while towards[at] != at {
        towards[at] = towards[towards[at]];
        at = towards[at];
    }
    at
}

#[cfg(test)]
mod tests {
    use super::super::super::Advance;
    use super::super::super::ball::Ball;
    use super::super::super::world::{Pairs, World};
    use super::super::Tuning;
    use super::*;

    const TUNING: Tuning = Tuning { rest_speed: 1.0, substeps: None, sleep: true, threads: 1 };

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
            contact.find_heaps();
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
    fn balls_in_each_other_are_heaps_and_what_nothing_moves_anchors_them_without_joining_them() {
        let ball = |k: usize| {
            let ball = Ball::new(DVec2::splat(100.0), 5.0).unwrap();
            Body::new(&if k == 9 { ball.fixed() } else { ball }, DVec2::ZERO)
        };
        let bodies: Vec<Body> = (0..10).map(ball).collect();
        let pairs = [(6, 2), (4, 5), (2, 1), (9, 4), (7, 9), (1, 6)];
        let found = |deep: &[usize]| {
            let heaps = heaps(&bodies, pairs.into_iter(), deep);
            heaps.into_iter().map(|heap| (heap.balls, heap.is_anchored)).collect::<Vec<_>>()
        };
        let [one, two, three] = [(vec![1, 2, 6], false), (vec![4, 5], true), (vec![7], true)];
        assert_eq!(found(&[2, 4, 6, 7]), [one.clone(), two.clone(), three]);
        assert_eq!(found(&[1, 5]), [one, two], "none is deep in the third");
        assert!(found(&[]).is_empty());
    }
}
