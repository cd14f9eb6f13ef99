//! Rapier: its defaults, without friction and sleep.

use carom::DVec2;
use rapier2d::prelude::{
    CoefficientCombineRule, ColliderBuilder, PhysicsWorld, RigidBodyBuilder, RigidBodyHandle, Vector,
};

use super::{Engine, Failure, PX_PER_METRE, State, metres, px, walls};
use crate::scenes::Scene;

/// A world of Rapier's, and its balls in the scene's order.
pub struct Rapier {
    world: PhysicsWorld,
    balls: Vec<RigidBodyHandle>,
}

impl Rapier {
    pub fn new(scene: &Scene) -> Self {
        let mut world = PhysicsWorld {
            gravity: vector(scene.world.gravity().unwrap_or_default()),
            ..PhysicsWorld::default()
        };
        if let Some(restitution) = scene.world.walls() {
            for (centre, half) in walls(scene.world.size()) {
                let half = vector(half);
                // Of the rules of two colliders the larger one holds, and `Max` is larger than `Min`: with a wall its
                // own restitution counts, which is never the smaller one here; between balls the smaller of theirs.
                let wall = ColliderBuilder::cuboid(half.x, half.y)
                    .translation(vector(centre))
                    .friction(0.0)
                    .restitution(restitution as f32)
                    .restitution_combine_rule(CoefficientCombineRule::Max);
                world.insert(RigidBodyBuilder::fixed(), wall);
            }
        }
        let ball = |ball: &carom::Ball| {
            let body = RigidBodyBuilder::dynamic()
                .translation(vector(ball.position()))
                .linvel(vector(ball.velocity()))
                .can_sleep(false)
                .ccd_enabled(scene.is_bullet(ball));
            let collider = ColliderBuilder::ball((ball.radius() / PX_PER_METRE) as f32)
                .mass(ball.mass() as f32)
                .friction(0.0)
                .restitution(ball.restitution() as f32)
                .restitution_combine_rule(CoefficientCombineRule::Min);
            world.insert(body, collider).0
        };
        let balls = scene.balls.iter().map(ball).collect();
        Self { world, balls }
    }
}

impl Engine for Rapier {
    fn step(&mut self, seconds: f64) -> Result<(), Failure> {
        self.world.integration_parameters.dt = seconds as f32;
        self.world.step();
        Ok(())
    }

    fn state(&mut self, states: &mut Vec<State>) -> Result<(), Failure> {
        states.clear();
        states.extend(self.balls.iter().map(|&handle| {
            let body = &self.world.bodies[handle];
            let (position, velocity) = (body.translation(), body.linvel());
            State { position: px(position.x, position.y), velocity: px(velocity.x, velocity.y) }
        }));
        Ok(())
    }
}

/// A vector of Rapier's, in metres.
fn vector(px: DVec2) -> Vector {
    Vector::from_array(metres(px))
}
