//! Overlaps, columns, full boxes and collapse.

use glam::DVec2;

use super::{FRAME, GRAVITY, ball, boxed, frames, moving, open, run, told};
use crate::report::stability::case::{Case, Measure, Setup, Step};
use crate::simulation::limits::OutOfRange;

pub(super) fn cases() -> Vec<Case> {
    vec![
        coincident("coincident", 0.0),
        coincident("coincident-falling", GRAVITY),
        deep(),
        wide(),
        column("column-100", 100, 5.0),
        column("column-1000", 1000, 2.0),
        jammed(),
        packed(),
        one_point(),
        collapse_on_a_line(),
        shrinking(),
        pegs(),
    ]
}

fn coincident(name: &'static str, gravity: f64) -> Case {
    let setup = move || -> Result<Setup, OutOfRange> {
        let balls = vec![ball(200.0, 200.0, 10.0)?.with_restitution(0.5)?; 3];
        Ok(run(boxed(400.0, 400.0, 0.5, gravity)?, balls, 5.0))
    };
    let falling = if gravity > 0.0 { ", under gravity" } else { "" };
    Case::new(name, format!("three balls at rest with their centres at one point{falling}"), move || {
        setup().map_err(told)
    })
    .holds(Measure::OverlapAtEnd, 0.05, 1.0)
    .holds(Measure::FastestAtEnd, 100.0, 1000.0)
    .holds(Measure::Escape, 1e-9, 1.0)
}

fn deep() -> Case {
    let setup = || -> Result<Setup, OutOfRange> {
        let place = |k: u32| {
            let (x, y) = (f64::from(k % 4), f64::from(k / 4));
            ball(190.0 + 6.0 * x + y, 190.0 + 7.0 * y, 10.0)?.with_restitution(0.5)
        };
        Ok(run(boxed(400.0, 400.0, 0.5, GRAVITY)?, (0..10).map(place).collect::<Result<_, _>>()?, 5.0))
    };
    Case::new("deep-overlap", "ten balls of radius 10 begin within 25 px of each other", move || {
        setup().map_err(told)
    })
    .holds(Measure::OverlapAtEnd, 0.05, 1.0)
    .holds(Measure::EnergyGain, 0.01, 1.0)
    .holds(Measure::Escape, 1e-9, 1.0)
}

fn wide() -> Case {
    let setup = || -> Result<Setup, OutOfRange> {
        let balls = vec![ball(200.0, 50.0, 50.0)?, moving(700.0, 30.0, 10.0, (-200.0, 35.0))?];
        Ok(run(boxed(1000.0, 100.0, 1.0, 0.0)?, balls, 10.0))
    };
    Case::new("box-wide", "a ball as wide as the box, and one that hits it, e = 1", move || {
        setup().map_err(told)
    })
    .stays_inside_and_apart()
    .keeps_energy()
}

fn column(name: &'static str, count: u32, seconds: f64) -> Case {
    let setup = move || -> Result<Setup, OutOfRange> {
        let height = 7.0 * f64::from(count) + 100.0;
        let place = |k: u32| ball(200.0, height - 3.5 - 7.0 * f64::from(k), 3.5)?.with_restitution(0.5);
        Ok(run(
            boxed(400.0, height, 0.5, GRAVITY)?,
            (0..count).map(place).collect::<Result<_, _>>()?,
            seconds,
        ))
    };
    let top = count as usize - 1;
    Case::new(name, format!("a column of {count} balls stands for {seconds} s"), move || {
        setup().map_err(told)
    })
    .holds(Measure::Sinking(top), 0.05, 1.0)
    .stays_inside_and_apart()
    .gains_no_energy()
}

fn jammed() -> Case {
    let setup = || -> Result<Setup, OutOfRange> {
        let place = |k: u32| {
            let speed = 20.0 * (f64::from(k) * 2.4).sin();
            moving(10.0 + 20.0 * f64::from(k), 380.0, 10.0, (speed, 0.0))?.with_restitution(0.5)
        };
        Ok(run(boxed(400.0, 400.0, 0.5, GRAVITY)?, (0..20).map(place).collect::<Result<_, _>>()?, 3.0))
    };
    Case::new("jammed-row", "twenty balls fall on a floor that they fill from wall to wall", move || {
        setup().map_err(told)
    })
    .stays_inside_and_apart()
    .gains_no_energy()
}

fn packed() -> Case {
    let setup = || -> Result<Setup, OutOfRange> {
        // A hexagonal lattice whose neighbours are a thousandth of a diameter apart.
        let (side, pitch) = (120_u32, 6.0 * 1.001);
        let rise = pitch * 0.75_f64.sqrt();
        let size = (pitch * (f64::from(side) + 0.5), 6.0 + rise * f64::from(side - 1) + 0.006);
        let place = |k: u32| {
            let (column, row) = (f64::from(k % side), f64::from(k / side));
            let x = 3.003 + pitch * (column + 0.5 * (row % 2.0));
            let turn = 2.4 * f64::from(k);
            moving(x, 3.003 + rise * row, 3.0, (10.0 * turn.cos(), 10.0 * turn.sin()))
        };
        let balls = (0..side * side).map(place).collect::<Result<_, _>>()?;
        Ok(run(boxed(size.0, size.1, 1.0, 0.0)?, balls, 0.1))
    };
    Case::new("packed-0.90", "14,400 balls fill 0.90 of a box, 10 px/s, e = 1, for 0.1 s", move || {
        setup().map_err(told)
    })
    .stays_inside_and_apart()
    .keeps_energy()
}

fn one_point() -> Case {
    let setup = || -> Result<Setup, OutOfRange> {
        Ok(run(boxed(1000.0, 1000.0, 0.5, 0.0)?, vec![ball(500.0, 500.0, 1.0)?; 100_000], 1.0))
    };
    Case::new("one-point-1e5", "100,000 balls of radius 1 at one point", move || setup().map_err(told))
        .holds(Measure::OverlapAtEnd, 0.5, 1.9)
        .holds(Measure::Escape, 1e-9, 1.0)
}

fn collapse_on_a_line() -> Case {
    let setup = || -> Result<Setup, OutOfRange> {
        let soft = |x: f64, speed: f64| moving(x, 100.0, 10.0, (speed, 0.0))?.with_restitution(0.05);
        Ok(run(open(1280.0, 200.0)?, vec![soft(100.0, 200.0)?, soft(150.0, 0.0)?, soft(201.0, -190.0)?], 2.0))
    };
    Case::new("collapse-line", "three balls on a line collapse, e = 0.05 < 7 − 4√3", move || {
        setup().map_err(told)
    })
    .holds(Measure::Overlap, 0.02, 0.5)
    .keeps_momentum()
    .gains_no_energy()
}

fn shrinking() -> Case {
    let setup = || -> Result<Setup, OutOfRange> {
        let place = |k: u32| {
            let (column, row) = (f64::from(k % 20), f64::from(k / 20));
            ball(16.0 + 28.0 * column + row, 60.0 + 30.0 * row, 8.0 + f64::from(k % 5))?.with_restitution(0.5)
        };
        let balls = (0..100).map(place).collect::<Result<_, _>>()?;
        let mut steps = frames(2.0);
        for narrower in 1..=50 {
            steps.push(Step::Resize(DVec2::new(600.0 - 6.0 * f64::from(narrower), 400.0)));
            steps.push(Step::Advance(FRAME));
        }
        steps.extend(frames(3.0));
        Ok(Setup::Run { world: boxed(600.0, 400.0, 0.5, GRAVITY)?, balls, steps })
    };
    Case::new("shrinking-window", "a pile of 100 in a window that shrinks from 600 to 300 px", move || {
        setup().map_err(told)
    })
    .holds(Measure::OverlapAtEnd, 0.05, 0.5)
    .holds(Measure::Escape, 1e-9, 1.0)
}

fn pegs() -> Case {
    let setup = || -> Result<Setup, OutOfRange> {
        let mut balls = Vec::new();
        for place in 0..40 {
            let (column, row) = (f64::from(place % 10), f64::from(place / 10));
            balls.push(ball(20.0 + 40.0 * column + 20.0 * (row % 2.0), 150.0 + 40.0 * row, 6.0)?.fixed());
        }
        for place in 0..20 {
            let falling = moving(25.0 + 19.0 * f64::from(place), 40.0, 7.0, (0.0, 500.0))?;
            balls.push(falling.with_restitution(0.5)?);
        }
        Ok(run(boxed(420.0, 400.0, 0.5, GRAVITY)?, balls, 3.0))
    };
    Case::new("pegs", "twenty balls fall through rows of fixed ones", move || setup().map_err(told))
        .stays_inside_and_apart()
        .gains_no_energy()
}
