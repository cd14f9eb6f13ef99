//! Many discs: the picture in bands of rows, painted on as many cores as pay.

use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread;

use super::disc::Disc;
use super::ink::Pixel;
use super::shapes::Shapes;
use super::target::{Area, Target};

/// From about this long on, ns, a picture is painted on more than one core. To start a thread takes 0.03 ms, and a core
/// that others use, too, may be late by much more.
const WORTH_THREADS: u64 = 1_000_000;
/// More cores than this wait for memory and for what one of them prepares.
const MOST_THREADS: usize = 8;
/// Bands for each core, so that one which is held up leaves some of its work to others.
const BANDS_PER_THREAD: usize = 2;

/// Pixels that are cleared in a nanosecond.
const CLEARED: u64 = 8;

/// Whether painting these discs, and clearing so many pixels before, takes long enough for more than one core.
fn is_worth_threads(discs: &[Disc], pixels: usize) -> bool {
    let mut cost = pixels as u64 / CLEARED;
    for disc in discs {
        if cost > WORTH_THREADS {
            break;
        }
        cost += disc.cost();
    }
    cost > WORTH_THREADS
}

/// Which discs reach into which band; kept from picture to picture.
#[derive(Debug, Default)]
pub(super) struct Bands {
    bands: Vec<Band>,
    /// What it takes to paint the discs in the middle of each row.
    costs: Vec<u64>,
}

#[derive(Debug, Default)]
struct Band {
    /// Its first row, and the one after its last.
    top: usize,
    bottom: usize,
    /// Its discs, in their order.
    discs: Vec<u32>,
}

impl Bands {
    /// Paints the background and the discs, which have been prepared, on as many cores as pay.
    pub(super) fn paint(&mut self, discs: &[Disc], shapes: &Shapes, pixels: &mut [Pixel], width: usize) {
        let threads = if is_worth_threads(discs, pixels.len()) { cores().min(MOST_THREADS) } else { 1 };
        self.paint_on(threads, discs, shapes, pixels, width);
    }

    /// Paints on so many threads: the same bytes, whatever their number.
    pub(super) fn paint_on(
        &mut self,
        threads: usize,
        discs: &[Disc],
        shapes: &Shapes,
        pixels: &mut [Pixel],
        width: usize,
    ) {
        if threads < 2 {
            return shapes.paint(discs.iter(), Target::rows(pixels, width, 0));
        }
        self.divide(discs, (width, pixels.len() / width), threads * BANDS_PER_THREAD);
        self.list(discs);
        let mut rest = pixels;
        let bands = self.bands.iter().map(|band| {
            let (rows, others) = std::mem::take(&mut rest).split_at_mut((band.bottom - band.top) * width);
            rest = others;
            (band, rows)
        });
        let bands = Mutex::new(bands.collect::<Vec<_>>().into_iter());
        let work = || {
            loop {
                let next = bands.lock().unwrap_or_else(PoisonError::into_inner).next();
                let Some((band, rows)) = next else { break };
                let discs = band.discs.iter().map(|&index| &discs[index as usize]);
                shapes.paint(discs, Target::rows(rows, width, band.top as i32));
            }
        };
        thread::scope(|scope| {
            // Where the system gives no more threads, those that there are do the work.
            for _ in 1..threads {
                if thread::Builder::new().spawn_scoped(scope, work).is_err() {
                    break;
                }
            }
            work();
        });
    }

    /// Divides the rows into so many bands, which take about the same time.
    fn divide(&mut self, discs: &[Disc], (width, height): (usize, usize), count: usize) {
        self.costs.clear();
        self.costs.resize(height, width as u64 / CLEARED);
        for disc in discs {
            let row = disc.centre.y.clamp(0.0, (height - 1) as f64) as usize;
            self.costs[row] += disc.cost();
        }
        let all: u64 = self.costs.iter().sum();
        self.bands.resize_with(count, Band::default);
        let (mut rows, mut cost, mut top) = (self.costs.iter().enumerate(), 0, 0);
        for (band, part) in self.bands.iter_mut().zip(1..) {
            let until = all * part / count as u64;
            let end = rows.find(|&(_, row)| {
                cost += row;
                cost >= until
            });
            let bottom = end.map_or(height, |(row, _)| row + 1);
            (band.top, band.bottom) = (top, bottom);
            top = bottom;
        }
    }

    /// Lists each band's discs.
    fn list(&mut self, discs: &[Disc]) {
        self.bands.iter_mut().for_each(|band| band.discs.clear());
        for (index, disc) in (0..).zip(discs) {
            let Area { top, bottom, .. } = disc.area();
            for band in &mut self.bands {
                if top < band.bottom as i32 && (band.top as i32) < bottom {
                    band.discs.push(index);
                }
            }
        }
    }
}

/// The number of cores, which takes files to read to find out.
fn cores() -> usize {
    static CORES: OnceLock<usize> = OnceLock::new();
    *CORES.get_or_init(|| thread::available_parallelism().map_or(1, usize::from))
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::{BALL, CONTACT};
    use super::*;

    const WIDTH: usize = 300;
    const HEIGHT: usize = 200;

    /// Discs of all sizes, some of them cut off, in places that look random.
    fn discs(count: u32) -> Vec<Disc> {
        let part = |index: u32, factor: f64| (f64::from(index + 1) * factor).fract();
        let disc = |index| Disc {
            centre: DVec2::new(part(index, 0.618_034), part(index, 0.754_878)) * DVec2::new(340.0, 240.0)
                - 20.0,
            radius: 0.5 + 30.0 * part(index, 0.569_84).powi(3),
            colour: if index % 3 == 0 { CONTACT } else { BALL },
        };
        (0..count)
            .map(disc)
            .chain(
                [Disc { centre: DVec2::splat(90.0), radius: 1e6, ..disc(0) }]
                    .into_iter()
                    .take((count % 2) as usize),
            )
            .collect()
    }

    fn painted(threads: usize, discs: &[Disc], bands: &mut Bands) -> Vec<Pixel> {
        let mut shapes = Shapes::default();
        for disc in discs {
            shapes.prepare(disc);
        }
        let mut pixels = vec![[0; 4]; WIDTH * HEIGHT];
        bands.paint_on(threads, discs, &shapes, &mut pixels, WIDTH);
        pixels
    }

    #[test]
    fn bands_on_any_number_of_threads_are_one_picture_to_the_bit() {
        let mut bands = Bands::default();
        for count in [0, 1, 30, 401, 3000] {
            let discs = discs(count);
            let one = painted(1, &discs, &mut bands);
            for threads in [2, 3, 5, 150] {
                assert_eq!(painted(threads, &discs, &mut bands), one, "{count} discs, {threads} threads");
            }
        }
    }

    #[test]
    fn a_later_disc_lies_over_an_earlier_one() {
        for radius in [3.0, 30.0] {
            let discs = [BALL, CONTACT].map(|colour| Disc {
                centre: DVec2::new(f64::from(colour.0) / 100.0 + 70.0, 80.0),
                radius,
                colour,
            });
            for [first, second] in [discs, [discs[1], discs[0]]] {
                let pixels = painted(1, &[first, second], &mut Bands::default());
                let between = pixels[80 * WIDTH + 71];
                assert_eq!(between[..3], [second.colour.0, second.colour.1, second.colour.2], "r {radius}");
            }
        }
    }

    #[test]
    fn bands_take_all_rows_once_and_about_the_same_time() {
        let mut bands = Bands::default();
        let heap: Vec<Disc> = discs(4000)
            .into_iter()
            .map(|disc| Disc { centre: disc.centre * DVec2::new(1.0, 0.1) + DVec2::new(0.0, 170.0), ..disc })
            .collect();
        bands.divide(&heap, (WIDTH, HEIGHT), 4);
        let ends: Vec<_> = bands.bands.iter().map(|band| (band.top, band.bottom)).collect();
        assert_eq!((ends[0].0, ends[3].1), (0, HEIGHT));
        assert!(ends.windows(2).all(|pair| pair[0].1 == pair[1].0));
        let all: u64 = bands.costs.iter().sum();
        for (top, bottom) in ends {
            let part = bands.costs[top..bottom].iter().sum::<u64>() as f64 / all as f64;
            assert!((0.1..0.4).contains(&part), "rows {top} to {bottom}: {part}");
        }
    }

    #[test]
    fn few_balls_are_painted_on_one_core_and_many_or_wide_pictures_on_all() {
        const WINDOW: usize = 1280 * 720;
        let discs = |count, radius| vec![Disc { centre: DVec2::ZERO, radius, colour: BALL }; count];
        assert!(!is_worth_threads(&discs(15, 30.0), WINDOW));
        assert!(!is_worth_threads(&discs(15, 60.0), WINDOW));
        assert!(is_worth_threads(&discs(100_000, 3.0), WINDOW));
        assert!(is_worth_threads(&[], 11_000 * 11_000));
    }
}
