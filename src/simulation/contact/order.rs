//! The order in which pairs are looked at, and what of them outlives a search.

use glam::DVec2;

use super::Body;
use super::constraints::{Constraint, Pair};

/// Room for sorting pairs by height.
#[derive(Debug, Clone, Default)]
pub(super) struct Heights {
    starts: Vec<u32>,
    /// The place of each ball in the order of heights.
    ranks: Vec<u32>,
    /// The ball at each of these places.
    ordered: Vec<u32>,
    sorted: Vec<Pair>,
}

impl Heights {
    /// Puts the pairs in the order of the height of their upper balls, from the lowest up, with all pairs of an upper ball side by
    /// side, and the upper ball first. `up` is the unit vector against gravity.
    pub(super) fn sort(&mut self, pairs: &mut Vec<Pair>, bodies: &[Body], up: DVec2) {
        self.rank(bodies, up);
        let Self { starts, ranks, sorted, .. } = self;
        starts.clear();
        starts.resize(bodies.len() + 1, 0);
        for pair in pairs.iter_mut() {
            let (first, second) = (ranks[pair.first as usize], ranks[pair.second as usize]);
            if first < second {
                (pair.first, pair.second) = (pair.second, pair.first);
            }
            starts[first.max(second) as usize + 1] += 1;
        }
        sum_up(starts);
        sorted.clear();
        sorted.resize(pairs.len(), Pair { first: 0, second: 0 });
        for pair in pairs.iter() {
            let start = &mut starts[ranks[pair.first as usize] as usize];
            sorted[*start as usize] = *pair;
            *start += 1;
        }
        std::mem::swap(pairs, sorted);
    }

    /// Finds the places of balls in the order of their heights. Of those that are as high as each other to the last bit, as in a row on
    /// the floor, every other one comes after both its neighbours: what comes later is stopped on what came before it (`carry`),
    /// and a heap would drift to one side.
    fn rank(&mut self, bodies: &[Body], up: DVec2) {
        let Self { starts, ranks, ordered, .. } = self;
        let height = |body: &Body| body.position.dot(up);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for body in bodies {
            low = low.min(height(body));
            high = high.max(height(body));
        }
        // By layers first, of one ball each on average.
        let density = if high > low { bodies.len() as f64 / (high - low) } else { 0.0 };
        let layer = |body: &Body| (((height(body) - low) * density) as usize).min(bodies.len());
        starts.clear();
        starts.resize(bodies.len() + 2, 0);
        for body in bodies {
            starts[layer(body) + 1] += 1;
        }
        sum_up(starts);
        ordered.resize(bodies.len(), 0);
        for (at, body) in (0..).zip(bodies) {
            let next = &mut starts[layer(body)];
            ordered[*next as usize] = at;
            *next += 1;
        }
        let mut start = 0;
        for &end in &*starts {
            let end = end as usize;
            ordered[start..end].sort_unstable_by(|&one, &other| {
                let [left, right] = [one, other].map(|at| bodies[at as usize].position);
                let by_height = left.dot(up).total_cmp(&right.dot(up));
                by_height.then_with(|| left.perp_dot(up).total_cmp(&right.perp_dot(up))).then(one.cmp(&other))
            });
            start = end;
        }
        ranks.resize(bodies.len(), 0);
        let mut first = 0;
        for level in
            ordered.chunk_by(|&one, &other| height(&bodies[one as usize]) == height(&bodies[other as usize]))
        {
            let others = first + level.len().div_ceil(2) as u32;
            for (number, two) in (0..).zip(level.chunks(2)) {
                for (&at, rank) in two.iter().zip([first, others]) {
                    ranks[at as usize] = rank + number;
                }
            }
            first += level.len() as u32;
        }
    }
}

/// Turns counts, each after its place, into starts.
fn sum_up(counts: &mut [u32]) {
    let mut sum = 0;
    for count in counts {
        sum += *count;
        *count = sum;
    }
}

/// The pairs of each ball: those that were there when they were first linked side by side, later ones as chains.
#[derive(Debug, Clone, Default)]
pub(super) struct Links {
    /// Where the pairs of each ball begin in `places`; one more than there are balls, or none where nothing is linked.
    starts: Vec<u32>,
    places: Vec<u32>,
    /// The last link of each ball's chain; empty where nothing was added. A link is twice its pair's place, and one
    /// more for the second ball, counted from the first pair that was added.
    lasts: Vec<u32>,
    /// For each link, the one before in its chain.
    befores: Vec<u32>,
}

/// The beginning of a chain.
const NO_LINK: u32 = u32::MAX;

impl Links {
    pub(super) fn clear(&mut self) {
        self.starts.clear();
        self.places.clear();
        self.lasts.clear();
        self.befores.clear();
    }

    /// Links the pairs that are not linked yet, of so many balls.
    pub(super) fn link(&mut self, pairs: &[Pair], count: usize) {
        let Self { starts, places, lasts, befores } = self;
        if starts.is_empty() {
            starts.resize(count + 1, 0);
            for pair in pairs {
                starts[pair.first as usize] += 1;
                starts[pair.second as usize] += 1;
            }
            // Counts become ends; filling from the back turns ends into starts.
            sum_up(starts);
            places.resize(2 * pairs.len(), 0);
            for (at, pair) in pairs.iter().enumerate().rev() {
                for body in [pair.first, pair.second] {
                    starts[body as usize] -= 1;
                    places[starts[body as usize] as usize] = at as u32;
                }
            }
            return;
        }
        let linked = places.len() / 2 + befores.len() / 2;
        if linked < pairs.len() {
            lasts.resize(count, NO_LINK);
        }
        for pair in &pairs[linked..] {
            for body in [pair.first, pair.second] {
                let link = befores.len() as u32;
                befores.push(std::mem::replace(&mut lasts[body as usize], link));
            }
        }
    }

    /// The places of a ball's pairs.
    #[inline]
    pub(super) fn of(&self, body: u32) -> impl Iterator<Item = usize> {
        let mut cursor = self.begin(body);
        std::iter::from_fn(move || self.next(&mut cursor))
    }

    /// The beginning of a ball's pairs.
    #[inline]
    pub(super) fn begin(&self, body: u32) -> Cursor {
        let body = body as usize;
        let last = self.lasts.get(body).copied().unwrap_or(NO_LINK);
        Cursor { at: self.starts[body], end: self.starts[body + 1], last }
    }

    /// The place of the next pair.
    #[inline]
    pub(super) fn next(&self, cursor: &mut Cursor) -> Option<usize> {
        if cursor.at < cursor.end {
            cursor.at += 1;
            return Some(self.places[cursor.at as usize - 1] as usize);
        }
        if cursor.last == NO_LINK {
            return None;
        }
        let link = cursor.last as usize;
        cursor.last = self.befores[link];
        Some(self.places.len() / 2 + link / 2)
    }
}

/// How far a ball's pairs have been gone through.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cursor {
    at: u32,
    end: u32,
    last: u32,
}

/// A set of balls that is soon emptied.
#[derive(Debug, Clone, Default)]
pub(super) struct Known {
    /// When each ball was last added.
    stamps: Vec<u64>,
    now: u64,
}

impl Known {
    /// Empties it, and makes room for so many balls.
    pub(super) fn begin(&mut self, count: usize) {
        self.now += 1;
        self.stamps.resize(count, 0);
    }

    /// Adds a ball. Whether it was not there yet.
    pub(super) fn add(&mut self, ball: u32) -> bool {
        std::mem::replace(&mut self.stamps[ball as usize], self.now) != self.now
    }
}

/// What held the balls of a stripe when pairs were searched anew: their impulses outlive the search, for a warm start.
#[derive(Debug, Clone, Default)]
pub(super) struct Kept {
    constraints: Vec<Constraint>,
    /// For each ball the last constraint of which it is the lower one, and for each of these the one before.
    lasts: Vec<u32>,
    befores: Vec<u32>,
}

impl Kept {
    pub(super) fn clear(&mut self) {
        self.constraints.clear();
    }

    /// Takes all constraints of a stripe.
    pub(super) fn take(&mut self, constraints: &mut Vec<Constraint>) {
        self.clear();
        std::mem::swap(&mut self.constraints, constraints);
    }

    pub(super) fn add(&mut self, constraint: Constraint) {
        self.constraints.push(constraint);
    }

    /// Puts the constraints that hold something where those of each of so many balls are found.
    pub(super) fn link(&mut self, count: usize) {
        let Self { constraints, lasts, befores } = self;
        lasts.clear();
        befores.clear();
        constraints.retain(|constraint| constraint.impulse > 0.0);
        if constraints.is_empty() {
            return;
        }
        lasts.resize(count, NO_LINK);
        for (at, constraint) in (0..).zip(&*constraints) {
            let lower = constraint.pair.first.min(constraint.pair.second) as usize;
            befores.push(std::mem::replace(&mut lasts[lower], at));
        }
    }

    /// What two balls held each other with. Constraints must be linked.
    #[inline]
    pub(super) fn of(&self, pair: Pair) -> Option<Constraint> {
        let mut at = *self.lasts.get(pair.first.min(pair.second) as usize)?;
        while at != NO_LINK {
            let constraint = self.constraints[at as usize];
            if (constraint.pair.first, constraint.pair.second) == (pair.first, pair.second) {
                return Some(constraint);
            }
            if (constraint.pair.second, constraint.pair.first) == (pair.first, pair.second) {
                return Some(constraint.turned_round());
            }
            at = self.befores[at as usize];
        }
        None
    }
}

impl Constraint {
    /// The same, with the balls the other way round.
    fn turned_round(self) -> Self {
        let pair = Pair { first: self.pair.second, second: self.pair.first };
        Self { normal: -self.normal, grip: -self.grip, pair, ..self }
    }
}
