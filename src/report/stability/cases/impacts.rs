//! Single impacts at the ends of what masses, radii, speeds and angles may be.

use glam::DVec2;

use super::{GRAVITY, ball, boxed, moving, open, run, said, told};
use crate::report::stability::case::{Case, Measure, Setup};
use crate::scene::Scene;
use crate::simulation::Ball;
use crate::simulation::limits::OutOfRange;

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, mass) in [("mass-impact-1e2", 1e2), ("mass-impact-1e6", 1e6), ("mass-impact-1e12", 1e12)] {
        cases.push(mass_impact(name, mass));
    }
    for (name, mass) in [("mass-rest-1e2", 1e2), ("mass-rest-1e6", 1e6), ("mass-rest-1e12", 1e12)] {
        cases.push(mass_rest(name, mass));
    }
    cases.push(radius_ratio());
    for (name, speed) in [("speed-1e2", 1e2), ("speed-1e4", 1e4), ("speed-1e6", 1e6), ("speed-1e8", 1e8)] {
        cases.push(bullet(name, speed));
    }
    cases.extend([corner(), three_at_once(), grazing("graze-hit", -1e-12), grazing("graze-miss", 1e-12)]);
    cases
}

fn mass_impact(name: &'static str, mass: f64) -> Case {
    let setup = move || -> Result<Setup, OutOfRange> {
        let heavy = moving(100.0, 300.0, 20.0, (300.0, 0.0))?.with_mass(mass)?;
        Ok(run(open(1280.0, 720.0)?, vec![heavy, ball(250.0, 300.0, 10.0)?], 1.0))
    };
    let wanted = [300.0 * (mass - 1.0) / (mass + 1.0), 600.0 * mass / (mass + 1.0)];
    let error = move |balls: &[Ball]| {
        let errors =
            balls.iter().zip(wanted).map(|(ball, wanted)| ball.velocity().distance(DVec2::new(wanted, 0.0)));
        errors.fold(0.0, f64::max) / 300.0
    };
    Case::new(name, format!("a ball of mass {} hits one of mass 1, e = 1", said(mass)), move || {
        setup().map_err(told)
    })
    .holds(Measure::AtEnd("velocities off by", Box::new(error)), 1e-9, 1e-2)
    .keeps_momentum()
    .keeps_energy()
}

fn mass_rest(name: &'static str, mass: f64) -> Case {
    let setup = move || -> Result<Setup, OutOfRange> {
        let light = ball(200.0, 380.0, 20.0)?.with_restitution(0.3)?;
        let heavy = ball(200.0, 320.0, 40.0)?.with_mass(mass)?.with_restitution(0.3)?;
        Ok(run(boxed(400.0, 400.0, 0.3, GRAVITY)?, vec![light, heavy], 3.0))
    };
    Case::new(name, format!("a ball of mass {} rests on one of mass 1", said(mass)), move || {
        setup().map_err(told)
    })
    .holds(Measure::Sinking(1), 0.02, 0.5)
    .stays_inside_and_apart()
    .gains_no_energy()
}

fn radius_ratio() -> Case {
    let text = "size = [800, 720]\n[walls]\n[pairs]\n[[ball]]\nposition = [400, 360]\nradius = 300\nvelocity = [50, 20]\n\
                mass = 1000\n[[fill]]\ncount = 60\nradius = 0.3\nspeed = 200\nmass = 1\n";
    let setup = || -> Result<Setup, String> {
        let simulation = Scene::parse("radii", text).and_then(|scene| scene.build()).map_err(told)?;
        Ok(run(*simulation.world(), simulation.balls().to_vec(), 2.0))
    };
    Case::new("radius-ratio", "radii of 300 and 0.3 px in a box, e = 1", setup)
        .stays_inside_and_apart()
        .keeps_energy()
}

fn bullet(name: &'static str, speed: f64) -> Case {
    let setup = move || -> Result<Setup, OutOfRange> {
        let mut balls = vec![moving(30.0, 200.0, 3.0, (speed, 0.0))?];
        for place in 0..5 {
            balls.push(ball(400.0 + 100.0 * f64::from(place), 200.0, 20.0)?.with_mass(50.0)?);
        }
        Ok(run(boxed(1000.0, 400.0, 1.0, 0.0)?, balls, 0.5))
    };
    let what = format!("a ball of radius 3 at {} px/s on a row of five in a box, e = 1", said(speed));
    Case::new(name, what, move || setup().map_err(told))
        .holds(Measure::OutOfOrder, 0.0, 0.0)
        .stays_inside_and_apart()
        .keeps_energy()
}

fn corner() -> Case {
    let setup = || -> Result<Setup, OutOfRange> {
        Ok(run(boxed(100.0, 100.0, 1.0, 0.0)?, vec![moving(50.0, 50.0, 10.0, (-100.0, -100.0))?], 2.0))
    };
    // 200 px along each axis: 40 to the corner, 80 across, and 80 back.
    let error = |balls: &[Ball]| balls[0].position().distance(DVec2::splat(10.0));
    Case::new("corner", "a ball hits a corner exactly, e = 1", move || setup().map_err(told))
        .holds(Measure::AtEnd("px from its place", Box::new(error)), 1e-9, 1.0)
        .holds(Measure::Escape, 1e-9, 1.0)
        .keeps_energy()
}

fn three_at_once() -> Case {
    let setup = || -> Result<Setup, OutOfRange> {
        let balls = vec![
            moving(100.0, 300.0, 10.0, (300.0, 0.0))?,
            ball(200.0, 290.0, 10.0)?,
            ball(200.0, 310.0, 10.0)?,
        ];
        Ok(run(open(1280.0, 720.0)?, balls, 1.0))
    };
    let skew = |balls: &[Ball]| (balls[1].velocity().y + balls[2].velocity().y).abs() / 300.0;
    Case::new("three-at-once", "a ball hits two that touch each other at one time, e = 1", move || {
        setup().map_err(told)
    })
    // Newton's law of impact is of two: an order among impacts at one time, which is not symmetric, is not a failure.
    .holds(Measure::AtEnd("skewed by", Box::new(skew)), 1e-9, f64::INFINITY)
    .keeps_momentum()
    .keeps_energy()
}

fn grazing(name: &'static str, beside: f64) -> Case {
    let setup = move || -> Result<Setup, OutOfRange> {
        let passing = moving(100.0, 300.0, 10.0, (300.0, 0.0))?;
        Ok(run(open(1280.0, 720.0)?, vec![passing, ball(250.0, 300.0 + 20.0 * (1.0 + beside), 10.0)?], 1.0))
    };
    // The line of centres is turned by √(2·10⁻¹²) from across at most.
    let turned = |balls: &[Ball]| balls[0].velocity().distance(DVec2::new(300.0, 0.0)) / 300.0;
    let what = format!("a ball passes another at {} of the distance at which they touch", 1.0 + beside);
    Case::new(name, what, move || setup().map_err(told))
        .holds(Measure::AtEnd("velocity changed by", Box::new(turned)), 1e-5, 1e-2)
        .keeps_momentum()
        .keeps_energy()
}
