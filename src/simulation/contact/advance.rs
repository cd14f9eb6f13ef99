//! How frames ask for substeps: as many as their time holds, and what is shown at their end.

use super::super::ball::Ball;
use super::super::clock::Clock;
use super::super::world::World;
use super::super::{Advance, Edit, Frame, Part};
use super::Contact;
use super::layout::Layout;
use super::team::Team;

impl Advance for Contact {
    fn advance(&mut self, frame: &mut Frame<'_>, seconds: f64, go_on: &mut dyn FnMut() -> bool) -> f64 {
        let (from, target) = (self.clock, self.clock.after(seconds));
        let (over, rest) = target.steps(self.substeps.rate);
        let last = over + u64::from(rest > 0.0);
        if self.all_asleep && self.before.is_empty() {
            // Nothing moves, and what was shown still stands.
            self.sleep_until(last);
            self.clock = target;
            return seconds;
        }
        let (mut stopped, mut held_found) = (false, false);
        while self.steps < last && !stopped {
            if self.is_calm() {
                self.before.clear();
                break;
            }
            if self.all_asleep {
                self.before.clear();
                self.sleep_until(last);
                break;
            }
            // One stripe is not worth waking threads for.
            if Layout::of(self.bodies.len()).is_cut() {
                self.team.start(self.tuning.threads);
            } else {
                self.team = Team::default();
            }
            let team = self.team.clone();
            team.gather(|| {
                self.before.clear();
                if self.steps + self.substeps.next_length() > over {
                    self.find_held(&team);
                    self.before = (0..self.bodies.len()).map(|at| self.start_of(at)).collect();
                }
                self.step(frame.tally);
                held_found = self.steps >= last;
                if held_found {
                    self.find_held_by_balls(&team);
                }
            });
            stopped = !go_on();
        }
        if !held_found {
            self.find_held_by_balls(&Team::default());
        }
        if self.steps < last {
            self.clock = Clock::at_step(self.steps, self.substeps.rate).max(from);
            self.show(frame, 0.0);
            self.clock.seconds_since(from)
        } else {
            self.clock = target;
            if rest == 0.0 && self.steps == over {
                self.before.clear();
            }
            self.show(frame, self.share());
            seconds
        }
    }

    fn take_up(&mut self, world: &World, balls: &[Ball], edit: Edit) -> bool {
        match edit {
            Edit::Added => self.add(world, balls),
            Edit::Removed(index) => self.remove(world, balls, index),
            Edit::Thrown(index) => self.throw(balls, index),
            Edit::Placed(index) => self.place(balls, index),
            Edit::Gravity => self.change_gravity(world, balls),
            Edit::Walls => self.move_walls(world, balls),
        }
    }

    fn substeps(&self) -> Option<[u32; 2]> {
        Some(self.substeps.range(self.setting.gravity))
    }

    fn within_substep(&self) -> f64 {
        let share = if self.before.is_empty() { 0.0 } else { self.share() };
        share.min(1.0 - share) * self.substeps.seconds()
    }

    fn parts(&self, world: &World) -> Vec<Part> {
        let mut parts = Part::of_motion(world);
        if self.pairs || self.shown.is_some() {
            parts.push(Part::Grid);
        }
        if self.pairs {
            parts.push(Part::Impulse);
        }
        parts
    }

    fn clone_boxed(&self) -> Box<dyn Advance> {
        Box::new(self.clone())
    }
}
