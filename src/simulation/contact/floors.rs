//! What keeps a ball from sinking into what carries it, or lies around it, as if that were firm: the least change of its velocity.
//!
//! That is a projection onto a convex set, of which one or two floors bound what is nearest. Nothing in it depends on the order of the
//! floors, or on left and right: in sweeps over them, what the last one leaves of the others would move a heap to one side.

use glam::DVec2;

use super::super::lesser::greater;

/// By so much of a ball's speed it may still go into what holds it: what rounding leaves in flat wedges.
const ROUNDING: f64 = 1e-9;
/// Two floors that face each other, or are the same, are taken for a little less so, by this factor of their cosine: what each adds
/// would be 0/0.
const NEVER_FACING: f64 = 1.0 - 1e-12;

/// What carries a ball, or lies beside or above it: how fast it goes down there, at most.
#[derive(Debug, Clone, Copy)]
pub(super) struct Floor {
    pub(super) up: DVec2,
    /// px/s along `up`, never more than 0.
    pub(super) least: f64,
}

/// How a ball is kept from sinking into floors.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Held {
    /// How that changes its velocity, px/s.
    pub(super) change: DVec2,
    /// Which of the floors push it, and how much each adds along its `up`, px/s. Nothing is known of that where it is stopped in
    /// a wedge that rounding makes too flat.
    pub(super) by: [Option<(usize, f64)>; 2],
}

/// How a ball of this velocity is kept out of all floors. A velocity of 0 sinks into none, so it only ever becomes less.
///
/// The floor that it still sinks into the fastest is added to those that push it, in turn (a dual active set; Goldfarb & Idnani 1983):
/// each turn takes it farther from the velocity that it had, so none comes twice.
pub(super) fn held(velocity: DVec2, floors: &[Floor]) -> Held {
    let slack = ROUNDING * velocity.length();
    let mut held = Held::default();
    for _ in 0..=2 * floors.len() {
        let goes = velocity + held.change;
        let sinks = floors.iter().map(|floor| floor.least - goes.dot(floor.up)).enumerate();
        let Some((fastest, _)) =
            sinks.filter(|(_, lacking)| *lacking > slack).max_by(|one, other| one.1.total_cmp(&other.1))
        else {
            return held;
        };
        let pushed = held.by.map(|by| by.map(|(at, _)| at));
        let holds = |held: &Held| {
            let goes = velocity + held.change;
            pushed.into_iter().flatten().all(|at| goes.dot(floors[at].up) >= floors[at].least - slack)
        };
        let alone = pushed_by(velocity, floors, [fastest, fastest]);
        let with_one =
            pushed.into_iter().flatten().filter_map(|at| pushed_by(velocity, floors, [fastest, at]));
        let Some(found) = alone.into_iter().chain(with_one).find(holds) else { break };
        held = found;
    }
    // Where rounding leaves none of a very flat wedge, it is that which sinks into nothing.
    Held { change: -velocity, by: [None; 2] }
}

/// What just keeps a ball of this velocity out of two floors, or of one, twice, where each of them pushes it.
fn pushed_by(velocity: DVec2, floors: &[Floor], [first, second]: [usize; 2]) -> Option<Held> {
    let [one, other] = [floors[first], floors[second]];
    if first == second {
        let added = one.least - velocity.dot(one.up);
        return (added > 0.0).then(|| Held { change: one.up * added, by: [Some((first, added)), None] });
    }
    let sine = one.up.perp_dot(other.up);
    let change = (one.up.perp() * other.least - other.up.perp() * one.least) / sine - velocity;
    let [by_one, by_other] = [change.perp_dot(other.up), one.up.perp_dot(change)].map(|added| added / sine);
    // Both push, and neither pulls.
    (by_one >= 0.0 && by_other >= 0.0)
        .then_some(Held { change, by: [Some((first, by_one)), Some((second, by_other))] })
}

/// How much each of two floors adds to the velocity of a ball that sinks into them so much too fast, px/s; the cosine is that between
/// them. Where they are the same floor, each adds half. That takes no branch, which a processor could not foresee.
#[inline]
pub(super) fn added_by_two([one, other]: [f64; 2], cosine: f64) -> [f64; 2] {
    let cosine = cosine * NEVER_FACING;
    let sine = 1.0 - cosine * cosine;
    // What each adds where both push; where one would have to pull, the other pushes alone.
    let both = [one - cosine * other, other - cosine * one].map(|lacking| lacking / sine);
    let added = |both: [f64; 2], alone: f64| if both[1] < 0.0 { alone } else { both[0] };
    [added(both, one), added([both[1], both[0]], other)].map(|added| greater(0.0, added))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_held_between_floors_changes_as_little_as_keeps_it_out_of_all() {
        for turn in 0..500 {
            let angle = |k: u32| f64::from(k * turn) * 0.618;
            let velocity = 100.0 * DVec2::from_angle(angle(7));
            let floor =
                |k| Floor { up: DVec2::from_angle(angle(k)), least: -20.0 * angle(k + 3).sin().abs() };
            let floors: Vec<_> = (1..2 + turn % 4).map(floor).collect();
            // Hildreth's way to the same (1957): slow, but by nothing else than one floor at a time.
            let mut slow: Vec<_> = floors.iter().map(|&floor| (floor, 0.0)).collect();
            let mut expected = velocity;
            for _ in 0..50_000 {
                for (floor, added) in &mut slow {
                    let more = (floor.least - expected.dot(floor.up)).max(-*added);
                    *added += more;
                    expected += floor.up * more;
                }
            }
            let Held { change, by } = held(velocity, &floors);
            assert!((velocity + change).abs_diff_eq(expected, 1e-6), "turn {turn}: {change} to {expected}");
            let given: DVec2 = by.into_iter().flatten().map(|(at, added)| floors[at].up * added).sum();
            assert!(given.abs_diff_eq(change, 1e-9), "turn {turn}: {given} of {change}");
            if let [one, other] = floors[..] {
                let lacking = [one, other].map(|floor| floor.least - velocity.dot(floor.up));
                let [first, second] = added_by_two(lacking, one.up.dot(other.up));
                let given = one.up * first + other.up * second;
                assert!(given.abs_diff_eq(change, 1e-6), "turn {turn}: {given} for {change}");
            }
        }
    }

    #[test]
    fn what_goes_into_a_wedge_stands_still_in_it_however_flat_it_is() {
        for flat in [0.3, 1e-2, 1e-4, 1e-7, 1e-10, 0.0] {
            let ups = [DVec2::from_angle(0.35), DVec2::from_angle(0.35 + std::f64::consts::PI - flat)];
            let floors = ups.map(|up| Floor { up, least: 0.0 });
            let into = -(ups[0] + ups[1]).normalize_or(ups[0].perp());
            let held = 3.0 * into + held(3.0 * into, &floors).change;
            assert!(flat < 1e-8 || held.length() < 1e-6, "{flat} rad: {held}");
            assert!(floors.iter().all(|floor| held.dot(floor.up) > -1e-6), "{flat} rad: {held}");
        }
    }

    #[test]
    fn between_two_that_face_each_other_or_on_the_same_twice_a_ball_goes_into_neither() {
        let up = DVec2::from_angle(0.7);
        let aside = up.perp();
        for other in [-up, -up + 1e-9 * aside, -up + 1e-15 * aside, up, up + 1e-9 * aside] {
            for velocity in [5.0 * up, -5.0 * up, 5.0 * aside, 3.0 * up - 4.0 * aside] {
                let floors = [up, other].map(|up| Floor { up, least: 0.0 });
                let [first, second] = added_by_two([up, other].map(|up| -velocity.dot(up)), up.dot(other));
                let by_two = velocity + up * first + other * second;
                let exactly = velocity + held(velocity, &floors).change;
                for (held, sinking) in [(by_two, 1e-3), (exactly, 1e-6)] {
                    assert!(
                        floors.iter().all(|floor| held.dot(floor.up) > -sinking),
                        "{other}, {velocity}: {held}"
                    );
                    assert!(held.length() < velocity.length() + 1e-6, "{other}, {velocity}: {held}");
                }
            }
        }
    }
}
