//! How long substeps are: two, three or four in each *beat* of a 60th of a second, six or eight where a pile is deep.
//!
//! What flies is followed from impact to impact in any substep, and what lies still needs no short ones. But where many
//! are hit, a ball may be hit more often than it may in one, and what is left is to be held before it goes far; and the
//! more balls carry, the farther they go for what is left to be found of that load. Few balls cost little, and so do
//! those that are awake among many asleep: they always take four, as do those that nothing presses together, many of one
//! size, and unlike balls, which may carry what is many times as heavy. What overlaps under a load does so by as much as that load
//! times the square of a substep: deep piles take six, or, where they are to sleep, six or eight, always. Where gravity is strong,
//! beats are shorter. They follow each other whatever the frames, so that what comes of them does not depend on these.

use glam::DVec2;

use super::super::Tuning;
use super::super::ball::Ball;
use super::super::world::World;
use super::Contact;
use super::amount::Amount;
use super::demands::{Depth, are_many_of_one_size, middle_radius, shortened, shortened_for};
use super::layout::Layer;
use super::softness::Softness;
use super::stripes::of_layer;
use super::sweep::Pass;
use super::unlike::Crush;

/// Beats in a second, at least.
pub(super) const BEATS: u32 = 60;
/// Substeps in a beat: the fewest, and the most, with which all begin, as a rule, in deep piles, and in still deeper ones.
pub(super) const FEWEST: u32 = 2;
pub(super) const MOST: u32 = 4;
const MOST_IN_DEEP: u32 = 6;
const MOST_IN_DEEPER: u32 = 8;
/// The parts of a beat in which time is counted: a multiple of all numbers of substeps.
const PARTS: u32 = 24;

/// A beat of long substeps is the last, for now, in one of which impacts shift more than one in so many balls ...
const MANY_HIT: usize = 16;
/// ... and the next comes after so many beats in a row in which they shift less than one in so many.
const FEW_HIT: (u32, usize) = (2, 64);
/// Substeps are short where more than one in so many balls sleeps, too ...
const MANY_ASLEEP: usize = 8;
/// ... and where more than one in so many pairs that press ...
const HEAVY: usize = 1000;
/// ... carries more than the weight of so many balls as heavy as its own: the longest suit less than the first number, a pile
/// of some three thousand, all but the shortest less than the second ...
pub(super) const CARRIED: [f64; 3] = [100.0, 200.0, 350.0];
/// ... or than the third, a pile of a hundred thousand, after so many beats in a row in which few were hit: one that still
/// falls would be squeezed.
const AT_REST: u32 = 60;

/// A pair that holds each other bounces only where it meets faster than so many kicks of gravity.
const FIRM: f64 = 2.0;

/// How long substeps are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Substeps {
    /// How many of the steps in which time is counted there are in a second: parts of a beat, or substeps where their number
    /// was asked for.
    pub(super) rate: u32,
    /// How many times shorter than usual beats are; [`None`] where the number of substeps was asked for.
    shortened: Option<u32>,
    /// How many times shorter they are than balls of the middle size alone would ask for.
    finer: f64,
    /// For how many balls.
    pub(super) amount: Amount,
    /// Whether so many balls are of one size that they lie in crystals: then all are short.
    pub(super) of_one_size: bool,
    /// Substeps in a beat of the shortest.
    most: u32,
    /// Whether what is to sleep is so deep that all are short.
    deep: bool,
    /// Substeps in the beat that the last one was in, and in that of the next.
    count: u32,
    next: u32,
    /// How many beats have passed since many balls were hit.
    calm: u32,
}

impl Substeps {
    /// Those that suit these balls under this gravity, unless a number was asked for.
    pub(super) fn new(world: &World, balls: &[Ball], tuning: Tuning) -> Self {
        let shortened = tuning.substeps.is_none().then(|| shortened(world, balls));
        let rate = shortened.map(|times| BEATS * PARTS * times).or(tuning.substeps).unwrap_or_default();
        let depth = Depth::of(world, balls, shortened.unwrap_or(1));
        let (of_one_size, deep) = (are_many_of_one_size(balls), depth > Depth::Shallow && tuning.sleep);
        let most = match depth {
            Depth::Shallow => MOST,
            Depth::Deeper if deep => MOST_IN_DEEPER,
            Depth::Deep | Depth::Deeper => MOST_IN_DEEP,
        };
        let middle = shortened_for(middle_radius(balls), world.gravity.unwrap_or_default());
        let finer = shortened.map_or(1.0, |times| f64::from(times) / f64::from(middle));
        let amount = Amount::of(balls);
        Self { rate, shortened, finer, amount, of_one_size, most, deep, count: most, next: most, calm: 0 }
    }

    /// The same for other balls, or another gravity, unless these ask for beats of another length, or other numbers of substeps in them.
    pub(super) fn with(&self, world: &World, balls: &[Ball], tuning: Tuning) -> Option<Self> {
        let Self { rate, finer, amount, of_one_size, most, deep, .. } = Self::new(world, balls, tuning);
        ((rate, most) == (self.rate, self.most)).then_some(Self { finer, amount, of_one_size, deep, ..*self })
    }

    /// Takes it that what goes on is no rest any more: something was changed from outside. What overlaps of other loads push then gains no
    /// energy.
    pub(super) fn stir(&mut self) {
        self.calm = 0;
    }

    /// Has the next beat of so many.
    #[cfg(test)]
    pub(super) fn begin_beat_of(&mut self, count: u32) {
        self.next = count;
    }

    /// How many of them, or of the shortest, there are in a second.
    pub(super) fn per_second(&self) -> u32 {
        self.shortened.map_or(self.rate, |times| BEATS * times * self.count)
    }

    /// The fewest and the most in a second under this gravity.
    pub(super) fn range(&self, gravity: DVec2) -> [u32; 2] {
        match self.shortened {
            Some(times) if self.varies(gravity) && !self.are_all_short() => {
                [FEWEST, self.most].map(|count| BEATS * times * count)
            }
            _ => [self.per_second(); 2],
        }
    }

    /// Whether beats may have fewer of them than most.
    fn varies(&self, gravity: DVec2) -> bool {
        self.amount > Amount::Few && gravity != DVec2::ZERO
    }

    /// Whether they are short.
    pub(super) fn are_short(&self) -> bool {
        self.count >= MOST
    }

    /// Whether what is to sleep is so deep that all are short.
    pub(super) fn is_deep(&self) -> bool {
        self.deep
    }

    /// Whether they always are.
    fn are_all_short(&self) -> bool {
        self.of_one_size || self.deep
    }

    /// Whether few balls were hit for so long that what goes on among them is no crash. That is never so where many are of one
    /// size, or lie deep: they come to rest later where the energy of what moves in them is not kept.
    pub(super) fn are_at_rest(&self) -> bool {
        !self.are_all_short() && self.calm >= AT_REST
    }

    /// How long a substep takes.
    pub(super) fn seconds(&self) -> f64 {
        1.0 / f64::from(self.per_second())
    }

    /// How contacts give way in one, by whom balls could crush.
    pub(super) fn softness(&self, crush: Crush) -> Softness {
        Softness::of(self.count, crush)
    }

    /// In how many of the steps in which time is counted a substep is over: the last, and the next.
    pub(super) fn length(&self) -> u64 {
        self.length_of(self.count)
    }

    pub(super) fn next_length(&self) -> u64 {
        self.length_of(self.next)
    }

    /// The same of the shortest.
    pub(super) fn shortest(&self) -> u64 {
        self.length_of(self.most)
    }

    /// What is fast among what holds each other, px/s, under such kicks of gravity: what is so for balls of the middle size. What is
    /// slower does not bounce, and is braked where it slides.
    pub(super) fn firm(&self, kick: DVec2) -> f64 {
        FIRM * self.finer * kick.length()
    }

    /// How long one of the shortest takes where all balls are of this size, s: what is slow for a ball is so whatever small ones lie
    /// around it.
    pub(super) fn seconds_for(&self, radius: f64, gravity: DVec2) -> f64 {
        let of_all = 1.0 / f64::from(self.rate);
        self.shortened.map_or(of_all, |_| 1.0 / f64::from(BEATS * self.most * shortened_for(radius, gravity)))
    }

    fn length_of(&self, count: u32) -> u64 {
        if self.shortened.is_some() { u64::from(PARTS / count) } else { 1 }
    }
}

impl Contact {
    /// Begins a substep that is longer or shorter than the last one.
    pub(super) fn change_length(&mut self) {
        if self.substeps.next != self.substeps.count {
            self.substeps.count = self.substeps.next;
            self.begin_substeps_of_new_length();
        }
    }

    /// Has balls and what holds them as if the last substep had been as long as the next are.
    pub(super) fn begin_substeps_of_new_length(&mut self) {
        let Self { setting, substeps, bodies, near, .. } = self;
        let old = std::mem::replace(setting, setting.with_length(substeps));
        let ratio = setting.substep / old.substep;
        for body in bodies {
            // What is held by others changes by as much as they give and gravity takes: at rest, by nothing.
            let change = body.change(old.kick);
            let given = body.velocity - body.free;
            body.velocity += 0.5 * (1.0 - ratio) * change;
            body.free = body.velocity - ratio * given;
        }
        if let Some(near) = near {
            for stripe in &mut near.stripes {
                stripe.apart.clear();
                for constraint in &mut stripe.constraints {
                    constraint.impulse *= ratio;
                    constraint.grip *= ratio;
                }
                for beside in &mut stripe.beside {
                    beside.push *= ratio;
                }
            }
        }
    }

    /// Finds out how many substeps the next beat is to have.
    pub(super) fn look_for_calm(&mut self) {
        let Self { setting, substeps, bodies, near: Some(near), steps, asleep, .. } = self else { return };
        if substeps.shortened.is_none() || !substeps.varies(setting.gravity) {
            return;
        }
        let layout = near.layout;
        let (beats, few) = FEW_HIT;
        let most_shifted = bodies.len() / if substeps.are_short() { few } else { MANY_HIT };
        let shifted: usize =
            of_layer(&mut near.stripes, layout, Layer::Own).map(|stripe| stripe.shifted).sum();
        if shifted > most_shifted {
            substeps.calm = 0;
        }
        if !steps.is_multiple_of(u64::from(PARTS)) {
            return;
        }
        let rough = substeps.are_all_short()
            || substeps.calm < beats
            || near.touched_unlike > 0
            || *asleep * MANY_ASLEEP > bodies.len();
        substeps.calm = substeps.calm.saturating_add(1);
        if rough {
            substeps.next = substeps.most;
            return;
        }
        self.sweep(&[Pass::COUNT_HEAVY]);
        let Self { substeps, near: Some(near), .. } = self else { return };
        // Not the greatest: one ball that is squeezed out from between others carries what most of a pile never does.
        let few_carry = |load: usize| {
            let heavy: usize = near.stripes.iter().map(|stripe| stripe.heavy[load]).sum();
            heavy * HEAVY <= near.touched
        };
        substeps.next = if few_carry(0) {
            FEWEST
        } else if few_carry(if substeps.are_at_rest() { 2 } else { 1 }) {
            FEWEST + 1
        } else {
            // In deep piles, too, that are not to sleep: what lies still needs no more.
            MOST
        };
    }
}

impl Pass<'_> {
    /// Counts the pairs that carry much.
    const COUNT_HEAVY: Self = Self {
        layers: Layer::OUTWARD,
        only_busy: true,
        work: &|setting, stripe, _| {
            let loads = CARRIED.map(|most| most * setting.kick.length());
            stripe.heavy = [0; CARRIED.len()];
            for constraint in &stripe.constraints {
                let carried = 0.5 * constraint.impulse / constraint.mass;
                for (heavy, load) in stripe.heavy.iter_mut().zip(loads) {
                    *heavy += usize::from(carried > load);
                }
            }
        },
    };
}

#[cfg(test)]
mod tests {
    use super::super::Tally;
    use super::super::testing::TUNING;
    use super::*;
    use crate::simulation::world::Pairs;

    const GRAVITY: DVec2 = DVec2::new(0.0, 980.0);

    /// Stacks of three beside each other, in walls or falling without any.
    fn stacks(walls: bool) -> Contact {
        let world = World::new(DVec2::new(1000.0, 500.0)).unwrap().with_gravity(GRAVITY).unwrap();
        let world = if walls { world.with_walls(0.5).unwrap() } else { world }.with_pairs(Pairs::Impulse);
        let place = |k: u32| DVec2::new(30.0 + 40.0 * f64::from(k / 3), 490.0 - 20.0 * f64::from(k % 3));
        let balls: Vec<_> = (0..60).map(|k| Ball::new(place(k), 10.0).unwrap()).collect();
        let mut stacks = Contact::new(&world, &balls, Tuning { sleep: false, ..TUNING });
        // As if there were more.
        (stacks.substeps.amount, stacks.setting.amount) = (Amount::Some, Amount::Some);
        stacks
    }

    /// Takes a beat of so many substeps, or of as many as suit; how many these were.
    fn beat(contact: &mut Contact, count: Option<u32>) -> u64 {
        contact.substeps.begin_beat_of(count.unwrap_or(contact.substeps.next));
        let (end, mut taken) = (contact.steps + u64::from(PARTS), 0);
        while contact.steps < end {
            contact.step(&mut Tally::default());
            taken += 1;
        }
        assert_eq!(contact.steps, end);
        taken
    }

    #[test]
    fn what_falls_follows_the_parabola_however_long_substeps_are() {
        let mut falling = stacks(false);
        let start: Vec<DVec2> = falling.bodies.iter().map(|body| body.position).collect();
        for (count, beats) in [4, 2, 3, 2, 4, 3].into_iter().cycle().zip(1..=60) {
            beat(&mut falling, Some(count));
            let seconds = f64::from(beats) / f64::from(BEATS);
            for (body, &id) in falling.bodies.iter().zip(&falling.ids) {
                let fallen = body.position - start[id as usize];
                let law = 0.5 * GRAVITY * seconds * seconds;
                assert!(fallen.distance(law) < 1e-9, "{fallen} after {beats} beats");
            }
        }
    }

    #[test]
    fn what_lies_does_not_stir_where_substeps_become_longer_or_shorter() {
        let mut lying = stacks(true);
        for _ in 0..120 {
            beat(&mut lying, Some(MOST));
        }
        let settled = lying.bodies.clone();
        for count in [2, 4, 3, 2, 6, 8, 3, 4] {
            beat(&mut lying, Some(count));
            for (before, after) in settled.iter().zip(&lying.bodies) {
                assert!(after.velocity.length() < 0.05, "at {} px/s", after.velocity);
                assert!(after.position.distance(before.position) < 2e-3);
            }
        }
    }

    #[test]
    fn substeps_are_long_where_little_happens_and_short_where_much_does() {
        let mut pile = stacks(true);
        let beats = |pile: &mut Contact| (0..15).map(|_| beat(pile, None)).collect::<Vec<_>>();
        let still = beats(&mut pile);
        assert!(still.starts_with(&[4; 2]) && still.ends_with(&[2; 10]), "{still:?}");
        for (at, body) in pile.bodies.iter_mut().enumerate() {
            body.velocity.x = if at % 2 == 0 { 900.0 } else { -900.0 };
            body.free = body.velocity;
        }
        let thrown = beats(&mut pile);
        assert!(thrown[1..].starts_with(&[4; 8]), "{thrown:?}");
    }

    /// How many substeps the next beat has where one pair of a pile at rest carries the weight of so many balls.
    fn count_under(pile: &mut Contact, balls: f64) -> u32 {
        let weight = pile.setting.kick.length();
        let constraint = pile.near.as_mut().unwrap().stripes[0].constraints.first_mut().unwrap();
        // Both of its balls weigh as much as each other.
        constraint.impulse = balls * weight * 2.0 * constraint.mass;
        pile.look_for_calm();
        pile.substeps.next
    }

    #[test]
    fn substeps_are_shorter_where_more_than_one_in_a_thousand_pairs_carries_more() {
        let mut pile = stacks(true);
        for _ in 0..15 {
            beat(&mut pile, None);
        }
        let mut counts = |calm: u32, touched: usize| {
            pile.near.as_mut().unwrap().touched = touched;
            [99.0, 101.0, 199.0, 201.0, 349.0, 351.0].map(|balls| {
                pile.substeps.calm = calm;
                count_under(&mut pile, balls)
            })
        };
        assert_eq!(counts(AT_REST - 2, HEAVY - 1), [2, 3, 3, 4, 4, 4], "while it falls");
        assert_eq!(counts(AT_REST, HEAVY - 1), [2, 3, 3, 3, 3, 4], "at rest");
        assert_eq!(counts(AT_REST, HEAVY), [2; 6], "where only one in a thousand does");
    }

    #[test]
    fn substeps_are_short_where_unlike_balls_press_and_where_some_sleep() {
        let mut pile = stacks(true);
        for _ in 0..15 {
            beat(&mut pile, None);
        }
        let mut next = |unlike, asleep| {
            pile.near.as_mut().unwrap().touched_unlike = unlike;
            pile.asleep = asleep;
            pile.look_for_calm();
            pile.substeps.next
        };
        assert_eq!([next(0, 0), next(1, 0), next(0, 7), next(0, 8)], [2, 4, 2, 4]);
    }

    #[test]
    fn what_holds_balls_grows_with_the_substep() {
        let mut lying = stacks(true);
        for _ in 0..15 {
            beat(&mut lying, Some(MOST));
        }
        let given = |lying: &mut Contact| {
            let stripe = &mut lying.near.as_mut().unwrap().stripes[0];
            let constraint = stripe.constraints.iter().find(|constraint| constraint.impulse > 0.0).unwrap();
            [constraint.impulse, constraint.grip.x, stripe.beside[0].push.y]
        };
        lying.near.as_mut().unwrap().stripes[0]
            .constraints
            .iter_mut()
            .for_each(|constraint| constraint.grip.x = 0.1);
        let short = given(&mut lying);
        for (count, ratio) in [(2, 2.0), (4, 1.0), (3, 4.0 / 3.0)] {
            lying.substeps.begin_beat_of(count);
            lying.change_length();
            for (long, short) in given(&mut lying).into_iter().zip(short) {
                assert!(short != 0.0 && (long / (ratio * short) - 1.0).abs() < 1e-12, "{long} for {short}");
            }
        }
    }

    #[test]
    fn a_pile_asleep_goes_on_at_the_end_of_a_substep() {
        let mut pile = stacks(true);
        for (count, ends) in
            [(4, [6, 6, 12, 18]), (2, [12, 12, 12, 24]), (3, [8, 8, 16, 16]), (8, [3, 6, 12, 18])]
        {
            pile.substeps.begin_beat_of(count);
            for (step, end) in [2, 6, 10, 16].into_iter().zip(ends) {
                pile.sleep_until(step);
                assert_eq!(pile.steps, end, "{step} of {count}");
            }
        }
    }
}
