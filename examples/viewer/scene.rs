//! The liquid, framed over its floor.

use bevy::{
    camera::ScalingMode,
    math::bounding::{Aabb3d, BoundingVolume},
    prelude::*,
};
use bevy_fluid::{prelude::*, settings::FluidDebugView};
use fluid_stage::scenery::{Scenery, frame_camera, orbit_camera};

use crate::args::Args;

/// Everything that is drawn.
#[derive(Resource, Clone)]
pub(crate) struct ScenePlugin {
    positions: Vec<Vec3>,
    radius: f32,
    isotropic: bool,
    settings: ScreenSpaceFluid,
    debug_view: Option<FluidDebugView>,
    eye: Option<Vec3>,
    look_at: Option<Vec3>,
    fov: f32,
    aspect: f32,
    orthographic: bool,
}

impl ScenePlugin {
    pub(crate) fn new(args: &Args, positions: Vec<Vec3>) -> Self {
        Self {
            positions,
            radius: args.radius,
            isotropic: args.isotropic,
            settings: args.settings(),
            debug_view: args.debug_view,
            eye: args.eye,
            look_at: args.look_at,
            fov: args.fov.to_radians(),
            aspect: args.size.x as f32 / args.size.y as f32,
            orthographic: args.orthographic,
        }
    }
}

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.clone())
            .add_plugins(FluidPlugin::default())
            .add_systems(Startup, setup);
    }
}

/// The box around the particles with finite positions.
fn bounds(scene: &ScenePlugin) -> Aabb3d {
    let (min, max) = scene
        .positions
        .iter()
        .filter(|p| p.is_finite())
        .fold((Vec3::MAX, Vec3::MIN), |(low, high), &p| {
            (low.min(p), high.max(p))
        });
    let (min, max) = if min.cmple(max).all() {
        (min - scene.radius, max + scene.radius)
    } else {
        (Vec3::NEG_ONE, Vec3::ONE)
    };
    Aabb3d::new(0.5 * (min + max), 0.5 * (max - min))
}

fn setup(mut scenery: Scenery, scene: Res<ScenePlugin>) {
    let bounds = bounds(&scene);
    let size = 2.0 * Vec3::from(bounds.half_size());
    let ground = Vec3::from(bounds.center()).with_y(bounds.min.y);
    let reach = 2.0 * size.max_element();
    let to_sun = vec3(0.55, 0.9, 0.45);
    scenery.checker_floor(ground, reach, 24);
    scenery.pillars(bounds, 6);
    scenery.sun(to_sun, reach, true);
    let sky = scenery.sky(to_sun);

    let (eye, target) = frame_camera(bounds, scene.fov, scene.aspect);
    let (eye, target) = (scene.eye.unwrap_or(eye), scene.look_at.unwrap_or(target));
    let distance = eye.distance(target);
    let projection = if scene.orthographic {
        Projection::Orthographic(OrthographicProjection {
            scaling_mode: ScalingMode::FixedVertical {
                viewport_height: 2.0 * distance * (0.5 * scene.fov).tan(),
            },
            near: 0.0,
            far: 4.0 * distance + 4.0 * reach,
            ..OrthographicProjection::default_3d()
        })
    } else {
        Projection::Perspective(PerspectiveProjection {
            fov: scene.fov,
            near: 0.02 * distance.min(size.max_element()),
            far: 4.0 * distance + 4.0 * reach,
            ..default()
        })
    };
    let mut camera = scenery.commands.spawn((
        orbit_camera(eye, target),
        projection,
        scene.settings,
        sky.bundle(),
    ));
    if let Some(view) = scene.debug_view {
        camera.insert(view);
    }
    scenery.commands.spawn((
        FluidParticles::new(scene.positions.clone(), scene.radius),
        FluidMaterial {
            // A lake's water, whatever the file's unit is, so that depth shows.
            medium: Medium::absorbing(LinearRgba::rgb(0.2, 0.62, 0.75), 0.5 * size.max_element()),
            ..FluidMaterial::WATER
        },
        SurfaceKernel {
            anisotropic: !scene.isotropic,
            ..default()
        },
    ));
}
