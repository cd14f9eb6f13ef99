//! A pile, measured by what is wrong with it once it lies: how deep its balls are in each other, and how much they
//! move.

use super::chart::{Figure, Panel, given_up};
use super::document::{Csv, Section, Table, duration, rounded};
use super::problems::Unposed;
use super::setting::{GivenUp, LOOKS, Setting};
use super::{Context, ReportError};
use crate::scene::Scene;
use crate::simulation::grid::Grid;
use crate::simulation::{Ball, Simulation, World};

/// How many balls.
const COUNT: usize = 300;
/// How long they fall and settle, s.
const SECONDS: f64 = 6.0;
/// The last so many looks are those of the settled pile: a second.
const SETTLED: u32 = LOOKS;

/// A settled pile.
#[derive(Debug, Clone, Copy)]
struct Rest {
    /// Overlaps in radii of the smaller ball: the mean of those that touch, and the largest.
    mean_overlap: f64,
    most_overlap: f64,
    /// The root mean square of speeds, px/s.
    speed: f64,
    /// The run time, s.
    seconds: f64,
}

/// The balls above the floor, from where they fall.
fn start() -> Result<(World, Vec<Ball>), Unposed> {
    let wrong = |error: crate::SceneError| Unposed::Scene(error.to_string());
    // Balls of radius 3 to 6, whose squares have a mean of 21, cover half of a 16:9 box.
    let area = COUNT as f64 * std::f64::consts::PI * 21.0 * 2.0;
    let (width, height) = ((area * 16.0 / 9.0).sqrt().round(), (area * 9.0 / 16.0).sqrt().round());
    let text = format!(
        "size = [{width}, {height}]\ngravity = [0, 980]\n[walls]\nrestitution = 0.7\n[pairs]\n[[fill]]\n\
         count = {COUNT}\nradius = [3, 6]\nrestitution = 0.7\n"
    );
    let simulation = Scene::parse("pile", &text).map_err(wrong)?.build().map_err(wrong)?;
    Ok((*simulation.world(), simulation.balls().to_vec()))
}

/// The mean and the largest overlap of pairs that touch.
fn overlaps(grid: &mut Grid, simulation: &Simulation) -> (f64, f64) {
    let balls = simulation.balls();
    let (mut sum, mut most, mut count) = (0.0, 0.0_f64, 0_u32);
    grid.for_each(balls, |i, j| {
        let (a, b) = (&balls[i as usize], &balls[j as usize]);
        let depth = a.radius() + b.radius() - a.position().distance(b.position());
        let depth = depth / a.radius().min(b.radius());
        sum += depth;
        most = most.max(depth);
        count += 1;
    });
    (sum / f64::from(count.max(1)), most)
}

fn measure(world: &World, balls: &[Ball], setting: Setting, context: &Context) -> Result<Rest, GivenUp> {
    let mut grid = Grid::new(balls, world.size());
    let (mut means, mut squares, mut most) = (Vec::new(), Vec::new(), 0.0_f64);
    let begin = SECONDS - f64::from(SETTLED) / f64::from(LOOKS);
    setting.watch(world, balls, SECONDS, context.effort.limit, |time, simulation| {
        if time > begin {
            let (mean, deepest) = overlaps(&mut grid, simulation);
            means.push(mean);
            most = most.max(deepest);
            squares.extend(simulation.balls().iter().map(|ball| ball.velocity().length_squared()));
        }
    })?;
    let seconds = setting.time(world, balls, SECONDS, context.effort.limit)?;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    Ok(Rest { mean_overlap: mean(&means), most_overlap: most, speed: mean(&squares).sqrt(), seconds })
}

/// The settings that are run.
fn settings(quick: bool) -> Vec<Setting> {
    let all = Setting::all(quick).into_iter();
    all.filter(|setting| match setting {
        Setting::Frames(_) | Setting::OwnSubsteps => true,
        Setting::Substeps(rate) => *rate <= 1920,
        Setting::RestSpeed(speed) => *speed >= 1.0,
    })
    .collect()
}

/// How many steps of the progress bar this takes.
pub(super) fn steps(quick: bool) -> usize {
    settings(quick).len()
}

/// The section of the report.
pub(super) fn section(context: &mut Context) -> Result<Section, ReportError> {
    let (world, balls) = start()?;
    let mut section = Section::default();
    section.heading("A pile, by what is wrong with it");
    section.say(format!(
        "{COUNT} balls of radius 3 to 6 px, e = 0.7, fall into a box and lie on each other; in the last second of {SECONDS} \
         their overlaps (in radii of the smaller ball, the mean over pairs that touch, and the largest) and their speeds \
         (root mean square) should be nothing. The run time is that of one run. No overlap and no motion at all are drawn \
         as 10⁻¹².",
    ));
    let mut csv =
        Csv::new("solver,quantity,setting,mean_overlap,most_overlap,rms_speed_px_per_s,seconds,outcome");
    let mut table = Table::new(&["solver", "setting", "mean overlap", "largest", "speed, px/s", "run time"]);
    let mut found = Vec::new();
    for setting in settings(context.quick) {
        context.progress.step("pile");
        let (solver, quantity, size) = (setting.solver(), setting.quantity(), setting.written_size());
        match measure(&world, &balls, setting, context) {
            Ok(rest) => {
                let Rest { mean_overlap, most_overlap, speed, seconds } = rest;
                let mut cells = vec![solver.to_string(), setting.to_string()];
                cells.extend([
                    rounded(mean_overlap),
                    rounded(most_overlap),
                    rounded(speed),
                    duration(seconds),
                ]);
                table.row(cells);
                csv.row(&[
                    &solver,
                    &quantity,
                    &size,
                    &mean_overlap,
                    &most_overlap,
                    &speed,
                    &seconds,
                    &"done",
                ]);
                found.push((setting, rest));
            }
            Err(why) => {
                table.row(vec![
                    solver.to_string(),
                    setting.to_string(),
                    format!("given up: {why}"),
                    "–".to_owned(),
                    "–".to_owned(),
                    "–".to_owned(),
                ]);
                csv.row(&[&solver, &quantity, &size, &"", &"", &"", &"", &why]);
                section.failures.push(format!("pile: `{solver}` with {setting}: {why}."));
            }
        }
    }
    section.say(table.markdown());
    let used = found.iter().filter(|(setting, _)| setting.is_default());
    section.in_short.extend(used.map(|(setting, rest)| {
        let (overlap, time) = (rounded(rest.most_overlap), duration(rest.seconds));
        format!(
            "Balls of a settled pile of {COUNT} overlap by up to {overlap} radii with `{}`, which takes {time} for {SECONDS} s.",
            setting.solver()
        )
    }));
    let figure = figure(&found, &settings(context.quick));
    section.picture(
        &figure.name,
        "A settled pile: its largest overlap, and its residual motion, against run time.",
    );
    section.files.extend(figure.files()?);
    section.files.push(csv.file("pile.csv"));
    Ok(section)
}

fn figure(found: &[(Setting, Rest)], tried: &[Setting]) -> Figure {
    let note = given_up(|solver| {
        let own = |setting: &Setting| setting.solver() == solver;
        let count = tried.iter().filter(|setting| own(setting)).count();
        count - found.iter().filter(|(setting, _)| own(setting)).count()
    });
    let panel = |title: &str, label: &'static str, value: fn(&Rest) -> f64| {
        Panel::of_solvers(title, label, note.clone(), |solver| {
            let own = found.iter().filter(|(setting, _)| setting.solver() == solver);
            let dot = |(setting, rest): &(Setting, Rest)| setting.dot(rest.seconds, value(rest).max(1e-12));
            own.map(dot).collect()
        })
    };
    let panels = vec![
        panel("A settled pile: overlap", "largest overlap, radii", |rest| rest.most_overlap),
        panel("A settled pile: motion", "speed, px/s (rms)", |rest| rest.speed),
    ];
    Figure { name: "pile".to_owned(), columns: 2, panels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::Solver;

    #[test]
    fn contact_holds_a_pile_that_canvas_lets_sink() {
        let (world, balls) = start().unwrap();
        let measured = |setting| {
            measure(
                &world,
                &balls,
                setting,
                &Context { effort: super::super::Effort::full(), ..Context::quick() },
            )
            .unwrap()
        };
        let (contact, canvas) =
            (measured(Setting::default_of(Solver::Contact)), measured(Setting::Frames(60)));
        assert!(contact.most_overlap < 0.1 && contact.speed < 10.0, "{contact:?}");
        assert!(canvas.most_overlap > 0.5, "{canvas:?}");
    }
}
