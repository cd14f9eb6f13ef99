//! Box2D: its defaults with four substeps, without friction and sleep.

use std::f64::consts::PI;

use boxdd::{BodyId, BodyType, Foundation, ShapeDef, SurfaceMaterial, Vec2, WorkerCount, World, shapes};

use super::{Engine, Failure, PX_PER_METRE, State, metres, px, walls};
use crate::scenes::Scene;

/// What Box2D's manual and samples use.
const SUBSTEPS: i32 = 4;

/// A world of Box2D's, and its balls in the scene's order.
pub struct Box2d {
    world: World,
    balls: Vec<BodyId>,
}

impl Box2d {
    pub fn new(scene: &Scene) -> Result<Self, Failure> {
        let foundation = Foundation::initialize_default()?;
        let definition = foundation
            .world_builder()
            .gravity(metres(scene.world.gravity().unwrap_or_default()))
            .enable_sleep(false)
            .worker_count(WorkerCount::new(1)?);
        let mut world = foundation.create_world(definition.build()?)?;
        if let Some(restitution) = scene.world.walls() {
            let frame = world.create_body(world.body_builder().build()?)?;
            let definition = ShapeDef::builder().material(material(restitution)?).build()?;
            for (centre, half) in walls(scene.world.size()) {
                let ([x, y], [half_width, half_height]) = (metres(centre), metres(half));
                let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                    .map(|(right, down)| Vec2::new(x + right * half_width, y + down * half_height));
                let wall = shapes::polygon_from_points(corners, 0.0)?;
                world.body(frame)?.create_polygon(&definition, &wall)?;
            }
        }
        let mut balls = Vec::with_capacity(scene.balls.len());
        for ball in &scene.balls {
            let definition = world
                .body_builder()
                .body_type(BodyType::Dynamic)
                .position(metres(ball.position()))
                .linear_velocity(metres(ball.velocity()))
                .bullet(scene.is_bullet(ball));
            let body = world.create_body(definition.build()?)?;
            let radius = ball.radius() / PX_PER_METRE;
            let shape = ShapeDef::builder()
                .density((ball.mass() / (PI * radius * radius)) as f32)
                .material(material(ball.restitution())?);
            let circle = shapes::circle(Vec2::new(0.0, 0.0), radius as f32)?;
            world.body(body)?.create_circle(&shape.build()?, &circle)?;
            balls.push(body);
        }
        Ok(Self { world, balls })
    }
}

impl Engine for Box2d {
    fn step(&mut self, seconds: f64) -> Result<(), Failure> {
        let step = self.world.step(seconds as f32, SUBSTEPS)?.into_result()?;
        drop(step);
        Ok(())
    }

    fn state(&mut self, states: &mut Vec<State>) -> Result<(), Failure> {
        states.clear();
        for &id in &self.balls {
            let body = self.world.body(id)?;
            let (position, velocity) = (body.position()?, body.linear_velocity()?);
            states.push(State { position: px(position.x, position.y), velocity: px(velocity.x, velocity.y) });
        }
        Ok(())
    }
}

/// Smooth, and as elastic as this.
fn material(restitution: f64) -> Result<SurfaceMaterial, Failure> {
    Ok(SurfaceMaterial::default().with_friction(0.0)?.with_restitution(restitution as f32)?)
}
