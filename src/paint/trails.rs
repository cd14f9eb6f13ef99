//! Where balls went in the last second, fading.

use glam::DVec2;
use tiny_skia::PixmapMut;

use super::ink::Pixel;
use super::strokes::line;
use super::{BACKGROUND, BALL, CONTACT, Colour};
use crate::simulation::Simulation;

/// A trail fades to 1/e in this simulated time, s.
const FADES: f64 = 0.55;
/// It fades in steps of this simulated time, s, whatever the frames.
const TICK: f64 = 1.0 / 30.0;
/// After so many steps nothing is left: each takes at least one of 255 levels from what is fainter than 1/e of them.
const GONE: u64 = 100;
/// What is left by a step of fading is counted in parts of this: as fine as products of 16 bits allow.
const WHOLE: i16 = 128;
/// Pixels that are faded together.
const LANES: usize = 8;
/// How bright a trail begins, beside its ball, from 0 to 1.
const BRIGHT: f64 = 0.6;
/// The width of its line, px of the world.
const WIDTH: f64 = 1.5;
/// A ball that moved farther than so many times what its speed allows ...
const JUMP: f64 = 2.0;
/// ... and so many px more has not flown there.
const LEAST_JUMP: f64 = 4.0;

const BLANK: Pixel = [BACKGROUND.0, BACKGROUND.1, BACKGROUND.2, 255];

/// Trails of all balls, as a picture that fades and to which each frame adds a piece of line for each ball.
#[derive(Debug, Default)]
pub(crate) struct Trails {
    pixels: Vec<Pixel>,
    size: (u32, u32),
    scale: f64,
    /// Where each ball was last, px of the picture.
    last: Vec<DVec2>,
    /// The simulated time of that, s.
    time: f64,
    /// Simulated time since the last step of fading, s.
    due: f64,
    /// Steps since anything was added.
    still: u64,
}

impl Trails {
    /// Follows the balls to where they are now, in a picture of `size` px with `scale` pixels per px of the world. What
    /// has not flown there, or in time that went back, begins anew.
    pub(crate) fn follow(&mut self, simulation: &Simulation, scale: f64, size: (u32, u32)) {
        let time = simulation.time();
        if (self.size, self.scale) != (size, scale) || time < self.time {
            let count = size.0 as usize * size.1 as usize;
            *self = Self { pixels: vec![BLANK; count], size, scale, still: GONE, ..Self::default() };
            self.begin(simulation);
        }
        let passed = time - self.time;
        self.due += passed;
        let ticks = (self.due / TICK).floor();
        self.due -= ticks * TICK;
        self.fade(ticks as u64);
        if passed > 0.0 && simulation.balls().len() >= self.last.len() {
            self.add(simulation, passed);
        }
        self.begin(simulation);
    }

    /// Goes on from where the balls are.
    fn begin(&mut self, simulation: &Simulation) {
        self.last.clear();
        self.last.extend(simulation.balls().iter().map(|ball| ball.position() * self.scale));
        self.time = simulation.time();
    }

    /// Fades by so many steps.
    fn fade(&mut self, ticks: u64) {
        if ticks == 0 || self.still >= GONE {
            return;
        }
        self.still += ticks;
        let part = (f64::from(WHOLE) * (-(ticks as f64) * TICK / FADES).exp()) as i16;
        // In blocks, which compilers turn into vector instructions; all products fit 16 bits.
        let blank: [i16; 4 * LANES] = std::array::from_fn(|byte| BLANK[byte % 4].into());
        let (blocks, rest) = self.pixels.as_chunks_mut::<LANES>();
        let fade = |value: &mut u8, blank: i16| {
            // The division truncates towards the background, so that nothing is left for ever.
            *value = (blank + (i16::from(*value) - blank) * part / WHOLE) as u8;
        };
        for block in blocks {
            block.as_flattened_mut().iter_mut().zip(blank).for_each(|(value, blank)| fade(value, blank));
        }
        rest.as_flattened_mut().iter_mut().zip(blank).for_each(|(value, blank)| fade(value, blank));
    }

    /// Adds a piece of line for each ball that has moved.
    fn add(&mut self, simulation: &Simulation, passed: f64) {
        let gravity = simulation.world().gravity().unwrap_or_default().length();
        let balls = simulation.balls().iter().zip(simulation.touching());
        for ((ball, &touching), &from) in balls.zip(&self.last) {
            let to = ball.position() * self.scale;
            let reach = JUMP * (ball.velocity().length() + gravity * passed) * passed + LEAST_JUMP;
            if from == to || from.distance(to) > reach * self.scale {
                continue;
            }
            let ink = if touching { CONTACT } else { BALL };
            let pixels = &mut self.pixels;
            line(self.size, (from, to), WIDTH * self.scale, |index, _, coverage| {
                add(&mut pixels[index], ink, BRIGHT * coverage);
            });
            self.still = 0;
        }
    }

    /// Paints the trails where a picture shows nothing but background: behind the balls.
    pub(crate) fn paint(&self, pixmap: &mut PixmapMut<'_>) {
        if self.still >= GONE || (pixmap.width(), pixmap.height()) != self.size {
            return;
        }
        let (pixels, _) = pixmap.data_mut().as_chunks_mut();
        let blank = u32::from_ne_bytes(BLANK);
        for (pixel, &trail) in pixels.iter_mut().zip(&self.pixels) {
            *pixel = if u32::from_ne_bytes(*pixel) == blank { trail } else { *pixel };
        }
    }
}

/// Makes a pixel at least as much `ink` as this part says. What has more of it keeps that, so that pieces of one line
/// do not show where they meet.
fn add(pixel: &mut Pixel, Colour(red, green, blue): Colour, part: f64) {
    for ((value, blank), ink) in pixel.iter_mut().zip(BLANK).zip([red, green, blue]) {
        let mixed = (f64::from(blank) + part * (f64::from(ink) - f64::from(blank))).round() as u8;
        *value = if ink > blank { mixed.max(*value) } else { mixed.min(*value) };
    }
}

#[cfg(test)]
mod tests {
    use tiny_skia::Pixmap;

    use super::*;
    use crate::simulation::{Ball, Solver, World};

    const SIZE: (u32, u32) = (300, 100);

    fn flying(speed: f64) -> Simulation {
        let ball = Ball::new(DVec2::new(20.0, 50.0), 5.0).unwrap();
        let ball = ball.with_velocity(DVec2::new(speed, 0.0)).unwrap();
        Simulation::new(World::new(DVec2::new(300.0, 100.0)).unwrap(), vec![ball], Solver::Canvas).unwrap()
    }

    /// How much of the trails' colour there is along the ball's line.
    fn profile(trails: &Trails) -> Vec<i32> {
        let row = &trails.pixels[50 * SIZE.0 as usize..51 * SIZE.0 as usize];
        row.iter().map(|pixel| i32::from(pixel[1]) - i32::from(BACKGROUND.1)).collect()
    }

    fn run(frames: u32, rate: f64) -> (Trails, Simulation) {
        let (mut trails, mut simulation) = (Trails::default(), flying(200.0));
        trails.follow(&simulation, 1.0, SIZE);
        for _ in 0..frames {
            simulation.advance(1.0 / rate).unwrap();
            trails.follow(&simulation, 1.0, SIZE);
        }
        (trails, simulation)
    }

    #[test]
    fn a_trail_is_a_line_that_grows_fainter_backwards() {
        let (trails, _) = run(60, 60.0);
        let profile = profile(&trails);
        assert!(profile[30..215].windows(2).all(|pair| pair[0] <= pair[1] + 1), "{profile:?}");
        assert!(profile[215] > 90 && (1..30).contains(&profile[30]), "{profile:?}");
        assert!(profile[240..].iter().all(|&level| level == 0));
    }

    #[test]
    fn trails_look_alike_at_any_frame_rate() {
        let expected = profile(&run(60, 60.0).0);
        for (frames, rate) in [(30, 30.0), (144, 144.0), (1000, 1000.0)] {
            let profile = profile(&run(frames, rate).0);
            let apart = profile.iter().zip(&expected).map(|(a, b)| (a - b).abs()).max().unwrap();
            assert!(apart <= 14, "{rate} frames a second: {apart} of 137 levels");
        }
    }

    #[test]
    fn nothing_is_left_of_a_trail_for_ever() {
        let (mut trails, _) = run(60, 60.0);
        trails.fade(1);
        for _ in 0..GONE {
            trails.fade(1);
        }
        assert!(trails.pixels.iter().all(|&pixel| pixel == BLANK));
    }

    #[test]
    fn what_jumps_goes_back_or_is_seen_at_another_size_leaves_no_line() {
        let (mut trails, mut simulation) = run(10, 60.0);
        simulation.set_position(0, DVec2::new(250.0, 90.0)).unwrap();
        simulation.advance(1.0 / 60.0).unwrap();
        trails.follow(&simulation, 1.0, SIZE);
        assert!(profile(&trails)[60..].iter().all(|&level| level == 0));
        let earlier = flying(200.0);
        trails.follow(&earlier, 1.0, SIZE);
        assert!(trails.pixels.iter().all(|&pixel| pixel == BLANK));
        let (mut trails, simulation) = run(10, 60.0);
        trails.follow(&simulation, 2.0, (600, 200));
        assert!(trails.pixels.len() == 120_000 && trails.pixels.iter().all(|&pixel| pixel == BLANK));
    }

    #[test]
    fn trails_lie_behind_balls() {
        let (trails, simulation) = run(60, 60.0);
        let mut picture = Pixmap::new(SIZE.0, SIZE.1).unwrap();
        super::super::paint(&simulation, 1.0, &mut picture.as_mut());
        trails.paint(&mut picture.as_mut());
        let green = |x, y| picture.pixel(x, y).unwrap().green();
        assert_eq!((green(220, 50), green(250, 50)), (BALL.1, BACKGROUND.1));
        assert!((100..BALL.1).contains(&green(205, 50)), "{}", green(205, 50));
    }
}
