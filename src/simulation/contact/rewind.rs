//! Impacts of a substep that turn out to have been taken too soon, and are taken back.
//!
//! Each turn takes its impacts after those of the turns before (`turns`), so a ball may be hit, at an edge, that would
//! have met another one before that one was hit in an earlier turn. Then the later impact, and all that came of it,
//! never happened: the balls go on as they did before it, and what they meet is foreseen anew ("Virtual Time"; Jefferson
//! 1985). So impacts come out in the order of time whatever the turns are.

use std::ops::Range;

use super::constraints::Marks;
use super::events::{Event, Spot};
use super::fates::Fate;
use super::impacts::{Stage, pair};
use super::legs::Leg;
use super::stripes::{NOWHERE, Stripes};
use super::turns::Turn;
use super::{Body, DVec2, Tally};

/// An impact that was taken.
#[derive(Debug, Clone)]
pub(super) struct Taken {
    turn: Turn,
    /// s after the substep's beginning.
    time: f64,
    /// Those that it gave another velocity.
    sides: [Option<Side>; 2],
    /// What was known of the pair before, if it was one.
    pair: Option<(Spot, Marks)>,
    /// What it has counted for.
    tally: Tally,
    /// Whether it is about to be taken back, or was.
    is_undone: bool,
}

/// A ball that was hit.
#[derive(Debug, Clone, Copy)]
struct Side {
    /// Its number among all.
    body: u32,
    before: State,
    /// The impact before this, or [`Past::NOTHING`].
    last: Spot,
}

/// How a ball moves.
#[derive(Debug, Clone, Copy)]
struct State {
    position: DVec2,
    velocity: DVec2,
    free: DVec2,
    fate: Fate,
    hit: bool,
}

/// Something that would have to be known is not: others may work on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Elsewhere;

/// What is known, in one turn, of the impacts that were taken in this substep.
pub(super) struct Past<'a> {
    pub(super) now: Turn,
    /// The numbers of the stripes that are worked on, and that of their first body.
    pub(super) stripes: Range<usize>,
    pub(super) start: usize,
    /// The last impact of each body: where it stands among those of a stripe; or [`Past::NOTHING`].
    pub(super) lasts: &'a mut [Spot],
    /// Pairs of which one ball was hit later.
    pub(super) later: Vec<Spot>,
}

impl Past<'_> {
    pub(super) const NOTHING: Spot = Spot { stripe: NOWHERE, at: NOWHERE };

    /// Takes an impact, and notes what was before.
    pub(super) fn take(
        &mut self,
        event: &Event,
        stage: &mut Stage<'_>,
        stripes: &mut Stripes<'_>,
    ) -> [Option<usize>; 2] {
        let before =
            Stage::bodies_of(event, stripes).map(|body| body.map(|body| (body, State::of(body, stage))));
        let among_all = |spot: Spot| Spot { stripe: self.stripes.start as u32 + spot.stripe, ..spot };
        let marks = |spot: Spot| stripes.list[spot.stripe as usize].marks[spot.at as usize];
        let pair = event.pair().map(|spot| (among_all(spot), marks(spot)));
        let tally = *stage.tally;
        let hit = stage.take(event, stripes);
        if hit == [None; 2] {
            return hit;
        }
        let taken = &mut stripes.list[0].taken;
        let spot = Spot { stripe: self.stripes.start as u32, at: taken.len() as u32 };
        let sides = before.map(|side| {
            let (body, before) = side.filter(|&(body, _)| hit.contains(&Some(body)))?;
            let last = std::mem::replace(&mut self.lasts[body], spot);
            Some(Side { body: (self.start + body) as u32, before, last })
        });
        let tally = stage.tally.since(&tally);
        taken.push(Taken { turn: self.now, time: event.time, sides, pair, tally, is_undone: false });
        hit
    }

    /// Foresees the impacts of a ball that was hit at this time, or goes on then as it did before, and takes those of
    /// others back that it forestalls. Those that then go on as they did before are added to `back`. Pairs must be
    /// linked.
    pub(super) fn foresee(
        &mut self,
        body: usize,
        time: f64,
        stage: &mut Stage<'_>,
        stripes: &mut Stripes<'_>,
        back: &mut Vec<(usize, f64)>,
    ) -> Result<(), Elsewhere> {
        let mut later = std::mem::take(&mut self.later);
        stage.foresee(body, stripes, |spot, [one, other]| {
            if one.time.max(other.time) > time {
                later.push(spot);
            }
        });
        let all = later.drain(..).try_for_each(|spot| {
            if let Some((other, impact)) = self.forestalled(spot, body, time, stage, stripes)? {
                let undone = self.undo(other, impact, stage, stripes)?;
                back.extend(undone.into_iter().map(|body| (body, time)));
            }
            Ok(())
        });
        self.later = later;
        all
    }

    /// The other ball of this pair, and its first impact that a ball forestalls, if there is one.
    fn forestalled(
        &self,
        spot: Spot,
        body: usize,
        time: f64,
        stage: &Stage<'_>,
        stripes: &Stripes<'_>,
    ) -> Result<Option<(usize, Spot)>, Elsewhere> {
        let stripe = &stripes.list[spot.stripe as usize];
        let (first, second) = pair(spot, stripes);
        let other = if first == body { second } else { first };
        // Where it has ended for fast ones, they are not where they were, and what they hit again and again shares their fate.
        if stage.fates[body].ended || stage.fates[other].ended {
            return Ok(None);
        }
        let presses = stage.setting.kick != DVec2::ZERO && stripe.marks[spot.at as usize].has(Marks::HELD);
        if presses && stage.restitutions[body].min(stage.restitutions[other]) < 1.0 {
            // They are held apart, whichever impact comes first, and what that takes of their energy is no loss.
            return Ok(None);
        }
        let (mut earliest, mut impact) = (None, self.lasts[other]);
        while let Some((until, side)) = self.after(time, other, impact, stripes)? {
            let (this, was) = (&stage.bodies[body], side.before.of_body(&stage.bodies[other]));
            let (this, that) = ((this, &stage.fates[body]), (&was, &side.before.fate));
            let both = if first == body { [this, that] } else { [that, this] };
            let since = time.max(side.before.fate.time);
            let meeting = stage.meeting_of(stripe, spot.at as usize, (first, second), both, since);
            if meeting.is_some_and(|meeting| meeting.time < until) {
                earliest = Some(impact);
            }
            impact = side.last;
        }
        Ok(earliest.map(|impact| (other, impact)))
    }

    /// When a body's impact was, if that is after this time, and how it was hit.
    fn after(
        &self,
        time: f64,
        body: usize,
        spot: Spot,
        stripes: &Stripes<'_>,
    ) -> Result<Option<(f64, Side)>, Elsewhere> {
        if spot == Self::NOTHING {
            return Ok(None);
        }
        let taken = &stripes.list[self.stripe_of(spot)?].taken[spot.at as usize];
        if taken.time <= time || taken.turn == self.now {
            return Ok(None);
        }
        let side = taken.sides.iter().flatten().find(|side| side.body as usize == self.start + body);
        Ok(side.map(|side| (taken.time, *side)))
    }

    /// Where a stripe stands that an impact was noted by, or whose pair it was of.
    fn stripe_of(&self, spot: Spot) -> Result<usize, Elsewhere> {
        let number = Some(spot.stripe as usize).filter(|number| self.stripes.contains(number));
        number.map(|number| number - self.stripes.start).ok_or(Elsewhere)
    }

    /// Takes back this impact of a body, and all that came of it. Those that go on as they did before: none where the substep
    /// has ended for one of them. Nothing has changed then, nor where that is not known here.
    fn undo(
        &mut self,
        body: usize,
        impact: Spot,
        stage: &mut Stage<'_>,
        stripes: &mut Stripes<'_>,
    ) -> Result<Vec<usize>, Elsewhere> {
        let mut all = Vec::new();
        let found = self.find_all(body, impact, stage.fates, stripes, &mut all);
        if found != Ok(true) {
            for (stripe, at) in all {
                stripes.list[stripe].taken[at].is_undone = false;
            }
            return found.map(|_| Vec::new());
        }
        // What was known of a pair is what was before the first of its impacts.
        let when = |&(stripe, at): &(usize, usize)| stripes.list[stripe].taken[at].time;
        all.sort_by(|one, other| when(other).total_cmp(&when(one)));
        let mut back = Vec::new();
        for (stripe, at) in all {
            let Taken { turn, sides, pair, tally, .. } = stripes.list[stripe].taken[at].clone();
            let counts = if turn == self.now { &mut *stage.tally } else { &mut stripes.list[stripe].tally };
            *counts = counts.since(&tally);
            if let Some((spot, marks)) = pair {
                stripes.list[spot.stripe as usize - self.stripes.start].marks[spot.at as usize] = marks;
            }
            for side in sides.into_iter().flatten() {
                let body = side.body as usize - self.start;
                if !self.is_undone(side.last, stripes) {
                    self.lasts[body] = side.last;
                    side.before.restore(body, stage);
                    back.push(body);
                }
            }
        }
        Ok(back)
    }

    /// Marks an impact of a body as undone, and all that came of it, and gathers where they stand. Whether they can be undone: not
    /// where the substep has ended for one of their balls, which need not be where it was any more.
    fn find_all(
        &self,
        body: usize,
        impact: Spot,
        fates: &[Fate],
        stripes: &mut Stripes<'_>,
        all: &mut Vec<(usize, usize)>,
    ) -> Result<bool, Elsewhere> {
        let mut later = vec![(body, impact)];
        while let Some((body, first)) = later.pop() {
            let mut spot = self.lasts[body];
            loop {
                let stripe = self.stripe_of(spot)?;
                let taken = &mut stripes.list[stripe].taken[spot.at as usize];
                let is_new = !std::mem::replace(&mut taken.is_undone, true);
                if is_new {
                    all.push((stripe, spot.at as usize));
                }
                if let Some((pair, _)) = taken.pair {
                    // A fixed ball is no side: the pair may belong to a seam beyond these.
                    self.stripe_of(pair)?;
                }
                let mut last = Self::NOTHING;
                for side in taken.sides.iter().flatten() {
                    let its = (side.body as usize).checked_sub(self.start);
                    let its = its.filter(|&its| its < fates.len()).ok_or(Elsewhere)?;
                    if fates[its].ended {
                        return Ok(false);
                    }
                    if its == body {
                        last = side.last;
                    } else if is_new {
                        later.push((its, spot));
                    }
                }
                if spot == first {
                    break;
                }
                spot = last;
            }
        }
        Ok(true)
    }

    fn is_undone(&self, spot: Spot, stripes: &Stripes<'_>) -> bool {
        let stripe = self.stripe_of(spot);
        stripe.is_ok_and(|stripe| stripes.list[stripe].taken[spot.at as usize].is_undone)
    }
}

impl State {
    fn of(body: usize, stage: &Stage<'_>) -> Self {
        let Body { position, velocity, free, .. } = stage.bodies[body];
        Self { position, velocity, free, fate: stage.fates[body], hit: stage.hit[body] }
    }

    /// The body as it was.
    fn of_body(&self, body: &Body) -> Body {
        Body { position: self.position, velocity: self.velocity, free: self.free, ..*body }
    }

    /// Lets a body go on as it did.
    fn restore(self, body: usize, stage: &mut Stage<'_>) {
        stage.bodies[body] = self.of_body(&stage.bodies[body]);
        stage.fates[body].back_to(self.fate);
        stage.hit[body] = self.hit;
        if let Some(legs) = &mut stage.legs {
            legs.push(Leg { goes_back: true, ..Leg::of(body, &stage.bodies[body], self.fate.time) });
        }
    }
}
