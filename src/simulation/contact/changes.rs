//! Balls that are taken away or put elsewhere, and gravity and walls that change, from outside.
//!
//! What holds the others goes on holding them, so that a pile at rest is not shaken. Those that lose a support, or a load, wake, and
//! so do those that walls have moved, or go away from, and, where gravity changes, all.

use glam::{BVec2, DVec2};

use super::super::ball::Ball;
use super::super::world::World;
use super::edits::Remainder;
use super::fates::Fate;
use super::find::Cargo;
use super::show::{Held, Start};
use super::team::Team;
use super::unlike::Crush;
use super::wake::wake_if_asleep;
use super::wall_support::any_jams;
use super::wedges::FLAT_UNDER_SLEEPER;
use super::{Contact, Setting, can_rest, has_pairs, is_few, least_restitution, takes_energy};

impl Contact {
    /// Takes over what it needs to know of a world and its balls together, if it still suits them.
    pub(super) fn adapt(&mut self, world: &World, balls: &[Ball]) -> bool {
        let Some(substeps) = self.substeps.with(world, balls, self.tuning) else { return false };
        let gravity = world.gravity.unwrap_or_default();
        if balls.is_empty()
            || has_pairs(world, balls) != self.pairs
            || can_rest(world, balls) != self.setting.can_rest
            || takes_energy(world.walls, least_restitution(balls))
                != takes_energy(self.setting.walls, self.setting.least_restitution)
            || (gravity == DVec2::ZERO) != (self.setting.gravity == DVec2::ZERO)
            || self.shown.is_some()
        {
            return false;
        }
        let (crush, kick) = (Crush::among(balls), gravity * self.setting.substep);
        self.substeps = substeps;
        self.setting = Setting {
            size: world.size,
            gravity,
            kick,
            least_restitution: least_restitution(balls),
            has_fixed: balls.iter().any(Ball::is_fixed),
            amount: substeps.amount,
            jammed: any_jams(world, balls),
            flat_under_sleeper: (!substeps.is_deep()).then_some(FLAT_UNDER_SLEEPER),
            firm: substeps.firm(kick),
            softness: substeps.softness(crush),
            crush,
            ..self.setting
        };
        true
    }

    /// The body that a ball is.
    pub(super) fn body_of(&self, index: usize) -> Option<usize> {
        self.ids.iter().position(|&id| id as usize == index)
    }

    /// Takes the ball of this index away, if it can; `balls` are those that are left.
    pub(super) fn remove(&mut self, world: &World, balls: &[Ball], index: usize) -> bool {
        let Some(at) = self.body_of(index) else { return false };
        let is_within = self.remainder().is_some();
        // Few that nothing holds may go from impact to impact.
        let become_few = is_few(balls) && !self.hands_back && self.tuning.substeps.is_none();
        if (become_few || is_within && self.is_hit_later(at)) && self.is_loose() || !self.adapt(world, balls)
        {
            return false;
        }
        self.free_by_hand(at);
        self.substeps.stir();
        let count = self.bodies.len() as u32;
        self.bodies.remove(at);
        self.restitutions.remove(at);
        self.rests.remove(at);
        self.hit.remove(at);
        let gone = self.ids.remove(at);
        self.ids.iter_mut().filter(|id| **id > gone).for_each(|id| *id -= 1);
        self.parting.forget(gone);
        if !self.before.is_empty() {
            self.before.remove(at);
        }
        if at < self.held.len() {
            self.held.remove(at);
        }
        self.course.forget(at);
        // Nothing holds the one that is gone, wherever it stood.
        let places: Vec<u32> = (0..count).map(|was| was - u32::from(was as usize > at)).collect();
        self.search_now(Some(&places));
        self.show_again(balls);
        true
    }

    /// Has the ball of this index stand where it was put, if it can; `balls` are all, as they are shown.
    pub(super) fn place(&mut self, balls: &[Ball], index: usize) -> bool {
        let ball = &balls[index];
        let Some(at) = self.body_of(index) else { return false };
        if self.any_sleeps_in(std::slice::from_ref(ball)) {
            return false;
        }
        let remainder = self.remainder();
        if remainder.is_some() && self.is_loose() && self.is_hit_later(at) {
            return false;
        }
        let flown = remainder.map(|remainder| {
            let way = remainder.way(ball);
            let is_free = !(self.leads_out(way) || self.comes_into(way, balls, Some(at), remainder.left));
            // Where something is in its way, it stands there until the substep is over.
            if is_free { (way.to, remainder.last_velocity(ball)) } else { (ball.position, ball.velocity) }
        });
        let (to, velocity) = flown.unwrap_or((ball.position, ball.velocity));
        self.free_by_hand(at);
        if ball.is_fixed() {
            self.bodies[at].position = to;
        } else {
            self.bodies[at].go(to, velocity, self.setting.kick);
        }
        self.forget_course_of(at);
        self.parting.put([index as u32]);
        self.search_now(None);
        self.show_again(balls);
        if let Some(start) = self.before.get_mut(at) {
            start.is_let_go = to == ball.position;
        }
        true
    }

    /// Takes over another gravity, if it can; `balls` are as they are shown.
    pub(super) fn change_gravity(&mut self, world: &World, balls: &[Ball]) -> bool {
        let remainder = self.remainder();
        if remainder.is_some() && self.is_loose() {
            return false;
        }
        let (old, flying) = (self.setting, self.flying());
        if !self.adapt(world, balls) {
            return false;
        }
        self.substeps.stir();
        let (kick, change) = (self.setting.kick, self.setting.gravity - old.gravity);
        for &at in &flying {
            // As fast as it was at the substep's end, half a substep before.
            let body = &mut self.bodies[at];
            body.velocity += 0.5 * (old.kick - kick);
            body.free = body.velocity;
            let Some(Remainder { left, .. }) = remainder else { continue };
            let to = self.setting.inside(body.position + 0.5 * change * left * left, body.radius);
            body.go(to, body.velocity + 0.5 * kick + change * left, kick);
        }
        self.wake(|_| true);
        self.search_now(None);
        self.show_again(balls);
        true
    }

    /// Takes over walls that were moved, if it can; `balls` are where these have moved them.
    pub(super) fn move_walls(&mut self, world: &World, balls: &[Ball]) -> bool {
        let remainder = self.remainder();
        if remainder.is_some() && self.is_loose() {
            return false;
        }
        // Where it is over, all are at its end.
        let share = remainder.map_or(1.0, |_| self.share());
        let moved: Vec<DVec2> = (0..self.bodies.len())
            .map(|at| {
                let ball = &balls[self.ids[at] as usize];
                if ball.is_fixed() { DVec2::ZERO } else { ball.position - self.seen(at, share).0 }
            })
            .collect();
        let old = self.setting.size;
        if !self.adapt(world, balls) {
            return false;
        }
        self.substeps.stir();
        self.leave_walls(world.size.cmpgt(old));
        self.wake(|at| moved[at] != DVec2::ZERO);
        for (body, &by) in self.bodies.iter_mut().zip(&moved).filter(|(body, _)| body.inverse_mass > 0.0) {
            // What was inside when it was shown may not be at the substep's end.
            body.position = self.setting.inside(body.position + by, body.radius);
        }
        let ids = moved.iter().zip(&self.ids).filter(|&(&by, _)| by != DVec2::ZERO).map(|(_, &id)| id);
        self.parting.put(ids);
        if let Some(near) = &mut self.near {
            // They were made for another world.
            near.cells = None;
        }
        self.search_now(None);
        self.show_again(balls);
        true
    }

    /// Has those that lean on the far walls along these axes lean on them no longer.
    fn leave_walls(&mut self, axes: BVec2) {
        let Some(near) = &mut self.near else { return };
        let mut left = vec![false; self.bodies.len()];
        for (number, stripe) in near.stripes.iter_mut().enumerate() {
            let start = near.layout.start(number);
            for beside in &mut stripe.beside {
                let leans = axes & beside.push.cmplt(DVec2::ZERO);
                left[start + beside.body as usize] = leans.any();
                beside.push = DVec2::select(leans, DVec2::ZERO, beside.push);
            }
        }
        self.wake(|at| left[at]);
    }

    /// The bodies that nothing but gravity and impacts move.
    fn flying(&self) -> Vec<usize> {
        (0..self.bodies.len()).filter(|&at| self.bodies[at].inverse_mass > 0.0 && self.flies(at)).collect()
    }

    /// Wakes those of these that sleep, and what that disturbs.
    fn wake(&mut self, which: impl Fn(usize) -> bool) {
        self.all_asleep = false;
        let Self { setting, bodies, rests, near: Some(near), .. } = self else { return };
        let count = near.homes.len();
        near.link_pairs(count);
        let stripes = &mut near.all();
        for at in (0..count).filter(|&at| which(at)) {
            wake_if_asleep(at, setting.kick, bodies, rests, stripes);
        }
        self.wake_unbalanced();
    }

    /// Has nothing that a body did in the substep that is shown, nor what held it then, count any more.
    pub(super) fn forget_course_of(&mut self, at: usize) {
        if let Some(fate) = self.course.fates.get_mut(at) {
            *fate = Fate::default();
        }
        if let Some(held) = self.held.get_mut(at) {
            *held = Held::default();
        }
    }

    /// Has all that is shown within a substep stay where it was, on its way to where it now comes to.
    pub(super) fn show_again(&mut self, balls: &[Ball]) {
        let Some(remainder) = self.remainder() else { return };
        let share = self.share();
        self.find_held(&Team::default());
        self.look_up_legs(share);
        for at in 0..self.bodies.len() {
            let ball = &balls[self.ids[at] as usize];
            if self.seen(at, share).0 == ball.position {
                continue;
            }
            if let Some(fate) = self.course.fates.get_mut(at) {
                *fate = Fate::default();
            }
            let start = if ball.is_fixed() {
                Start::of(ball)
            } else {
                let end = (self.bodies[at].position, self.velocity_between(at));
                remainder.start(ball, end, self.flies(at))
            };
            self.before[at] = Start { is_let_go: self.before[at].is_let_go, ..start };
        }
    }

    /// Searches pairs anew, and before the next substep again: then what is found counts. `places` are those that bodies now have,
    /// where they have others.
    fn search_now(&mut self, places: Option<&[u32]>) {
        let Self { setting, bodies, restitutions, ids, rests, near: Some(near), hit, before, .. } = self
        else {
            return;
        };
        // What was never searched is before the next substep.
        if !near.homes.is_empty() {
            let cargo = Cargo { bodies, restitutions, ids, hit, rests, before };
            near.search_after(places, &cargo, setting, &Team::default());
            // None counts as covered.
            near.moved = self.bodies.len();
        }
    }
}
