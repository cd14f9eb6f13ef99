//! What a run came to.

use std::fmt;

use serde::Serialize;

use crate::session::Played;
use crate::simulation::Simulation;
use crate::simulation::invariants::{kinetic_energy, momentum, non_finite, potential_energy};

/// The figures of a run, as `--summary` writes them. Units are px, s and the scene's unit of mass.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// The scene's name.
    pub scene: String,
    /// The solver's name.
    pub solver: &'static str,
    /// How many balls there are.
    pub balls: usize,
    /// How many frames were run.
    pub frames: u64,
    /// The simulated time since the start, whatever a replay resets, s.
    pub seconds: f64,
    /// The time that `advance` took in all, s.
    pub wall_seconds: f64,
    /// The same per ball and frame, ns.
    pub ns_per_ball_frame: f64,
    /// Impacts between balls since then.
    pub collisions: u64,
    /// Impacts on walls since then.
    pub wall_hits: u64,
    /// Kinetic energy at the end.
    pub kinetic_energy: f64,
    /// Potential energy at the end, 0 at the floor.
    pub potential_energy: f64,
    /// Kinetic and potential energy at the start.
    pub energy_start: f64,
    /// Momentum at the end.
    pub momentum: [f64; 2],
    /// The deepest overlap of two balls at a frame, as a fraction of the smaller radius.
    pub max_overlap: f64,
    /// The deepest overlap of a ball and a wall at a frame, as a fraction of its radius.
    pub max_wall_overlap: f64,
    /// Balls with a NaN or an infinity at the end.
    pub non_finite: usize,
    /// What else has changed the energy, beside the solver; not in the JSON.
    #[serde(skip)]
    pub(super) fed: Option<&'static str>,
}

/// What is watched while a run goes on; the fields are those of [`Summary`].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Watched {
    /// Seconds, collisions and wall hits.
    pub(super) played: Played,
    pub(super) energy_start: f64,
    pub(super) frames: u64,
    pub(super) wall_seconds: f64,
    pub(super) max_overlap: f64,
    pub(super) max_wall_overlap: f64,
}

impl Summary {
    pub(super) fn new(
        scene: &str,
        simulation: &Simulation,
        watched: &Watched,
        fed: Option<&'static str>,
    ) -> Self {
        let balls = simulation.balls();
        let ball_frames = balls.len().max(1) as f64 * watched.frames.max(1) as f64;
        let Played { seconds, impacts, wall_hits } = watched.played;
        Self {
            scene: scene.to_owned(),
            solver: simulation.solver().name(),
            balls: balls.len(),
            frames: watched.frames,
            seconds,
            wall_seconds: watched.wall_seconds,
            ns_per_ball_frame: watched.wall_seconds * 1e9 / ball_frames,
            collisions: impacts,
            wall_hits,
            kinetic_energy: kinetic_energy(balls),
            potential_energy: potential_energy(simulation.world(), balls),
            energy_start: watched.energy_start,
            momentum: momentum(balls).to_array(),
            max_overlap: watched.max_overlap,
            max_wall_overlap: watched.max_wall_overlap,
            non_finite: non_finite(balls),
            fed,
        }
    }
}

/// A number of things, and what they are called.
fn counted(count: u64, name: &str) -> String {
    format!("{count} {name}{}", if count == 1 { "" } else { "s" })
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let energy = self.kinetic_energy + self.potential_energy;
        let balls = counted(self.balls as u64, "ball");
        writeln!(f, "scene        {} with {balls}, solver {}", self.scene, self.solver)?;
        writeln!(f, "simulated    {:.6} s in {}", self.seconds, counted(self.frames, "frame"))?;
        writeln!(
            f,
            "run time     {:.6} s, {:.1} ns per ball and frame",
            self.wall_seconds, self.ns_per_ball_frame
        )?;
        writeln!(f, "impacts      {} between balls, {} on walls", self.collisions, self.wall_hits)?;
        write!(f, "energy       {energy:.6e}, at the start {:.6e}", self.energy_start)?;
        if let Some(fed) = self.fed {
            write!(f, "; {fed}")?;
        } else if self.energy_start > 0.0 {
            // Adding zero turns a rounded −0 into 0.
            let change = (1e5 * (energy / self.energy_start - 1.0)).round() / 1e3 + 0.0;
            write!(f, " ({change:+.3} %)")?;
        }
        writeln!(f)?;
        writeln!(f, "momentum     [{:.6e}, {:.6e}]", self.momentum[0], self.momentum[1])?;
        writeln!(
            f,
            "overlap      at most {:.4} of a radius between balls, {:.4} with walls, over the run",
            self.max_overlap, self.max_wall_overlap
        )?;
        write!(f, "not finite   {}", counted(self.non_finite as u64, "ball"))
    }
}
