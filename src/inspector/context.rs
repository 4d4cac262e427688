//! An egui context while the window is open, if the program has none itself.

use bevy::{
    camera::RenderTarget,
    prelude::*,
    render::{Extract, RenderApp, sync_world::MainEntity},
};
use bevy_egui::{EguiContext, EguiPreUpdateSet, PrimaryEguiContext, egui, render::EguiCameraView};

use super::FluidInspector;

/// Where the window is drawn, and its state while it is closed: its place, its sections.
#[derive(Resource, Default)]
struct OwnContext {
    camera: Option<Entity>,
    memory: Option<egui::Memory>,
}

pub(super) fn plugin(app: &mut App) {
    app.init_resource::<OwnContext>().add_systems(
        PreUpdate,
        attach_context.before(EguiPreUpdateSet::InitContexts),
    );
    if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
        render_app.add_systems(ExtractSchedule, forget_closed_views);
    }
}

/// `bevy_egui` never unmarks a camera whose context is removed, and looks for the context in vain.
fn forget_closed_views(
    views: Query<(Entity, &MainEntity), With<EguiCameraView>>,
    contexts: Extract<Query<(), With<EguiContext>>>,
    mut commands: Commands,
) {
    for (view, camera) in &views {
        if !contexts.contains(camera.id()) {
            commands.entity(view).remove::<EguiCameraView>();
        }
    }
}

/// Gives the camera that is drawn last a context while the window is open. An idle context would
/// still run a pass, on the CPU and on the GPU, every frame.
fn attach_context(
    inspector: Res<FluidInspector>,
    mut own: ResMut<OwnContext>,
    cameras: Query<(Entity, &Camera, &RenderTarget)>,
    mut contexts: Query<&mut EguiContext>,
    mut commands: Commands,
) {
    let own = own.bypass_change_detection();
    if !inspector.open {
        let Some(camera) = own.camera.take() else {
            return;
        };
        if let Ok(mut context) = contexts.get_mut(camera) {
            own.memory = Some(context.get_mut().memory(Clone::clone));
            commands
                .entity(camera)
                .remove_with_requires::<(EguiContext, PrimaryEguiContext)>();
        }
        return;
    }
    let attached = own.camera.and_then(|camera| cameras.get(camera).ok());
    if attached.is_some_and(|(_, camera, _)| camera.is_active) {
        return;
    }
    let shown = cameras.iter().filter(|(_, camera, _)| camera.is_active);
    let last = shown.max_by_key(|(entity, camera, target)| {
        let in_window = matches!(target, RenderTarget::Window(_));
        (in_window, camera.order, core::cmp::Reverse(*entity))
    });
    let Some((camera, ..)) = last else {
        return;
    };
    if let Some(before) = own.camera.replace(camera)
        && contexts.contains(before)
    {
        commands
            .entity(before)
            .remove_with_requires::<(EguiContext, PrimaryEguiContext)>();
    }
    let mut context = EguiContext::default();
    if let Some(memory) = own.memory.take() {
        context.get_mut().memory_mut(|it| *it = memory);
    }
    commands
        .entity(camera)
        .insert((context, PrimaryEguiContext));
}
