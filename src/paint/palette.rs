//! The colours of a GIF's frame: at most 255 that stand for all that are in it.
//!
//! Colours that differ by less than an eye sees count as one, the one that most pixels have. The most frequent ones
//! stay, and others become the nearest of them, as long as they are near enough and of few pixels; where that leaves
//! too many, how near and how few grows until they fit. So what fills areas keeps its colour to the byte, and edges,
//! text and what fades have steps that hardly show.

use super::ink::Pixel;

/// The most colours of a frame; one more index is needed for pixels that stay as they were.
pub(super) const MOST: usize = 255;
/// Colours that agree in so many bits of red, green and blue count as one.
const BITS: u32 = 6;
/// The squared distance within which a colour may be taken for another, at first: it is doubled until the colours fit.
const NEAR: u32 = 49;
/// What the pixels of such a colour, times their squared distance, may come to: one part in so many of all pixels at
/// first, doubled too. So areas of one colour stay as they are.
const SHARE: u64 = 4;

/// A choice of colours in the making: pixels are counted, then reduced, and then found.
#[derive(Debug)]
pub(super) struct Palette {
    /// For each cell of the colour space, one more than the place of its entry; 0 where it has none.
    places: Vec<u32>,
    entries: Vec<Entry>,
}

/// The pixels of one cell.
#[derive(Debug, Clone, Copy)]
struct Entry {
    cell: usize,
    /// The colour that most of them have, if more than half have the same (the majority vote of Boyer and Moore).
    colour: [u8; 3],
    votes: u32,
    count: u32,
    /// Which colour of the palette stands for them.
    index: u8,
}

impl Default for Palette {
    fn default() -> Self {
        Self { places: vec![0; 1 << (3 * BITS)], entries: Vec::new() }
    }
}

impl Palette {
    /// Counts `count` pixels of one colour.
    pub(super) fn count(&mut self, [red, green, blue, _]: Pixel, count: u32) {
        let colour = [red, green, blue];
        let cell = cell(colour);
        if self.places[cell] == 0 {
            self.entries.push(Entry { cell, colour, votes: count, count, index: 0 });
            self.places[cell] = self.entries.len() as u32;
            return;
        }
        let entry = &mut self.entries[self.places[cell] as usize - 1];
        entry.count += count;
        if entry.colour == colour {
            entry.votes += count;
        } else if entry.votes < count {
            (entry.colour, entry.votes) = (colour, count - entry.votes);
        } else {
            entry.votes -= count;
        }
    }

    /// Chooses the colours for the pixels that were counted, at most [`MOST`].
    pub(super) fn reduce(&mut self) -> Vec<[u8; 3]> {
        // The most frequent first; among equals in a fixed order.
        let mut order: Vec<usize> = (0..self.entries.len()).collect();
        order.sort_unstable_by_key(|&place| (u32::MAX - self.entries[place].count, self.entries[place].cell));
        let total: u64 = self.entries.iter().map(|entry| u64::from(entry.count)).sum();
        let (mut near, mut budget) = (NEAR, total / SHARE);
        loop {
            if let Some(colours) = self.choose(&order, near, budget) {
                return colours;
            }
            (near, budget) = (2 * near, 2 * budget + 1);
        }
    }

    /// Gives each entry the nearest of the colours before it, or makes it one of them where none is `near` enough, or
    /// its pixels are too many for `budget`; `None` where these are too many.
    fn choose(&mut self, order: &[usize], near: u32, budget: u64) -> Option<Vec<[u8; 3]>> {
        let mut colours: Vec<[u8; 3]> = Vec::with_capacity(MOST);
        for &place in order {
            let entry = &mut self.entries[place];
            let nearest = colours.iter().map(|&colour| distance(colour, entry.colour)).enumerate();
            match nearest.min_by_key(|&(_, distance)| distance) {
                Some((index, distance))
                    if distance <= near && u64::from(distance) * u64::from(entry.count) <= budget =>
                {
                    entry.index = index as u8;
                }
                _ if colours.len() == MOST => return None,
                _ => {
                    entry.index = colours.len() as u8;
                    colours.push(entry.colour);
                }
            }
        }
        Some(colours)
    }

    /// Which of the colours stands for a pixel that was counted.
    pub(super) fn find(&self, [red, green, blue, _]: Pixel) -> u8 {
        let place = self.places[cell([red, green, blue])];
        self.entries[place as usize - 1].index
    }

    /// Forgets what was counted.
    pub(super) fn clear(&mut self) {
        for entry in self.entries.drain(..) {
            self.places[entry.cell] = 0;
        }
    }
}

/// The cell of the colour space that a colour is in.
fn cell(colour: [u8; 3]) -> usize {
    colour.iter().fold(0, |cell, &value| cell << BITS | usize::from(value >> (8 - BITS)))
}

fn distance(one: [u8; 3], other: [u8; 3]) -> u32 {
    one.iter().zip(other).map(|(&a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
}
