//! A long run in which everything changes all the time: half a minute of it with every test run, ten
//! minutes with `cargo test --release --workspace --test soak -- --ignored soak`.

mod common;

use std::time::{Duration, Instant};

use bevy::{camera::Viewport, prelude::*, render::renderer::RenderDevice};
use bevy_fluid::{
    Bilateral, CurvatureFlow, FluidDebugView, Fresnel, NormalAverage, PlaneFit, Refractions,
    ScreenSpaceFluid, Search, Smoothing, SurfaceKernel, prelude::*,
};
use common::*;
use fluid_stage::{capture, resize, step, validation_errors};

/// Frames after which everything has been asked for once, and comes again.
const CYCLE: u32 = 96;
const SIZES: [UVec2; 4] = [uvec2(64, 48), uvec2(33, 65), uvec2(1, 1), uvec2(96, 64)];
const RADIUS: f32 = 0.1;

fn settings(i: u32) -> ScreenSpaceFluid {
    let smoothed = |smoothing| ScreenSpaceFluid {
        smoothing,
        ..default()
    };
    match i % 8 {
        0 => ScreenSpaceFluid::DEFAULT,
        1 => ScreenSpaceFluid::THESIS,
        2 => RAW,
        3 => smoothed(Smoothing::Bilateral(Bilateral {
            iterations: 3,
            ..default()
        })),
        4 => smoothed(Smoothing::NormalAverage(NormalAverage::default())),
        5 => smoothed(Smoothing::CurvatureFlow(CurvatureFlow {
            iterations: 5,
            ..default()
        })),
        6 => ScreenSpaceFluid {
            refractions: Refractions::One,
            fresnel: Fresnel::Schlick,
            ..smoothed(Smoothing::PlaneFit(PlaneFit {
                half_taps: 2,
                iterations: 1,
                ..default()
            }))
        },
        _ => ScreenSpaceFluid {
            refractions: Refractions::Two,
            search: Search::Bracketed { coarse_samples: 4 },
            ..default()
        },
    }
}

/// A block and droplets, as many particles as `count`, elsewhere in every frame.
fn particles(frame: u32, count: usize) -> impl Iterator<Item = Vec3> {
    let mut random = Random(u64::from(frame) + 1);
    (0..count).map(move |i| {
        let cell = vec3((i % 8) as f32, (i / 64) as f32, (i / 8 % 8) as f32);
        let place = if i % 16 == 15 {
            16.0 * random.point()
        } else {
            2.0 * cell
        };
        (place + random.point() - 8.0) * RADIUS + vec3(0.0, 0.0, -5.0)
    })
}

fn start(size: UVec2) -> App {
    let view = View {
        size,
        ..View::new(
            64,
            Lens::Perspective {
                fov: 0.7,
                near: 0.1,
            },
        )
    };
    show(&view, ScreenSpaceFluid::default(), |world| {
        world.spawn((DirectionalLight::default(), Transform::IDENTITY));
        let wall = Transform::from_xyz(0.0, 0.4, -8.0);
        spawn_box(world, vec3(3.0, 1.0, 0.1), wall);
    })
}

/// What comes and goes.
#[derive(Default)]
struct Cast {
    second_camera: Option<Entity>,
    fluids: Vec<Entity>,
}

/// Everything that changes in a frame; the same in every cycle.
fn change(app: &mut App, cast: &mut Cast, first_camera: Entity, frame: u32) {
    let frame = frame % CYCLE;
    let mut random = Random(u64::from(frame) * 7919 + 1);
    let size = SIZES[(frame / 5) as usize % SIZES.len()];
    resize(app, size).unwrap();
    let world = app.world_mut();

    let msaa = [Msaa::Off, Msaa::Sample4][(frame / 32) as usize % 2];
    let pose = Transform::from_translation(random.point() - 0.5);
    let mut camera = world.entity_mut(first_camera);
    camera.insert((settings(frame), msaa, pose));
    if frame % 12 == 7 {
        camera.insert(FluidDebugView::Normals);
    } else {
        camera.remove::<FluidDebugView>();
    }

    if frame.is_multiple_of(6) {
        match cast.second_camera.take() {
            Some(camera) => {
                world.despawn(camera);
            }
            None => {
                let half = (size / 2).max(UVec2::ONE);
                let camera = Camera {
                    order: 1,
                    clear_color: ClearColorConfig::None,
                    viewport: Some(Viewport {
                        physical_size: half,
                        ..default()
                    }),
                    ..default()
                };
                let bundle = (Camera3d::default(), camera, msaa, settings(frame + 3), pose);
                cast.second_camera = Some(world.spawn(bundle).id());
            }
        }
    } else if let Some(camera) = cast.second_camera {
        // A viewport has to fit its target.
        let mut entity = world.entity_mut(camera);
        entity.insert(msaa);
        let mut camera = entity.get_mut::<Camera>().unwrap();
        camera.viewport.as_mut().unwrap().physical_size = (size / 2).max(UVec2::ONE);
    }

    if frame.is_multiple_of(4) {
        if cast.fluids.len() > 2 {
            world.despawn(cast.fluids.remove(0));
        }
        let material = [FluidMaterial::WATER, FluidMaterial::INK][(frame / 4) as usize % 2];
        let fluid = (FluidParticles::new(vec![], RADIUS), material);
        cast.fluids.push(world.spawn(fluid).id());
    }
    for (i, &fluid) in cast.fluids.iter().enumerate() {
        let count = (random.next() * 700.0) as usize * usize::from(frame % 10 != 9);
        let mut fluid = world.get_mut::<FluidParticles>(fluid).unwrap();
        fluid.positions.clear();
        fluid.positions.extend(particles(frame + i as u32, count));
    }
    if frame % 16 == 3 {
        world.entity_mut(cast.fluids[0]).insert(SurfaceKernel {
            spray_threshold: frame % 12,
            ..default()
        });
    }
}

/// Bytes that the GPU's allocator has handed out: every texture and buffer there is.
fn allocated(app: &App) -> u64 {
    let device = app.world().resource::<RenderDevice>();
    let report = device.wgpu_device().generate_allocator_report();
    report
        .expect("Vulkan's allocator reports")
        .total_allocated_bytes
}

/// Bytes of this process that are in memory, whatever they are for.
fn resident() -> u64 {
    let statm = std::fs::read_to_string("/proc/self/statm").unwrap();
    let pages: u64 = statm.split(' ').nth(1).unwrap().parse().unwrap();
    4096 * pages
}

/// Sets a scene that is the same after any run, and shows it.
fn last_frame(app: &mut App) -> image::RgbaImage {
    resize(app, SIZES[0]).unwrap();
    look(
        app,
        (ScreenSpaceFluid::default(), Msaa::Off, Transform::IDENTITY),
    );
    let positions = particles(0, 500).collect();
    pour(
        app,
        (FluidParticles::new(positions, RADIUS), FluidMaterial::INK),
    );
    assert_sound(app);
    capture(app).unwrap()
}

fn soak(duration: Duration) {
    let began = Instant::now();
    let mut app = start(SIZES[0]);
    let first_camera = only::<Camera3d>(&mut app);
    let mut cast = Cast::default();
    let [mut samples, mut residents] = [(); 2].map(|()| Vec::new());
    let mut cycles = 0;
    while began.elapsed() < duration || cycles < 4 {
        for frame in 0..CYCLE {
            change(&mut app, &mut cast, first_camera, frame);
            step(&mut app, 1);
        }
        assert_eq!(validation_errors(&app), [""; 0]);
        cycles += 1;
        // All pipelines are made in the first cycle; the second grows into its buffers.
        if cycles > 2 && began.elapsed() > duration / 10 {
            samples.push(allocated(&app) as f64);
            residents.push(resident() as f64);
        }
    }
    // Each sample is taken in the same state; single ones still tremble with the allocator.
    let part = samples.len().div_ceil(5);
    let mean = |samples: &[f64]| samples.iter().sum::<f64>() / samples.len() as f64;
    let ends = |samples: &[f64]| [&samples[..part], &samples[samples.len() - part..]].map(mean);
    let [first, last] = ends(&samples);
    println!("{cycles} cycles of {CYCLE} frames; after the first tenth and at the end, in MiB:");
    for (name, [first, last]) in [("on the GPU", [first, last]), ("in all", ends(&residents))] {
        println!("{name}: {:.1}, {:.1}", first / 1048576.0, last / 1048576.0);
    }
    assert!(
        last < 1.01 * first,
        "memory grows from {first} to {last} bytes"
    );

    for entity in cast.fluids.drain(..).chain(cast.second_camera) {
        app.world_mut().despawn(entity);
    }
    app.world_mut()
        .entity_mut(first_camera)
        .remove::<FluidDebugView>();
    let seen = last_frame(&mut app);
    assert!(
        seen == last_frame(&mut start(SIZES[0])),
        "not as in a fresh app"
    );
}

#[test]
fn soak_for_half_a_minute() {
    soak(Duration::from_secs(30));
}

#[test]
#[ignore = "ten minutes"]
fn soak_for_ten_minutes() {
    soak(Duration::from_secs(600));
}
