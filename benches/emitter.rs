//! Cost of emitting and moving particles: a step of an emitter that keeps some number of them alive,
//! without their shaping.
//!
//! `cargo bench --package fluid_benches --bench emitter`, or with `-- --quick` for fewer runs and a smaller size; medians and
//! the slowest of ten are shown. In flight nothing is near; over solids they fall onto a ground, a
//! ball, a box and a capsule and live on there; at rest all lie on the ground.

use std::time::{Duration, Instant};

use bevy::{prelude::*, time::TimeUpdateStrategy};
use bevy_fluid::{emitter::EmittedParticles, prelude::*};

const STEP: Duration = Duration::from_micros(16_667);
/// How long particles live. Unit: s.
const LIFETIME: f32 = 2.0;

fn main() {
    // Cargo adds `--bench`; only `--quick` means something here.
    let quick = std::env::args().any(|argument| argument == "--quick");
    let sizes: &[usize] = if quick {
        &[10_000]
    } else {
        &[1000, 10_000, 100_000, 1_000_000]
    };
    println!(
        "a step of 1/60 s on {} threads",
        rayon::current_num_threads()
    );
    println!("scene        particles   median ms  90 % below  ns per particle");
    for (name, scene) in [
        ("in flight", in_flight as fn(&mut World, u32)),
        ("over solids", over_solids),
        ("at rest", at_rest),
    ] {
        for &size in sizes {
            run(name, scene, size, if quick { 30 } else { 200 });
        }
    }
}

/// As many as this, half of which have died since the start by the time that is measured.
fn emitter(count: u32) -> ParticleEmitter {
    ParticleEmitter {
        lifetime: LIFETIME,
        capacity: count,
        nozzle_radius: 0.3,
        cone_half_angle: 0.4,
        drag: 0.1,
        particle_radius: 0.01,
        ..ParticleEmitter::fountain(count as f32 / LIFETIME, 5.0)
    }
}

fn in_flight(world: &mut World, count: u32) {
    world.spawn((emitter(count), Transform::from_xyz(0.0, 30.0, 0.0)));
    solids(world);
}

fn over_solids(world: &mut World, count: u32) {
    world.spawn((emitter(count), Transform::from_xyz(0.0, 1.0, 0.0)));
    solids(world);
}

fn at_rest(world: &mut World, count: u32) {
    world.spawn((
        ParticleEmitter {
            rate: 0.0,
            speed: 0.0,
            pending_burst: count,
            lifetime: f32::INFINITY,
            ..emitter(count)
        },
        Transform::from_xyz(0.0, 0.02, 0.0),
    ));
    world.spawn(ParticleCollider::ground());
}

fn solids(world: &mut World) {
    world.spawn(ParticleCollider::ground());
    for (solid, x) in [
        (ParticleCollider::from(Sphere::new(0.4)), -1.0),
        (Cuboid::from_length(0.6).into(), 0.0),
        (Capsule3d::new(0.2, 0.6).into(), 1.0),
    ] {
        let tilt = Quat::from_rotation_z(x);
        world.spawn((solid, Transform::from_xyz(x, 0.4, 0.0).with_rotation(tilt)));
    }
}

#[derive(Resource, Default)]
struct Watch {
    start: Option<Instant>,
    times: Vec<Duration>,
}

fn run(name: &str, scene: fn(&mut World, u32), count: usize, runs: usize) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .add_plugins(FluidPlugin::default())
        .insert_resource(TimeUpdateStrategy::ManualDuration(STEP))
        .init_resource::<Watch>()
        .add_systems(
            PostUpdate,
            (
                (|mut watch: ResMut<Watch>| watch.start = Some(Instant::now()))
                    .before(FluidSystems::Emit),
                (|mut watch: ResMut<Watch>| {
                    let elapsed = watch.start.map(|start| start.elapsed());
                    watch.times.extend(elapsed);
                })
                .after(FluidSystems::Simulate)
                .before(FluidSystems::Shape),
            ),
        );
    app.finish();
    app.cleanup();
    scene(app.world_mut(), count as u32);
    // Without a kernel they are not shaped.
    let mut emitters = app
        .world_mut()
        .query_filtered::<Entity, With<ParticleEmitter>>();
    if let Ok(emitter) = emitters.single(app.world()) {
        app.world_mut()
            .entity_mut(emitter)
            .remove::<SurfaceKernel>();
    }

    // Until as many die as are born.
    for _ in 0..(1.2 * LIFETIME / STEP.as_secs_f32()) as u32 {
        app.update();
    }
    app.world_mut().resource_mut::<Watch>().times.clear();
    for _ in 0..runs {
        app.update();
    }

    let world = app.world_mut();
    let mut emitted = world.query::<&EmittedParticles>();
    let living: usize = emitted.iter(world).map(EmittedParticles::len).sum();
    let mut times = std::mem::take(&mut world.resource_mut::<Watch>().times);
    times.sort();
    let [median, slow] = [times.len() / 2, times.len() * 9 / 10].map(|i| times[i].as_secs_f64());
    println!(
        "{name:11}  {living:9}  {:10.3}  {:10.3}  {:15.1}",
        median * 1e3,
        slow * 1e3,
        median * 1e9 / living as f64,
    );
}
