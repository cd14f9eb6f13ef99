//! Which balls belong together: those that touch each other, and those that these touch.

use glam::DVec2;

use crate::simulation::flight::DEEP;

use super::contacts::Support;
use super::flights::{Marks, Matter};
use super::group::{Group, Member, RATTLER};
use super::impacts::QUICK;
use super::{Exact, Needs};

/// Walls of this restitution and less take nearly all of the energy of what chatters on them, however elastic balls are: in as many
/// hits as are counted, 95 % of it at the least.
const ABSORBENT: f64 = 0.9;
/// No place in a group.
const NONE: u32 = u32::MAX;

/// Which balls belong together: those that are no farther from each other than `touch`, px, and of them ...
#[derive(Debug, Clone, Copy)]
pub(super) struct Near {
    pub(super) touch: f64,
    pub(super) belong: Belong,
    /// By how much farther from each other those may be that both are among many, px.
    pub(super) farther: f64,
    /// How many there may be.
    pub(super) most: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Belong {
    /// ... those that are held, or carried, or have chattered, or are slower beside each other than this many rest speeds.
    Slow(f64),
    /// The same, but it is enough to find one that is carried, if any is: what comes after it is left out then.
    UpToCarried(f64),
    /// ... those of groups that were carried on in the last step, and others that have been hit again and again. What is held counts
    /// as immovable.
    Flurry,
}

impl Exact {
    /// The balls that touch a ball, those that touch these and so on, as far as they belong together and are none of those that were
    /// `taken` in by others, by their slots.
    pub(super) fn gather<N: Needs>(&mut self, slot: usize, now: f64, near: Near, taken: &[bool]) -> Group {
        debug_assert!(!self.matter::<N>(slot).is_fixed());
        let Near { touch, belong, farther, most } = near;
        let (up_to_carried, flurry) = (matches!(belong, Belong::UpToCarried(_)), belong == Belong::Flurry);
        let mut group = Group { absorbs: self.wedged(), ..Group::default() };
        let mut found = std::mem::take(&mut self.found);
        found.resize(self.flights.len(), NONE);
        let add = |group: &mut Group, slot: usize| {
            group.add(slot, self.state::<N>(slot, now), self.matter::<N>(slot).mass, self.gravity) as u32
        };
        found[slot] = add(&mut group, slot);
        let mut at = 0;
        while at < group.members.len() {
            let Member { slot: one, position, .. } = group.members[at];
            if up_to_carried && self.marks[one].has(Marks::CARRIED) {
                break;
            }
            let Matter { radius, restitution, .. } = *self.matter::<N>(one);
            let among_many = self.marks[one].has(Marks::AMONG_MANY);
            self.add_walls(&mut group, at, radius, touch);
            let Some(cells) = self.cells.as_ref().filter(|_| !N::DETECT) else { break };
            cells.for_each_near::<N>(one, self.flights[one].place, None, |slot| {
                // Those that were looked at before know of this one, which does not touch itself.
                if (found[slot] as usize) <= at {
                    return;
                }
                if flurry && found[slot] == NONE && !self.is_of_flurry::<N>(slot) {
                    return;
                }
                let (their_position, their_velocity) = self.state::<N>(slot, now);
                let matter = self.matter::<N>(slot);
                let offset = position - their_position;
                let (length, reach) = (offset.length(), radius + matter.radius);
                let e = restitution.min(matter.restitution);
                let both = among_many && self.marks[slot].has(Marks::AMONG_MANY);
                let touch = if both { touch + farther } else { touch };
                if length - reach >= touch || length == 0.0 || !self.takes_energy(e) {
                    return;
                }
                let normal = offset / length;
                let held = self.marks[slot].has(Marks::HELD);
                let is_taken = taken.get(slot).is_some_and(|taken| *taken);
                let is_new = found[slot] == NONE && !matter.is_fixed();
                if is_new {
                    let speed = || (group.velocities[at] - their_velocity).dot(normal).abs();
                    let joins = self.joins::<N>(belong, [one, slot], speed);
                    if joins && !is_taken && group.members.len() < most {
                        found[slot] = add(&mut group, slot);
                    } else if !held {
                        return;
                    }
                }
                let place = found[slot];
                let against =
                    if place == NONE { Support::Immovable(slot) } else { Support::Member(place as usize) };
                group.add_contact(at, against, (length - reach, normal));
                group.absorbs |= e < 1.0;
                if reach - length > DEEP * reach {
                    group.members[at].deep = true;
                    if let Support::Member(other) = against {
                        group.members[other].deep = true;
                    }
                }
            });
            at += 1;
        }
        group.members.iter().for_each(|member| found[member.slot] = NONE);
        self.found = found;
        group
    }

    /// Adds a member's contacts with walls that are nearer than this, px.
    fn add_walls(&self, group: &mut Group, at: usize, radius: f64, touch: f64) {
        let Some(restitution) = self.walls else { return };
        let position = group.members[at].position;
        for (axis, high) in [(0, false), (0, true), (1, false), (1, true)] {
            let place = position[axis];
            let gap = if high { self.size[axis] - radius - place } else { place - radius };
            if gap < touch {
                let normal = DVec2::AXES[axis] * if high { -1.0 } else { 1.0 };
                group.add_contact(at, Support::Wall, (gap, normal));
                group.absorbs |= restitution <= ABSORBENT;
            }
        }
    }

    /// Whether a ball that touches a member, and approaches or leaves it at this speed, px/s, belongs to it.
    fn joins<N: Needs>(
        &self,
        belong: Belong,
        [member, slot]: [usize; 2],
        speed: impl FnOnce() -> f64,
    ) -> bool {
        let marks = self.marks[slot];
        match belong {
            Belong::Flurry => !marks.has(Marks::HELD),
            Belong::Slow(slow) | Belong::UpToCarried(slow) => {
                marks.has(Marks::HELD)
                    || self.wedged()
                    || marks.is_restless()
                    || marks.has(Marks::GOES_ALONG)
                    || self.rattles::<N>(member, slot)
                    || self.rattles::<N>(slot, member)
                    || speed() < slow * self.rest_speed
            }
        }
    }

    /// Whether a ball was of a group that was carried on in the last step, or has been hit again and again; or does not move.
    fn is_of_flurry<N: Needs>(&self, slot: usize) -> bool {
        let marks = self.marks[slot];
        let hit = marks.hits_in_step() > 0 || marks.quick_hits() >= QUICK;
        hit && !marks.has(Marks::WAITS) || marks.has(Marks::HELD) || self.matter::<N>(slot).is_fixed()
    }

    /// Whether a ball goes to and fro beside one that is so much heavier: how fast it does says nothing of that.
    fn rattles<N: Needs>(&self, light: usize, heavy: usize) -> bool {
        let unlike = self.matter::<N>(heavy).mass > RATTLER * self.matter::<N>(light).mass;
        unlike && self.marks[light].quick_hits() >= QUICK
    }
}
