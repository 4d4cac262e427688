//! Cameras that draw fluids, in the render world.

use bevy::{
    camera::visibility::RenderLayers,
    prelude::*,
    render::{Extract, sync_component::SyncComponent, sync_world::RenderEntity},
};

use crate::settings::{Checked, FluidDebugView, ScreenSpaceFluid};

/// A camera's settings.
#[derive(Component, Clone, Default)]
#[doc(hidden)]
pub struct FluidView {
    pub(crate) settings: ScreenSpaceFluid,
    pub(crate) debug_view: Option<FluidDebugView>,
    pub(crate) layers: RenderLayers,
}

impl SyncComponent for ScreenSpaceFluid {
    type Target = FluidView;
}

pub(crate) fn extract_views(
    cameras: Extract<
        Query<
            (
                RenderEntity,
                &Checked<ScreenSpaceFluid>,
                Option<&FluidDebugView>,
                Option<&RenderLayers>,
            ),
            With<Camera3d>,
        >,
    >,
    mut views: Query<&mut FluidView>,
    mut commands: Commands,
) {
    for (entity, settings, debug_view, layers) in &cameras {
        let mut new = None;
        let mut known = views.get_mut(entity).ok();
        let view = known
            .as_deref_mut()
            .unwrap_or_else(|| new.insert(FluidView::default()));
        view.settings = **settings;
        view.debug_view = debug_view.copied();
        view.layers
            .clone_from(layers.unwrap_or(&RenderLayers::layer(0)));
        if let Some(view) = new {
            commands.entity(entity).insert(view);
        }
    }
}
