//! The neighbour list: what the last search found of which balls are near each other, or a wall.

use glam::DVec2;

use super::super::grid::Grid;
use super::Body;
use super::constraints::{Beside, Constraint, Pair};
use super::cover::{Covered, Home};
use super::layout::{Layer, Layout};
use super::stripes::{Stripe, Stripes};
use super::weights::Weights;

/// The neighbour list, which `find` makes.
#[derive(Debug, Clone, Default)]
pub(super) struct Near {
    pub(super) layout: Layout,
    /// The pairs, and what is beside walls.
    pub(super) stripes: Vec<Stripe>,
    pub(super) homes: Vec<Home>,
    /// For each ball, the last layer that pairs of it belong to.
    pub(super) crossing: Vec<Layer>,
    /// Whether pairs are looked for.
    pub(super) seeks_pairs: bool,
    /// How many pairs the search found.
    pub(super) found: usize,
    /// How many pairs were held apart in the last substep.
    pub(super) touched: usize,
    /// ... and how many of these were of unlike balls.
    pub(super) touched_unlike: usize,
    /// Whether the search found a crowd.
    pub(super) crowd: bool,
    /// How many balls were covered anew since the search.
    pub(super) moved: usize,
    pub(super) discs: Vec<Covered>,
    pub(super) cells: Option<Cells>,
    /// Whether the axes of `discs` are swapped, so that rows of cells are columns of the world.
    pub(super) turned: bool,
    pub(super) weights: Weights,
    /// The root mean square of all speeds at the search, px/s.
    pub(super) rms_speed: f64,
    /// How many times balls are covered for a shorter time than usual, less one.
    pub(super) haste: u32,
    pub(super) searches: u32,
    /// What walls gave to balls before the search, px/s.
    pub(super) kept_pushes: Vec<(u32, DVec2)>,
    pub(super) gathered: Vec<Gathered>,
}

/// The cells, and what they were made for.
#[derive(Debug, Clone)]
pub(super) struct Cells {
    pub(super) grid: Grid,
    /// The sum of the radii of the discs that there were, px.
    pub(super) made_for: f64,
}

/// The pairs that a part of the cells gave.
#[derive(Debug, Clone, Default)]
pub(super) struct Gathered {
    pub(super) pairs: Vec<Pair>,
    /// The same by the numbers of their stripes.
    pub(super) parted: Vec<Vec<Pair>>,
}

impl Near {
    /// Of nothing yet; whether it `seeks_pairs`, too, or what is beside walls alone.
    pub(super) fn new(seeks_pairs: bool) -> Self {
        Self { seeks_pairs, ..Self::default() }
    }

    /// All stripes.
    pub(super) fn all(&mut self) -> Stripes<'_> {
        Stripes { layout: self.layout, list: &mut self.stripes }
    }

    /// Weighs all pairs anew.
    pub(super) fn weigh_all(&mut self, bodies: &[Body]) {
        for (number, stripe) in self.stripes.iter_mut().enumerate() {
            stripe.weigh_all(&bodies[self.layout.start(number).min(bodies.len())..]);
        }
    }

    /// Links each of so many balls to its pairs, as far as they are not linked yet.
    pub(super) fn link_pairs(&mut self, count: usize) {
        for (number, stripe) in self.stripes.iter_mut().enumerate() {
            stripe.link(self.layout.count(number, count));
        }
    }

    /// How many pairs there are.
    pub(super) fn pair_count(&self) -> usize {
        self.stripes.iter().map(|stripe| stripe.pairs.len()).sum()
    }

    /// The balls of all pairs.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        self.stripes.iter().enumerate().flat_map(|(number, stripe)| {
            let start = self.layout.start(number);
            stripe.pairs.iter().map(move |pair| (start + pair.first as usize, start + pair.second as usize))
        })
    }

    /// All pairs that hold each other, with the numbers of their balls.
    pub(super) fn holding(&self) -> impl Iterator<Item = (usize, usize, &Constraint)> {
        self.stripes.iter().enumerate().flat_map(|(number, stripe)| {
            let start = self.layout.start(number);
            stripe.constraints.iter().filter(|constraint| constraint.impulse > 0.0).map(move |constraint| {
                let pair = constraint.pair.from(start);
                (pair.first as usize, pair.second as usize, constraint)
            })
        })
    }

    /// All balls beside walls, with their numbers.
    pub(super) fn beside(&self) -> impl Iterator<Item = (usize, &Beside)> {
        self.stripes.iter().enumerate().flat_map(|(number, stripe)| {
            let start = self.layout.start(number);
            stripe.beside.iter().map(move |beside| (start + beside.body as usize, beside))
        })
    }

    /// Takes over another layout, and keeps what holds balls, which now have these `places`, or still those that they had.
    pub(super) fn keep(&mut self, layout: Layout, places: Option<&[u32]>) {
        let place = |at: usize| places.map_or(at as u32, |places| places[at]);
        let pushed = self.beside().filter(|(_, beside)| beside.push != DVec2::ZERO);
        let mut pushes: Vec<_> = pushed.map(|(body, beside)| (place(body), beside.push)).collect();
        pushes.sort_unstable_by_key(|&(body, _)| body);
        self.kept_pushes = pushes;
        if places.is_none() && layout == self.layout {
            // They stay where they are.
            self.stripes.iter_mut().for_each(|stripe| stripe.kept.take(&mut stripe.constraints));
            return;
        }
        let held = self.holding().map(|(first, second, constraint)| {
            let pair = Pair { first: place(first), second: place(second) };
            Constraint { pair, ..*constraint }
        });
        let held: Vec<_> = held.collect();
        self.layout = layout;
        self.stripes.resize_with(layout.len(), Stripe::default);
        self.stripes.iter_mut().for_each(|stripe| stripe.kept.clear());
        for constraint in held {
            let number = layout.of_pair(constraint.pair.first as usize, constraint.pair.second as usize);
            let pair = constraint.pair.within(layout.start(number));
            self.stripes[number].kept.add(Constraint { pair, ..constraint });
        }
    }
}
