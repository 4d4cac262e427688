//! Resources that all views share.

use bevy::{
    prelude::*,
    render::render_resource::{Buffer, DynamicUniformBuffer},
};

use super::{
    gpu_types::GpuRain,
    lights::NearLights,
    quads::{MAX_SHELLS, RainQuads},
    shelters::DryPlaces,
};
use crate::rain::bake::LostDevices;

/// Resources shared by all views.
#[derive(Resource)]
pub(crate) struct RainBuffers {
    pub(crate) uniforms: DynamicUniformBuffer<GpuRain>,
    /// Two triangles for every four vertices.
    pub(crate) drop_indices: Option<Buffer>,
    /// Phases distinguish their items by entity; these represent a view's shells, its backdrop and
    /// its drops.
    pub(crate) items: [Entity; MAX_SHELLS + 2],
    pub(crate) near: NearLights,
    pub(crate) dry: DryPlaces,
}

/// Creates what all views share; on another device than before, drops what the lost one held.
pub(crate) fn init_rain_buffers(
    known: Option<ResMut<RainBuffers>>,
    mut views: Query<&mut RainQuads>,
    lost: Res<LostDevices>,
    mut commands: Commands,
) {
    let Some(mut buffers) = known else {
        let items = core::array::from_fn(|_| commands.spawn_empty().id());
        commands.insert_resource(RainBuffers {
            uniforms: DynamicUniformBuffer::default(),
            drop_indices: None,
            items,
            near: NearLights::default(),
            dry: DryPlaces::default(),
        });
        return;
    };
    buffers.uniforms = DynamicUniformBuffer::default();
    buffers.drop_indices = None;
    for mut quads in &mut views {
        *quads = RainQuads::default();
    }
    lost.add();
}
