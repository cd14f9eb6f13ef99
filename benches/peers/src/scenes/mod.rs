//! The scenes: what every engine starts from, and over which frames it is measured.

mod states;

use carom::{Ball, DVec2, World};
use states::{bullet, column, gas, heavy, pile};

use crate::engines::{Failure, State};

/// Frames a second.
pub const FPS: u32 = 60;

/// A scene, by what it is made of.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// So many elastic balls without gravity.
    Gas(u32),
    /// So many balls that fall onto a heap.
    Pile(u32),
    /// The demo's fifteen balls.
    Demo,
    /// A ball so many times as heavy as the one that it lies on.
    Heavy(f64),
    /// So many balls, one on top of the other.
    Column(u32),
    /// A ball so fast that it is past its target within a frame, and whether engines that look for impacts between frames
    /// only on demand are asked to.
    Bullet(bool),
}

/// How much of the list is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Size {
    Quick,
    Normal,
    Large,
}

/// What all engines start from.
#[derive(Debug)]
pub struct Scene {
    pub kind: Kind,
    pub world: World,
    pub balls: Vec<Ball>,
    pub spans: Vec<Span>,
    /// Few balls' spans are timed as wholes in so many runs at most; 0: in windows of a single run.
    pub runs: usize,
}

/// Frames that are measured, from the end of `from` to the end of `to`.
#[derive(Debug, Clone, Copy)]
pub struct Span {
    pub from: u32,
    pub to: u32,
    /// How many of them are timed at once; after each such window the state is looked at.
    pub window: u32,
    /// Whether all should lie still at the end.
    pub settled: bool,
}

/// The names that the command line knows.
pub const NAMES: &[&str] = &["gas", "pile", "demo", "heavy", "column", "bullet"];

impl Kind {
    /// All scenes of such a list, in the table's order.
    pub fn all(size: Size) -> Vec<Self> {
        let mut kinds = Vec::new();
        let mut add = |from: Size, kind: Self| {
            if size >= from {
                kinds.push(kind);
            }
        };
        add(Size::Quick, Self::Gas(100));
        add(Size::Quick, Self::Gas(1000));
        add(Size::Normal, Self::Gas(10_000));
        add(Size::Normal, Self::Gas(100_000));
        add(Size::Quick, Self::Pile(1000));
        add(Size::Normal, Self::Pile(10_000));
        add(Size::Normal, Self::Pile(50_000));
        add(Size::Large, Self::Pile(100_000));
        add(Size::Quick, Self::Demo);
        for mass in [1e2, 1e4, 1e6] {
            add(Size::Quick, Self::Heavy(mass));
        }
        add(Size::Quick, Self::Column(20));
        add(Size::Quick, Self::Column(100));
        add(Size::Quick, Self::Bullet(false));
        add(Size::Quick, Self::Bullet(true));
        kinds
    }

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gas(_) => "gas",
            Self::Pile(_) => "pile",
            Self::Demo => "demo",
            Self::Heavy(_) => "heavy",
            Self::Column(_) => "column",
            Self::Bullet(_) => "bullet",
        }
    }

    /// The name in the table.
    pub fn title(self) -> String {
        match self {
            Self::Demo | Self::Bullet(false) => self.name().to_owned(),
            Self::Bullet(true) => "bullet, CCD".to_owned(),
            Self::Heavy(mass) => format!("heavy {mass:e}"),
            Self::Gas(count) | Self::Pile(count) | Self::Column(count) if count % 1000 == 0 => {
                format!("{} {}k", self.name(), count / 1000)
            }
            Self::Gas(count) | Self::Pile(count) | Self::Column(count) => format!("{} {count}", self.name()),
        }
    }

    /// The scene itself, the same each time.
    pub fn build(self) -> Result<Scene, Failure> {
        match self {
            Self::Gas(count) => gas(self, count),
            Self::Pile(count) => pile(self, count),
            Self::Demo => {
                let demo = carom::Scene::load("gravity")?.build()?;
                Ok(Scene::short(self, *demo.world(), demo.balls().to_vec(), 10 * FPS))
            }
            Self::Heavy(mass) => Ok(heavy(self, mass)?),
            Self::Column(count) => Ok(column(self, count)?),
            Self::Bullet(_) => Ok(bullet(self)?),
        }
    }

    /// What the scene is there to tell, from the first and the last state.
    pub fn outcome(self, scene: &Scene, last: &[State]) -> Option<String> {
        let (first, size) = (&scene.balls, scene.world.size());
        match self {
            Self::Gas(_) | Self::Pile(_) | Self::Demo => None,
            Self::Heavy(_) => {
                let gap = size.y - first[1].radius() - last[1].position.y;
                Some(format!("gap {} px of 20", hundredths(gap)))
            }
            Self::Column(count) => {
                let sunk = last.last()?.position.y - first.last()?.position().y;
                Some(format!("sank {} px of {}", hundredths(sunk), 20 * count))
            }
            Self::Bullet(_) => {
                let hit = if last[1].velocity.length() > 1.0 { "hit" } else { "missed" };
                Some(format!("{hit}, then {:.0} px/s", last[0].velocity.length()))
            }
        }
    }
}

/// Two decimals, and no minus before a zero.
fn hundredths(value: f64) -> String {
    format!("{:.2}", (value * 100.0).round() / 100.0 + 0.0).replace('-', "−")
}

impl Scene {
    /// Whether impacts of this ball are to be searched for between frames. Box2D does so against other balls only where
    /// those are no bullets too.
    pub fn is_bullet(&self, ball: &Ball) -> bool {
        matches!(self.kind, Kind::Bullet(true)) && ball.velocity() != DVec2::ZERO
    }

    /// A scene of few balls, timed as a whole.
    fn short(kind: Kind, world: World, balls: Vec<Ball>, frames: u32) -> Self {
        // The demo's small balls roll on along the floor for long.
        let settled = matches!(kind, Kind::Heavy(_) | Kind::Column(_));
        let spans = vec![Span { from: 0, to: frames, window: 1, settled }];
        Self { kind, world, balls, spans, runs: 50 }
    }
}
