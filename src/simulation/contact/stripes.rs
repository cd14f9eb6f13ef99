//! What a stripe holds: the pairs of a range of bodies, and what is known of them; and what is asked of several
//! stripes.

use std::collections::BinaryHeap;

use super::super::Tally;
use super::events::Event;
use super::holds::{Beside, Given, Hold, Mark, Pair};
use super::layout::{Layer, Layout};
use super::order::{Heights, Links};
use super::support::Floor;
use super::{Body, DVec2};

/// The place of a ball that is not beside a wall.
const NOWHERE: u32 = u32::MAX;

/// Pairs of a range of bodies, by the places of these within it, and what is known of them.
#[derive(Debug, Clone, Default)]
pub(super) struct Stripe {
    /// Where there is gravity, the first is the upper one, and pairs stand in the order of its height, from the lowest
    /// up, before those that were added since.
    pub(super) pairs: Vec<Pair>,
    /// For each pair, how it is held apart; empty where nothing rests.
    pub(super) holds: Vec<Hold>,
    /// For each pair, what is to be done with it.
    pub(super) marks: Vec<Mark>,
    pub(super) links: Links,
    pub(super) heights: Heights,
    /// Bodies of this stripe, no seam, that may touch a wall.
    pub(super) beside: Vec<Beside>,
    /// For each body its place among them, or [`NOWHERE`].
    places_beside: Vec<u32>,
    /// The pairs that are held apart in a substep.
    pub(super) touching: Vec<u32>,
    /// Where the pairs of each upper ball end among them, after a 0.
    pub(super) uppers: Vec<u32>,
    /// For each of those that may have to be, where its first ball is at the substep's beginning, seen from the second, and
    /// how far away, px.
    pub(super) ways: Vec<DVec2>,
    pub(super) distances: Vec<f64>,
    /// What carries the ball that is looked at.
    pub(super) floors: Vec<Floor>,
    /// Bodies asleep that others, awake, press on, or did: then with the impulse that is lost.
    pub(super) disturbed: Vec<(u32, f64)>,
    /// Places of pairs that may meet in a substep.
    pub(super) nearing: Vec<u32>,
    /// Impacts that are foreseen.
    pub(super) queue: BinaryHeap<Event>,
    /// Impacts that are left to the second round, and bodies whose impacts are after they were hit.
    pub(super) left_events: Vec<Event>,
    pub(super) left_bodies: Vec<u32>,
    /// Balls that were kept from going where they are not covered.
    pub(super) strays: Vec<u32>,
    /// Balls that what held them has thrown.
    pub(super) thrown: Vec<u32>,
    /// How many are about to go where they are not covered.
    pub(super) leaving: usize,
    /// Whether any of its bodies is fast.
    pub(super) has_fast: bool,
    /// Whether impulses that hold apart changed much in the last sweep.
    pub(super) unsettled: bool,
    /// What happened in the first round.
    pub(super) tally: Tally,
}

impl Stripe {
    /// Forgets all pairs and walls.
    pub(super) fn clear(&mut self, count: usize) {
        let Self { pairs, holds, marks, links, beside, places_beside, .. } = self;
        pairs.clear();
        holds.clear();
        marks.clear();
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
    pub(super) fn add_pair(&mut self, pair: Pair, give: f64, can_rest: bool) {
        self.pairs.push(pair);
        self.marks.push(Mark { held: false, live: false, close: true, idle: give == 0.0 });
        if can_rest {
            self.holds.push(Hold { mass: give.recip(), ..Hold::NONE });
        }
    }

    /// Notes that a pair has exchanged momentum; `after` the substep's beginning or right then.
    pub(super) fn note_met(&mut self, at: usize, after: bool) {
        if let Some(hold) = self.holds.get_mut(at) {
            hold.met |= after;
            self.marks[at].live = true;
        }
    }

    /// Finds the mass of a pair anew, and whether it is idle.
    #[inline]
    pub(super) fn weigh(&mut self, at: usize, bodies: &[Body]) {
        let pair = self.pairs[at];
        let give = bodies[pair.first as usize].inverse_mass + bodies[pair.second as usize].inverse_mass;
        self.marks[at].idle = give == 0.0;
        if let Some(hold) = self.holds.get_mut(at) {
            hold.mass = give.recip();
        }
    }

    /// The same for all pairs.
    pub(super) fn weigh_all(&mut self, bodies: &[Body]) {
        for at in 0..self.pairs.len() {
            self.weigh(at, bodies);
        }
    }
}

/// Another ball that holds one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Holder {
    /// The stripe that their pair belongs to, and its place there.
    pub(super) number: usize,
    pub(super) at: usize,
    pub(super) other: usize,
    /// The direction in which it pushes.
    pub(super) normal: DVec2,
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

    /// What holds a ball, but for walls. Its pairs must be linked.
    pub(super) fn holders(&self, body: usize) -> impl Iterator<Item = Holder> {
        self.layout.of_body(body).flat_map(move |number| {
            let (stripe, start) = (&self.list[number], self.layout.start(number));
            stripe.links.of((body - start) as u32).filter(|&at| stripe.holds[at].impulse > 0.0).map(
                move |at| {
                    let (pair, normal) = (stripe.pairs[at].from(start), stripe.holds[at].normal);
                    let (first, second) = (pair.first as usize, pair.second as usize);
                    let (other, normal) = if first == body { (second, normal) } else { (first, -normal) };
                    Holder { number, at, other, normal }
                },
            )
        })
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
            let mut cursor = stripe.links.begin((body - start) as u32);
            while let Some(at) = stripe.links.next(&mut cursor) {
                stripe.weigh(at, &bodies[start..]);
            }
        }
    }
}

/// Makes as many stripes as a layout has, all empty.
pub(super) fn clear_all(list: &mut Vec<Stripe>, layout: Layout, count: usize) {
    list.resize_with(layout.len(), Stripe::default);
    for (number, stripe) in list.iter_mut().enumerate() {
        // Only stripes have bodies beside walls.
        stripe.clear(if layout.numbers(Layer::Own).contains(&number) {
            layout.count(number, count)
        } else {
            0
        });
    }
}

/// The stripes of a layer, in the order of their bodies. None where nothing was searched yet.
pub(super) fn of_layer(list: &mut [Stripe], layout: Layout, layer: Layer) -> &mut [Stripe] {
    list.get_mut(layout.numbers(layer)).unwrap_or_default()
}
