//! Balls that are thrown by what holds them.
//!
//! What held a ball goes on holding it in the next substep, which is right where it rests, or nearly so. Between others of
//! many times its mass it may be given more than any rest needs: given again, that would be speed from nowhere, which
//! impacts would pass on. So would what drives a ball against another, off which it bounces back to where it is held: both
//! would go on for ever. Such balls are let go of, and start anew; where something carries them, no faster than they were, or
//! than what counts as thrown.
//! What held others against them would throw those now: they are let go of, too.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::amount::Amount;
use super::constraints::Constraint;
use super::fates::{Fate, Shift};
use super::layout::Layer;
use super::prepare::let_go;
use super::stripes::{Holder, Stripes};
use super::support::{give, two};
use super::sweep::Pass;
use super::unlike::Unlike;
use super::{Body, Contact, Setting};

/// A ball is thrown by what changes its velocity in a substep by more than so many kicks of gravity.
pub(super) const THROWN: f64 = 100.0;
/// The same where an impact shifted it in that substep, of balls alike: what holds light ones between heavy ones is many times
/// their weight. With fewer, balls sink into each other in crashes.
const DRIVEN: f64 = 25.0;

impl Pass<'_> {
    /// Finds the balls that what held them has thrown.
    pub(super) const FIND_THROWN: Self = Self {
        layers: &[Layer::Own],
        only_busy: false,
        work: &|setting, stripe, share| {
            if setting.kick == DVec2::ZERO {
                return;
            }
            let bodies = (0..).zip(share.bodies.iter().zip(share.fates));
            let most = |at: u32, fate| setting.most_held(fate, || share.rests[at as usize].unlike);
            let thrown = bodies.filter(|&(at, (body, fate))| is_thrown(body, most(at, fate)));
            stripe.thrown.extend(thrown.map(|(at, _)| at));
        },
    };
}

impl Setting {
    /// By how much what holds a ball may change its velocity in a substep, px/s: else it is thrown.
    #[inline]
    fn most_held(&self, fate: &Fate, unlike: impl FnOnce() -> Unlike) -> f64 {
        if fate.shift == Shift::None || unlike().differs() {
            self.most_thrown()
        } else {
            DRIVEN * self.kick.length()
        }
    }

    /// The same of balls that no impact shifted.
    pub(super) fn most_thrown(&self) -> f64 {
        THROWN * self.kick.length()
    }
}

/// Whether what holds a ball changes its velocity by more than this.
#[inline]
fn is_thrown(body: &Body, most: f64) -> bool {
    (body.velocity - body.free).length_squared() > most * most
}

impl Contact {
    /// Forgets what held the balls that it has thrown, and takes away what speed that gave them beyond this.
    pub(super) fn let_go_of_thrown(&mut self) {
        let Self { setting, bodies, rests, near: Some(near), course, .. } = self else { return };
        let layout = near.layout;
        if near.stripes.iter().all(|stripe| stripe.thrown.is_empty()) {
            return;
        }
        let mut thrown = Vec::new();
        for number in layout.numbers(Layer::Own) {
            let start = layout.start(number);
            thrown.extend(near.stripes[number].thrown.drain(..).map(|body| start + body as usize));
        }
        let most = |at: usize| setting.most_held(&course.fates[at], || rests[at].unlike);
        near.link_pairs(bodies.len());
        // Many in a crash, or unlike ones, throw each other as fast as any is; like ones that walls alone carry are pushed along these.
        let pushes = setting.amount == Amount::Few && !setting.unlike.differs();
        let stripes = near.all();
        let is_pushed = |at: usize| {
            let rest = &rests[at];
            pushes || !rest.unlike.differs() && stripes.is_carried_by_walls_alone(at, rest, setting.kick)
        };
        let throws = |holder: &Holder| holder.impulse * rests[holder.other].counted > most(holder.other);
        let fastest = stripes.fastest_around(&thrown, bodies, is_pushed, throws);
        // What falls with others keeps what it gave them, and with these its energy (`energy`).
        let is_carried = setting.grounded;
        near.all().let_go_of_all(thrown, bodies, let_go, most, |at, body, most| {
            let fastest = fastest.get(&at).copied().unwrap_or_default().max(body.free.length()).max(most);
            if is_carried { body.velocity.clamp_length_max(fastest) } else { body.velocity }
        });
    }

    /// Forgets what would throw balls at the beginning of a substep, and takes it back: where balls weigh something else than
    /// before, or are not near each other any more, what others give them may balance nothing.
    pub(super) fn take_back_thrown(&mut self) {
        let Self { setting, bodies, near: Some(near), .. } = self else { return };
        let most = setting.most_thrown();
        let thrown: Vec<_> = (0..bodies.len()).filter(|&at| is_thrown(&bodies[at], most)).collect();
        if thrown.is_empty() {
            return;
        }
        near.link_pairs(bodies.len());
        near.all().let_go_of_all(thrown, bodies, take_back, |_| most, |_, body, _| body.free);
    }
}

/// Forgets how two balls held each other. What that has given them is taken back.
fn take_back(constraint: &mut Constraint, first: &mut Body, second: &mut Body) {
    give(-(constraint.normal * constraint.impulse + constraint.grip), first, second);
    (constraint.impulse, constraint.grip) = (0.0, DVec2::ZERO);
}

impl Stripes<'_> {
    /// Lets go of these bodies, as `forget` does it with each constraint, and then of those that what held them against these
    /// throws: by more than `most` says, px/s. Each goes on with the velocity that `anew` makes of what it was, and of that.
    /// Pairs must be linked.
    pub(super) fn let_go_of_all(
        &mut self,
        mut thrown: Vec<usize>,
        bodies: &mut [Body],
        forget: fn(&mut Constraint, &mut Body, &mut Body),
        most: impl Fn(usize) -> f64,
        anew: impl Fn(usize, &Body, f64) -> DVec2,
    ) {
        let mut others = Vec::new();
        while let Some(at) = thrown.pop() {
            let velocity = anew(at, &bodies[at], most(at));
            self.let_go_of(at, bodies, forget, &mut others);
            (bodies[at].velocity, bodies[at].free) = (velocity, velocity);
            thrown.extend(others.drain(..).filter(|&other| is_thrown(&bodies[other], most(other))));
        }
    }

    /// For each of these bodies that are thrown, and `is_pushed`, the fastest that any is, px/s, of itself, of those that hold each
    /// other through such ones: as fast as that it may have been pushed, as in a row that is hit. The same of those that what holds
    /// them `throws` as soon as these are let go of. Pairs must be linked.
    fn fastest_around(
        &self,
        thrown: &[usize],
        bodies: &[Body],
        is_pushed: impl Fn(usize) -> bool,
        throws: impl Fn(&Holder) -> bool,
    ) -> BTreeMap<usize, f64> {
        let pushed: BTreeSet<usize> = thrown.iter().copied().filter(|&at| is_pushed(at)).collect();
        let mut fastest = BTreeMap::new();
        for &first in &pushed {
            if fastest.contains_key(&first) {
                continue;
            }
            let (mut group, mut most, mut next) = (BTreeSet::from([first]), 0.0_f64, vec![first]);
            while let Some(at) = next.pop() {
                most = most.max(bodies[at].free.length());
                for holder in self.holders(at) {
                    let other = holder.other;
                    if !(pushed.contains(&other) || throws(&holder) && is_pushed(other)) {
                        most = most.max(bodies[other].free.length());
                    } else if group.insert(other) {
                        next.push(other);
                    }
                }
            }
            fastest.extend(group.into_iter().map(|at| (at, most)));
        }
        fastest
    }

    /// Lets go of a body, and of those that what held them against it would throw. Its pairs must be linked.
    pub(super) fn let_go_of_one(&mut self, at: usize, bodies: &mut [Body], kick: DVec2) {
        // Without gravity nothing that held a ball does so in the next substep.
        let most = if kick == DVec2::ZERO { f64::INFINITY } else { THROWN * kick.length() };
        self.let_go_of_all(vec![at], bodies, let_go, |_| most, |_, body, _| body.velocity);
    }

    /// Forgets what others and walls give a ball, and it them, as `forget` does it with each constraint, and adds the
    /// `others` that were pressed. Its pairs must be linked.
    fn let_go_of(
        &mut self,
        body: usize,
        bodies: &mut [Body],
        forget: fn(&mut Constraint, &mut Body, &mut Body),
        others: &mut Vec<usize>,
    ) {
        self.each_pair_of(body, |stripe, at, start| {
            let Some(constraint) = stripe.constraint_mut(at) else { return };
            let (pair, lost) = (constraint.pair, constraint.impulse);
            let (first, second) = two(&mut bodies[start..], pair);
            forget(constraint, first, second);
            if lost > 0.0 {
                let other = pair.other((body - start) as u32);
                others.push(start + other as usize);
                stripe.disturbed.push((other, lost));
            }
        });
        let (number, own) = self.layout.place_of(body);
        let stripe = &mut self.list[number];
        if let Some(at) = stripe.place_beside(own) {
            stripe.beside[at].push = DVec2::ZERO;
        }
    }
}
