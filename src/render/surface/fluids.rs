//! Fluids in the render world. Splats are swapped, never copied.

use bevy::{
    camera::visibility::RenderLayers,
    math::Mat3A,
    prelude::*,
    render::{MainWorld, sync_component::SyncComponent, sync_world::RenderEntity},
};

use super::bounds::Bounds;
use crate::{
    material::FluidMaterial,
    settings::Checked,
    shape::{Splat, SurfaceKernel},
    source::particles::{FluidParticles, ShapedFluid},
};

/// A fluid in the render world: its transform, material and splats.
#[derive(Component, Default)]
#[doc(hidden)]
pub struct ExtractedFluid {
    pub(crate) transform: GlobalTransform,
    pub(crate) material: FluidMaterial,
    pub(crate) layers: RenderLayers,
    pub(crate) visible: bool,
    /// Particle radius in world units.
    pub(crate) radius: f32,
    /// Whether droplets have a class of their own, so that what is thin in the bulk is a sheet.
    pub(crate) sheets: bool,
    /// Particle radius in the fluid's own units.
    pub(crate) local_radius: f32,
    pub(crate) bounds: Bounds,
    /// Numbers of splats, partial ones included.
    pub(crate) bulk: u32,
    pub(crate) interior: u32,
    pub(crate) spray: u32,
    /// Of them, the partial ones: the first of the bulk and the last of the spray.
    pub(crate) partial: [u32; 2],
    /// In the order bulk, interior, spray.
    pub(crate) splats: Vec<Splat>,
    /// Whether the splats are new and not uploaded yet.
    pub(crate) fresh: bool,
}

impl SyncComponent for FluidParticles {
    type Target = ExtractedFluid;
}

/// Extracts transforms and materials every frame, splats only when they were reshaped: the two
/// worlds swap their buffers.
pub(super) fn extract_fluids(
    mut main: ResMut<MainWorld>,
    mut state: Local<
        Option<
            QueryState<(
                RenderEntity,
                &GlobalTransform,
                Option<&Checked<FluidMaterial>>,
                &FluidParticles,
                Option<&Checked<SurfaceKernel>>,
                &InheritedVisibility,
                Option<&RenderLayers>,
                &mut ShapedFluid,
            )>,
        >,
    >,
    mut fluids: Query<&mut ExtractedFluid>,
    mut commands: Commands,
) {
    let state = state.get_or_insert_with(|| main.query());
    for (entity, transform, material, particles, kernel, visibility, layers, mut shaped) in
        state.iter_mut(&mut main)
    {
        let mut new = None;
        let mut known = fluids.get_mut(entity).ok();
        let fluid = known
            .as_deref_mut()
            .unwrap_or_else(|| new.insert(ExtractedFluid::default()));
        fluid.transform = particles.world_from_particles(transform);
        fluid.material = material.map(|it| **it).unwrap_or_default();
        fluid.sheets = kernel.is_none_or(|it| it.anisotropic && it.spray_threshold > 0);
        // Splats of where the particles were when they were seen last are not drawn.
        fluid.visible = visibility.get() && !shaped.is_stale();
        fluid.local_radius = particles.radius;
        fluid.radius = particles.radius * mean_scale(&fluid.transform.affine().matrix3);
        fluid
            .layers
            .clone_from(layers.unwrap_or(&RenderLayers::layer(0)));
        // Taking the splats must not trigger change detection.
        let shaped = shaped.bypass_change_detection();
        if shaped.take_fresh() {
            let splats = &mut shaped.splats;
            core::mem::swap(&mut fluid.splats, &mut splats.splats);
            fluid.bounds = Bounds {
                min: splats.min,
                max: splats.max,
            };
            fluid.bulk = splats.partial_bulk + splats.bulk;
            fluid.interior = splats.interior;
            fluid.spray = splats.spray + splats.partial_spray;
            fluid.partial = [splats.partial_bulk, splats.partial_spray];
            fluid.fresh = true;
        }
        if let Some(fluid) = new {
            commands.entity(entity).insert(fluid);
        }
    }
}

/// The scale of a sphere of the same volume.
pub(crate) fn mean_scale(matrix: &Mat3A) -> f32 {
    let volume = matrix.determinant().abs();
    if volume.is_finite() && volume > 0.0 {
        volume.cbrt()
    } else {
        1.0
    }
}
