//! Emitters: how many particles come out and where, how they fly, bounce, slide and vanish, against
//! closed forms.

mod births;
mod bounces;
mod clock;
mod ends;
mod flight;
mod hierarchy;
mod relocation;
mod settings;
mod solids;

use std::time::Duration;

use bevy::{prelude::*, time::TimeUpdateStrategy};
use bevy_fluid::{emitter::EmittedParticles, prelude::*};

use fluid_stage::log;

const G: f32 = 9.81;

/// One particle at a time and in a place, along a line: what closed forms are about.
const EXACT: ParticleEmitter = ParticleEmitter {
    cone_half_angle: 0.0,
    nozzle_radius: 0.0,
    jitter: 0.0,
    lifetime: f32::INFINITY,
    ..ParticleEmitter::DEFAULT
};

/// The same, one single particle.
fn one(speed: f32, direction: Vec3) -> ParticleEmitter {
    ParticleEmitter {
        rate: 0.0,
        speed,
        direction,
        pending_burst: 1,
        ..EXACT
    }
}

/// An app without a renderer. Its clock has started.
fn app() -> App {
    log::listen();
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .add_plugins(FluidPlugin::default());
    app.finish();
    app.cleanup();
    step(&mut app, 0.0);
    app
}

/// An app with this emitter, and its entity. Its particles are not shaped, which takes longer than
/// all else.
fn emitting(emitter: ParticleEmitter) -> (App, Entity) {
    let mut app = app();
    let mut entity = app.world_mut().spawn(emitter);
    let entity = entity.remove::<SurfaceKernel>().id();
    (app, entity)
}

/// Steps by `seconds`.
fn step(app: &mut App, seconds: f32) {
    let step = TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(seconds));
    app.insert_resource(step);
    app.update();
}

/// Steps as often as it takes for `seconds` to pass, at `rate` frames a second.
fn run(app: &mut App, seconds: f32, rate: f32) {
    for _ in 0..(seconds * rate).round() as u32 {
        step(app, 1.0 / rate);
    }
}

/// All that is known of an emitter's particles.
struct Particles<'a> {
    fluid: &'a FluidParticles,
    emitted: &'a EmittedParticles,
}

impl<'a> Particles<'a> {
    fn len(&self) -> usize {
        self.emitted.len()
    }

    fn is_empty(&self) -> bool {
        self.emitted.is_empty()
    }

    fn positions(&self) -> &'a [Vec3] {
        &self.fluid.positions
    }

    fn velocities(&self) -> &'a [Vec3] {
        &self.fluid.velocities
    }

    fn ages(&self) -> &'a [f32] {
        self.emitted.ages()
    }
}

fn particles(app: &App, entity: Entity) -> Particles<'_> {
    Particles {
        fluid: app.world().get(entity).unwrap(),
        emitted: app.world().get(entity).unwrap(),
    }
}

fn emitter(app: &mut App, entity: Entity) -> Mut<'_, ParticleEmitter> {
    app.world_mut().get_mut(entity).unwrap()
}

fn place(app: &mut App, entity: Entity) -> Mut<'_, Transform> {
    app.world_mut().get_mut(entity).unwrap()
}

/// The particles as they are drawn, in the world.
fn drawn(app: &App, entity: Entity) -> Vec<Vec3> {
    let transform = app.world().get::<GlobalTransform>(entity).unwrap();
    let fluid = app.world().get::<FluidParticles>(entity).unwrap();
    let transform = fluid.world_from_particles(transform);
    let positions = fluid.positions.iter();
    positions.map(|&p| transform.transform_point(p)).collect()
}

/// The only particle's place and velocity.
#[track_caller]
fn single(app: &App, entity: Entity) -> (Vec3, Vec3) {
    let particles = particles(app, entity);
    assert_eq!(particles.len(), 1);
    (particles.positions()[0], particles.velocities()[0])
}

#[track_caller]
fn assert_near(value: f32, expected: f32, slack: f32) {
    assert!(
        (value - expected).abs() <= slack,
        "{value}, expected {expected} ± {slack}"
    );
}
