//! Which balls are unlike those around them: many times as heavy, or as light.
//!
//! What a light ball passes on that a heavy one presses on is many times its own weight, and found in steps of its own mass. So
//! around such balls contacts are firmer, sweeps more, and no energy is gained. Elsewhere that would only cost, and keep large
//! piles from coming to rest. So each ball is judged by those near it, and what holds two balls by both.

use super::super::ball::Ball;
use super::super::invariants::free;
use super::Body;
use super::amount::{Amount, SOME};
use super::constraints::Marks;
use super::near::Near;
use super::sleep::Rest;

/// Two balls are unlike in density where both their masses and these for their sizes differ by more than this ratio, ...
const IN_DENSITY: f64 = 4.0;
/// ... and in size where their masses differ by more than the second, among more than few balls, of which the masses of some
/// differ by more than the first, or some are unlike in density, and where no more than so many are: of one material, small ones
/// between large ones went on trembling, and were pressed into each other. More do not come to rest either way, and take twice as
/// long.
const IN_SIZE: (f64, f64) = (8.0, 5.0);
const MOST_IN_SIZE: usize = 16_384;
/// So are balls up to so many away, each of which may touch the next before long: what presses on the unlike ones comes through
/// these. With two, ten balls of 10⁴ times the mass of two thousand others, among these, press some of them wholly into each
/// other ...
const RINGS: usize = 8;
/// ... and where they are more than one in so many, so are all: little would be saved, and what presses on many comes from
/// everywhere.
const MANY: usize = 8;

/// Balls that are more than so many times as dense as others could crush these. What is less dense is held by them: three thousand
/// balls, half of them ten times as dense as the others, would take half as long again to come to rest, or twice as long.
const CRUSHING: f64 = 100.0;

/// In what a ball is unlike those around it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(super) enum Unlike {
    /// In nothing, or hardly.
    #[default]
    Nothing,
    /// In mass, by its size alone.
    Size,
    /// In mass, and in mass for its size: it may count as heavier than it is.
    Density,
}

/// Among whom any ball is dense enough to crush others. Few are looked after one by one, and count as none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Crush {
    Nobody,
    /// Up to [`SOME`] balls.
    AmongSome,
    /// More.
    AmongMany,
}

impl Crush {
    /// Whether any of these balls is.
    pub(super) fn among(balls: &[Ball]) -> Self {
        let densities = free(balls).map(|ball| ball.mass / (ball.radius * ball.radius));
        let (least, most) =
            densities.fold((f64::INFINITY, 0.0_f64), |(least, most), of| (least.min(of), most.max(of)));
        match Amount::of(balls) {
            _ if most <= CRUSHING * least => Self::Nobody,
            Amount::Few => Self::Nobody,
            Amount::Some => Self::AmongSome,
            Amount::Many => Self::AmongMany,
        }
    }
}

impl Unlike {
    pub(super) const KINDS: usize = 3;
    pub(super) const ALL: [Self; Self::KINDS] = [Self::Nothing, Self::Size, Self::Density];

    /// Whether it is in anything.
    pub(super) fn differs(self) -> bool {
        self != Self::Nothing
    }

    /// In what any two of these balls, of which so many can be moved, are, wherever they are.
    pub(super) fn among(amount: Amount, bodies: &[Body], rests: &[Rest]) -> Self {
        let ratio = |of: &dyn Fn(&Body, &Rest) -> f64| {
            let moved = bodies.iter().zip(rests).filter(|(_, rest)| rest.own > 0.0);
            let (least, most) = moved
                .map(|(body, rest)| of(body, rest))
                .fold((f64::INFINITY, 0.0_f64), |(least, most), of| (least.min(of), most.max(of)));
            most / least
        };
        let masses = ratio(&|_, rest| rest.own);
        if masses > IN_DENSITY && ratio(&|body, rest| rest.own * body.radius * body.radius) > IN_DENSITY {
            Self::Density
        } else if masses > IN_SIZE.0 && amount > Amount::Few {
            Self::Size
        } else {
            Self::Nothing
        }
    }

    /// In what two balls are: nothing where one is fixed.
    fn between((first, one): (&Body, &Rest), (second, other): (&Body, &Rest)) -> Self {
        let exceeds = |one: f64, two: f64, ratio: f64| one > ratio * two || two > ratio * one;
        let [density, its] =
            [(first, one), (second, other)].map(|(body, rest)| rest.own * body.radius * body.radius);
        if one.own == 0.0 || other.own == 0.0 {
            Self::Nothing
        } else if exceeds(one.own, other.own, IN_DENSITY) && exceeds(density, its, IN_DENSITY) {
            Self::Density
        } else if exceeds(one.own, other.own, IN_SIZE.1) {
            Self::Size
        } else {
            Self::Nothing
        }
    }

    /// In what a pair is of balls that are so: that of the one that moves where the other does not.
    fn of_pair(first: &Rest, second: &Rest) -> Self {
        let (one, other) = (first.unlike, second.unlike);
        if first.own == 0.0 || second.own == 0.0 || one.differs() && other.differs() {
            one.max(other)
        } else {
            Self::Nothing
        }
    }
}

impl Near {
    /// Finds which balls are unlike those around them where any are, in what is `possible`, and which pairs are of such. The
    /// greatest of that.
    pub(super) fn find_unlike(&mut self, bodies: &[Body], rests: &mut [Rest], possible: Unlike) -> Unlike {
        if bodies.len() <= SOME || !possible.differs() {
            // Most are near each other, and they cost little.
            for rest in rests.iter_mut() {
                rest.unlike = possible;
            }
            self.mark_unlike(rests);
            return possible;
        }
        for rest in rests.iter_mut() {
            // What counts as heavier than it is passes on more than its weight, too.
            rest.unlike = if rest.counted == rest.own { Unlike::Nothing } else { Unlike::Density };
        }
        for (i, j) in self.pairs() {
            let kind = Unlike::between((&bodies[i], &rests[i]), (&bodies[j], &rests[j]));
            for at in [i, j] {
                rests[at].unlike = rests[at].unlike.max(kind);
            }
        }
        for kind in [Unlike::Density, Unlike::Size] {
            self.spread(rests, kind);
        }
        let in_size = |rest: &&mut Rest| rest.unlike == Unlike::Size;
        if rests.iter_mut().filter(in_size).count() > MOST_IN_SIZE {
            for rest in rests.iter_mut().filter(in_size) {
                rest.unlike = Unlike::Nothing;
            }
        }
        self.mark_unlike(rests);
        rests.iter().map(|rest| rest.unlike).max().unwrap_or_default()
    }

    /// Has balls be unlike in the same as those near them, some balls away.
    fn spread(&mut self, rests: &mut [Rest], kind: Unlike) {
        let mut ring: Vec<usize> = (0..rests.len()).filter(|&at| rests[at].unlike == kind).collect();
        let (mut count, mut next) = (ring.len(), Vec::new());
        for _ in 0..RINGS {
            if ring.is_empty() || count * MANY > rests.len() {
                break;
            }
            self.link_pairs(rests.len());
            let stripes = self.all();
            for other in ring.drain(..).flat_map(|at| stripes.around(at)) {
                let rest = &mut rests[other];
                if rest.own > 0.0 && rest.unlike < kind {
                    rest.unlike = kind;
                    next.push(other);
                }
            }
            count += next.len();
            std::mem::swap(&mut ring, &mut next);
        }
        if count * MANY > rests.len() {
            for rest in rests.iter_mut() {
                rest.unlike = rest.unlike.max(kind);
            }
        }
    }

    /// Marks the pairs of unlike balls.
    fn mark_unlike(&mut self, rests: &[Rest]) {
        for (number, stripe) in self.stripes.iter_mut().enumerate() {
            let rests = &rests[self.layout.start(number).min(rests.len())..];
            for (marks, pair) in stripe.marks.iter_mut().zip(&stripe.pairs) {
                let [first, second] = [pair.first, pair.second].map(|body| &rests[body as usize]);
                marks.set_unlike(Unlike::of_pair(first, second));
            }
        }
    }
}

impl Marks {
    /// In what the two are unlike those around them.
    #[inline]
    pub(super) fn unlike(self) -> Unlike {
        if self.has(Self::UNLIKE_IN_DENSITY) {
            Unlike::Density
        } else if self.has(Self::UNLIKE_IN_SIZE) {
            Unlike::Size
        } else {
            Unlike::Nothing
        }
    }

    fn set_unlike(&mut self, unlike: Unlike) {
        self.set(Self::UNLIKE_IN_SIZE, unlike == Unlike::Size);
        self.set(Self::UNLIKE_IN_DENSITY, unlike == Unlike::Density);
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::ball::Ball;
    use super::super::amount::FEW;
    use super::super::testing::{TUNING, boxed_world};
    use super::super::{Contact, DVec2, Tally, Tuning};
    use super::*;

    /// Balls of these radii and masses upon each other, from the floor up, after a second.
    fn column(of: &[(f64, f64)]) -> Contact {
        let mut y = 5000.0;
        let mut place = |&(radius, mass): &(f64, f64)| {
            y -= 2.0 * radius;
            Ball::new(DVec2::new(200.0, y + radius), radius).unwrap().with_mass(mass).unwrap()
        };
        let balls: Vec<Ball> = of.iter().map(&mut place).collect();
        let mut contact =
            Contact::new(&boxed_world(DVec2::new(400.0, 5000.0)), &balls, Tuning { sleep: false, ..TUNING });
        (0..240).for_each(|_| contact.step(&mut Tally::default()));
        contact
    }

    /// In what each ball is unlike, in their order.
    fn kinds(contact: &Contact) -> Vec<Unlike> {
        let mut kinds = vec![Unlike::Nothing; contact.ids.len()];
        for (&id, rest) in contact.ids.iter().zip(&contact.rests) {
            kinds[id as usize] = rest.unlike;
        }
        kinds
    }

    #[test]
    fn balls_are_unlike_as_far_from_an_unlike_one_as_what_presses_on_it_comes_from() {
        let mut of = vec![(5.0, 1.0); SOME + 1];
        of[50] = (5.0, 1e-2);
        let kinds = kinds(&column(&of));
        // The one that it touches is unlike it, too; and so are some more.
        let unlike = |at: usize| at.abs_diff(50) <= 1 + RINGS;
        let law = (0..=SOME).map(|at| if unlike(at) { Unlike::Density } else { Unlike::Nothing });
        assert!(kinds.iter().copied().eq(law), "{kinds:?}");
    }

    #[test]
    fn among_some_all_are_unlike_where_any_two_are_and_among_few_not_by_size() {
        let [larger, denser, alike] = [(15.0, 9.0), (5.0, 9.0), (5.0, 4.0)];
        for (count, other, kind) in [
            (SOME, denser, Unlike::Density),
            (SOME, larger, Unlike::Size),
            (SOME, alike, Unlike::Nothing),
            (FEW, denser, Unlike::Density),
            (FEW, larger, Unlike::Nothing),
        ] {
            let mut of = vec![(5.0, 1.0); count];
            of[0] = other;
            assert_eq!(kinds(&column(&of)), vec![kind; count], "{count}, {other:?}");
        }
    }

    #[test]
    fn where_more_than_one_in_eight_is_unlike_all_are() {
        for (every, first) in [(60, Unlike::Density), (400, Unlike::Nothing)] {
            let mut of = vec![(5.0, 1.0); SOME + 1];
            for at in (every..=SOME).step_by(every) {
                of[at] = (5.0, 0.1);
            }
            let kinds = kinds(&column(&of));
            assert_eq!([kinds[0], kinds[SOME]], [first, Unlike::Density], "every {every}");
        }
    }

    #[test]
    fn a_pair_with_a_fixed_ball_is_what_the_other_is_and_one_with_a_like_ball_is_like() {
        let rest = |own: f64, unlike: Unlike| {
            let ball = Ball::new(DVec2::ZERO, 1.0).unwrap();
            let mut rest = Rest::new(&Body::new(&ball, DVec2::ZERO));
            (rest.own, rest.unlike) = (own, unlike);
            rest
        };
        let fixed = rest(0.0, Unlike::Nothing);
        let [like, size, density] = Unlike::ALL.map(|kind| rest(1.0, kind));
        let pairs = [(fixed, density), (size, fixed), (like, density), (size, density), (size, size)];
        let kinds = pairs.map(|(first, second)| Unlike::of_pair(&first, &second));
        let law = [Unlike::Density, Unlike::Size, Unlike::Nothing, Unlike::Density, Unlike::Size];
        assert_eq!(kinds, law);
        for kind in Unlike::ALL {
            let mut marks = Marks::CLOSE;
            marks.set_unlike(kind);
            assert_eq!(marks.unlike(), kind);
        }
    }
}
