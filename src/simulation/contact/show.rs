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

    /// A body's position and velocity at the end of the last substep, or after this share of it.
    #[inline]
    fn seen(&self, at: usize, share: f64) -> (DVec2, DVec2) {
        let (position, velocity) = (self.bodies[at].position, self.velocity_between(at));
        let Some(&(was, had)) = self.before.get(at) else { return (position, velocity) };
        let mut between = was.lerp(position, share);
        if self.flew(at) {
            // Its path is a parabola, not that line.
            between -= 0.5 * share * (1.0 - share) * self.setting.substep * self.setting.kick;
        }
        (between, had.lerp(velocity, share))
    }

    /// Shows the balls as they are at the clock's time, after this share of the last substep where `before` tells of its
    /// beginning. This evaluates, and never writes back.
    pub(super) fn show(&mut self, frame: &mut Frame<'_>, share: f64) {
        self.find_held_by_balls();
        for (hit, &held) in self.hit.iter_mut().zip(&self.held) {
            *hit |= held;
        }
        self.find_held_by_walls();
        // Bodies are read out of their order: that costs less than to write balls out of theirs.
        let mut places = std::mem::take(&mut self.places);
        places.resize(self.ids.len(), 0);
        for (at, &id) in (0..).zip(&self.ids) {
            places[id as usize] = at;
        }
        for (ball, &at) in frame.balls.iter_mut().zip(&places) {
            // Not even rounding moves a fixed one.
            if !ball.is_fixed() {
                (ball.position, ball.velocity) = self.seen(at as usize, share);
            }
        }
        if self.near.is_some() {
            for (touching, &at) in frame.touching.iter_mut().zip(&places) {
                *touching = self.hit[at as usize];
            }
            self.hit.fill(false);
        } else {
            frame.touching.fill(false);
        }
        self.places = places;
        if let Some(grid) = &mut self.shown {
            frame.touching.fill(false);
            frame.show_overlaps::<true>(grid);
        }
    }
}
