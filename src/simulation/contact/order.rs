//! The order in which pairs are looked at, and what of them outlives a search.

use glam::DVec2;

use super::Body;
use super::holds::{Hold, Pair};
use super::layout::Layout;
use super::stripes::Stripe;

/// The height of a layer, in the smallest radius.
const LAYER: f64 = 0.25;

/// Room for sorting pairs by height.
#[derive(Debug, Clone, Default)]
pub(super) struct Heights {
    starts: Vec<u32>,
    /// The place of each ball in the order of heights.
    ranks: Vec<u32>,
    sorted: Vec<Pair>,
}

impl Heights {
    /// Puts the pairs in the order of the height of their upper balls, from the lowest up to a fraction of a radius,
    /// with all pairs of an upper ball side by side, and the upper ball first. `up` is the unit vector against gravity.
    pub(super) fn sort(&mut self, pairs: &mut Vec<Pair>, bodies: &[Body], up: DVec2) {
        self.rank(bodies, up);
        let Self { starts, ranks, sorted } = self;
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

    /// Finds the places of balls in the order of their heights, up to the height of a layer.
    fn rank(&mut self, bodies: &[Body], up: DVec2) {
        let Self { starts, ranks, .. } = self;
        let height = |body: &Body| body.position.dot(up);
        let (mut low, mut high, mut smallest) = (f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY);
        for body in bodies {
            low = low.min(height(body));
            high = high.max(height(body));
            smallest = smallest.min(body.radius);
        }
        let layers = ((high - low) / (LAYER * smallest)).min(2.0 * bodies.len() as f64).max(1.0);
        let density = if high > low { layers / (high - low) } else { 0.0 };
        let layer = |body: &Body| ((height(body) - low) * density) as usize;
        starts.clear();
        starts.resize(layers as usize + 2, 0);
        for body in bodies {
            starts[layer(body) + 1] += 1;
        }
        sum_up(starts);
        ranks.clear();
        ranks.extend(bodies.iter().map(|body| {
            let next = &mut starts[layer(body)];
            *next += 1;
            *next - 1
        }));
    }
}

/// Turns counts, each behind its place, into starts.
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

/// What held balls when pairs were searched anew: their impulses outlive the search, for a warm start.
#[derive(Debug, Clone, Default)]
pub(super) struct Kept {
    /// Where the holds begin whose lower index is a ball's; one more than there are balls, or none where nothing
    /// was held.
    starts: Vec<u32>,
    /// Each hold as seen from the ball of the higher index to that of the lower one.
    holds: Vec<Hold>,
    walls: Vec<(u32, DVec2)>,
}

impl Kept {
    /// Takes what holds so many balls, which now have these `places`, or still those that they had.
    pub(super) fn take(&mut self, layout: Layout, stripes: &[Stripe], places: Option<&[u32]>, count: usize) {
        let place = |at: u32| places.map_or(at, |places| places[at as usize]);
        let numbered = || (0..).map(|number| layout.start(number)).zip(stripes);
        self.walls.clear();
        for (start, stripe) in numbered() {
            let pushed = stripe.beside.iter().filter(|beside| beside.push != DVec2::ZERO);
            self.walls.extend(pushed.map(|beside| (place(beside.body + start as u32), beside.push)));
        }
        self.walls.sort_unstable_by_key(|&(body, _)| body);
        self.starts.clear();
        self.holds.clear();
        let held = || {
            numbered().flat_map(|(start, stripe)| {
                stripe.holds.iter().filter(|hold| hold.impulse > 0.0).map(move |hold| {
                    let pair = hold.pair.from(start);
                    let pair = Pair { first: place(pair.first), second: place(pair.second) };
                    Hold { pair, ..*hold }
                })
            })
        };
        let Some(any) = held().next() else { return };
        self.starts.resize(count + 1, 0);
        for Hold { pair, .. } in held() {
            self.starts[pair.first.min(pair.second) as usize + 1] += 1;
        }
        sum_up(&mut self.starts);
        let total = self.starts[count];
        self.holds.resize(total as usize, any);
        for hold in held().map(upright) {
            let start = &mut self.starts[hold.pair.first as usize];
            self.holds[*start as usize] = hold;
            *start += 1;
        }
        // Each start has become the next one's.
        self.starts.rotate_right(1);
        self.starts[0] = 0;
    }

    /// What two balls held each other with.
    pub(super) fn by_ball(&self, pair: Pair) -> Option<Hold> {
        let (low, high) = (pair.first.min(pair.second), pair.first.max(pair.second));
        let ends = self.starts.get(low as usize..low as usize + 2)?;
        let holds = &self.holds[ends[0] as usize..ends[1] as usize];
        let hold = *holds.iter().find(|hold| hold.pair.second == high)?;
        Some(if pair.first == low { hold } else { hold.turned_round() })
    }

    /// The velocity that walls gave to a ball.
    pub(super) fn by_wall(&self, body: usize) -> DVec2 {
        let found = self.walls.binary_search_by_key(&(body as u32), |&(at, _)| at);
        found.map_or(DVec2::ZERO, |at| self.walls[at].1)
    }
}

/// A hold with the ball of the lower index as the first.
fn upright(hold: Hold) -> Hold {
    if hold.pair.first < hold.pair.second { hold } else { hold.turned_round() }
}

impl Hold {
    /// The same, with the balls the other way round.
    fn turned_round(self) -> Self {
        let pair = Pair { first: self.pair.second, second: self.pair.first };
        Self { normal: -self.normal, grip: -self.grip, pair, ..self }
    }
}
