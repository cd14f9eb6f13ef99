//! What holds balls that press on walls.

use glam::{BVec2, DVec2};

use super::super::jams;
use super::constraints::Beside;
use super::fates::Fate;
use super::support::Tolerance;
use super::{Ball, Body, Setting, World, within};

/// A wall's push that is less than this part of a velocity is rounding.
pub(super) const ROUNDING: f64 = 1e-9;

/// Along which axes any ball that can be moved, and may be pressed on walls, has no room between them.
pub(super) fn any_jams(world: &World, balls: &[Ball]) -> BVec2 {
    let presses = world.walls.is_some() && world.gravity.is_some();
    let moving = balls.iter().filter(|ball| presses && !ball.is_fixed());
    moving.fold(BVec2::FALSE, |any, ball| any | jams(world.size, ball.radius))
}

/// Holds a ball where it is along axes along which it has no room. One wall's push would else be an impact on the other, and
/// what it touches would be hit by a ball that goes nowhere, again and again.
pub(super) fn hold_jammed(setting: &Setting, body: &mut Body) {
    let jammed = jams(setting.size, body.radius);
    body.position = DVec2::select(jammed, within(body.position, body.radius, setting.size), body.position);
    body.velocity = DVec2::select(jammed, DVec2::ZERO, body.velocity);
    body.free = DVec2::select(jammed, DVec2::ZERO, body.free);
}

/// Has walls bear the balls that came to rest on them in this substep.
pub(super) fn lay_on_walls(fates: &[Fate], beside: &mut [Beside]) {
    for beside in beside {
        let borne = fates[beside.body as usize].borne;
        beside.push = DVec2::select(borne.cmpne(DVec2::ZERO), borne, beside.push);
    }
}

/// Takes back what walls gave in the last substep from balls that it would throw off them now: they do not press on these any more. An
/// impact at such a speed would give a ball more than it has, and throw it against the wall anew, the harder each time.
pub(super) fn let_off_walls(setting: &Setting, bodies: &mut [Body], beside: &mut [Beside]) {
    for beside in beside.iter_mut().filter(|beside| beside.push != DVec2::ZERO) {
        let body = &mut bodies[beside.body as usize];
        let away = body.velocity * beside.push.signum();
        let thrown = away.cmpgt(DVec2::splat(setting.firm)) & beside.push.cmpne(DVec2::ZERO);
        if thrown.any() && body.inverse_mass > 0.0 {
            let back = DVec2::select(thrown, beside.push.abs().min(away).copysign(beside.push), DVec2::ZERO);
            beside.push -= back;
            body.velocity -= back;
        }
    }
}

/// Stops the balls that walls hold at the walls. The largest change of a ball's speed, in times what is enough.
#[inline]
pub(super) fn hold_on_walls(
    setting: &Setting,
    bodies: &mut [Body],
    beside: &mut [Beside],
    enough: Tolerance,
) -> f64 {
    let mut most = 0.0_f64;
    for beside in beside {
        let body = &mut bodies[beside.body as usize];
        if body.inverse_mass == 0.0 {
            continue;
        }
        let held;
        (held, beside.push) = hold(setting, body, beside.push);
        most = most.max((body.velocity - held).abs().max_element() / enough.of(body.radius));
        body.velocity = held;
        if setting.jammed.any() {
            hold_jammed(setting, body);
            beside.push = DVec2::select(jams(setting.size, body.radius), DVec2::ZERO, beside.push);
        }
    }
    most
}

/// The velocity with which walls hold a ball that they gave this push in the last substep, and what they give it in this one.
#[inline]
fn hold(setting: &Setting, body: &Body, push: DVec2) -> (DVec2, DVec2) {
    // The velocities with which it would just reach the walls at the end of the substep.
    let low = ((DVec2::splat(body.radius) - body.position) / setting.substep).min(DVec2::ZERO);
    let high = ((setting.size - body.radius - body.position) / setting.substep).max(DVec2::ZERO);
    let without = body.velocity - push;
    let held = without.max(low).min(high);
    (held, held - without)
}

/// Whether walls bear a ball as in the last substep, so that it goes on along them as it does.
pub(super) fn is_borne(setting: &Setting, bodies: &[Body], beside: &Beside) -> bool {
    let body = &bodies[beside.body as usize];
    !body.is_free()
        && hold(setting, body, beside.push) == (body.velocity, beside.push)
        && body.velocity * beside.push == DVec2::ZERO
}

/// Takes the velocities away that walls gave to balls that would have overlapped them. The largest change of a ball's speed,
/// in times what is enough.
pub(super) fn relax_on_walls(bodies: &mut [Body], beside: &mut [Beside], enough: Tolerance) -> f64 {
    let mut most = 0.0_f64;
    for beside in beside {
        let body = &mut bodies[beside.body as usize];
        if body.inverse_mass == 0.0 {
            continue;
        }
        for axis in 0..2 {
            // What comes near a wall only now meets it in the next substep.
            let push = beside.push[axis];
            // Not for what rounding leaves: one that just comes to a wall is not held by it.
            if push.abs() > ROUNDING * body.velocity[axis].abs() {
                let without = body.velocity[axis] - push;
                let velocity = if push > 0.0 { without.max(0.0) } else { without.min(0.0) };
                let change = velocity - body.velocity[axis];
                most = most.max(change.abs() / enough.of(body.radius));
                beside.push[axis] += change;
                body.velocity[axis] = velocity;
            }
        }
    }
    most
}
