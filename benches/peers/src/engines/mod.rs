//! The engines, behind one trait: made from a scene, stepped frame by frame, asked for their balls' state.

mod box2d;
mod carom;
mod rapier;

use std::error::Error;

use ::carom::{DVec2, Solver};

use crate::scenes::{Kind, Scene};

/// How many px are one metre to the engines that are tuned for metres.
const PX_PER_METRE: f64 = 50.0;
/// How thick their walls are, px: thicker than the fastest ball that they let pass gets in a frame.
const WALL: f64 = 500.0;

/// Why an engine could not go on.
pub type Failure = Box<dyn Error>;

/// A physics engine with a scene in it.
pub trait Engine {
    /// Moves on by one frame.
    fn step(&mut self, seconds: f64) -> Result<(), Failure>;
    /// Replaces `states` by those of the balls, in the scene's order. It takes `&mut self` because Box2D's safe interface
    /// reads a body through a mutable borrow of its world.
    fn state(&mut self, states: &mut Vec<State>) -> Result<(), Failure>;
}

/// Where a ball is and how it moves, px and px/s.
#[derive(Debug, Clone, Copy)]
pub struct State {
    pub position: DVec2,
    pub velocity: DVec2,
}

/// An engine that can be chosen; carom is one for each of its solvers.
#[derive(Debug, Clone, Copy)]
pub enum Maker {
    Carom(Solver),
    Rapier,
    Box2d,
}

impl Maker {
    /// All of them, in the table's order.
    pub fn all() -> Vec<Self> {
        let solvers = Solver::ALL.iter().map(|&solver| Self::Carom(solver));
        solvers.chain([Self::Rapier, Self::Box2d]).collect()
    }

    /// The name in the table.
    pub fn name(self) -> String {
        match self {
            Self::Carom(solver) => format!("carom `{solver}`"),
            Self::Rapier => "Rapier".to_owned(),
            Self::Box2d => "Box2D".to_owned(),
        }
    }

    /// Why this engine is not run on such a scene, if it is not.
    pub fn unsuited(self, kind: Kind) -> Option<&'static str> {
        match (self, kind) {
            (Self::Carom(Solver::Exact), Kind::Pile(_)) => {
                Some("it follows every tiny impact in a pile, far slower than real time")
            }
            // A thousand balls show it.
            (Self::Carom(Solver::Canvas), Kind::Pile(1001..)) => {
                Some("it moves no balls apart: they sink into a layer in which all overlap")
            }
            _ => None,
        }
    }

    /// The engine with the scene in it.
    pub fn start(self, scene: &Scene) -> Result<Box<dyn Engine>, Failure> {
        Ok(match self {
            Self::Carom(solver) => Box::new(carom::Carom::new(scene, solver)?),
            Self::Rapier => Box::new(rapier::Rapier::new(scene)),
            Self::Box2d => Box::new(box2d::Box2d::new(scene)?),
        })
    }
}

/// The four walls around a world of this size as boxes: centre and half extents, px.
fn walls(size: DVec2) -> [(DVec2, DVec2); 4] {
    let (middle, half) = (size / 2.0, DVec2::splat(WALL / 2.0));
    // Those above and below cover the corners.
    let (flat, upright) = (DVec2::new(middle.x + WALL, half.y), DVec2::new(half.x, middle.y));
    [
        (DVec2::new(middle.x, -half.y), flat),
        (DVec2::new(middle.x, size.y + half.y), flat),
        (DVec2::new(-half.x, middle.y), upright),
        (DVec2::new(size.x + half.x, middle.y), upright),
    ]
}

/// A vector in metres.
fn metres(px: DVec2) -> [f32; 2] {
    (px / PX_PER_METRE).to_array().map(|component| component as f32)
}

/// A vector in px.
fn px(x: f32, y: f32) -> DVec2 {
    DVec2::new(x.into(), y.into()) * PX_PER_METRE
}
