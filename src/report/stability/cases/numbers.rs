//! Gravity, restitution and numbers at the ends of their ranges.

use glam::DVec2;

use super::{GRAVITY, boxed, moving, open, run, said, scattered, told};
use crate::report::stability::case::{Case, Setup};
use crate::simulation::limits::{DELTA, OutOfRange};
use crate::simulation::{Ball, World};

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, gravity) in [
        ("gravity-0", 0.0),
        ("gravity-1", 1.0),
        ("gravity-1e3", 1e3),
        ("gravity-1e5", 1e5),
        ("gravity-1e7", 1e7),
    ] {
        cases.push(gravity_of(name, gravity));
    }
    for (name, e, said) in [
        ("restitution-0", 0.0, "0"),
        ("restitution-1e-12", 1e-12, "10⁻¹²"),
        ("restitution-1-1e-12", 1.0 - 1e-12, "1 − 10⁻¹²"),
        ("restitution-1", 1.0, "1"),
    ] {
        cases.push(restitution_of(name, e, said));
    }
    cases.extend([subnormal(), refused()]);
    cases
}

fn gravity_of(name: &'static str, gravity: f64) -> Case {
    let setup = move || -> Result<Setup, OutOfRange> {
        Ok(run(boxed(600.0, 400.0, 0.5, gravity)?, scattered(30, 0.5)?, 3.0))
    };
    Case::new(name, format!("thirty balls in a box, e = 0.5, gravity {} px/s²", said(gravity)), move || {
        setup().map_err(told)
    })
    .stays_inside_and_apart()
    .gains_no_energy()
}

fn restitution_of(name: &'static str, e: f64, said: &str) -> Case {
    let setup = move || -> Result<Setup, OutOfRange> {
        Ok(run(boxed(430.0, 400.0, e, GRAVITY)?, scattered(30, e)?, 3.0))
    };
    let case =
        Case::new(name, format!("thirty balls fall in a box, e = {said}"), move || setup().map_err(told));
    let case = case.stays_inside_and_apart();
    if e > 0.5 { case.keeps_energy() } else { case.gains_no_energy() }
}

fn subnormal() -> Case {
    let setup = || -> Result<Setup, OutOfRange> {
        let tiny = f64::from_bits(1);
        let balls = vec![
            moving(1e-6, 5.0, 1e-6, (tiny, -tiny))?,
            moving(3e-6, 5.0, 1e-6, (-tiny, tiny))?,
            moving(5e-6 + tiny, 5.0, 1e-6, (-1e-310, 0.0))?.with_mass(1e-30)?,
        ];
        let world = open(10.0, 10.0)?.with_walls(tiny)?.with_gravity(DVec2::new(tiny, 1e-310))?;
        Ok(run(world, balls, 1.0))
    };
    Case::new(
        "subnormal",
        "velocities, gravity and restitution of 5·10⁻³²⁴, the smallest radii and mass",
        move || setup().map_err(told),
    )
    .stays_inside_and_apart()
}

/// What must be refused when it is put in, so that no solver ever sees it.
fn refused() -> Case {
    let setup = || -> Result<Setup, String> {
        let at = DVec2::splat(50.0);
        let ball = Ball::new(at, 10.0).map_err(told)?;
        let world = World::new(DVec2::splat(100.0)).map_err(told)?;
        let mut accepted = Vec::new();
        for bad in [1e300, -1e300, f64::MAX, f64::INFINITY, f64::NAN] {
            let tried = [
                ("position", Ball::new(DVec2::new(bad, 50.0), 10.0).is_ok()),
                ("radius", Ball::new(at, bad).is_ok()),
                ("velocity", ball.with_velocity(DVec2::new(0.0, bad)).is_ok()),
                ("mass", ball.with_mass(bad).is_ok()),
                ("restitution", ball.with_restitution(bad).is_ok()),
                ("gravity", world.with_gravity(DVec2::new(0.0, bad)).is_ok()),
                ("size", World::new(DVec2::new(bad, 100.0)).is_ok()),
                ("delta", DELTA.check(bad).is_ok()),
            ];
            accepted.extend(tried.iter().filter(|(_, ok)| *ok).map(|(name, _)| format!("{name} {bad:e}")));
        }
        for tiny in [0.0, f64::from_bits(1), -1.0] {
            accepted.extend(Ball::new(at, tiny).is_ok().then(|| format!("radius {tiny:e}")));
            accepted.extend(ball.with_mass(tiny).is_ok().then(|| format!("mass {tiny:e}")));
        }
        if accepted.is_empty() {
            Ok(Setup::Refused("all of it is refused".to_owned()))
        } else {
            Err(format!("taken: {}", accepted.join(", ")))
        }
    };
    Case::new("refused", "10³⁰⁰, infinities and NaN anywhere; radii and masses of 0, 5·10⁻³²⁴ and −1", setup)
}
