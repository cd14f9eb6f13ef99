//! How many balls can be moved: the fewer, the more is done for each. Fixed ones beside them, as in rows of pegs, do not count, up to
//! where there are so many in all that they are several stripes: what is looked at in each turn would cost too much.

use super::super::ball::Ball;
use super::super::invariants::free;
use super::layout::Layout;

/// So many are few, ...
pub(super) const FEW: usize = 128;
/// ... and so many are some.
pub(super) const SOME: usize = 400;

/// How many balls can be moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Amount {
    /// Each is followed from impact to impact, and what it presses on to the end of that.
    Few,
    /// Sweeps take their time.
    Some,
    Many,
}

impl Amount {
    /// How many of these can.
    pub(super) fn of(balls: &[Ball]) -> Self {
        let moving = free(balls).take(SOME + 1).count();
        if moving > SOME || Layout::of(balls.len()).is_cut() {
            Self::Many
        } else if moving > FEW {
            Self::Some
        } else {
            Self::Few
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    #[test]
    fn what_is_fixed_does_not_count_unless_it_makes_several_stripes() {
        let ball = Ball::new(DVec2::splat(50.0), 5.0).unwrap();
        let amount = |moving: usize, fixed: usize| {
            let fixed = std::iter::repeat_n(ball.fixed(), fixed);
            Amount::of(&std::iter::repeat_n(ball, moving).chain(fixed).collect::<Vec<_>>())
        };
        for fixed in [0, 1000] {
            let amounts = [0, FEW, FEW + 1, SOME, SOME + 1].map(|moving| amount(moving, fixed));
            assert_eq!(
                amounts,
                [Amount::Few, Amount::Few, Amount::Some, Amount::Some, Amount::Many],
                "{fixed}"
            );
        }
        assert_eq!([amount(1, 2046), amount(1, 2047)], [Amount::Few, Amount::Many]);
    }
}
