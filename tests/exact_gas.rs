//! What the `exact` solver's gases do in the long run: the laws of statistical physics, and not a bit lost.

use std::f64::consts::PI;

use carom::simulation::invariants::{energy, kinetic_energy, max_wall_overlap, momentum};
use carom::{Ball, DVec2, Pairs, Scene, Simulation, Solver, World};

#[path = "common/at_impacts.rs"]
mod at_impacts;

use at_impacts::Looks;

/// `side`² balls of radius 1 px and mass 1 that cover the part `eta` of a square box, all at `speed` px/s.
///
/// They start on a square lattice, which melts at once, and fill the box evenly: no density has to even out from one
/// end of it to the other. Directions come without sines, so that the same bits start on every machine.
fn gas(side: usize, eta: f64, speed: f64) -> Simulation {
    let pitch = (PI / eta).sqrt();
    let ball = |index: usize| {
        let place = DVec2::new((index % side) as f64 + 0.5, (index / side) as f64 + 0.5) * pitch;
        let bits = ((index * index) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let t = (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        let direction = DVec2::new(1.0 - t * t, 2.0 * t) / (1.0 + t * t);
        let sign = if bits & 1024 == 0 { 1.0 } else { -1.0 };
        Ball::new(place, 1.0).unwrap().with_velocity(direction * (sign * speed)).unwrap()
    };
    let world = World::new(DVec2::splat(side as f64 * pitch)).unwrap().with_walls(1.0).unwrap();
    let balls = (0..side * side).map(ball).collect();
    Simulation::new(world.with_pairs(Pairs::Impulse), balls, Solver::Exact).unwrap()
}

/// Advances in steps of `delta` until there have been so many impacts more.
fn advance_by_impacts(simulation: &mut Simulation, delta: f64, impacts: u64) {
    let end = simulation.tally().impacts + impacts;
    while simulation.tally().impacts < end {
        simulation.advance(delta).unwrap();
    }
}

/// kT of balls of mass 1, px²/s²: half of ⟨v²⟩.
fn temperature(simulation: &Simulation) -> f64 {
    kinetic_energy(simulation.balls()) / simulation.balls().len() as f64
}

/// FNV-1a over the bits of all positions and velocities.
fn hash(simulation: &Simulation) -> u64 {
    let numbers = simulation.balls().iter().flat_map(|ball| {
        let (p, v) = (ball.position(), ball.velocity());
        [p.x, p.y, v.x, v.y]
    });
    let bytes = numbers.flat_map(|number| number.to_bits().to_le_bytes());
    bytes.fold(0xCBF2_9CE4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3))
}

#[test]
fn ten_million_elastic_impacts_keep_energy_and_momentum_and_leave_no_ball_in_another_or_in_a_wall() {
    // Radius 1 is the hardest: where the squared distance at contact is a power of two, rounding is biased there, and
    // this gas gains 3·10⁻²⁰ of its energy an impact. With other radii its energy wanders by 10⁻¹⁴.
    let mut simulation = gas(20, 0.4, 200.0);
    let (start, pushed) = (kinetic_energy(simulation.balls()), momentum(simulation.balls()));
    let sum_of_momenta = 400.0 * 200.0;
    let mut looks = Looks::new(&simulation);
    let (mut drift, mut lost) = (0.0_f64, 0.0_f64);
    while simulation.tally().impacts < 10_000_000 {
        looks.advance(&mut simulation, 1.0);
        drift = drift.max((kinetic_energy(simulation.balls()) / start - 1.0).abs());
        let change = momentum(simulation.balls()) - pushed - simulation.tally().wall_impulse;
        lost = lost.max(change.length() / sum_of_momenta);
    }
    assert!(looks.seen > 20_000, "{} impacts were looked at", looks.seen);
    // The rounding of coordinates of 56 px is 7·10⁻¹⁵.
    assert!(looks.overlap < 3e-14, "overlap {:e}", looks.overlap);
    assert!(looks.escape < 3e-14, "escape {:e}", looks.escape);
    assert!(drift < 1e-12, "drift {drift:e}");
    assert!(lost < 2e-14, "momentum {lost:e}");
}

/// A ball's flight through a step: straight, but for one impact at most.
struct Flight {
    from: Ball,
    to: Ball,
    seconds: f64,
    /// When that impact is, s since the step began; at its end where there is none.
    turns: f64,
}

impl Flight {
    fn new((&from, &to): (&Ball, &Ball), seconds: f64) -> Self {
        let change = to.velocity() - from.velocity();
        let turns = if change == DVec2::ZERO {
            seconds
        } else {
            // Where the lines before and after it cross.
            let apart = from.position() - (to.position() - to.velocity() * seconds);
            apart.dot(change) / change.length_squared()
        };
        Self { from, to, seconds, turns }
    }

    fn at(&self, time: f64) -> DVec2 {
        if time <= self.turns {
            self.from.position() + self.from.velocity() * time
        } else {
            self.to.position() - self.to.velocity() * (self.seconds - time)
        }
    }

    /// How near another ball's centre comes to this one's.
    fn nearest(&self, other: &Self) -> f64 {
        let times = [0.0, self.turns.min(other.turns), self.turns.max(other.turns), self.seconds];
        let [start, first, second, end] = times.map(|time| self.at(time) - other.at(time));
        let pieces = [(start, first), (first, second), (second, end)];
        pieces.map(|(from, to)| nearest_to_origin(from, to)).into_iter().fold(f64::INFINITY, f64::min)
    }
}

/// How near to the origin a straight line comes between two points.
fn nearest_to_origin(from: DVec2, to: DVec2) -> f64 {
    let along = to - from;
    let part = -from.dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
    (from + along * part.clamp(0.0, 1.0)).length()
}

/// Advances by `seconds`, in steps of one event at most, and calls `look` with the flights of each.
fn follow(simulation: &mut Simulation, seconds: f64, look: &mut impl FnMut(&[Flight])) {
    let hits = |simulation: &Simulation| simulation.tally().impacts + simulation.tally().wall_hits;
    let before = simulation.clone();
    simulation.advance(seconds).unwrap();
    if hits(simulation) > hits(&before) + 1 {
        // Frames are shown at multiples of 2⁻⁴⁶ s.
        assert!(seconds > 2_f64.powi(-46), "two events at one time");
        *simulation = before;
        for _ in 0..2 {
            follow(simulation, seconds / 2.0, look);
        }
    } else {
        let flights: Vec<_> =
            before.balls().iter().zip(simulation.balls()).map(|balls| Flight::new(balls, seconds)).collect();
        look(&flights);
    }
}

#[test]
fn at_no_time_between_frames_does_the_way_of_a_ball_lead_into_another_or_into_a_wall() {
    // At each of the impacts, and where two balls pass each other by: a grazing impact that was missed is seen, too.
    let mut simulation = gas(6, 0.4, 200.0);
    let size = simulation.world().size();
    let (mut overlap, mut escape, mut turns) = (0.0_f64, 0.0_f64, 0);
    let mut look = |flights: &[Flight]| {
        for (index, one) in flights.iter().enumerate() {
            turns += u64::from(one.turns < one.seconds);
            let turn = one.at(one.turns);
            escape = escape.max((1.0 - turn).max(turn + 1.0 - size).max_element());
            for other in &flights[..index] {
                // With all of the energy, two that are farther apart would not meet in so short a step.
                if one.from.position().distance_squared(other.from.position()) < 6.25 {
                    overlap = overlap.max(2.0 - one.nearest(other));
                }
            }
        }
    };
    while simulation.tally().impacts < 150_000 {
        follow(&mut simulation, 2_f64.powi(-12), &mut look);
    }
    let tally = simulation.tally();
    assert_eq!(turns, 2 * tally.impacts + tally.wall_hits, "all of them were looked at");
    // The rounding of coordinates of 17 px is 2·10⁻¹⁵.
    assert!(overlap < 2e-14, "overlap {overlap:e}");
    assert!(escape < 2e-14, "escape {escape:e}");
}

#[test]
fn a_gas_of_tens_of_thousands_keeps_the_laws_of_a_small_one() {
    // So many that their events are read ahead: equal balls in straight flight, and two sizes under gravity, so different
    // that they live in cells of two levels.
    let fill =
        |count: u32, radius: f64| format!("[[fill]]\ncount = {count}\nradius = {radius}\nspeed = [0, 200]\n");
    let file = format!(
        "solver = \"exact\"\nsize = [900, 900]\ngravity = [0, 98]\n[walls]\n[pairs]\n{}{}",
        fill(1000, 6.0),
        fill(30_000, 0.3)
    );
    let falling = Scene::parse("gas", &file).and_then(|scene| scene.build()).unwrap();
    for mut simulation in [gas(180, 0.4, 200.0), falling] {
        let start = energy(simulation.world(), simulation.balls());
        let mut looks = Looks::new(&simulation);
        for _ in 0..20 {
            advance_by_impacts(&mut simulation, 0.002, 4000);
            for _ in 0..6 {
                looks.advance(&mut simulation, 0.002);
            }
        }
        let drift = energy(simulation.world(), simulation.balls()) / start - 1.0;
        // The rounding of coordinates of 900 px is 4·10⁻¹³ of a radius of 0.3 px.
        assert!(looks.overlap < 5e-13, "overlap {:e}", looks.overlap);
        assert!(looks.escape < 5e-13, "escape {:e}", looks.escape);
        assert!(looks.seen > 20, "{} impacts were looked at", looks.seen);
        assert!(drift.abs() < 1e-13, "{:?}: {drift:e}", simulation.world());
    }
}

#[test]
fn thirty_thousand_equal_balls_in_a_shaft_hand_their_velocities_on() {
    // Without their diameters they are points that fly through each other, and only their order is kept (Tonks 1936).
    // Half of them are at rest, and are so again and again.
    let (count, mean_gap, delta) = (31_000, 2.0, 0.2);
    let scattered = |index: usize| {
        ((index as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 11) as f64 / (1_u64 << 53) as f64
    };
    let length = count as f64 * mean_gap;
    let start = |index: usize| (index as f64 + scattered(index)) * mean_gap;
    let speed =
        |index: usize| if index.is_multiple_of(2) { 0.0 } else { 400.0 * scattered(2 * index) - 200.0 };
    let diameters = |index: usize| 1.0 + 2.0 * index as f64;
    let ball = |index: usize| {
        let place = DVec2::new(1.1, start(index) + diameters(index));
        Ball::new(place, 1.0).unwrap().with_velocity(DVec2::new(0.0, speed(index))).unwrap()
    };
    let world =
        World::new(DVec2::new(2.2, length + diameters(count) - 1.0)).unwrap().with_walls(1.0).unwrap();
    let balls = (0..count).map(ball).collect();
    let mut simulation = Simulation::new(world.with_pairs(Pairs::Impulse), balls, Solver::Exact).unwrap();
    simulation.advance(delta).unwrap();

    let reflected = |place: f64| if place < 0.0 { -place } else { length - (length - place).abs() };
    let mut points: Vec<f64> =
        (0..count).map(|index| reflected(start(index) + speed(index) * delta)).collect();
    points.sort_by(f64::total_cmp);
    for (index, (ball, point)) in simulation.balls().iter().zip(points).enumerate() {
        let difference = ball.position().y - point - diameters(index);
        assert!(difference.abs() < 5e-10, "ball {index}: {difference:e}");
    }
    assert!(simulation.tally().impacts > 100_000, "{:?}", simulation.tally());
}

/// Z = PA/NkT, from the rate of impacts between balls and from that of hits on the walls.
///
/// The virial of elastic impacts is in 2D Z − 1 = (√π/4)·σω/√(kT/m), with ω the impacts per disc and second (each
/// counts for both of its discs). A ball of a Maxwellian gas brings √(2πmkT) to a wall on average, so h hits a second
/// on four walls push each with F = h√(2πmkT)/4; and the virial theorem for centres that keep to a box of side L − σ
/// says F·(L − σ) = NkT·Z of the impacts, whatever the density does at the walls.
fn compressibilities(simulation: &mut Simulation, impacts: u64) -> (f64, f64) {
    let (start, before) = (simulation.time(), simulation.tally());
    advance_by_impacts(simulation, 0.01, impacts);
    let (seconds, after) = (simulation.time() - start, simulation.tally());
    let (count, kt) = (simulation.balls().len() as f64, temperature(simulation));
    let rate = 2.0 * (after.impacts - before.impacts) as f64 / (count * seconds);
    let hits = (after.wall_hits - before.wall_hits) as f64 / seconds;
    let (diameter, side) = (2.0, simulation.world().size().x);
    let of_impacts = 1.0 + PI.sqrt() / 4.0 * diameter * rate / kt.sqrt();
    let of_walls = hits * (2.0 * PI * kt).sqrt() / 4.0 * (side - diameter) / (count * kt);
    (of_impacts, of_walls)
}

/// How much larger than in an endless gas Z is between walls.
///
/// To first order in 1/L the grand potential of discs of radius r in a box is −PL² + 4γL, with γ the line tension of
/// a hard wall. Scaled particle theory (Helfand, Frisch & Lebowitz 1961) has in 2D βP = η/πr²(1−η)² and
/// βγ = η/πr(1−η). From N = −∂Ω/∂μ the middle of the box is denser than N/L² by the factor 1 + (4r/L)(1−η)/(1+η); a
/// wall bears F = PL − 2γ; and F·(L − 2r) = NkT·Z of the impacts (see [`compressibilities`]). Together: 1 + 2rη/L.
///
/// The theory is an approximation: of 10⁴ discs it leaves 0.01–0.05 % of Z, as the extrapolations of
/// `cargo bench --bench exact -- pressure` show.
fn walls_factor(simulation: &Simulation, eta: f64) -> f64 {
    1.0 + 2.0 * eta / simulation.world().size().x
}

#[test]
fn the_pressure_of_hard_discs_is_that_of_their_virial_series() {
    // Clisby & McCoy (2006), ten coefficients and a geometric tail.
    for (eta, published) in [(0.1, 1.23614), (0.2, 1.57037), (0.3, 2.0633), (0.4, 2.829), (0.5, 4.107)] {
        let mut simulation = gas(70, eta, 1000.0);
        advance_by_impacts(&mut simulation, 0.01, 150_000);
        let (of_impacts, of_walls) = compressibilities(&mut simulation, 3_000_000);
        let z = of_impacts / walls_factor(&simulation, eta);
        assert!((z / published - 1.0).abs() < 0.003, "η = {eta}: Z = {z} is not {published}");
        assert!((of_walls / of_impacts - 1.0).abs() < 0.015, "η = {eta}: {of_walls} is not {of_impacts}");
    }
}

#[test]
fn walls_raise_the_pressure_of_a_small_box_as_scaled_particle_theory_says() {
    // By 1.9, 4.0 and 2.0 %; the corners add some tenths at most.
    for (side, eta, published) in [(10, 0.3, 2.0633), (10, 0.5, 4.107), (20, 0.5, 4.107)] {
        let mut simulation = gas(side, eta, 1000.0);
        advance_by_impacts(&mut simulation, 0.01, 100_000);
        let (of_impacts, of_walls) = compressibilities(&mut simulation, 1_500_000);
        let (raised, expected) = (of_impacts / published, walls_factor(&simulation, eta));
        assert!((raised - expected).abs() < 0.005, "{side}² discs, η = {eta}: {raised} is not {expected}");
        assert!((of_walls / of_impacts - 1.0).abs() < 0.01, "η = {eta}: {of_walls} is not {of_impacts}");
    }
}

#[test]
fn equal_speeds_become_maxwellian() {
    // Maxwell (1860): in 2D the part of balls slower than v is 1 − exp(−v²/⟨v²⟩), so that ⟨|v|⟩² = π/4·⟨v²⟩ and
    // ⟨v⁴⟩ = 2⟨v²⟩².
    let mut simulation = gas(32, 0.2, 1000.0);
    let mean = 2.0 * temperature(&simulation);
    advance_by_impacts(&mut simulation, 0.01, 50_000);
    let mut squares = Vec::new();
    for _ in 0..800 {
        // Some five impacts of each ball.
        simulation.advance(0.01).unwrap();
        squares.extend(simulation.balls().iter().map(|ball| ball.velocity().length_squared() / mean));
    }
    let count = squares.len() as f64;
    let moment = |power: f64| squares.iter().map(|square: &f64| square.powf(power)).sum::<f64>() / count;
    let (first, second, fourth) = (moment(0.5), moment(1.0), moment(2.0));
    assert!((second - 1.0).abs() < 1e-13, "{second}");
    // Both within four standard errors.
    assert!((first * first / (PI / 4.0) - 1.0).abs() < 0.003, "{first}");
    assert!((fourth / 2.0 - 1.0).abs() < 0.01, "{fourth}");
    squares.sort_by(f64::total_cmp);
    let distances = squares.iter().enumerate().map(|(rank, square)| {
        let expected = 1.0 - (-square).exp();
        (rank as f64 / count - expected).abs().max(((rank + 1) as f64 / count - expected).abs())
    });
    let distance = distances.fold(0.0, f64::max) * count.sqrt();
    // Kolmogorov (1933): samples are farther off once in a thousand times.
    assert!(distance < 1.95, "{distance}");
}

#[test]
fn a_granular_gas_cools_by_haffs_law() {
    // Haff (1983): T = T₀/(1 + t/τ)² with τ = 4/((1 − e²)ω₀), and ω₀ the rate of impacts per disc by Enskog's theory.
    // It holds until the gas swirls and clusters, which it cannot in so small a box (Goldhirsch & Zanetti 1993):
    // viscosity stops a vortex of its size faster than the gas cools. Few balls make noise, so there are many runs.
    const RUNS: u32 = 60;
    for (side, eta, e) in [(20, 0.1, 0.95), (15, 0.1, 0.9)] {
        let mut elastic = gas(side, eta, 1e6);
        let mut ratios = [0.0; 6];
        for _ in 0..RUNS {
            advance_by_impacts(&mut elastic, 1e-5, 10 * (side * side) as u64);
            let balls = elastic.balls().iter().map(|ball| ball.with_restitution(e).unwrap()).collect();
            let mut simulation = Simulation::new(*elastic.world(), balls, Solver::Exact).unwrap();
            let start = temperature(&simulation);
            let (density, diameter) = (eta / PI, 2.0);
            let contact = (1.0 - 7.0 * eta / 16.0) / (1.0 - eta).powi(2);
            let rate = 2.0 * density * diameter * contact * (PI * start).sqrt();
            let tau = 4.0 / ((1.0 - e * e) * rate);
            for (taus, ratio) in (1..).zip(&mut ratios) {
                simulation.advance(tau).unwrap();
                let expected = start / f64::from(1 + taus).powi(2);
                *ratio += temperature(&simulation) / expected / f64::from(RUNS);
            }
        }
        // The last at a forty-ninth of the temperature.
        assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < 0.025), "e = {e}: {ratios:?}");
    }
}

#[test]
fn a_scene_gives_the_same_bits_on_every_run_and_machine_and_however_it_is_cut_into_frames() {
    // The hashes are those of the first run: all is + − × ÷ and √, which IEEE 754 rounds in one way only.
    let gravity = || Scene::load("gravity").unwrap().with_solver(Solver::Exact).build().unwrap();
    let discs = || gas(22, 0.3, 200.0);
    let scenes: [(&dyn Fn() -> Simulation, u64); 2] =
        [(&gravity, 0xae0d_ccc8_a258_fdca), (&discs, 0x47A7_C54E_5479_8587)];
    for (build, expected) in scenes {
        for frames in
            [&[4.0; 1][..], &[4.0; 1], &[1.0 / 60.0; 240], &[1.0 / 144.0; 576], &[0.1, 0.7, 0.0, 3.2]]
        {
            let mut simulation = build();
            for &delta in frames {
                simulation.advance(delta).unwrap();
            }
            assert_eq!(hash(&simulation), expected, "{:#X}, {} frames", hash(&simulation), frames.len());
        }
        let mut simulation = build();
        while simulation.time() < 4.0 {
            // As often as the solver lets itself be interrupted.
            simulation.advance_while(4.0 - simulation.time(), || false).unwrap();
        }
        assert_eq!(hash(&simulation), expected, "{:#X}, interrupted", hash(&simulation));
    }
}

#[test]
fn an_hour_of_frames_ends_on_the_same_bits_as_one_step_of_an_hour() {
    let elastic = || Scene::load("elastic").unwrap().with_solver(Solver::Exact).build().unwrap();
    let mut once = elastic();
    let start = kinetic_energy(once.balls());
    once.advance(3600.0).unwrap();
    assert!(once.tally().impacts > 10_000, "{:?}", once.tally());
    // The number next to 1/60 is so much less that an hour of it ends 5·10⁻¹⁴ s early.
    for (rate, rest) in [(60.0, 5e-14), (64.0, 0.0)] {
        let mut simulation = elastic();
        let (mut drift, mut escape) = (0.0_f64, 0.0_f64);
        for _ in 0..(3600.0 * rate) as u32 {
            simulation.advance(1.0 / rate).unwrap();
            drift = drift.max((kinetic_energy(simulation.balls()) / start - 1.0).abs());
            escape = escape.max(max_wall_overlap(simulation.world(), simulation.balls()));
        }
        simulation.advance(rest).unwrap();
        assert_eq!(hash(&simulation), hash(&once), "{rate} Hz");
        assert!(drift < 1e-13, "{rate} Hz: {drift:e}");
        assert!(escape < 1e-13, "{rate} Hz: {escape:e}");
    }
}

#[test]
fn after_an_hour_at_sixty_frames_a_second_a_ball_is_where_its_unfolded_line_ends() {
    let world = World::new(DVec2::new(1280.0, 720.0)).unwrap().with_walls(1.0).unwrap();
    // No period: the sides and the velocity have no common measure.
    let velocity = DVec2::new(700.0 * 2_f64.sqrt(), -500.0 * 3_f64.sqrt());
    let ball = Ball::new(DVec2::new(300.0, 200.0), 10.0).unwrap().with_velocity(velocity).unwrap();
    let mut simulation = Simulation::new(world, vec![ball], Solver::Exact).unwrap();
    for _ in 0..216_000 {
        simulation.advance(1.0 / 60.0).unwrap();
    }
    let fold = |at: f64, span: f64| {
        let within = at.rem_euclid(2.0 * span);
        if within > span { 2.0 * span - within } else { within }
    };
    let x = 10.0 + fold(290.0 + velocity.x * 3600.0, 1260.0);
    let y = 10.0 + fold(190.0 + velocity.y * 3600.0, 700.0);
    let error = (simulation.balls()[0].position() - DVec2::new(x, y)).length();
    assert!(simulation.tally().wall_hits > 7000, "{:?}", simulation.tally());
    // Each bounce is timed to 10⁻¹³ s, the rounding of times of some 10³ s, in which the ball moves 10⁻¹⁰ px: √7000
    // times that.
    assert!(error < 2e-8, "{error:e}");
}
