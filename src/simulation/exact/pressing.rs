//! When events end because balls come to press on each other, where others hold these.

use crate::simulation::clock::Clock;

use super::Exact;
use super::begin::hop_time;

/// After so many impacts in a row that are chatter something presses a ball.
const PRESSES: u32 = 4;

/// How the run ends once something presses: where the next substep begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pressing {
    /// Substeps in a second.
    rate: u32,
    /// When that is, once it does.
    ends: Option<Clock>,
    /// Whether whoever takes events does not know of it yet.
    is_new: bool,
}

impl Exact {
    /// The same solver that does not lay balls to rest on each other, and stops instead: where the next substep begins, if there are
    /// so many in a second. On walls they rest once they come to these more slowly than this, px/s, or than it would have them rest.
    pub(in crate::simulation) fn while_nothing_presses(self, rate: u32, rest_speed: f64) -> Self {
        let rest_speed = self.rest_speed.min(rest_speed);
        Self {
            rest_speed,
            chatter_time: hop_time(rest_speed, self.gravity),
            long_chatter: PRESSES,
            pressing: Some(Pressing { rate, ends: None, is_new: false }),
            ..self
        }
    }

    /// Notes that something presses, and returns whether that ends the run.
    pub(super) fn note_pressing(&mut self, now: f64) -> bool {
        let Some(Pressing { rate, ends, is_new }) = &mut self.pressing else { return false };
        if ends.is_none() {
            (*ends, *is_new) = (Some(self.origin.after(now).next_step(*rate)), true);
        }
        true
    }

    /// Whether something presses, for the first time since this was asked.
    #[inline]
    pub(super) fn has_just_pressed(&mut self) -> bool {
        self.pressing.as_mut().is_some_and(|pressing| std::mem::take(&mut pressing.is_new))
    }

    /// When the run ends because something presses.
    fn ends(&self) -> Option<Clock> {
        self.pressing.and_then(|pressing| pressing.ends)
    }

    /// This time, or that at which the run ends, where that is earlier.
    pub(super) fn until_it_ends(&self, target: Clock) -> Clock {
        self.ends().map_or(target, |ends| target.min(ends))
    }

    /// Whether the run has ended.
    pub(super) fn is_over(&self) -> bool {
        self.ends().is_some_and(|ends| self.clock >= ends)
    }
}
