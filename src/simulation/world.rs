//! The world that balls move in, and what it leaves out.

use glam::DVec2;

use super::limits::{GRAVITY, OutOfRange, RESTITUTION, SIZE};

/// A rectangle from (0, 0) to `size`, with gravity, walls and contacts between balls where they are asked for.
///
/// What is not asked for does not exist: a solver decides once, from this, which of its parts run.
///
/// ```
/// use carom::{DVec2, Pairs, World};
///
/// let world = World::new(DVec2::new(1280.0, 720.0))?
///     .with_gravity(DVec2::new(0.0, 980.0))?
///     .with_walls(0.8)?
///     .with_pairs(Pairs::Impulse);
/// assert_eq!(world.walls(), Some(0.8));
/// # Ok::<(), carom::OutOfRange>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct World {
    pub(super) size: DVec2,
    pub(super) gravity: Option<DVec2>,
    pub(super) walls: Option<f64>,
    pub(super) pairs: Option<Pairs>,
}

/// What happens where two balls touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pairs {
    /// Contacts are found and shown; balls fly through each other.
    Detect,
    /// Contacts exchange momentum along the line of centres.
    Impulse,
}

impl World {
    /// A world of `size` px with no gravity, no walls and no contacts.
    ///
    /// # Errors
    /// [`OutOfRange`] where a side is not in the range of sizes.
    pub fn new(size: DVec2) -> Result<Self, OutOfRange> {
        Ok(Self { size: SIZE.check_vector(size)?, gravity: None, walls: None, pairs: None })
    }

    /// The same world, of another size.
    ///
    /// # Errors
    /// [`OutOfRange`] where a side is not in the range of sizes.
    pub fn with_size(self, size: DVec2) -> Result<Self, OutOfRange> {
        Ok(Self { size: SIZE.check_vector(size)?, ..self })
    }

    /// The same world with this acceleration, px/s², on every ball. Zero is no gravity at all.
    ///
    /// # Errors
    /// [`OutOfRange`] where a component is not in the range of gravity.
    pub fn with_gravity(self, gravity: DVec2) -> Result<Self, OutOfRange> {
        let gravity = GRAVITY.check_vector(gravity)?;
        Ok(Self { gravity: (gravity != DVec2::ZERO).then_some(gravity), ..self })
    }

    /// The same world with walls on its four edges that give back `restitution` of the speed of approach.
    ///
    /// # Errors
    /// [`OutOfRange`] where the restitution is not from 0 to 1.
    pub fn with_walls(self, restitution: f64) -> Result<Self, OutOfRange> {
        Ok(Self { walls: Some(RESTITUTION.check(restitution)?), ..self })
    }

    /// The same world in which balls notice each other.
    #[must_use]
    pub fn with_pairs(self, pairs: Pairs) -> Self {
        Self { pairs: Some(pairs), ..self }
    }

    /// Width and height, px.
    #[must_use]
    pub fn size(&self) -> DVec2 {
        self.size
    }

    /// Acceleration on every ball, px/s²; `None` where there is none.
    #[must_use]
    pub fn gravity(&self) -> Option<DVec2> {
        self.gravity
    }

    /// The walls' coefficient of restitution; `None` where there are no walls.
    #[must_use]
    pub fn walls(&self) -> Option<f64> {
        self.walls
    }

    /// What happens where two balls touch; `None` where nothing does.
    #[must_use]
    pub fn pairs(&self) -> Option<Pairs> {
        self.pairs
    }
}
