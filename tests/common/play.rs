//! Any bytes, played: a scene that they describe, and what they do to it, with the laws held against every frame.
//!
//! The tests and the fuzz targets share it. Every choice takes the next byte or two, and 0 where there are no more, so
//! that whatever shortens the bytes finds a simpler game.

use carom::simulation::ledger::Ledger;
use carom::{Change, Command, DVec2, Scene, Session, Simulation, Solver};

/// How often, in one game, a solver may ask whether to go on: what bounds the work.
const LOOKS: u32 = 400;

/// Bytes to choose by.
struct Choices<'a>(&'a [u8]);

impl Choices<'_> {
    fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[usize::from(self.byte()) % choices.len()]
    }

    /// Yes, once in so many times.
    fn one_in(&mut self, times: u8) -> bool {
        self.byte().is_multiple_of(times)
    }

    /// From 0 to 1, both included.
    fn share(&mut self) -> f64 {
        f64::from(u16::from_le_bytes([self.byte(), self.byte()])) / f64::from(u16::MAX)
    }

    /// From −1 to 1.
    fn signed(&mut self) -> f64 {
        2.0 * self.share() - 1.0
    }

    /// Ten to the power of something in this range.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        10_f64.powf(low + (high - low) * self.share())
    }

    fn delta(&mut self) -> f64 {
        match self.byte() % 6 {
            0..=2 => 1.0 / 60.0,
            3 => self.one_of(&[0.0, 1e-9, 1.0 / 240.0, 0.1, 1.0, 1e6]),
            4 => self.share(),
            _ => self.decades(-12.0, 6.0),
        }
    }
}

/// The text of the scene that the bytes begin with.
fn scene(choices: &mut Choices<'_>) -> String {
    let (width, height) = match choices.byte() % 4 {
        0..=2 => (100 + 2 * u32::from(choices.byte()), 100 + 2 * u32::from(choices.byte())),
        _ => (choices.decades(0.0, 6.0) as u32, choices.decades(0.0, 6.0) as u32),
    };
    let (width, height) = (width.clamp(1, 1_000_000), height.clamp(1, 1_000_000));
    let solver = choices.one_of(Solver::ALL);
    let mut text = format!("solver = \"{solver}\"\nsize = [{width}, {height}]\n");
    let gravity = match choices.byte() % 4 {
        0 => None,
        1 | 2 => Some((0.0, 980.0)),
        _ => {
            let pull = choices.decades(-3.0, 5.0);
            Some((pull * choices.signed(), pull * choices.signed()))
        }
    };
    if let Some((x, y)) = gravity {
        text += &format!("gravity = [{x:?}, {y:?}]\n");
    }
    let restitutions = [0.0, 0.5, 0.8, 1.0, 1.0];
    if !choices.one_in(5) {
        text += &format!("[walls]\nrestitution = {:?}\n", choices.one_of(&restitutions));
    }
    match choices.byte() % 6 {
        0 => {}
        1 => text += "[pairs]\nresponse = \"detect\"\n",
        _ => text += "[pairs]\n",
    }
    let least = f64::from(width.min(height)) / 2.0;
    for _ in 0..choices.byte() % 16 {
        let radius = (least * choices.decades(-3.0, 0.0)).max(1e-6);
        let place = |side: u32, share: f64| radius + (f64::from(side) - 2.0 * radius) * share;
        let (x, y) = (place(width, choices.share()), place(height, choices.share()));
        text += &format!("[[ball]]\nposition = [{x:?}, {y:?}]\nradius = {radius:?}\n");
        text += &format!("restitution = {:?}\n", choices.one_of(&restitutions));
        if choices.one_in(8) {
            text += "fixed = true\n";
        } else {
            let speed = choices.decades(0.0, 6.0);
            let (vx, vy) = (speed * choices.signed(), speed * choices.signed());
            text += &format!("velocity = [{vx:?}, {vy:?}]\nmass = {:?}\n", choices.decades(-3.0, 6.0));
        }
    }
    if choices.one_in(3) {
        let radius = (least / 8.0 * choices.decades(-2.0, 0.0)).max(1e-6);
        text += &format!("[[fill]]\ncount = {}\nradius = {radius:?}\n", choices.byte() % 64);
        text += &format!("speed = {:?}\n", choices.decades(-1.0, 4.0));
        text += &format!("restitution = {:?}\nseed = {}\n", choices.one_of(&restitutions), choices.byte());
    }
    if choices.one_in(8) {
        let radius = (least / 8.0 * choices.decades(-2.0, 0.0)).max(1e-6);
        text += &format!("[rain]\nrate = {:?}\nradius = {radius:?}\n", choices.decades(-3.0, 2.0));
    }
    text
}

/// Plays the bytes; panics where a law is broken, with the scene and how it came to it.
pub fn play(bytes: &[u8]) {
    let mut choices = Choices(bytes);
    let text = scene(&mut choices);
    let scene = Scene::parse("played.toml", &text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    // A fill that finds no room is refused, and said so.
    let Ok(simulation) = scene.build() else { return };
    let mut told = format!("{text}# played:\n");
    let mut looks = LOOKS;
    if choices.one_in(2) {
        play_simulation(simulation, &mut choices, &mut told, &mut looks);
    } else {
        let session = Session::new(&scene, choices.byte().into()).expect("it was built before");
        play_session(session, scene.rain().is_some(), &mut choices, &mut told, &mut looks);
    }
}

/// Says whether to go on, until the looks are used up, and panics where it is asked after a no.
fn watch(looks: &mut u32) -> impl FnMut() -> bool + '_ {
    let mut said_no = false;
    move || {
        assert!(!said_no, "asked again after a no");
        *looks = looks.saturating_sub(1);
        said_no = *looks == 0;
        !said_no
    }
}

fn hold(ledger: &mut Ledger, simulation: &Simulation, told: &str) {
    if let Err(violation) = ledger.check(simulation) {
        panic!("{} at {} s: {violation}\n{told}", simulation.solver(), simulation.time());
    }
}

fn play_simulation(
    mut simulation: Simulation,
    choices: &mut Choices<'_>,
    told: &mut String,
    looks: &mut u32,
) {
    let mut ledger = Ledger::new(&simulation);
    while !choices.0.is_empty() && *looks > 0 {
        match choices.byte() % 16 {
            0 => {
                simulation.set_solver(choices.one_of(Solver::ALL));
                told.push_str(&format!("# {}\n", simulation.solver()));
            }
            1 => {
                let size = simulation.world().size() * choices.decades(-1.0, 1.0);
                told.push_str(&format!("# resize to {size}\n"));
                // A world that would be too large stays as it is.
                let _ = simulation.resize(size);
            }
            2 => {
                let pull = choices.decades(-3.0, 4.0);
                let gravity = DVec2::new(pull * choices.signed(), pull * choices.signed());
                told.push_str(&format!("# gravity {gravity}\n"));
                simulation.set_gravity(gravity).expect("gravity in range");
            }
            3 => {
                told.push_str("# remove the last\n");
                simulation.remove_last();
            }
            _ => {
                let delta = choices.delta();
                told.push_str(&format!("# advance {delta:?}\n"));
                let before = simulation.time();
                let done = simulation.advance_while(delta, watch(looks)).expect("a delta in range");
                assert!((0.0..=delta).contains(&done) && simulation.time() >= before, "{done}\n{told}");
                hold(&mut ledger, &simulation, told);
                continue;
            }
        }
        ledger = Ledger::new(&simulation);
    }
}

fn play_session(
    mut session: Session,
    rains: bool,
    choices: &mut Choices<'_>,
    told: &mut String,
    looks: &mut u32,
) {
    let open = |session: &Session| {
        let ledger = Ledger::new(session.simulation());
        // Several steps, or what falls in, are several advances.
        if rains || session.is_paused() || session.name() == "rain" {
            ledger.without_flights()
        } else {
            ledger
        }
    };
    let mut ledger = open(&session);
    while !choices.0.is_empty() && *looks > 0 {
        if !choices.one_in(3) {
            let measured = choices.delta();
            told.push_str(&format!("# frame {measured:?}\n"));
            let in_the_past = session.is_in_the_past();
            session.advance_while(measured, watch(looks)).expect("a time in range");
            if in_the_past {
                // What was done after that is done again with the frames.
                ledger = open(&session);
                continue;
            }
            hold(&mut ledger, session.simulation(), told);
            continue;
        }
        let command = command(choices, session.simulation().world().size());
        told.push_str(&format!("# {command:?}\n"));
        // What cannot be done is said, and leaves a session that can be played on.
        let _ = session.apply(command);
        ledger = open(&session);
    }
}

fn command(choices: &mut Choices<'_>, size: DVec2) -> Command {
    let place = |choices: &mut Choices<'_>| size * DVec2::new(choices.share(), choices.share());
    let change = match choices.byte() % 24 {
        0 => return Command::TogglePause,
        1 => return Command::Step,
        2 => Change::Reset,
        3 => Change::AddRandom(usize::from(choices.byte() % 32)),
        4 => Change::AddRandom(choices.one_of(&[0, 1, 100, usize::MAX])),
        5 | 6 => {
            let position = place(choices);
            let speed = choices.decades(0.0, 10.0);
            let velocity = speed * DVec2::new(choices.signed(), choices.signed());
            let radius = choices.one_of(&[20.0, 3.0, 200.0, -1.0, f64::NAN]);
            Change::AddBall { position, velocity, radius }
        }
        7 => Change::RemoveLast,
        // The demo's stages: thousands of balls that are squeezed into a small world take long.
        8..=10 => return Command::Scene(usize::from(choices.byte() % 8)),
        11 => return Command::NextSolver,
        12 => Change::ToggleGravity,
        13 => {
            let by = choices.one_of(&[10.0, 1e3, 1e9, 2e9, f64::NAN]);
            Change::TiltGravity(by * DVec2::new(choices.signed(), choices.signed()))
        }
        14 => return Command::Slower,
        15 => return Command::Faster,
        16 | 17 => {
            Change::Carry { ball: usize::from(choices.byte() % 20), to: 2.0 * place(choices) - size / 2.0 }
        }
        18 => Change::Place { ball: usize::from(choices.byte() % 20), at: 2.0 * place(choices) - size / 2.0 },
        19 => Change::Remove(usize::from(choices.byte() % 20)),
        20 => return Command::Back,
        21 => return Command::ToggleComparison,
        22 => return Command::Reseed,
        _ => return Command::StepToImpact,
    };
    change.into()
}
