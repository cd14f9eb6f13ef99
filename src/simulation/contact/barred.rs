//! Balls that push against what cannot give way, in a substep that had no room for them (`room`), bounce off it.
//!
//! A light ball between a heavy one and a fixed one is hit ever more often, until it has turned the heavy one back, or, where
//! impacts take energy, until that has stopped. Where there were more impacts than a substep takes, the heavy one bounces off
//! the light one as off a fixed one, with the restitution of these two: it comes no nearer than it would have, and no energy
//! comes from nowhere, since only ever a part of a velocity is turned round.

use glam::DVec2;

use super::{Body, Contact, Setting};

/// Balls that are closer to each other, or to a wall, than this part of the smaller radius touch.
const TOUCHING: f64 = 0.02;
/// A ball gives way to a push where at least this part of its speed is left to it, along it.
const YIELDING: f64 = 0.1;
/// Rounds over what bars a ball, where each may undo some of what the others did.
const ROUNDS: u32 = 8;

/// Two bodies that touch, by their places among those without room.
struct Touch {
    pusher: usize,
    pushed: usize,
    /// From the pushed one to the pusher, of length 1.
    normal: DVec2,
    /// Whether the pushed one was found not to give way.
    is_firm: bool,
}

impl Contact {
    /// Turns those round that had no room and push against what cannot give way. Whether there were any.
    pub(super) fn bounce_off_barred(&mut self) -> bool {
        let Self { setting, bodies, restitutions, near: Some(near), room, .. } = self else { return false };
        let short = &room.short;
        let mut any_turned = false;
        // What keeps each from where it would go: the directions in which it is pushed back.
        let mut bars: Vec<_> = short.iter().map(|short| walls_at(setting, &bodies[short.body])).collect();
        let mut touches = Vec::new();
        for (pusher, its) in short.iter().enumerate() {
            for other in near.all().around(its.body) {
                let Some(normal) = touching(&bodies[its.body], &bodies[other]) else { continue };
                if bodies[other].inverse_mass == 0.0 {
                    bars[pusher].push(normal);
                } else if let Ok(pushed) = short.binary_search_by_key(&other, |short| short.body) {
                    touches.push(Touch { pusher, pushed, normal, is_firm: false });
                }
            }
        }
        let mut any = true;
        while std::mem::take(&mut any) {
            for Touch { pusher, pushed, normal, is_firm } in &mut touches {
                if *is_firm || gives_way(&bars[*pushed], -*normal) {
                    continue;
                }
                (*is_firm, any) = (true, true);
                bars[*pusher].push(*normal);
                let (at, on) = (short[*pusher].body, short[*pushed].body);
                let restitution = restitutions[at].min(restitutions[on]);
                let [closing, own] = [bodies[on].velocity, DVec2::ZERO]
                    .map(|velocity| normal.dot(bodies[at].velocity - velocity));
                if closing < 0.0 && own < 0.0 {
                    let change = *normal * (-(1.0 + restitution) * own);
                    bodies[at].velocity += change;
                    bodies[at].free += change;
                    any_turned = true;
                }
            }
        }
        any_turned
    }
}

/// The directions away from the walls that a body touches.
fn walls_at(setting: &Setting, body: &Body) -> Vec<DVec2> {
    let near = (1.0 + TOUCHING) * body.radius;
    let (low, high) = (body.position, setting.size - body.position);
    let sides = [(low.x, DVec2::X), (low.y, DVec2::Y), (high.x, DVec2::NEG_X), (high.y, DVec2::NEG_Y)];
    let at_walls = sides.into_iter().filter(|&(far, _)| setting.walls.is_some() && far < near);
    at_walls.map(|(_, away)| away).collect()
}

/// The direction from another body to one, if they touch.
fn touching(body: &Body, other: &Body) -> Option<DVec2> {
    let offset = body.position - other.position;
    let least = TOUCHING * body.radius.min(other.radius);
    (offset.length() < body.radius + other.radius + least).then(|| offset.try_normalize()).flatten()
}

/// Whether a body that is pushed back in these directions gives way to a push in that one.
fn gives_way(bars: &[DVec2], push: DVec2) -> bool {
    let mut left = push;
    for _ in 0..ROUNDS {
        for bar in bars {
            left -= *bar * bar.dot(left).min(0.0);
        }
    }
    left.dot(push) > YIELDING
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_gives_way_to_a_push_unless_something_is_behind_it_or_on_both_sides() {
        let (right, up) = (DVec2::X, DVec2::NEG_Y);
        let aslant = |angle: f64| DVec2::from_angle(angle.to_radians());
        for (bars, push, gives) in [
            (vec![], right, true),
            (vec![-right], right, false),
            (vec![right], right, true),
            (vec![up], right, true),
            (vec![-aslant(10.0)], right, false),
            (vec![-aslant(40.0)], right, true),
            (vec![-aslant(40.0), -aslant(-40.0)], right, false),
        ] {
            assert_eq!(gives_way(&bars, push), gives, "{bars:?} {push}");
        }
    }
}
