//! Which fluids no camera sees: they are not shaped until one does.

use bevy::{
    camera::{
        CameraUpdateSystems,
        visibility::{RenderLayers, VisibilitySystems},
    },
    math::Affine3A,
    prelude::*,
};

use super::bounds::Bounds;
use crate::{
    schedule::FluidSystems,
    settings::{Checked, ScreenSpaceFluid},
    shape::SurfaceKernel,
    source::particles::{FluidParticles, ShapedFluid, shape_fluids},
};

pub(super) fn plugin(app: &mut App) {
    app.add_systems(
        PostUpdate,
        find_unseen
            .in_set(FluidSystems::Shape)
            .before(shape_fluids)
            .after(CameraUpdateSystems)
            .after(TransformSystems::Propagate)
            .after(VisibilitySystems::VisibilityPropagate),
    );
}

/// A camera as fluids are seen from it.
struct Sight<'a> {
    layers: &'a RenderLayers,
    eye: Vec3,
    clip_from_eye: Mat4,
}

impl Sight<'_> {
    fn shows(&self, bounds: &Bounds, world_from_local: &Affine3A) -> bool {
        let eye_from_local = Affine3A::from_translation(-self.eye) * *world_from_local;
        bounds
            .transformed(&eye_from_local)
            .is_in_view(&self.clip_from_eye)
    }
}

/// Finds the changed fluids that no camera sees.
fn find_unseen(
    cameras: Query<
        (&Camera, &GlobalTransform, Option<&RenderLayers>),
        (With<Camera3d>, With<ScreenSpaceFluid>),
    >,
    mut fluids: Query<(
        Ref<FluidParticles>,
        Ref<Checked<SurfaceKernel>>,
        &GlobalTransform,
        &InheritedVisibility,
        Option<&RenderLayers>,
        &mut ShapedFluid,
    )>,
) {
    let default_layers = RenderLayers::default();
    let sights = || {
        cameras
            .iter()
            .filter(|(camera, ..)| camera.is_active)
            .map(|(camera, place, layers)| {
                let eye_from_view = Mat4::from_mat3a(place.affine().matrix3);
                Sight {
                    layers: layers.unwrap_or(&default_layers),
                    eye: place.translation(),
                    clip_from_eye: camera.clip_from_view() * eye_from_view.inverse(),
                }
            })
    };
    for (particles, kernel, place, visibility, layers, mut shaped) in &mut fluids {
        let shaped = shaped.bypass_change_detection();
        // What changes after this is shaped.
        shaped.set_unseen(false);
        if !(shaped.is_stale() || particles.is_changed() || kernel.is_changed()) {
            continue;
        }
        let layers = layers.unwrap_or(&default_layers);
        let world_from_local = particles.world_from_particles(place).affine();
        let mut bounds = None;
        let is_seen = visibility.get()
            && sights()
                .filter(|sight| sight.layers.intersects(layers))
                .any(|sight| {
                    let bounds = bounds.get_or_insert_with(|| bounds_of(&particles, &kernel));
                    // Without a box there is nothing to shape, but something to log or to count.
                    bounds.is_empty() || sight.shows(bounds, &world_from_local)
                });
        shaped.set_unseen(!is_seen);
    }
}

/// A box around all splats that the particles may become.
fn bounds_of(particles: &FluidParticles, kernel: &SurfaceKernel) -> Bounds {
    let positions = particles.positions.iter().filter(|p| p.is_finite());
    let around = positions.fold(Bounds::EMPTY, |bounds, &p| {
        bounds.union(Bounds { min: p, max: p })
    });
    // Splats are shifted within the neighbourhood or outwards, and stretched.
    let stretched = kernel.radius_scale.max(LARGEST_SPHERE) * kernel.max_ratio;
    let margin = particles.radius * (kernel.neighbor_radius + kernel.surface_offset + stretched);
    Bounds {
        min: around.min - margin,
        max: around.max + margin,
    }
}

/// Radius of interior particles. Unit: particle radii.
const LARGEST_SPHERE: f32 = 2.4;
