//! The balls as a frame shows them: between the substeps that are taken, and never written back.

use glam::DVec2;

use super::super::Frame;
use super::Contact;

impl Contact {
    /// Notes which bodies are held in the substep that is over.
    pub(super) fn find_held(&mut self) {
        self.find_held_by_balls();
        self.find_held_by_walls();
    }

    fn find_held_by_balls(&mut self) {
        let Self { near: Some(near), held, bodies, .. } = self else { return };
        held.clear();
        held.resize(bodies.len(), false);
        for (first, second, _) in near.holding() {
            (held[first], held[second]) = (true, true);
        }
    }

    fn find_held_by_walls(&mut self) {
        let Self { near: Some(near), held, .. } = self else { return };
        for (body, _) in near.beside().filter(|(_, beside)| beside.push != DVec2::ZERO) {
            held[body] = true;
        }
    }

    /// A body's velocity between the substep that is over and the next.
    pub(super) fn velocity_between(&self, at: usize) -> DVec2 {
        let body = &self.bodies[at];
        let held = self.held.get(at) == Some(&true);
        if held { body.velocity } else { body.velocity + 0.5 * body.change(self.setting.kick) }
    }

    /// Whether nothing but gravity moved a body in the substep that is over.
    fn flew(&self, at: usize) -> bool {
        let body = &self.bodies[at];
        let was_hit = self.course.was_hit(at);
        body.inverse_mass > 0.0 && body.velocity == body.free && !was_hit && self.held.get(at) != Some(&true)
    }

    /// Shows the balls as they are at the clock's time, `since` s after the last whole substep but one where that is
    /// not 0. This evaluates, and never writes back.
    pub(super) fn show(&mut self, frame: &mut Frame<'_>, since: f64) {
        let share = since * f64::from(self.rate);
        self.find_held_by_balls();
        for (hit, &held) in self.hit.iter_mut().zip(&self.held) {
            *hit |= held;
        }
        self.find_held_by_walls();
        for (at, body) in self.bodies.iter().enumerate() {
            let ball = &mut frame.balls[self.ids[at] as usize];
            if ball.is_fixed() {
                // Not even rounding moves it.
                continue;
            }
            let (mut position, mut velocity) = (body.position, self.velocity_between(at));
            if let Some(&(was, had)) = self.before.get(at) {
                position = was.lerp(position, share);
                velocity = had.lerp(velocity, share);
                if self.flew(at) {
                    // Its path is a parabola, not that line.
                    position -= 0.5 * share * (1.0 - share) * self.setting.substep * self.setting.kick;
                }
            }
            (ball.position, ball.velocity) = (position, velocity);
        }
        if self.near.is_some() {
            for (&id, hit) in self.ids.iter().zip(&mut self.hit) {
                frame.touching[id as usize] = *hit;
                *hit = false;
            }
        } else {
            frame.touching.fill(false);
        }
        if let Some(grid) = &mut self.shown {
            frame.touching.fill(false);
            frame.show_overlaps::<true>(grid);
        }
    }
}
