//! Bodies in stripes: runs of neighbours that are worked on by themselves, so that several threads share a substep.
//!
//! Bodies stand in the order of their places, along columns where gravity pulls down, so a stripe is a range of them.
//! Pairs within a stripe belong to it. Those across its edge belong to the *seam* there, the halves of the stripes on
//! both sides; the few that span more, those of a ball larger than a stripe, to the *rest*. First all stripes are
//! worked on, each by itself, then all seams, then the rest; or stripes by twos, with the seam between them. How many
//! stripes there are depends on the balls alone, so the order, and with it every bit of the result, is the same for any
//! number of threads.
//!
//! Stripes and the seams between them are numbered as they lie: each begins half a stripe after the one before.

use std::mem::take;
use std::ops::Range;

/// Fewer balls are one stripe: threads would cost more than they save.
const LEAST: usize = 2048;
/// A stripe is about so many balls wide, at least: few of its balls lie at an edge, and a core's cache takes it.
const WIDTH: f64 = 10.0;

/// Which stripes there are, and which numbers they have: each stripe with the seam behind it, the rest. Nothing is in the
/// last seam, since nothing is behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    /// Half a stripe is 2 to this power bodies long.
    shift: u32,
    /// How many there are, seams and the rest not counted.
    own: usize,
}

/// Parts that share no body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Layer {
    Own,
    Seams,
    Rest,
    /// Stripes by twos with the seam between them, from the first stripe on; what is left over is by itself.
    Even,
    /// The same from the second stripe on.
    Odd,
}

impl Layer {
    /// Stripes first.
    pub(super) const OUTWARD: &'static [Self] = &[Self::Own, Self::Seams, Self::Rest];
    /// Stripes last.
    pub(super) const INWARD: &'static [Self] = &[Self::Rest, Self::Seams, Self::Own];
    /// What lies across edges before and after what lies between them.
    pub(super) const AROUND: &'static [Self] = &[Self::Rest, Self::Seams, Self::Own, Self::Seams, Self::Rest];
}

impl Default for Layout {
    fn default() -> Self {
        Self::ONE
    }
}

impl Layout {
    /// All bodies are one stripe.
    pub(super) const ONE: Self = Self { shift: usize::BITS - 2, own: 1 };

    /// The layout that suits so many balls.
    pub(super) fn of(count: usize) -> Self {
        if count < LEAST {
            return Self::ONE;
        }
        // A square of so many balls has their root on a side. Between two powers of two, the nearer by ratio.
        let half = 0.5 * WIDTH * (count as f64).sqrt();
        let shift = ((half * std::f64::consts::SQRT_2) as usize).ilog2();
        Self { shift, own: count.div_ceil(2 << shift) }
    }

    /// Whether there is more than one stripe.
    pub(super) fn is_cut(self) -> bool {
        self.own > 1
    }

    /// How many stripes there are, seams and the rest counted.
    pub(super) fn len(self) -> usize {
        if self.is_cut() { 2 * self.own + 1 } else { 1 }
    }

    /// The layout of two stripes and the seam between them.
    pub(super) fn of_block(self) -> Self {
        Self { own: 2, ..self }
    }

    /// The stripe of a body, its seam and the rest.
    #[inline]
    pub(super) fn of_body(self, body: usize) -> impl Iterator<Item = usize> + use<> {
        let rest = self.is_cut().then_some(2 * self.own);
        [Some(self.own_of(body)), self.seam_of(body), rest].into_iter().flatten()
    }

    /// The stripe of a body.
    #[inline]
    pub(super) fn own_of(self, body: usize) -> usize {
        (body >> self.shift) & !1
    }

    /// The stripe of a body, and its place there.
    #[inline]
    pub(super) fn place_of(self, body: usize) -> (usize, u32) {
        let number = self.own_of(body);
        (number, (body - self.start(number)) as u32)
    }

    /// The seam of a body. The first half of the first stripe has none.
    #[inline]
    pub(super) fn seam_of(self, body: usize) -> Option<usize> {
        (((body >> self.shift) + 1) & !1).checked_sub(1)
    }

    /// The number of the stripe that a pair belongs to by itself.
    #[inline]
    pub(super) fn of_pair(self, one: usize, other: usize) -> usize {
        if self.own_of(one) == self.own_of(other) {
            return self.own_of(one);
        }
        self.seam_of(one).filter(|_| self.seam_of(one) == self.seam_of(other)).unwrap_or(2 * self.own)
    }

    /// The layer of a stripe, a seam, or the rest.
    pub(super) fn layer(self, number: usize) -> Layer {
        if number >= 2 * self.own {
            Layer::Rest
        } else if number & 1 == 0 {
            Layer::Own
        } else {
            Layer::Seams
        }
    }

    /// Those stripes by twos that hold a seam.
    pub(super) fn twos_of_seam(number: usize) -> Layer {
        if number & 3 == 1 { Layer::Even } else { Layer::Odd }
    }

    /// How many stripes there are, no seams.
    pub(super) fn stripes(self) -> usize {
        self.own
    }

    /// The numbers of the stripes, of the seams, or of the rest.
    pub(super) fn numbers(self, layer: Layer) -> impl Iterator<Item = usize> + use<> {
        self.parts(layer).map(|part| part.start)
    }

    /// The numbers that each part of a layer has.
    #[inline]
    fn parts(self, layer: Layer) -> impl Iterator<Item = Range<usize>> + use<> {
        // The first begins two before this.
        let (first, step, width) = match layer {
            Layer::Own => (2, 2, 1),
            Layer::Seams => (3, 2, 1),
            Layer::Rest => (2 * self.own + 2, 2, 1),
            Layer::Even => (2, 4, 3),
            Layer::Odd => (0, 4, 3),
        };
        // What is behind the last stripe has no pairs.
        let end = if layer == Layer::Rest { self.len() } else { 2 * self.own - 1 };
        let parts = (end + 2).saturating_sub(first).div_ceil(step);
        (0..parts).map(move |part| {
            let begin = first + part * step;
            begin.saturating_sub(2)..(begin + width - 2).min(end)
        })
    }

    /// The first body of a stripe.
    #[inline]
    pub(super) fn start(self, number: usize) -> usize {
        // Nothing is shifted out where all are one stripe.
        if number < 2 * self.own { number << self.shift } else { 0 }
    }

    /// How many of `all` bodies a stripe has.
    #[inline]
    pub(super) fn count(self, number: usize, all: usize) -> usize {
        let left = all.saturating_sub(self.start(number));
        if number < 2 * self.own { left.min(2 << self.shift) } else { left }
    }

    /// Which of `all` bodies each part of a layer has.
    #[inline]
    fn bodies(self, layer: Layer, all: usize) -> impl Iterator<Item = Range<usize>> + use<> {
        self.parts(layer).map(move |part| {
            let last = part.end - 1;
            self.start(part.start).min(all)..(self.start(last) + self.count(last, all)).min(all)
        })
    }

    /// Items, one a body, as the parts of a layer have them.
    #[inline]
    pub(super) fn share<T>(
        self,
        layer: Layer,
        items: &mut [T],
    ) -> impl Iterator<Item = &mut [T]> + use<'_, T> {
        let bodies = self.bodies(layer, items.len());
        cut_out(items, bodies)
    }

    /// The same for items that are only read.
    #[inline]
    pub(super) fn share_read<T>(self, layer: Layer, items: &[T]) -> impl Iterator<Item = &[T]> + use<'_, T> {
        self.bodies(layer, items.len()).map(|bodies| &items[bodies])
    }

    /// Stripes, as the parts of a layer have them, with the number of the first of each. None where there are none yet.
    #[inline]
    pub(super) fn share_stripes<T>(
        self,
        layer: Layer,
        stripes: &mut [T],
    ) -> impl Iterator<Item = (usize, &mut [T])> + use<'_, T> {
        let count = stripes.len();
        let parts = self.parts(layer).take_while(move |part| part.end <= count);
        self.numbers(layer).zip(cut_out(stripes, parts))
    }
}

/// Ranges of items, in their order, none of which overlap.
#[inline]
fn cut_out<T>(
    mut items: &mut [T],
    ranges: impl Iterator<Item = Range<usize>>,
) -> impl Iterator<Item = &mut [T]> {
    let mut begin = 0;
    ranges.map(move |range| {
        let (cut, others) = take(&mut items)[range.start - begin..].split_at_mut(range.len());
        (items, begin) = (others, range.end);
        cut
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Layouts of few, of just enough, and of many balls.
    fn layouts() -> impl Iterator<Item = (usize, Layout)> {
        [0, 1, 40, LEAST - 1, LEAST, LEAST + 1, 5000, 10_000, 33_333].into_iter().map(|n| (n, Layout::of(n)))
    }

    #[test]
    fn every_pair_belongs_to_a_stripe_that_has_both_of_its_balls() {
        for (count, layout) in layouts() {
            for (i, j) in (0..count).flat_map(|i| [1, 7, 100, 900, 1200, 30_000].map(|step| (i, i + step))) {
                if j < count {
                    let number = layout.of_pair(i, j);
                    let range = layout.start(number)..layout.start(number) + layout.count(number, count);
                    assert!(
                        range.contains(&i) && range.contains(&j),
                        "{i} {j} of {count} in {number}: {range:?}"
                    );
                    for body in [i, j] {
                        assert!(layout.of_body(body).any(|its| its == number), "{body} of {count}: {number}");
                    }
                    assert_eq!(number, layout.of_pair(j, i));
                }
            }
        }
    }

    #[test]
    fn stripes_of_a_layer_share_all_balls_in_their_order() {
        for (count, layout) in layouts() {
            let mut bodies: Vec<usize> = (0..count).collect();
            for layer in [Layer::Own, Layer::Seams, Layer::Rest] {
                let read: Vec<Vec<usize>> =
                    layout.share_read(layer, &bodies).map(<[usize]>::to_vec).collect();
                for (number, share) in layout.numbers(layer).zip(&read) {
                    let (start, length) = (layout.start(number), layout.count(number, count));
                    assert!(share.iter().copied().eq(start..start + length), "{count} {number}");
                    assert_eq!(layout.layer(number), layer);
                }
                if layer == Layer::Own || layer == Layer::Rest && layout.is_cut() {
                    assert_eq!(read.concat(), bodies);
                }
                assert_eq!(read.len(), layout.numbers(layer).count(), "{count} {layer:?}");
                assert!(layout.share(layer, &mut bodies).eq(read.iter()), "{count} {layer:?}");
            }
            assert_eq!(layout.numbers(Layer::Own).count(), layout.stripes());
        }
    }

    #[test]
    fn each_seam_is_once_between_two_stripes_that_are_taken_together() {
        for (count, layout) in layouts().filter(|(_, layout)| layout.is_cut()) {
            let mut seams = Vec::new();
            for layer in [Layer::Even, Layer::Odd] {
                let mut bodies: Vec<usize> = (0..count).collect();
                let mut stripes: Vec<usize> = (0..layout.len()).collect();
                let mut own = Vec::new();
                let shares = layout.share(layer, &mut bodies);
                for ((first, numbers), bodies) in layout.share_stripes(layer, &mut stripes).zip(shares) {
                    let last = *numbers.last().unwrap();
                    assert_eq!(first, numbers[0]);
                    let end = layout.start(last) + layout.count(last, count);
                    assert!(bodies.iter().copied().eq(layout.start(first)..end), "{count} {numbers:?}");
                    if let [_, seam, _] = *numbers {
                        assert_eq!(Layout::twos_of_seam(seam), layer);
                        seams.push(seam);
                    }
                    own.extend(numbers.iter().copied().step_by(2));
                }
                assert!(own.into_iter().eq(layout.numbers(Layer::Own)), "{count} {layer:?}");
            }
            seams.sort_unstable();
            assert!(seams.into_iter().eq(layout.numbers(Layer::Seams)), "{count}");
        }
    }

    #[test]
    fn few_balls_are_one_stripe_and_more_are_more() {
        let stripes: Vec<usize> = layouts().map(|(_, layout)| layout.stripes()).collect();
        assert_eq!(stripes[..4], [1; 4]);
        assert!(stripes[4] > 2 && stripes.is_sorted(), "{stripes:?}");
    }
}
