//! What the figures are taken from: frames that come in, and what is kept of them for rates and the chart.

use std::collections::VecDeque;
use std::time::Duration;

use crate::simulation::grid::Grid;
use crate::simulation::invariants::{kinetic_energy, max_overlap, momentum, potential_energy};
use crate::simulation::{Simulation, Solver, Tally};

use super::panel::{Panel, Room};

/// How long numbers stand at least, s of wall-clock time: long enough to be read.
const STAND: f64 = 0.25;
/// The simulated time that the chart shows, s.
pub(super) const SPAN: f64 = 10.0;
/// Between two points of the chart, simulated s.
const SPACING: f64 = 0.05;
/// In less simulated time than this, s, impacts are not counted per second: where time hardly moves on, as in a jam, a few would
/// be any number of them.
const COUNTED: f64 = 1e-3;

/// A frame as the gauge takes it in.
#[derive(Debug, Clone, Copy)]
pub(in crate::window) struct Frame<'a> {
    /// The scene's name.
    pub(in crate::window) scene: &'a str,
    /// As it is shown in this frame.
    pub(in crate::window) simulation: &'a Simulation,
    /// Simulated seconds per measured second.
    pub(in crate::window) time_scale: f64,
    /// What that comes to where the simulation does not keep up.
    pub(in crate::window) speed: Option<f64>,
    /// Whether time stands still. Every frame has its own figures then.
    pub(in crate::window) paused: bool,
    /// The time since the frame before, s of wall-clock time; 0 where it is not known.
    pub(in crate::window) measured: f64,
    /// The energy that the balls would have if no impact had taken any, mass·px²/s²; none while a hand carries a ball, and nobody
    /// knows.
    pub(in crate::window) given: Option<f64>,
    /// How long it took to advance, to paint and to present the last frame that did all three.
    pub(in crate::window) split: [Duration; 3],
}

/// Keeps of the frames that it is fed what their figures need.
///
/// A quarter of a second of frames of one scene has one set of figures, so that one can read them. Each paused frame in
/// which anything has changed has its own.
#[derive(Debug, Clone, Default)]
pub(in crate::window) struct Gauge {
    /// What has come in since the figures were taken.
    sum: Sum,
    /// The time and the tally of the frame before.
    last: Option<(f64, Tally)>,
    /// The last ten seconds, from the oldest.
    points: VecDeque<Point>,
    figures: Option<Figures>,
    /// The panel as it was painted last, and for which room; none where the figures have changed since.
    pub(super) painted: Option<(Room, Panel)>,
}

/// Energies at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point {
    /// Simulated time, s.
    pub(super) time: f64,
    pub(super) kinetic: f64,
    pub(super) potential: f64,
}

/// What frames come to between two sets of figures.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    frames: u32,
    measured: f64,
    simulated: f64,
    impacts: u64,
    split: [Duration; 3],
}

/// The figures of a frame.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Figures {
    pub(super) scene: String,
    pub(super) solver: Solver,
    pub(super) balls: usize,
    /// Simulated time, s.
    pub(super) time: f64,
    pub(super) time_scale: f64,
    /// What that comes to where the simulation does not keep up.
    pub(super) speed: Option<f64>,
    /// Frames in a second; none while paused.
    pub(super) frame_rate: Option<f64>,
    /// Of a frame, to advance, to paint, to present, ms.
    pub(super) split: [f64; 3],
    /// Impacts in a simulated second, between balls and on walls; none while no time passes.
    pub(super) impact_rate: Option<f64>,
    pub(super) kinetic: f64,
    pub(super) potential: f64,
    /// What impacts have added to the energy, as a fraction of what it would be without: negative where they took some. None where
    /// that is not known.
    pub(super) change: Option<f64>,
    /// The energy that there would be without impacts.
    pub(super) given: Option<f64>,
    pub(super) momentum: [f64; 2],
    /// The deepest overlap of two balls as a fraction of the smaller radius; none where balls do not notice each other.
    pub(super) overlap: Option<f64>,
}

impl Gauge {
    /// Takes in a frame, and the figures where it is time to.
    pub(in crate::window) fn feed(&mut self, frame: &Frame<'_>) {
        let simulation = frame.simulation;
        let (time, tally) = (simulation.time(), simulation.tally());
        let count = |tally: &Tally| tally.impacts + tally.wall_hits;
        let (before, counted) =
            self.last.map_or((time, count(&tally)), |(time, tally)| (time, count(&tally)));
        self.last = Some((time, tally));
        if time < before || count(&tally) < counted {
            // A scene that begins, or goes back: what comes later has not been. Frames have, and figures stand no longer
            // where each goes back.
            self.points.retain(|point| point.time < time);
            (self.sum.simulated, self.sum.impacts) = (0.0, 0);
        } else {
            self.sum.simulated += time - before;
            self.sum.impacts += count(&tally) - counted;
        }
        self.sum.frames += 1;
        self.sum.measured += frame.measured;
        for (sum, part) in self.sum.split.iter_mut().zip(frame.split) {
            *sum += part;
        }
        let other = self.figures.as_ref().is_none_or(|figures| figures.scene != frame.scene);
        let due = other || frame.paused || self.sum.measured >= STAND;
        if due || self.points.back().is_none_or(|last| time >= last.time + SPACING) {
            let point = Point {
                time,
                kinetic: kinetic_energy(simulation.balls()),
                potential: potential_energy(simulation.world(), simulation.balls()),
            };
            self.note(point);
            if due {
                self.take(frame, point);
            }
        }
    }

    /// The figures that stand now.
    pub(super) fn figures(&self) -> Option<&Figures> {
        self.figures.as_ref()
    }

    /// What impacts have added to the energy, where that is known.
    #[cfg(test)]
    pub(in crate::window) fn change(&self) -> Option<f64> {
        self.figures.as_ref()?.change
    }

    /// The energies of the last ten simulated seconds.
    pub(super) fn points(&self) -> impl DoubleEndedIterator<Item = &Point> {
        self.points.iter()
    }

    /// Adds a point to the chart, in place of the last one where that is too near.
    fn note(&mut self, point: Point) {
        if !(point.kinetic + point.potential).is_finite() {
            return;
        }
        // The last point is the present one, until it is far enough from that before.
        let count = self.points.len();
        if count >= 2 && point.time < self.points[count - 2].time + SPACING {
            self.points.pop_back();
        }
        if self.points.back().is_none_or(|last| last.time < point.time) {
            self.points.push_back(point);
        } else if let Some(last) = self.points.back_mut() {
            *last = point;
        }
        while self.points.get(1).is_some_and(|second| second.time < point.time - SPAN) {
            self.points.pop_front();
        }
    }

    /// Takes the figures of a frame, whose energies are known.
    fn take(&mut self, frame: &Frame<'_>, Point { time, kinetic, potential }: Point) {
        let (simulation, sum) = (frame.simulation, std::mem::take(&mut self.sum));
        let (balls, solver) = (simulation.balls(), simulation.solver());
        let before = self.figures.take();
        // A frame of a paused scene that looks as the one before has the same figures: it is the pointer that moved.
        let kept = before.as_ref().filter(|before| {
            frame.paused
                && (before.time, before.kinetic, before.potential) == (time, kinetic, potential)
                && (before.balls, before.solver) == (balls.len(), solver)
        });
        let overlap = match kept {
            Some(before) => before.overlap,
            None => simulation
                .world()
                .pairs()
                .map(|_| max_overlap(&mut Grid::new(balls, simulation.world().size()), balls)),
        };
        let impact_rate = if sum.simulated > 0.0 {
            (sum.simulated >= COUNTED).then(|| sum.impacts as f64 / sum.simulated)
        } else {
            kept.and_then(|before| before.impact_rate)
        };
        let split = sum.split.map(|part| 1e3 * part.as_secs_f64() / f64::from(sum.frames.max(1)));
        let change = frame.given.map(|given| (kinetic + potential - given) / given.abs());
        let figures = Figures {
            scene: frame.scene.to_owned(),
            solver,
            balls: balls.len(),
            time,
            time_scale: frame.time_scale,
            speed: frame.speed.filter(|_| !frame.paused),
            frame_rate: (!frame.paused && sum.measured > 0.0).then(|| f64::from(sum.frames) / sum.measured),
            split: kept.map_or(split, |before| before.split),
            impact_rate,
            kinetic,
            potential,
            change: change.filter(|change| change.is_finite()),
            given: frame.given,
            momentum: momentum(balls).to_array(),
            overlap,
        };
        if before.as_ref() != Some(&figures) {
            self.painted = None;
        }
        self.figures = Some(figures);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use crate::scene::Scene;
    use crate::simulation::{Ball, World};

    use super::*;

    /// A frame of a sixtieth of a second of wall-clock time.
    fn frame(simulation: &Simulation) -> Frame<'_> {
        Frame {
            scene: "test",
            simulation,
            time_scale: 1.0,
            speed: None,
            paused: false,
            measured: 1.0 / 60.0,
            given: Some(1.0),
            split: [1, 2, 3].map(Duration::from_millis),
        }
    }

    #[test]
    fn figures_stand_for_a_quarter_of_a_second_of_frames() {
        let mut simulation = Scene::load("elastic").unwrap().build().unwrap();
        let (mut gauge, mut changes) = (Gauge::default(), 0);
        for _ in 0..120 {
            let before = gauge.figures.clone();
            gauge.feed(&frame(&simulation));
            changes += u32::from(gauge.figures != before);
            simulation.advance(1.0 / 60.0).unwrap();
        }
        assert!((8..=9).contains(&changes), "{changes} sets of figures in two seconds");
        let figures = gauge.figures().unwrap();
        assert!((figures.frame_rate.unwrap() - 60.0).abs() < 1e-6);
        for (part, expected) in figures.split.into_iter().zip([1.0, 2.0, 3.0]) {
            assert!((part - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn another_scene_has_its_own_figures_at_once() {
        let [one, two] = ["elastic", "draw"].map(|name| Scene::load(name).unwrap().build().unwrap());
        let mut gauge = Gauge::default();
        gauge.feed(&frame(&one));
        gauge.feed(&Frame { scene: "another", ..frame(&two) });
        let figures = gauge.figures().unwrap();
        assert_eq!((figures.scene.as_str(), figures.balls), ("another", 1));
    }

    #[test]
    fn figures_go_on_where_time_runs_back() {
        let mut simulation = Scene::load("elastic").unwrap().build().unwrap();
        let mut states = Vec::new();
        for _ in 0..61 {
            states.push(simulation.clone());
            simulation.advance(1.0 / 60.0).unwrap();
        }
        let (mut gauge, mut times) = (Gauge::default(), Vec::new());
        for state in states.iter().rev() {
            gauge.feed(&frame(state));
            times.push(gauge.figures().unwrap().time);
        }
        times.dedup();
        assert!(times.len() >= 4 && times.is_sorted_by(|a, b| a > b), "{times:?}");
        assert_eq!(gauge.figures().unwrap().impact_rate, None);
    }

    #[test]
    fn impacts_are_counted_per_simulated_second_at_any_speed_of_time() {
        // A ball between walls 80 px of its way apart, at 400 px/s: five impacts a second.
        let world = World::new(DVec2::splat(100.0)).unwrap().with_walls(1.0).unwrap();
        let ball =
            Ball::new(DVec2::splat(50.0), 10.0).unwrap().with_velocity(DVec2::new(400.0, 0.0)).unwrap();
        for time_scale in [0.25, 1.0, 4.0] {
            let mut simulation = Simulation::new(world, vec![ball], Solver::Exact).unwrap();
            let mut gauge = Gauge::default();
            let mut rates = Vec::new();
            for _ in 0..600 {
                gauge.feed(&Frame { time_scale, ..frame(&simulation) });
                rates.extend(gauge.figures().and_then(|figures| figures.impact_rate));
                simulation.advance(time_scale / 60.0).unwrap();
            }
            let mean = rates.iter().sum::<f64>() / rates.len() as f64;
            assert!((mean - 5.0).abs() < 0.25, "at {time_scale}: {mean}");
        }
    }

    #[test]
    fn impacts_are_not_counted_where_next_to_no_time_was_simulated() {
        let mut simulation = Scene::load("elastic").unwrap().build().unwrap();
        let mut gauge = Gauge::default();
        for _ in 0..600 {
            simulation.advance(1.0 / 60.0).unwrap();
            gauge.feed(&frame(&simulation));
        }
        assert!(gauge.figures().unwrap().impact_rate.is_some());
        for _ in 0..60 {
            simulation.advance(1e-6).unwrap();
            gauge.feed(&frame(&simulation));
        }
        assert_eq!(gauge.figures().unwrap().impact_rate, None);
    }

    #[test]
    fn the_change_is_what_impacts_took_of_the_energy_that_was_given() {
        let simulation = Scene::load("gravity").unwrap().build().unwrap();
        let energy =
            kinetic_energy(simulation.balls()) + potential_energy(simulation.world(), simulation.balls());
        for (given, change) in [
            (Some(energy), Some(0.0)),
            (Some(2.0 * energy), Some(-0.5)),
            (Some(0.0), None),
            (Some(f64::NAN), None),
            (None, None),
        ] {
            let mut gauge = Gauge::default();
            gauge.feed(&Frame { given, ..frame(&simulation) });
            assert_eq!(gauge.figures().unwrap().change, change, "{given:?}");
        }
    }

    #[test]
    fn the_chart_keeps_ten_seconds_and_few_points_and_forgets_what_has_not_been() {
        let mut simulation = Scene::load("elastic").unwrap().build().unwrap();
        let mut gauge = Gauge::default();
        for _ in 0..3000 {
            gauge.feed(&frame(&simulation));
            simulation.advance(1.0 / 200.0).unwrap();
        }
        let times: Vec<f64> = gauge.points().map(|point| point.time).collect();
        assert!(times.is_sorted_by(|a, b| a < b));
        let span = times[times.len() - 1] - times[0];
        assert!((SPAN..SPAN + 0.2).contains(&span), "{span}");
        assert!(times.len() <= 2 * (SPAN / SPACING) as usize, "{}", times.len());
        let begun = Scene::load("elastic").unwrap().build().unwrap();
        gauge.feed(&frame(&begun));
        assert!(gauge.points().all(|point| point.time == 0.0), "a reset begins a new chart");
    }

    /// The same while paused.
    fn paused(simulation: &Simulation) -> Frame<'_> {
        Frame { paused: true, measured: 0.0, ..frame(simulation) }
    }

    #[test]
    fn each_paused_step_has_its_own_figures_and_a_frame_that_shows_nothing_new_keeps_them() {
        let mut simulation = Scene::load("gravity").unwrap().build().unwrap();
        let mut gauge = Gauge::default();
        for _ in 0..3 {
            simulation.advance(1.0 / 60.0).unwrap();
            gauge.feed(&paused(&simulation));
            let figures = gauge.figures().unwrap().clone();
            assert_eq!(figures.time, simulation.time());
            assert_eq!(figures.frame_rate, None);
            gauge.feed(&Frame { split: [Duration::from_secs(1); 3], ..paused(&simulation) });
            assert_eq!(gauge.figures(), Some(&figures));
        }
    }

    #[test]
    fn balls_that_do_not_notice_each_other_have_no_overlap_and_others_the_largest() {
        for (scene, known) in [("two", false), ("detect", true)] {
            let simulation = Scene::load(scene).unwrap().build().unwrap();
            let mut gauge = Gauge::default();
            gauge.feed(&frame(&simulation));
            assert_eq!(gauge.figures().unwrap().overlap.is_some(), known, "{scene}");
        }
    }
}
