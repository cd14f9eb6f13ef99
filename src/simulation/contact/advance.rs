//! How frames ask for substeps: as many as their time holds, what is shown at their end, and what is changed from outside.

use super::super::ball::Ball;
use super::super::clock::Clock;
use super::super::world::World;
use super::super::{Advance, Frame, Part};
use super::body::Body;
use super::layout::Layout;
use super::show::Start;
use super::sleep::Rest;
use super::team::Team;
use super::unlike::Crush;
use super::wall_support::any_jams;
use super::{Contact, can_rest, has_pairs};

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
            // One stripe is not worth waking threads for, and balls never become fewer.
            if Layout::of(self.bodies.len()).is_cut() {
                self.team.start(self.tuning.threads);
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

    fn add(&mut self, world: &World, balls: &[Ball]) -> bool {
        let tuning = self.tuning;
        let Some(substeps) = self.substeps.with(world, balls, tuning) else { return false };
        if has_pairs(world, balls) != self.pairs
            || can_rest(world, balls) != self.setting.can_rest
            || self.shown.is_some()
            || self.any_sleeps_in(&balls[self.bodies.len()..])
        {
            return false;
        }
        self.substeps = substeps;
        self.setting.firm = substeps.firm(self.setting.kick);
        self.setting.crush = Crush::among(balls);
        self.setting.softness = substeps.softness(self.setting.crush);
        self.setting.has_fixed = balls.iter().any(Ball::is_fixed);
        self.setting.jammed = any_jams(world, balls);
        let known = self.bodies.len();
        for (id, ball) in (known as u32..).zip(&balls[known..]) {
            let body = Body::new(ball, self.setting.kick);
            self.bodies.push(body);
            self.rests.push(Rest::new(&body));
            self.restitutions.push(ball.restitution);
            self.ids.push(id);
            self.hit.push(false);
            if !self.before.is_empty() {
                self.before.push(Start::of(ball));
            }
        }
        self.parting.begin_again(known as u32);
        self.all_asleep = false;
        true
    }

    fn set_velocity(&mut self, _: &World, balls: &[Ball], index: usize) -> bool {
        let ball = &balls[index];
        if ball.is_fixed() {
            // Nothing moves it.
            return true;
        }
        let Some(at) = self.ids.iter().position(|&id| id as usize == index) else { return false };
        self.free_by_hand(at);
        let body = &mut self.bodies[at];
        body.velocity = ball.velocity - 0.5 * self.setting.kick;
        body.free = body.velocity;
        if let Some(start) = self.before.get_mut(at) {
            start.velocity = ball.velocity;
        }
        true
    }

    fn substeps(&self) -> Option<[u32; 2]> {
        Some(self.substeps.range(self.bodies.len(), self.setting.gravity))
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
