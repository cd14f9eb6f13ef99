//! What a stripe holds: the pairs of a range of bodies, and what is known of them; and what is asked of several
//! stripes.

use std::collections::BinaryHeap;

use super::super::Tally;
use super::apart::Apart;
use super::constraints::{Beside, Constraint, Given, Marks, Pair};
use super::energy::Account;
use super::events::Event;
use super::floors::Floor;
use super::layout::{Layer, Layout};
use super::legs::Leg;
use super::order::{Heights, Kept, Known, Links};
use super::prepare::Followed;
use super::rewind::Taken;
use super::substeps::CARRIED;
use super::unlike::Unlike;
use super::wedges::Wedging;
use super::{Body, DVec2, Setting};

/// A pair that holds each other bounces only where it meets faster than [`Setting::firm`] and this part of the velocity
/// that the constraint gives it in a substep, but no more than so many kicks of gravity: under a great load, what is left to be
/// found of that is no impact.
const PRESSED: (f64, f64) = (0.2, 200.0);

/// The place of a ball that is not beside a wall, and of the constraint of a pair that has none.
pub(super) const NOWHERE: u32 = u32::MAX;

/// Pairs of a range of bodies, by the places of these within it, and what is known of them.
#[derive(Debug, Clone, Default)]
pub(super) struct Stripe {
    /// Where there is gravity, the first is the upper one, and pairs stand in the order of its height, from the lowest
    /// up, before those that were added since.
    pub(super) pairs: Vec<Pair>,
    /// How pairs are held apart: those that have been since the search, in the order in which they came to be.
    pub(super) constraints: Vec<Constraint>,
    /// For each pair the place of its constraint among them, or [`NOWHERE`].
    pub(super) places_of_constraints: Vec<u32>,
    /// For each pair, what is known of it.
    pub(super) marks: Vec<Marks>,
    /// What pushed them apart in the last substep that was no quiet one, where sweeps are followed to their end.
    pub(super) apart: Apart,
    /// What held them before the search.
    pub(super) kept: Kept,
    pub(super) links: Links,
    pub(super) heights: Heights,
    /// Bodies of this stripe, no seam, that may touch a wall.
    pub(super) beside: Vec<Beside>,
    /// For each body its place among them, or [`NOWHERE`].
    places_beside: Vec<u32>,
    /// The pairs that may have to be held apart in a substep, as they stand, and dealt.
    pub(super) close: Vec<u32>,
    pub(super) dealt: Vec<u32>,
    pub(super) close_for: Followed,
    /// The places of the constraints of those that are, dealt.
    pub(super) touching: Vec<u32>,
    /// Where among these the ones of like balls end, of those unlike in size, and of those in density.
    pub(super) ends: [usize; Unlike::KINDS],
    /// Those of them in which one ball may carry the other (`abreast`), the ones of each upper ball side by side, and where these end,
    /// after a 0.
    pub(super) carrying: Vec<u32>,
    pub(super) uppers: Vec<u32>,
    /// For each body, whether it lies on others or under them, or leans on something that does not give way, by itself or in a row.
    pub(super) backed: Vec<bool>,
    /// The pairs that stand abreast, of which that is looked for.
    pub(super) abreast: Vec<Pair>,
    /// Those of which one cannot be moved.
    pub(super) wedging: Vec<Wedging>,
    pub(super) carrying_for: Followed,
    /// For each dealt pair, where its first ball is at the substep's beginning, seen from the second, and
    /// how far away, px.
    pub(super) ways: Vec<DVec2>,
    pub(super) distances: Vec<f64>,
    /// What carries the ball that is looked at, and what is above it in a flat wedge.
    pub(super) floors: Vec<Floor>,
    /// How much each adds to its velocity, where that is found in sweeps.
    pub(super) added: Vec<f64>,
    /// Bodies asleep that others, awake, press on, or did: then with the impulse that is lost.
    pub(super) disturbed: Vec<(u32, f64)>,
    /// Places of pairs that may meet in a substep.
    pub(super) nearing: Vec<u32>,
    /// Impacts that are foreseen; none between turns.
    pub(super) queue: BinaryHeap<Event>,
    /// Impacts that are left to a later turn, and bodies whose impacts are after they were hit.
    pub(super) left_events: Vec<Event>,
    pub(super) left_bodies: Vec<u32>,
    /// Impacts that were taken in turns that began with this stripe.
    pub(super) taken: Vec<Taken>,
    /// The legs that balls are on after those of the present turn, where they are noted.
    pub(super) legs: Vec<Leg>,
    /// Balls that were kept from going where they are not covered.
    pub(super) strays: Vec<u32>,
    /// Pairs that end deep in each other.
    pub(super) deep: Vec<Pair>,
    /// Balls that what held them has thrown.
    pub(super) thrown: Vec<u32>,
    /// How its bodies, no seam's, would move without what holds them; where something carries balls, with how much energy instead.
    pub(super) unheld: Vec<DVec2>,
    pub(super) unheld_energies: Vec<f64>,
    /// What they gain and lose by that.
    pub(super) account: Account,
    /// Strays, and balls that are about to go where they are not covered.
    pub(super) leaving: Vec<u32>,
    /// Pairs of these across the stripe's edges, by the numbers of their bodies among all.
    pub(super) across: Vec<Pair>,
    pub(super) known: Known,
    /// How many of its bodies impacts have shifted in this substep.
    pub(super) shifted: usize,
    /// How many of its pairs carried more than each of the loads that ask for shorter substeps, when that was last looked at.
    pub(super) heavy: [usize; CARRIED.len()],
    /// Whether impulses that hold apart changed much in the last sweep.
    pub(super) unsettled: bool,
    /// How many times as much as is enough that was at most, where it is measured; infinite before the first sweep.
    pub(super) changed: f64,
    /// What happened in all turns but the last.
    pub(super) tally: Tally,
}

impl Stripe {
    /// Forgets all pairs and walls.
    pub(super) fn clear(&mut self, count: usize) {
        let Self { pairs, constraints, places_of_constraints, marks, links, beside, places_beside, .. } =
            self;
        let Self { close, dealt, close_for, touching, carrying, uppers, carrying_for, .. } = self;
        for list in [close, dealt, touching, carrying, uppers] {
            list.clear();
        }
        self.wedging.clear();
        self.apart.clear();
        self.ends = [0; Unlike::KINDS];
        close_for.forget();
        carrying_for.forget();
        pairs.clear();
        constraints.clear();
        places_of_constraints.clear();
        marks.clear();
        links.clear();
        beside.clear();
        places_beside.clear();
        places_beside.resize(count, NOWHERE);
        self.strays.clear();
        self.leaving.clear();
        self.disturbed.clear();
        self.shifted = 0;
        self.heavy = [0; CARRIED.len()];
    }

    /// Whether it has neither pairs nor anything beside a wall.
    pub(super) fn is_idle(&self) -> bool {
        self.pairs.is_empty() && self.beside.is_empty()
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

    /// Adds a pair of balls of these inverse masses.
    pub(super) fn add_pair(&mut self, pair: Pair, first: f64, second: f64) {
        self.pairs.push(pair);
        let mut marks = Marks::CLOSE;
        marks.weigh(first, second);
        self.marks.push(marks);
        self.places_of_constraints.push(NOWHERE);
    }

    /// Notes that a pair has exchanged momentum; `after` the substep's beginning or right then.
    pub(super) fn note_met(&mut self, at: usize, after: bool) {
        let marks = &mut self.marks[at];
        marks.set(Marks::LIVE, true);
        if after {
            marks.set(Marks::MET, true);
        }
    }

    /// How a pair is held apart, if it ever was.
    #[inline]
    pub(super) fn constraint(&self, at: usize) -> Option<&Constraint> {
        self.constraints.get(self.places_of_constraints[at] as usize)
    }

    /// The same, to be changed.
    #[inline]
    pub(super) fn constraint_mut(&mut self, at: usize) -> Option<&mut Constraint> {
        self.constraints.get_mut(self.places_of_constraints[at] as usize)
    }

    /// The speed, px/s, below which a pair that presses on each other does not bounce; [`None`] where it does not press.
    #[inline]
    pub(super) fn firm(&self, at: usize, setting: &Setting) -> Option<f64> {
        if !self.marks[at].has(Marks::HELD) {
            return None;
        }
        let (part, most) = PRESSED;
        let carried =
            self.constraint(at).map_or(0.0, |constraint| part * constraint.impulse / constraint.mass);
        Some(setting.firm + carried.min(most * setting.kick.length()))
    }

    /// Finds the mass of a pair anew, and whether it is idle.
    #[inline]
    pub(super) fn weigh(&mut self, at: usize, bodies: &[Body]) {
        let pair = self.pairs[at];
        let [first, second] = [pair.first, pair.second].map(|body| bodies[body as usize].inverse_mass);
        self.marks[at].weigh(first, second);
        if let Some(constraint) = self.constraint_mut(at) {
            constraint.mass = (first + second).recip();
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
    /// What it gives in a substep, mass·px/s.
    pub(super) impulse: f64,
}

/// All stripes, those of a block, or one by itself.
#[derive(Debug)]
pub(super) struct Stripes<'a> {
    pub(super) layout: Layout,
    pub(super) list: &'a mut [Stripe],
}

impl Stripes<'_> {
    /// The numbers of those that a body is in.
    #[inline]
    pub(super) fn of_body(&self, body: usize) -> impl Iterator<Item = usize> + use<> {
        let count = self.list.len();
        self.layout.of_body(body).filter(move |&number| number < count)
    }

    /// What others and walls give a ball of this inverse mass in a substep. Its pairs must be linked.
    pub(super) fn given(&self, body: usize, inverse_mass: f64) -> Given {
        let mut given = Given { velocity: DVec2::ZERO, pressed: 0.0 };
        for number in self.of_body(body) {
            let (stripe, body) = (&self.list[number], (body - self.layout.start(number)) as u32);
            for constraint in stripe.links.of(body).filter_map(|at| stripe.constraint(at)) {
                let push = (constraint.normal * constraint.impulse + constraint.grip) * inverse_mass;
                given.velocity += if constraint.pair.first == body { push } else { -push };
                given.pressed += constraint.impulse * inverse_mass;
            }
            if let Some(at) = stripe.place_beside(body) {
                given.velocity += stripe.beside[at].push;
                given.pressed += stripe.beside[at].push.length();
            }
        }
        given
    }

    /// What holds a ball, except walls. Its pairs must be linked.
    pub(super) fn holders(&self, body: usize) -> impl Iterator<Item = Holder> {
        self.of_body(body).flat_map(move |number| {
            let (stripe, start) = (&self.list[number], self.layout.start(number));
            let constraints = stripe.links.of((body - start) as u32).map(|at| (at, stripe.constraint(at)));
            let constraints = constraints.filter_map(|(at, constraint)| Some((at, constraint?)));
            constraints.filter(|(_, constraint)| constraint.impulse > 0.0).map(move |(at, constraint)| {
                let (pair, normal) = (constraint.pair.from(start), constraint.normal);
                let (first, second) = (pair.first as usize, pair.second as usize);
                let (other, normal) = if first == body { (second, normal) } else { (first, -normal) };
                Holder { number, at, other, normal, impulse: constraint.impulse }
            })
        })
    }

    /// The balls that one may touch. Its pairs must be linked.
    pub(super) fn around(&self, body: usize) -> impl Iterator<Item = usize> {
        self.of_body(body).flat_map(move |number| {
            let (stripe, start) = (&self.list[number], self.layout.start(number));
            let own = (body - start) as u32;
            stripe.links.of(own).map(move |at| start + stripe.pairs[at].other(own) as usize)
        })
    }

    /// Whether a ball may touch a wall.
    pub(super) fn is_beside(&self, body: usize) -> bool {
        let (number, own) = self.layout.place_of(body);
        self.list[number].place_beside(own).is_some()
    }

    /// Weighs all pairs of a ball anew. They must be linked.
    pub(super) fn weigh_pairs_of(&mut self, body: usize, bodies: &[Body]) {
        self.each_pair_of(body, |stripe, at, start| stripe.weigh(at, &bodies[start..]));
    }

    /// Works on each pair of a body: with the stripe that it belongs to, its place there, and where that stripe's bodies start. Pairs must
    /// be linked.
    #[inline]
    pub(super) fn each_pair_of(&mut self, body: usize, mut work: impl FnMut(&mut Stripe, usize, usize)) {
        for number in self.of_body(body) {
            let start = self.layout.start(number);
            let stripe = &mut self.list[number];
            let mut cursor = stripe.links.begin((body - start) as u32);
            while let Some(at) = stripe.links.next(&mut cursor) {
                work(stripe, at, start);
            }
        }
    }
}

/// Makes as many stripes as a layout has, all empty.
pub(super) fn clear_all(list: &mut Vec<Stripe>, layout: Layout, count: usize) {
    list.resize_with(layout.len(), Stripe::default);
    for (number, stripe) in list.iter_mut().enumerate() {
        // Only stripes have bodies beside walls.
        stripe.clear(if layout.layer(number) == Layer::Own { layout.count(number, count) } else { 0 });
    }
}

/// The stripes of a layer, in the order of their bodies. None where nothing was searched yet.
pub(super) fn of_layer(
    list: &mut [Stripe],
    layout: Layout,
    layer: Layer,
) -> impl Iterator<Item = &mut Stripe> {
    layout.share_stripes(layer, list).filter_map(|(_, stripes)| stripes.first_mut())
}
