//! Bodies in stripes: runs of neighbours that are worked on by themselves, so that several threads share a substep.
//!
//! Bodies stand in the order of their places, along columns where gravity pulls down, so a stripe is a range of them.
//! Pairs within a stripe belong to it. Those across its edge belong to the *seam* there, the halves of the stripes on both
//! sides; the few that span more, those of a ball larger than a stripe, to the *rest*. First all stripes are worked on, each by
//! itself, then all seams, then the rest. How many stripes there are depends on the balls alone, so the order, and with it
//! every bit of the result, is the same for any number of threads.

use std::collections::BinaryHeap;

use super::super::Tally;
use super::find::{Beside, Given, Hold, Pair};
use super::impacts::Event;
use super::order::{Heights, Links};
use super::{Body, DVec2};

/// Fewer balls are one stripe: threads would cost more than they save.
const LEAST: usize = 2048;
/// A stripe is about so many balls wide, at least: few of its balls lie at an edge, and a core's cache takes it.
const WIDTH: f64 = 10.0;
/// The place of a ball that is not beside a wall.
const NOWHERE: u32 = u32::MAX;

/// Which stripes there are, and which numbers they have: the stripes, the seams before and behind each, the rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    /// A stripe is twice 2 to this power bodies long.
    shift: u32,
    /// How many there are, seams and the rest not counted.
    own: usize,
}

/// Stripes that share no body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Layer {
    Own,
    Seams,
    Rest,
}

impl Layer {
    /// Stripes first.
    pub(super) const OUTWARD: &'static [Self] = &[Self::Own, Self::Seams, Self::Rest];
    /// Stripes last.
    pub(super) const INWARD: &'static [Self] = &[Self::Rest, Self::Seams, Self::Own];
    /// What lies across edges before and after what lies between them.
    pub(super) const AROUND: &'static [Self] = &[Self::Rest, Self::Seams, Self::Own, Self::Seams, Self::Rest];
}

impl Layer {
    /// The layer of a pair that shares a stripe, and a seam.
    pub(super) fn of((own, seam): (bool, bool)) -> Self {
        match (own, seam) {
            (true, _) => Self::Own,
            (_, true) => Self::Seams,
            _ => Self::Rest,
        }
    }
}

impl Default for Layout {
    fn default() -> Self {
        Self::ONE
    }
}

impl Layout {
    /// All bodies are one stripe.
    pub(super) const ONE: Self = Self { shift: usize::BITS - 2, own: 1 };

    /// The layout that suits so many balls.
    pub(super) fn of(count: usize) -> Self {
        if count < LEAST {
            return Self::ONE;
        }
        // A square of so many balls has their root on a side.
        let shift = (0.5 * WIDTH * (count as f64).sqrt()).log2().round() as u32;
        Self { shift, own: count.div_ceil(2 << shift) }
    }

    /// Whether there is more than one stripe.
    pub(super) fn is_cut(self) -> bool {
        self.own > 1
    }

    /// How many stripes there are, seams and the rest counted.
    pub(super) fn len(self) -> usize {
        if self.is_cut() { 2 * self.own + 2 } else { 1 }
    }

    /// The stripe of a body, its seam and the rest.
    #[inline]
    pub(super) fn of_body(self, body: usize) -> impl Iterator<Item = usize> + use<> {
        let numbers = [self.own_of(body), self.own + (body >> self.shift).div_ceil(2), 2 * self.own + 1];
        numbers.into_iter().take(if self.is_cut() { 3 } else { 1 })
    }

    /// The stripe of a body.
    #[inline]
    pub(super) fn own_of(self, body: usize) -> usize {
        body >> (self.shift + 1)
    }

    /// Whether two bodies share a stripe, and a seam.
    #[inline]
    pub(super) fn shared(self, one: usize, other: usize) -> (bool, bool) {
        let (one, other) = (one >> self.shift, other >> self.shift);
        (one >> 1 == other >> 1, (one + 1) >> 1 == (other + 1) >> 1)
    }

    /// The number of the stripe that a pair belongs to by itself.
    #[inline]
    pub(super) fn of_pair(self, one: usize, other: usize) -> usize {
        self.number(one, Layer::of(self.shared(one, other)))
    }

    /// The number of the one of a body's stripes that is within this layer.
    #[inline]
    pub(super) fn number(self, body: usize, layer: Layer) -> usize {
        match layer {
            Layer::Own => self.own_of(body),
            Layer::Seams => self.own + (body >> self.shift).div_ceil(2),
            Layer::Rest => 2 * self.own + 1,
        }
    }

    /// The number of the first stripe of a layer.
    pub(super) fn first_of(self, layer: Layer) -> usize {
        match layer {
            Layer::Own => 0,
            Layer::Seams => self.own,
            Layer::Rest => 2 * self.own + 1,
        }
    }

    /// The first body of a stripe.
    #[inline]
    pub(super) fn start(self, number: usize) -> usize {
        if number < self.own {
            // Nothing is shifted out where all are one stripe.
            number << (self.shift + 1)
        } else if number <= 2 * self.own {
            (2 * (number - self.own)).saturating_sub(1) << self.shift
        } else {
            0
        }
    }

    /// How many of `all` bodies a stripe has.
    pub(super) fn count(self, number: usize, all: usize) -> usize {
        let left = all.saturating_sub(self.start(number));
        if number > 2 * self.own {
            left
        } else if number == self.own && self.is_cut() {
            left.min(1 << self.shift)
        } else {
            left.min(2 << self.shift)
        }
    }

    /// Items, one a body, as the stripes of a layer have them.
    pub(super) fn share<T>(
        self,
        layer: Layer,
        items: &mut [T],
    ) -> impl Iterator<Item = &mut [T]> + use<'_, T> {
        let (first, length) = self.first_and_length(layer, items.len());
        let (first, others) = items.split_at_mut(first);
        let none_first = first.is_empty();
        std::iter::once(first).skip(usize::from(none_first)).chain(others.chunks_mut(length))
    }

    /// The same for items that are only read.
    pub(super) fn share_read<T>(self, layer: Layer, items: &[T]) -> impl Iterator<Item = &[T]> + use<'_, T> {
        let (first, length) = self.first_and_length(layer, items.len());
        let (first, others) = items.split_at(first);
        let none_first = first.is_empty();
        std::iter::once(first).skip(usize::from(none_first)).chain(others.chunks(length))
    }

    /// How many of so many bodies the first stripe of a layer has where that is not as many as in others, and those.
    fn first_and_length(self, layer: Layer, count: usize) -> (usize, usize) {
        let length = 2 << self.shift;
        match layer {
            Layer::Own => (0, length),
            Layer::Seams => (count.min(1 << self.shift), length),
            Layer::Rest => (0, count.max(1)),
        }
    }
}

/// Pairs of a range of bodies, by the places of these within it, and what is known of them.
#[derive(Debug, Default)]
pub(super) struct Stripe {
    /// Where there is gravity, the first is the upper one, and pairs stand in the order of its height, from the lowest up,
    /// before those that were added since.
    pub(super) pairs: Vec<Pair>,
    /// For each pair; empty where nothing rests.
    pub(super) holds: Vec<Hold>,
    /// For each of these, whether they pressed on each other, or met, in the last substep.
    pub(super) held: Vec<bool>,
    /// For each pair, whether nothing moves either of its balls.
    pub(super) idle: Vec<bool>,
    /// For each pair, whether it may come close enough in this substep to be held apart.
    pub(super) close: Vec<bool>,
    pub(super) links: Links,
    pub(super) heights: Heights,
    /// Bodies of this stripe, no seam, that may touch a wall.
    pub(super) beside: Vec<Beside>,
    /// For each body its place among them, or [`NOWHERE`].
    places_beside: Vec<u32>,
    /// The pairs that are held apart in a substep, in the order in which they were looked at.
    pub(super) touching: Vec<u32>,
    /// Bodies asleep that others, awake, press on, or did: then with the impulse that is lost.
    pub(super) disturbed: Vec<(u32, f64)>,
    /// Impacts that are foreseen.
    pub(super) queue: BinaryHeap<Event>,
    /// Impacts that are left to the second round, and bodies whose impacts are after they were hit.
    pub(super) left_events: Vec<Event>,
    pub(super) left_bodies: Vec<u32>,
    /// Balls that were kept from going where they are not covered.
    pub(super) strays: Vec<u32>,
    /// How many are about to go where they are not covered.
    pub(super) leaving: usize,
    /// Whether any of its bodies is fast.
    pub(super) has_fast: bool,
    /// What happened in the first round.
    pub(super) tally: Tally,
}

impl Stripe {
    /// Forgets all pairs and walls.
    pub(super) fn clear(&mut self, count: usize) {
        let Self { pairs, holds, held, idle, close, links, beside, places_beside, .. } = self;
        pairs.clear();
        holds.clear();
        held.clear();
        idle.clear();
        close.clear();
        links.clear();
        beside.clear();
        places_beside.clear();
        places_beside.resize(count, NOWHERE);
        self.touching.clear();
        self.strays.clear();
        self.disturbed.clear();
    }

    /// Links each body of so many to its pairs, as far as they are not linked yet.
    pub(super) fn link(&mut self, count: usize) {
        self.links.link(&self.pairs, count);
    }

    /// Puts a body beside the walls, if it is not there yet.
    pub(super) fn add_beside(&mut self, body: u32, push: DVec2) {
        if self.place_beside(body).is_none() {
            self.places_beside[body as usize] = self.beside.len() as u32;
            self.beside.push(Beside { body, push });
        }
    }

    /// The place of a ball among those beside walls, if it is one of them.
    #[inline]
    pub(super) fn place_beside(&self, body: u32) -> Option<usize> {
        self.places_beside.get(body as usize).filter(|&&place| place != NOWHERE).map(|&place| place as usize)
    }

    /// Adds a pair, which may press in a stripe where things rest.
    pub(super) fn add_pair(&mut self, pair: Pair, give: f64, rests: bool) {
        self.pairs.push(pair);
        self.idle.push(give == 0.0);
        self.close.push(true);
        if rests {
            self.holds.push(Hold { mass: give.recip(), ..Hold::NONE });
            self.held.push(false);
        }
    }

    /// Finds the mass of a pair anew, and whether it is idle.
    #[inline]
    pub(super) fn weigh(&mut self, at: usize, bodies: &[Body]) {
        let pair = self.pairs[at];
        let give = bodies[pair.first as usize].inverse_mass + bodies[pair.second as usize].inverse_mass;
        self.idle[at] = give == 0.0;
        if let Some(hold) = self.holds.get_mut(at) {
            hold.mass = give.recip();
        }
    }

    /// The same for all pairs.
    pub(super) fn weigh_all(&mut self, bodies: &[Body]) {
        self.idle.resize(self.pairs.len(), false);
        for at in 0..self.pairs.len() {
            self.weigh(at, bodies);
        }
    }
}

/// All stripes, or one by itself.
#[derive(Debug)]
pub(super) struct Stripes<'a> {
    pub(super) layout: Layout,
    pub(super) list: &'a mut [Stripe],
}

impl Stripes<'_> {
    /// What others and walls give a ball of this inverse mass in a substep. Its pairs must be linked.
    pub(super) fn given(&self, body: usize, inverse_mass: f64) -> Given {
        let mut given = Given { velocity: DVec2::ZERO, pressed: 0.0 };
        for number in self.layout.of_body(body) {
            let (stripe, body) = (&self.list[number], (body - self.layout.start(number)) as u32);
            for at in stripe.links.of(body) {
                let hold = &stripe.holds[at];
                let push = (hold.normal * hold.impulse + hold.grip) * inverse_mass;
                given.velocity += if stripe.pairs[at].first == body { push } else { -push };
                given.pressed += hold.impulse * inverse_mass;
            }
            if let Some(at) = stripe.place_beside(body) {
                given.velocity += stripe.beside[at].push;
                given.pressed += stripe.beside[at].push.length();
            }
        }
        given
    }

    /// Whether a ball may touch a wall.
    pub(super) fn is_beside(&self, body: usize) -> bool {
        let number = self.layout.own_of(body);
        self.list[number].place_beside((body - self.layout.start(number)) as u32).is_some()
    }

    /// Weighs all pairs of a ball anew. They must be linked.
    pub(super) fn weigh_pairs_of(&mut self, body: usize, bodies: &[Body]) {
        for number in self.layout.of_body(body) {
            let start = self.layout.start(number);
            let stripe = &mut self.list[number];
            let mut link = stripe.links.last((body - start) as u32);
            while let Some(at) = link {
                stripe.weigh(at.pair(), &bodies[start..]);
                link = stripe.links.before(at);
            }
        }
    }
}

/// Makes as many stripes as a layout has, all empty.
pub(super) fn clear_all(list: &mut Vec<Stripe>, layout: Layout, count: usize) {
    list.resize_with(layout.len(), Stripe::default);
    for (number, stripe) in list.iter_mut().enumerate() {
        // Only stripes have bodies beside walls.
        stripe.clear(if number < layout.own { layout.count(number, count) } else { 0 });
    }
}

/// The stripes of a layer, in the order of their bodies.
pub(super) fn of_layer(list: &mut [Stripe], layout: Layout, layer: Layer) -> &mut [Stripe] {
    let own = layout.own;
    if list.is_empty() {
        // Nothing was searched yet: there are no balls.
        return list;
    }
    match layer {
        Layer::Own => &mut list[..own],
        Layer::Seams if layout.is_cut() => &mut list[own..=2 * own],
        Layer::Rest if layout.is_cut() => &mut list[2 * own + 1..],
        _ => &mut [],
    }
}
