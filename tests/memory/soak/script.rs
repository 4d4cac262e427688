//! What changes in which frame.

use bevy::{camera::Viewport, prelude::*};
use bevy_fluid::{
    prelude::*,
    settings::{
        Bilateral, CurvatureFlow, FluidDebugView, Fresnel, NormalAverage, PlaneFit, Refractions,
        Search, Smoothing,
    },
};
use fluid_stage::{headless_app, resize, step, validation_errors};

use crate::common::*;

/// Frames after which everything has been asked for once, and comes again.
pub(crate) const CYCLE: u32 = 96;
pub(crate) const SIZES: [UVec2; 4] = [uvec2(64, 48), uvec2(33, 65), uvec2(1, 1), uvec2(96, 64)];
pub(crate) const RADIUS: f32 = 0.1;

pub(crate) fn settings(i: u32) -> ScreenSpaceFluid {
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
pub(crate) fn particles(frame: u32, count: usize) -> impl Iterator<Item = Vec3> {
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

/// An app for the script to play in; without the plugin it is Bevy alone, with the same entities.
pub(crate) fn start(with_fluids: bool) -> App {
    let view = View {
        size: SIZES[0],
        ..View::new(
            64,
            Lens::Perspective {
                fov: 0.7,
                near: 0.1,
            },
        )
    };
    let mut app = headless_app(view.size, |app| {
        if with_fluids {
            app.add_plugins(FluidPlugin::default());
        }
        let world = app.world_mut();
        world.spawn(view.camera(ScreenSpaceFluid::default()));
        world.spawn((DirectionalLight::default(), Transform::IDENTITY));
        let wall = Transform::from_xyz(0.0, 0.4, -8.0);
        spawn_box(world, vec3(3.0, 1.0, 0.1), wall);
    })
    .unwrap();
    settle(&mut app).unwrap();
    app
}

/// What comes and goes.
#[derive(Default)]
struct Cast {
    second_camera: Option<Entity>,
    fluids: Vec<Entity>,
}

/// An app in which the script is played.
pub(crate) struct Play {
    pub(crate) app: App,
    cast: Cast,
    first_camera: Entity,
    pub(crate) cycles: u32,
}

impl Play {
    pub(crate) fn new(with_fluids: bool) -> Self {
        let mut app = start(with_fluids);
        let first_camera = only::<Camera3d>(&mut app);
        Self {
            app,
            cast: Cast::default(),
            first_camera,
            cycles: 0,
        }
    }

    /// Plays the whole script once; no frame may be invalid.
    pub(crate) fn cycle(&mut self) {
        for frame in 0..CYCLE {
            change(&mut self.app, &mut self.cast, self.first_camera, frame);
            step(&mut self.app, 1);
        }
        assert_eq!(validation_errors(&self.app), [""; 0]);
        self.cycles += 1;
    }

    /// The app with its first camera alone.
    pub(crate) fn end(mut self) -> App {
        let world = self.app.world_mut();
        for entity in self.cast.fluids.drain(..).chain(self.cast.second_camera) {
            world.despawn(entity);
        }
        world
            .entity_mut(self.first_camera)
            .remove::<FluidDebugView>();
        self.app
    }
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
