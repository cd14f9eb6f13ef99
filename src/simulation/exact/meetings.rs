//! When a ball meets others: the earliest of its meetings with those near it, and whose earliest that is too.

use glam::DVec2;

use crate::simulation::flight::{NEVER, Pair};
use crate::simulation::lesser::lesser;

use super::cells::{Border, END};
use super::flights::{Against, Marks};
use super::together::AT_HAND;
use super::{Exact, Needs};

/// Balls that touch, and are carried, or one of them and the other held, do not meet before their next step if they come nearer until
/// then by less than this part of the distance at which they touch: what takes their approach leaves as much of it, and what lies in
/// an exact fit would hit others for ever.
const NO_NEARER: f64 = 1e-12;
/// So many balls near a ball count as one event more for the caller's watch: each of them costs a root.
const NEAR_PER_EVENT: u32 = 16;

impl Exact {
    /// Two balls as the first sees the other now.
    #[inline]
    pub(super) fn pair<N: Needs>(&self, slot: usize, other: usize, now: f64) -> Pair {
        self.pair_seen_from::<N>(slot, self.state::<N>(slot, now), other, now)
    }

    /// The same where the first one's position and velocity are known.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "it is called for each of the balls that are looked at")]
    fn pair_seen_from<N: Needs>(
        &self,
        slot: usize,
        (position, velocity): (DVec2, DVec2),
        other: usize,
        now: f64,
    ) -> Pair {
        let (their_position, their_velocity) = self.state::<N>(other, now);
        let (slow, dull) = if self.wedged() { (0.0, self.rest_speed) } else { (self.rest_speed, 0.0) };
        Pair {
            offset: their_position - position,
            velocity: their_velocity - velocity,
            reach: self.matter::<N>(slot).radius + self.matter::<N>(other).radius,
            own: velocity,
            slow,
            dull,
        }
    }

    /// When two balls meet that touch, or nearly do. They are looked at anew: that keeps all others in registers.
    #[cold]
    fn meet_at_hand<N: Needs>(&self, slot: usize, other: usize, now: f64) -> f64 {
        let pair = self.pair::<N>(slot, other, now);
        if N::HOLDS && self.come_no_nearer(slot, other, &pair, DVec2::ZERO, now) {
            return NEVER;
        }
        pair.meet()
    }

    /// Whether two balls that touch, or as good as touch, come nearer by as good as nothing before one of them sets out anew in the next
    /// step, where the other is accelerated by this relative to the one.
    fn come_no_nearer(&self, slot: usize, other: usize, pair: &Pair, pull: DVec2, now: f64) -> bool {
        let carried =
            |slot: usize| self.marks[slot].has(Marks::CARRIED) || self.marks[slot].hits_in_step() > 0;
        let fits = |slot: usize| carried(slot) || self.marks[slot].has(Marks::HELD);
        let Some(next) = self.carry.next_since(self.origin) else { return false };
        if !((carried(slot) || carried(other)) && fits(slot) && fits(other)) || pair.overlap_deeply() {
            return false;
        }
        let left = next - now;
        let (closing, pulled) = (-pair.velocity.dot(pair.offset), pull.dot(pair.offset));
        let nearer_after = |time: f64| (closing - pulled * (0.5 * time)) * time;
        // They come nearest when gravity has turned that, if it does.
        let turns = if pulled > 0.0 { (closing / pulled).clamp(0.0, left) } else { left };
        let most = NO_NEARER * pair.reach * pair.offset.length();
        (0.0..most).contains(&nearer_after(left)) && nearer_after(turns) < most
    }

    /// Finds the ball that this one meets first, where that is before both have another impact; then each is the
    /// other's earliest. Where it crosses a border now, only those that have come near by that are looked at.
    #[inline]
    pub(super) fn meet_others<N: Needs>(&mut self, slot: usize, now: f64, crossed: Option<Border>) {
        let Some(cells) = &self.cells else { return };
        let flight = &self.flights[slot];
        let own = self.state::<N>(slot, now);
        let pair = |other: usize| self.pair_seen_from::<N>(slot, own, other, now);
        let inside = |other: usize| N::DETECT && self.overlap(slot, other);
        let mut first = First { time: flight.impact, partner: END, touches: false };
        let mut accelerated = Postponed::default();
        let pull = |other: usize| self.pull::<N>(other) - self.pull::<N>(slot);
        // A meeting after the next impact of either of them does not count.
        let limit = |other: usize, first: &First| lesser(first.time, self.flights[other].impact);
        let meet_accelerated = |other: usize, first: &mut First| {
            let pair = pair(other);
            let (pull, limit) = (pull(other), limit(other, first));
            if pair.are_within(AT_HAND) {
                first.touches = true;
                if self.come_no_nearer(slot, other, &pair, pull, now) {
                    return;
                }
            }
            let time = if inside(other) {
                pair.part_accelerated(pull, limit - now)
            } else {
                pair.meet_accelerated(pull, limit - now)
            };
            first.or(now + time, other, self.flights[other].impact);
        };
        let mut near = 0;
        let visit = |other: usize| {
            near += 1;
            let held = |slot: usize| self.marks[slot].rests() == 3;
            if N::HOLDS && held(slot) && held(other) {
                // Neither moves: they never meet.
            } else if N::HOLDS && self.marks[slot].unaccelerated() != self.marks[other].unaccelerated() {
                // These cost most, and least where there is little time left: they come last.
                let time = limit(other, &first) - now;
                let keeps_away = !inside(other) && pair(other).keeps_away(pull(other), time);
                if !keeps_away && !accelerated.push(other) {
                    meet_accelerated(other, &mut first);
                }
            } else {
                let pair = pair(other);
                let time = if inside(other) {
                    pair.part()
                } else if pair.are_within(AT_HAND) {
                    first.touches = true;
                    self.meet_at_hand::<N>(slot, other, now)
                } else {
                    pair.meet_from_afar()
                };
                first.or(now + time, other, self.flights[other].impact);
            }
        };
        if self.swept.is_empty() {
            cells.for_each_near::<N>(slot, flight.place, crossed, visit);
        } else {
            let own = self.sweep::<N>(slot, now);
            // In the order in which they stand in their cell.
            let others = self.swept.iter().enumerate().rev().filter(|(_, swept)| own.overlaps(swept));
            others.map(|(other, _)| other).for_each(visit);
        }
        for &other in accelerated.all() {
            meet_accelerated(other, &mut first);
        }
        self.beside |= first.touches;
        if N::HOLDS {
            self.unwatched += near / NEAR_PER_EVENT;
        }
        if first.partner != END {
            let First { time, partner, .. } = first;
            let partner = partner as usize;
            (self.flights[slot].impact, self.flights[slot].against) = (time, Against::ball(partner));
            let other = &mut self.flights[partner];
            (other.impact, other.against) = (time, Against::ball(slot));
            if time < other.event {
                other.event = time;
                self.calendar.write(time, partner as u32);
            }
        }
    }

    /// Whether two balls that fly through each other overlap now.
    fn overlap(&self, slot: usize, other: usize) -> bool {
        self.overlaps.as_ref().is_some_and(|overlaps| overlaps[slot].binary_search(&(other as u32)).is_ok())
    }
}

/// The earliest meeting found, if it is earlier than what else will happen to a ball.
struct First {
    time: f64,
    /// [`END`] while none has been found.
    partner: u32,
    /// Whether any of those that were looked at touches the ball.
    touches: bool,
}

impl First {
    /// Takes a meeting instead where it is earlier, and earlier than the partner's next impact: a toss, for which
    /// there is no branch, since each choice between two numbers hangs on one comparison.
    #[inline]
    fn or(&mut self, time: f64, partner: usize, impact: f64) {
        let time = if time < impact { time } else { NEVER };
        self.partner = if time < self.time { partner as u32 } else { self.partner };
        self.time = if time < self.time { time } else { self.time };
    }
}

/// A few slots that are looked at last.
#[derive(Debug, Clone, Default)]
struct Postponed {
    slots: [usize; 16],
    count: usize,
}

impl Postponed {
    /// Keeps a slot, if there is room.
    fn push(&mut self, slot: usize) -> bool {
        let room = self.count < self.slots.len();
        if room {
            self.slots[self.count] = slot;
            self.count += 1;
        }
        room
    }

    fn all(&self) -> &[usize] {
        &self.slots[..self.count]
    }
}
