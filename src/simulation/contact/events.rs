//! Impacts that are foreseen, in the order in which they are taken.

use std::cmp::Ordering;

/// Where a pair stands, or a ball beside a wall: the number of its stripe, and its place there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Spot {
    pub(super) stripe: u32,
    pub(super) at: u32,
}

/// An impact that is foreseen, while both bodies are on these courses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Event {
    /// s after the substep's beginning.
    pub(super) time: f64,
    pub(super) what: What,
    pub(super) courses: [u32; 2],
}

/// What is foreseen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum What {
    /// The ball at this place beside the walls reaches one.
    Wall(Spot),
    /// This fast body meets a wall across this axis.
    FastWall(u32, u8),
    /// The pair of this place meets.
    Pair(Spot),
}

impl Eq for Event {}

impl Ord for Event {
    /// The earliest is the greatest; those at one time come in the order of their places.
    fn cmp(&self, other: &Self) -> Ordering {
        other.time.total_cmp(&self.time).then_with(|| other.what.cmp(&self.what))
    }
}

impl PartialOrd for Event {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Event {
    /// The place of the pair that meets, if it is one.
    pub(super) fn pair(&self) -> Option<Spot> {
        match self.what {
            What::Pair(spot) => Some(spot),
            What::Wall(_) | What::FastWall(..) => None,
        }
    }

    /// The number of the stripe that a pair belongs to, or a ball beside a wall.
    pub(super) fn stripe(&self) -> Option<usize> {
        match self.what {
            What::Pair(spot) | What::Wall(spot) => Some(spot.stripe as usize),
            What::FastWall(..) => None,
        }
    }

    /// The same, foreseen by the stripe of this number as if it were all there is.
    pub(super) fn of_stripe(self, number: usize) -> Self {
        let spot = |spot: Spot| Spot { stripe: number as u32, ..spot };
        let what = match self.what {
            What::Wall(at) => What::Wall(spot(at)),
            What::Pair(at) => What::Pair(spot(at)),
            What::FastWall(..) => self.what,
        };
        Self { what, ..self }
    }
}
