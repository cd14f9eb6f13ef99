//! How substeps take over from events, and hand back to them (`hybrid`).

use super::super::Tuning;
use super::super::ball::Ball;
use super::super::clock::Clock;
use super::super::world::World;
use super::Contact;
use super::amount::Amount;
use super::substeps::Substeps;

/// Events take over once so many substeps in a row were quiet: to begin with them takes as long as some of these.
const CALM: u32 = 16;

impl Contact {
    /// The same solver at a later time, at which its balls are as they are: its first substep is what is left of the one
    /// that this time lies in.
    pub(in crate::simulation) fn starting_at(mut self, clock: Clock) -> Self {
        let rate = self.substeps.rate;
        let (steps, since) = clock.steps(rate);
        let within = steps % self.substeps.next_length();
        self.late = within as f64 / f64::from(rate) + since;
        let whole = self.setting.kick;
        self.setting.substep -= self.late;
        self.setting.kick = self.setting.gravity * self.setting.substep;
        // Half-way through this one they are less far on their ways.
        let less = 0.5 * (whole - self.setting.kick);
        for body in self.bodies.iter_mut().filter(|body| body.inverse_mass > 0.0) {
            body.velocity += less;
            body.free += less;
        }
        Self { clock, steps: steps - within, ..self }
    }

    /// The same solver, which stops once nothing has pressed for a while.
    pub(in crate::simulation) fn that_hands_back(self) -> Self {
        Self { hands_back: true, ..self }
    }

    /// Whether it has stopped for that.
    pub(super) fn is_calm(&self) -> bool {
        self.hands_back && self.quiet >= CALM
    }

    /// The time, if it has stopped for that, and shows a substep's end.
    pub(in crate::simulation) fn calm_since(&self) -> Option<Clock> {
        (self.is_calm() && self.clock >= Clock::at_step(self.steps, self.substeps.rate)).then_some(self.clock)
    }

    /// Goes on for another while.
    pub(in crate::simulation) fn stay_on(&mut self) {
        self.quiet = 0;
    }
}

/// Whether those of them that move are so few that substeps look at each.
pub(in crate::simulation) fn is_few(balls: &[Ball]) -> bool {
    Amount::of(balls) == Amount::Few
}

/// How many substeps in a second these balls take at most.
pub(in crate::simulation) fn most_substeps(world: &World, balls: &[Ball], tuning: Tuning) -> u32 {
    let [_, most] = Substeps::new(world, balls, tuning).range(world.gravity.unwrap_or_default());
    most
}
