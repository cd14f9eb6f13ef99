//! How balls that are carried get on from step to step, and which of them are jammed.
//!
//! A group in which hits have no end waits in place until the next step (see `blows`), and no time passes for it meanwhile. Where that
//! goes on step after step, sweeps do not find with which velocities it gets on, as in a row that fits between walls to the last digit: it
//! is *jammed*. For a while its velocities are found directly (see `interior`), and it does not hop.

use super::group::Group;

/// What has waited in place before more steps in a row than this is jammed, ...
const MOST_WAITS: u32 = 4;
/// ... for so many steps, ...
const JAM_LASTS: u32 = 32;
/// ... but in the first of them alone where there are more contacts than this: that takes longer than a frame.
const MOST_DIRECTLY: usize = 1000;

/// How each slot's ball gets on, as far as any has been of a flurry yet.
#[derive(Debug, Clone, Default)]
pub(super) struct Headway(Vec<OfBall>);

#[derive(Debug, Clone, Copy, Default)]
struct OfBall {
    /// Of how many flurries it was since the last step.
    flurries: u32,
    /// Whether it has waited in place since then, ...
    waits: bool,
    /// ... and before how many of the last steps in a row.
    waited: u32,
    /// For how many steps yet it is jammed.
    jammed: u32,
}

impl OfBall {
    fn begin_step(&mut self) {
        let Self { waits, waited, jammed, .. } = *self;
        let waited = if waits { waited + 1 } else { 0 };
        let begins_jam = jammed == 0 && waited > MOST_WAITS;
        let jammed = if begins_jam { JAM_LASTS } else { jammed.saturating_sub(1) };
        *self = Self { waited: if begins_jam { 0 } else { waited }, jammed, ..Self::default() };
    }
}

impl Headway {
    /// Begins a step.
    pub(super) fn begin_step(&mut self) {
        self.0.iter_mut().for_each(OfBall::begin_step);
    }

    /// Counts a flurry of a group, and says whether any of it was of more than this since the last step.
    pub(super) fn has_too_many_flurries(&mut self, group: &Group, most: u32) -> bool {
        let mut flurries = 0;
        self.note(group, |ball| {
            ball.flurries += 1;
            flurries = flurries.max(ball.flurries);
        });
        flurries > most
    }

    /// Notes that a group waits in place until the next step.
    pub(super) fn note_wait(&mut self, group: &Group) {
        self.note(group, |ball| ball.waits = true);
    }

    /// Whether any of a group is jammed, so that all of it is to be solved for directly.
    pub(super) fn is_jammed(&self, group: &Group) -> bool {
        let jammed =
            group.members.iter().filter_map(|member| self.0.get(member.slot)).map(|ball| ball.jammed);
        let longest = jammed.max().unwrap_or_default();
        longest == JAM_LASTS || longest > 0 && group.contacts.len() <= MOST_DIRECTLY
    }

    fn note(&mut self, group: &Group, mut note: impl FnMut(&mut OfBall)) {
        let slots = || group.members.iter().map(|member| member.slot);
        let known = slots().max().map_or(0, |last| last + 1).max(self.0.len());
        self.0.resize(known, OfBall::default());
        slots().for_each(|slot| note(&mut self.0[slot]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::exact::contacts::Support;
    use glam::DVec2;

    /// Two balls, with so many contacts.
    fn group(contacts: usize) -> Group {
        let mut group = Group::default();
        for slot in [3, 8] {
            group.add(slot, (DVec2::ZERO, DVec2::ZERO), 1.0, DVec2::Y);
        }
        for _ in 0..contacts {
            group.add_contact(0, Support::Member(1), (0.0, DVec2::X));
        }
        group
    }

    #[test]
    fn what_waits_before_five_steps_in_a_row_is_jammed_for_a_while_and_what_gets_on_in_between_is_not() {
        let (group, many, mut headway) = (group(1), group(MOST_DIRECTLY + 1), Headway::default());
        let mut steps = |waits: &[bool]| {
            for &waits in waits {
                if waits {
                    headway.note_wait(&group);
                }
                headway.begin_step();
            }
            [&group, &many].map(|group| headway.is_jammed(group))
        };
        assert_eq!(steps(&[true, true, true, true, false, true, true, true, true]), [false; 2]);
        assert_eq!(steps(&[true]), [true; 2]);
        assert_eq!(steps(&[true]), [true, false]);
        assert_eq!(steps(&[false; JAM_LASTS as usize - 2]), [true, false]);
        assert_eq!(steps(&[false]), [false; 2]);
    }

    #[test]
    fn flurries_are_counted_for_each_ball_from_step_to_step() {
        let (group, mut headway) = (group(0), Headway::default());
        let mut count = || headway.has_too_many_flurries(&group, 2);
        assert_eq!([count(), count(), count()], [false, false, true]);
        headway.begin_step();
        assert!(!headway.has_too_many_flurries(&group, 2));
    }
}
