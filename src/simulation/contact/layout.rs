//! Bodies in stripes: runs of neighbours that are worked on by themselves, so that several threads share a substep.
//!
//! Bodies stand in the order of their places, along columns where gravity pulls down, so a stripe is a range of them.
//! Pairs within a stripe belong to it. Those across its edge belong to the *seam* there, the halves of the stripes on
//! both sides; the few that span more, those of a ball larger than a stripe, to the *rest*. First all stripes are
//! worked on, each by itself, then all seams, then the rest. How many stripes there are depends on the balls alone, so
//! the order, and with it every bit of the result, is the same for any number of threads.

use std::ops::Range;

/// Fewer balls are one stripe: threads would cost more than they save.
const LEAST: usize = 2048;
/// A stripe is about so many balls wide, at least: few of its balls lie at an edge, and a core's cache takes it.
const WIDTH: f64 = 10.0;

/// Which stripes there are, and which numbers they have: the stripes, the seams before and behind each, the rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    /// Half a stripe is 2 to this power bodies long.
    shift: u32,
    /// How many there are, seams and the rest not counted.
    own: usize,
}

/// Stripes that share no body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Layer {
    Own,
    Seams,
    Rest,
}

impl Layer {
    /// Stripes first.
    pub(super) const OUTWARD: &'static [Self] = &[Self::Own, Self::Seams, Self::Rest];
    /// Stripes last.
    pub(super) const INWARD: &'static [Self] = &[Self::Rest, Self::Seams, Self::Own];
    /// What lies across edges before and after what lies between them.
    pub(super) const AROUND: &'static [Self] = &[Self::Rest, Self::Seams, Self::Own, Self::Seams, Self::Rest];

    /// The layer of a pair that shares a stripe, and a seam.
    pub(super) fn of((own, seam): (bool, bool)) -> Self {
        match (own, seam) {
            (true, _) => Self::Own,
            (_, true) => Self::Seams,
            _ => Self::Rest,
        }
    }
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
        if self.is_cut() { 2 * self.own + 2 } else { 1 }
    }

    /// The stripe of a body, its seam and the rest.
    #[inline]
    pub(super) fn of_body(self, body: usize) -> impl Iterator<Item = usize> + use<> {
        let numbers = [Layer::Own, Layer::Seams, Layer::Rest].map(|layer| self.number(body, layer));
        numbers.into_iter().take(if self.is_cut() { 3 } else { 1 })
    }

    /// The stripe of a body.
    #[inline]
    pub(super) fn own_of(self, body: usize) -> usize {
        body >> (self.shift + 1)
    }

    /// Whether two bodies share a stripe, and a seam.
    #[inline]
    pub(super) fn shared(self, one: usize, other: usize) -> (bool, bool) {
        let (one, other) = (one >> self.shift, other >> self.shift);
        (one >> 1 == other >> 1, (one + 1) >> 1 == (other + 1) >> 1)
    }

    /// The number of the stripe that a pair belongs to by itself.
    #[inline]
    pub(super) fn of_pair(self, one: usize, other: usize) -> usize {
        self.number(one, Layer::of(self.shared(one, other)))
    }

    /// The number of the one of a body's stripes that is within this layer.
    #[inline]
    pub(super) fn number(self, body: usize, layer: Layer) -> usize {
        match layer {
            Layer::Own => self.own_of(body),
            Layer::Seams => self.own + (body >> self.shift).div_ceil(2),
            Layer::Rest => 2 * self.own + 1,
        }
    }

    /// The numbers of the stripes of a layer.
    pub(super) fn numbers(self, layer: Layer) -> Range<usize> {
        match layer {
            Layer::Own => 0..self.own,
            // One stripe alone has no edges.
            _ if !self.is_cut() => 1..1,
            Layer::Seams => self.own..2 * self.own + 1,
            Layer::Rest => 2 * self.own + 1..self.len(),
        }
    }

    /// The first body of a stripe.
    #[inline]
    pub(super) fn start(self, number: usize) -> usize {
        if number < self.own {
            // Nothing is shifted out where all are one stripe.
            number << (self.shift + 1)
        } else if number <= 2 * self.own {
            (2 * (number - self.own)).saturating_sub(1) << self.shift
        } else {
            0
        }
    }

    /// How many of `all` bodies a stripe has.
    pub(super) fn count(self, number: usize, all: usize) -> usize {
        let left = all.saturating_sub(self.start(number));
        if number > 2 * self.own {
            left
        } else if number == self.own && self.is_cut() {
            left.min(1 << self.shift)
        } else {
            left.min(2 << self.shift)
        }
    }

    /// Items, one a body, as the stripes of a layer have them.
    pub(super) fn share<T>(
        self,
        layer: Layer,
        items: &mut [T],
    ) -> impl Iterator<Item = &mut [T]> + use<'_, T> {
        let (first, length) = self.first_and_length(layer, items.len());
        let (first, others) = items.split_at_mut(first);
        let none_first = first.is_empty();
        std::iter::once(first).skip(usize::from(none_first)).chain(others.chunks_mut(length))
    }

    /// The same for items that are only read.
    pub(super) fn share_read<T>(self, layer: Layer, items: &[T]) -> impl Iterator<Item = &[T]> + use<'_, T> {
        let (first, length) = self.first_and_length(layer, items.len());
        let (first, others) = items.split_at(first);
        let none_first = first.is_empty();
        std::iter::once(first).skip(usize::from(none_first)).chain(others.chunks(length))
    }

    /// How many of so many bodies the first stripe of a layer has where that is not as many as in others, and those.
    fn first_and_length(self, layer: Layer, count: usize) -> (usize, usize) {
        let length = 2 << self.shift;
        match layer {
            Layer::Own => (0, length),
            Layer::Seams => (count.min(1 << self.shift), length),
            Layer::Rest => (0, count.max(1)),
        }
    }
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
                if layer != Layer::Own && !layout.is_cut() {
                    continue;
                }
                let read: Vec<Vec<usize>> =
                    layout.share_read(layer, &bodies).map(<[usize]>::to_vec).collect();
                assert_eq!(read.concat(), bodies);
                for (number, share) in layout.numbers(layer).zip(&read) {
                    assert_eq!((share[0], share.len()), (layout.start(number), layout.count(number, count)));
                }
                assert!(read.len() <= layout.numbers(layer).len(), "{count} {layer:?}");
                assert!(layout.share(layer, &mut bodies).eq(read.iter()), "{count} {layer:?}");
            }
        }
    }

    #[test]
    fn few_balls_are_one_stripe_and_more_are_more() {
        let stripes: Vec<usize> = layouts().map(|(_, layout)| layout.numbers(Layer::Own).len()).collect();
        assert_eq!(stripes[..4], [1; 4]);
        assert!(stripes[4] > 2 && stripes.is_sorted(), "{stripes:?}");
    }
}
