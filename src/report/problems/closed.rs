//! Problems with a closed form.

use glam::DVec2;

use super::{Problem, Setup, Unposed};
use crate::simulation::limits::OutOfRange;
use crate::simulation::{Ball, Pairs, World};

/// The demo's gravity, px/s².
const GRAVITY: f64 = 980.0;
/// From how high above the floor a ball is dropped, px.
const DROP: f64 = 400.0;
/// The floor's restitution.
const DROP_RESTITUTION: f64 = 0.8;

pub(super) fn problems() -> Result<Vec<Problem>, Unposed> {
    Ok(vec![
        free_flight()?,
        drop("drop", "A dropped ball, e = 0.8, while it bounces", 3.01)?,
        drop("drop-rest", "A dropped ball, e = 0.8, after it has come to rest", 9.01)?,
        head_on()?,
        oblique()?,
        cradle()?,
        galperin()?,
        boxed()?,
    ])
}

fn ball(position: (f64, f64), radius: f64, velocity: (f64, f64)) -> Result<Ball, OutOfRange> {
    Ball::new(position.into(), radius)?.with_velocity(velocity.into())
}

fn free_flight() -> Result<Problem, Unposed> {
    let (start, velocity) = (DVec2::new(100.0, 600.0), DVec2::new(300.0, -400.0));
    let gravity = DVec2::new(0.0, GRAVITY);
    let setup = Setup {
        name: "free-flight",
        title: "Free flight under gravity",
        about: "One ball flies freely for 1.01 s; the truth is its parabola.".to_owned(),
        world: World::new(DVec2::new(1280.0, 720.0))?.with_gravity(gravity)?,
        balls: vec![Ball::new(start, 10.0)?.with_velocity(velocity)?],
        seconds: 1.01,
    };
    Ok(setup.with_truth(|time| vec![start + velocity * time + gravity * (0.5 * time * time)]))
}

/// When a ball that is dropped comes to rest, s: √(2h/g)·(1+e)/(1−e).
fn drop_rest() -> f64 {
    (2.0 * DROP / GRAVITY).sqrt() * (1.0 + DROP_RESTITUTION) / (1.0 - DROP_RESTITUTION)
}

/// The height of the dropped ball: after the fall, hops of ever less height, infinitely many before it rests.
fn drop_height(time: f64) -> f64 {
    let fall = (2.0 * DROP / GRAVITY).sqrt();
    if time <= fall {
        return DROP - 0.5 * GRAVITY * time * time;
    }
    if time >= drop_rest() {
        return 0.0;
    }
    let (mut begun, mut speed) = (fall, GRAVITY * fall * DROP_RESTITUTION);
    while begun + 2.0 * speed / GRAVITY <= time && speed > 0.0 {
        begun += 2.0 * speed / GRAVITY;
        speed *= DROP_RESTITUTION;
    }
    let since = time - begun;
    since * (speed - 0.5 * GRAVITY * since)
}

fn drop(name: &'static str, title: &'static str, seconds: f64) -> Result<Problem, Unposed> {
    let about = if seconds < drop_rest() {
        format!(
            "A ball falls {DROP} px and bounces, e = {DROP_RESTITUTION}, for {seconds} s; the truth is its hops."
        )
    } else {
        format!(
            "The same to {seconds} s: it rests from √(2h/g)·(1+e)/(1−e) = {:.4} s on, after infinitely many hops.",
            drop_rest()
        )
    };
    let world = World::new(DVec2::new(100.0, 500.0))?.with_walls(DROP_RESTITUTION)?;
    let setup = Setup {
        name,
        title,
        about,
        world: world.with_gravity(DVec2::new(0.0, GRAVITY))?.with_pairs(Pairs::Impulse),
        balls: vec![ball((50.0, 490.0 - DROP), 10.0, (0.0, 0.0))?],
        seconds,
    };
    Ok(setup.with_truth(|time| vec![DVec2::new(50.0, 490.0 - drop_height(time))]))
}

/// Two balls that meet once, by the law of impact: where they are at a time.
fn meeting_pair(balls: &[Ball; 2], time: f64) -> Vec<DVec2> {
    let [one, other] = balls;
    let (distance, velocity) = (other.position() - one.position(), other.velocity() - one.velocity());
    let reach = one.radius() + other.radius();
    let (b, square) = (distance.dot(velocity), velocity.length_squared());
    let c = distance.length_squared() - reach * reach;
    let meeting = c / ((b * b - square * c).sqrt() - b);
    if time <= meeting {
        return balls.iter().map(|ball| ball.position() + ball.velocity() * time).collect();
    }
    let normal = (distance + velocity * meeting) / reach;
    let approach = -velocity.dot(normal);
    let e = one.restitution().min(other.restitution());
    let reduced = one.mass() * other.mass() / (one.mass() + other.mass());
    let impulse = (1.0 + e) * approach * reduced;
    let after = |ball: &Ball, sign: f64| {
        let place = ball.position() + ball.velocity() * meeting;
        place + (ball.velocity() + sign * impulse / ball.mass() * normal) * (time - meeting)
    };
    vec![after(one, -1.0), after(other, 1.0)]
}

fn pair(name: &'static str, title: &'static str, about: &str, balls: [Ball; 2]) -> Result<Problem, Unposed> {
    let world = World::new(DVec2::new(1280.0, 720.0))?.with_pairs(Pairs::Impulse);
    let about = about.to_owned();
    let setup = Setup { name, title, about, world, balls: balls.to_vec(), seconds: 1.51 };
    Ok(setup.with_truth(|time| meeting_pair(&balls, time)))
}

fn head_on() -> Result<Problem, Unposed> {
    let one = ball((100.0, 300.0), 10.0, (300.0, 0.0))?.with_restitution(0.7)?;
    let other = ball((407.3, 300.0), 20.0, (-100.0, 0.0))?.with_mass(3.0)?;
    let about = "Two balls of masses 1 and 3 meet head-on, e = 0.7; the truth is the law of impact.";
    pair("head-on", "Two balls meet head-on, masses 1 and 3", about, [one, other])
}

fn oblique() -> Result<Problem, Unposed> {
    let one = ball((100.0, 300.0), 10.0, (300.0, 20.0))?.with_restitution(0.7)?;
    let other = ball((400.0, 320.0), 20.0, (-100.0, 10.0))?.with_mass(3.0)?;
    let about = "The same pair meets off its line of centres, which shows errors in the time of impact best.";
    pair("oblique", "Two balls meet obliquely, masses 1 and 3", about, [one, other])
}

fn cradle() -> Result<Problem, Unposed> {
    let mut balls = vec![ball((95.7, 300.0), 10.0, (300.0, 0.0))?];
    for place in 0..4 {
        balls.push(ball((400.0 + 20.0 * f64::from(place), 300.0), 10.0, (0.0, 0.0))?);
    }
    let setup = Setup {
        name: "cradle",
        title: "Newton's cradle of five",
        about:
            "A ball meets four that touch each other in a row; the truth is that the last takes its velocity."
                .to_owned(),
        world: World::new(DVec2::new(1280.0, 720.0))?.with_pairs(Pairs::Impulse),
        balls: balls.clone(),
        seconds: 2.01,
    };
    Ok(setup.with_truth(move |time| {
        let meeting = (380.0 - 95.7) / 300.0;
        let mut places: Vec<DVec2> = balls.iter().map(Ball::position).collect();
        places[0].x += 300.0 * time.min(meeting);
        places[4].x += 300.0 * (time - meeting).max(0.0);
        places
    }))
}

fn galperin() -> Result<Problem, Unposed> {
    let digits = 3141;
    let setup = Setup {
        name: "galperin",
        title: "Galperin's billiard, mass ratio 10⁶",
        about: format!(
            "A ball of mass 10⁶ drives one of mass 1 against a wall: ⌊1000π⌋ = {digits} impacts in all (Galperin 2003). \
             Their number has a closed form; places are those of a reference run."
        ),
        world: World::new(DVec2::new(1e6, 100.0))?.with_walls(1.0)?.with_pairs(Pairs::Impulse),
        balls: vec![
            ball((300.0, 50.0), 10.0, (0.0, 0.0))?,
            ball((500.0, 50.0), 10.0, (-100.0, 0.0))?.with_mass(1e6)?,
        ],
        seconds: 10.01,
    };
    Ok(Problem { impacts: Some(digits), closed: true, ..setup.with_reference()? })
}

fn boxed() -> Result<Problem, Unposed> {
    let (start, velocity) = (DVec2::new(200.0, 300.0), DVec2::new(8125.0, -4312.5));
    let setup = Setup {
        name: "box",
        title: "One ball in a box, 1,463 bounces",
        about: "One ball bounces in a box without loss for 100.01 s; the truth is the straight line of the unfolded \
                box, 920,000 px long, of which an f64 resolves 10⁻¹⁰ px."
            .to_owned(),
        world: World::new(DVec2::new(1000.0, 700.0))?.with_walls(1.0)?,
        balls: vec![Ball::new(start, 10.0)?.with_velocity(velocity)?],
        seconds: 100.01,
    };
    let fold = |at: f64, span: f64| {
        let within = at.rem_euclid(2.0 * span);
        if within > span { 2.0 * span - within } else { within }
    };
    // How often the unfolded line crosses walls of the box's copies, along one axis.
    let crossed = |from: f64, speed: f64, span: f64| ((from + speed * setup.seconds) / span).floor().abs();
    let bounces = crossed(190.0, velocity.x, 980.0) + crossed(290.0, velocity.y, 680.0);
    let problem = setup.with_truth(|time| {
        let way = start - 10.0 + velocity * time;
        vec![DVec2::new(10.0 + fold(way.x, 980.0), 10.0 + fold(way.y, 680.0))]
    });
    Ok(Problem { impacts: Some(bounces as u64), ..problem })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dropped_ball_is_up_between_hops_and_down_after_the_last() {
        let fall = (2.0 * DROP / GRAVITY).sqrt();
        assert_eq!(drop_height(0.0), DROP);
        assert!(drop_height(fall).abs() < 1e-12);
        // The first hop reaches h·e², half its length after the fall.
        let top = drop_height(fall * (1.0 + DROP_RESTITUTION));
        assert!((top - DROP * 0.64).abs() < 1e-12, "{top}");
        assert!(drop_height(drop_rest() - 0.01) > 0.0 && drop_height(drop_rest() - 0.01) < 0.05);
        assert_eq!(drop_height(drop_rest()), 0.0);
    }
}
