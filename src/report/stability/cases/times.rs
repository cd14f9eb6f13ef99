//! Time in unusual pieces: none, tiny, huge, mixed, and for long.

use super::{FRAME, told};
use crate::report::problems::demo;
use crate::report::stability::case::{Case, Measure, Setup, Step};
use crate::simulation::Ball;

pub(super) fn cases() -> Vec<Case> {
    let moved_by = |start: Vec<Ball>| {
        move |balls: &[Ball]| {
            let pairs = balls.iter().zip(&start);
            pairs.map(|(ball, start)| ball.position().distance(start.position())).fold(0.0, f64::max)
        }
    };
    let start = demo("gravity").map(|(_, balls)| balls).unwrap_or_default();
    let mut cases = vec![
        stage("delta-0", "the demo's gravity, 1,000 frames of 0 s", "gravity", vec![0.0; 1000])
            .holds(Measure::AtEnd("px moved", Box::new(moved_by(start))), 0.0, 1e-9)
            .gains_no_energy(),
        bounded(stage(
            "delta-1e-9",
            "the demo's gravity, 1,000 frames of 10⁻⁹ s",
            "gravity",
            vec![1e-9; 1000],
        )),
        bounded(stage("delta-1", "the demo's gravity, ten frames of 1 s", "gravity", vec![1.0; 10])),
        bounded(stage("delta-60", "the demo's gravity, two frames of 60 s", "gravity", vec![60.0; 2])),
        bounded(stage("delta-3600", "the demo's gravity, one frame of an hour", "gravity", vec![3600.0])),
    ];
    let mixed = [0.0, 1e-9, FRAME, 0.125, 1e-3, 0.0, 0.25, 1e-9];
    let mixed: Vec<f64> = mixed.iter().copied().cycle().take(40).collect();
    cases.push(
        stage(
            "delta-mixed",
            "the demo's gravity to 2 s, frames of 0, 10⁻⁹, 1/60, 0.125, 0.001 and 0.25 s in turn",
            "gravity",
            mixed,
        )
        .holds(Measure::AgainstEvenFrames, 1e-9, 1.0),
    );
    let hour = vec![FRAME; 216_000];
    cases.push(
        stage("hour-elastic", "the demo's elastic for an hour", "elastic", hour.clone())
            .stays_inside_and_apart()
            .keeps_energy(),
    );
    cases.push(bounded(stage("hour-gravity", "the demo's gravity for an hour", "gravity", hour)));
    cases.push(bounded(stage(
        "collapse-demo",
        "the demo's gravity for a minute: infinitely many bounces in finite time, from 2.17 s on",
        "gravity",
        vec![FRAME; 3600],
    )));
    cases
}

fn bounded(case: Case) -> Case {
    case.stays_inside_and_apart().gains_no_energy()
}

fn stage(name: &'static str, what: &str, scene: &'static str, deltas: Vec<f64>) -> Case {
    Case::new(name, what, move || {
        let (world, balls) = demo(scene).map_err(told)?;
        Ok(Setup::Run { world, balls, steps: deltas.iter().map(|&delta| Step::Advance(delta)).collect() })
    })
}
