//! Balls that were put into each other part without energy from nowhere.
//!
//! What holds balls apart goes on doing so in the next substep, which is right for a load, and not for an overlap: that is to
//! go away, with what was given for it, and balls deep in many others would be shot out of these. So for half a second after
//! balls were put somewhere, those that lie deep in others are let go of after each substep, and all that touch these, or each
//! other around them, a *heap*, move against each other with no more energy than they had. Then most have parted, and those that
//! have not are held as if they lay on each other.

use glam::DVec2;

use super::sleep::Rest;
use super::take_up::let_go;
use super::{Body, Contact};

/// For so long after balls were put somewhere they may still lie in each other, s.
const TIME: f64 = 0.5;
/// Balls lie deep in each other from this part of the smaller radius on: in piles they do as a rule nowhere ...
const DEEP: f64 = 0.1;
/// ... or, once some have begun to part, from this one.
const APART: f64 = 0.02;

/// Which balls are to part.
#[derive(Debug, Clone)]
pub(super) struct Parting {
    /// How much longer such balls are looked for, s.
    left: f64,
    /// The first of the balls that were put somewhere: all from this one on were.
    first: u32,
    /// Those that lay deep in others when pairs were searched last, in the order of their numbers.
    deep: Vec<usize>,
    /// Those with all that touch them, directly or through others.
    heaps: Vec<Heap>,
}

/// Balls that touch each other, directly or through others.
#[derive(Debug, Clone, Default)]
struct Heap {
    balls: Vec<usize>,
    /// Whether one of them touches something that nothing moves.
    is_anchored: bool,
    /// Twice the energy of their motion against each other, or against what anchors them, before anything held them.
    energy: f64,
}

impl Parting {
    /// Of balls that were just put where they are.
    pub(super) fn new() -> Self {
        Self { left: TIME, first: 0, deep: Vec::new(), heaps: Vec::new() }
    }

    /// Looks for such balls again: those from this one on were just added.
    pub(super) fn begin_again(&mut self, first: u32) {
        // If others are still parting, these do with them.
        if self.heaps.is_empty() {
            self.first = first;
        }
        self.left = TIME;
    }

    fn end(&mut self) {
        self.left = 0.0;
        self.deep.clear();
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
        let begun = !parting.heaps.is_empty();
        let was_put = |&(first, second): &(usize, usize)| ids[first].max(ids[second]) >= parting.first;
        let deep = near
            .pairs()
            .filter(|pair| overlap(pair, if begun { APART } else { DEEP }) && (begun || was_put(pair)));
        parting.deep = deep.flat_map(|(first, second)| [first, second]).collect();
        parting.deep.retain(|&at| bodies[at].inverse_mass > 0.0);
        if parting.deep.is_empty() {
            parting.end();
            return;
        }
        parting.deep.sort_unstable();
        parting.deep.dedup();
        parting.heaps = heaps(bodies, near.pairs().filter(|pair| overlap(pair, 0.0)));
        parting.heaps.retain(|heap| heap.balls.iter().any(|ball| parting.deep.binary_search(ball).is_ok()));
    }

    /// Notes the energy of each heap's motion after its impacts, before anything holds it.
    pub(super) fn note_heaps(&mut self) {
        let Self { bodies, rests, parting, .. } = self;
        for heap in &mut parting.heaps {
            heap.energy = heap.motion(rests, |at| bodies[at].free).1;
        }
    }

    /// Slows heaps whose balls move faster against each other than they did, and lets go of those that lie deep in others.
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

/// The heaps that these pairs make.
fn heaps(bodies: &[Body], pairs: impl Iterator<Item = (usize, usize)>) -> Vec<Heap> {
    // Each ball points to another one of its heap, or to itself (disjoint sets; Galler & Fischer 1964).
    let mut towards: Vec<usize> = (0..bodies.len()).collect();
    let mut found = Vec::new();
    let mut anchored = Vec::new();
    for (first, second) in pairs {
        match [first, second].map(|at| bodies[at].inverse_mass > 0.0) {
            [true, true] => {
                found.extend([first, second]);
                let (one, other) = (root(&mut towards, first), root(&mut towards, second));
                towards[one.max(other)] = one.min(other);
            }
            [true, false] => anchored.push(first),
            [false, true] => anchored.push(second),
            [false, false] => (),
        }
    }
    found.extend_from_slice(&anchored);
    let mut of_roots: Vec<_> = found.into_iter().map(|at| (root(&mut towards, at), at)).collect();
    of_roots.sort_unstable();
    of_roots.dedup();
    let mut anchored: Vec<usize> = anchored.into_iter().map(|at| root(&mut towards, at)).collect();
    anchored.sort_unstable();
    let heap = |balls: &[(usize, usize)]| Heap {
        balls: balls.iter().map(|&(_, at)| at).collect(),
        is_anchored: anchored.binary_search(&balls[0].0).is_ok(),
        energy: 0.0,
    };
    of_roots.chunk_by(|one, other| one.0 == other.0).map(heap).collect()
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
    use super::super::super::ball::Ball;
    use super::*;

    #[test]
    fn balls_in_each_other_are_heaps_and_what_nothing_moves_anchors_them_without_joining_them() {
        let ball = |k: usize| {
            let ball = Ball::new(DVec2::splat(100.0), 5.0).unwrap();
            Body::new(&if k == 9 { ball.fixed() } else { ball }, DVec2::ZERO)
        };
        let bodies: Vec<Body> = (0..10).map(ball).collect();
        let pairs = [(6, 2), (4, 5), (2, 1), (9, 4), (7, 9), (1, 6)];
        let found = heaps(&bodies, pairs.into_iter());
        let found: Vec<_> = found.iter().map(|heap| (&heap.balls[..], heap.is_anchored)).collect();
        assert_eq!(found, [(&[1, 2, 6][..], false), (&[4, 5], true), (&[7], true)]);
        assert!(heaps(&bodies, std::iter::empty()).is_empty());
    }
}
