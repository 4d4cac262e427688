//! Where the window is shown: in the program's primary egui context, or in one that a camera is
//! given while the window is open.

use bevy::{
    camera::RenderTarget,
    ecs::{schedule::ScheduleLabel, system::SystemParam},
    prelude::*,
    render::{Extract, RenderApp, sync_world::MainEntity},
    window::PrimaryWindow,
};
use bevy_egui::{
    EguiContext, EguiManagedTextures, EguiPreUpdateSet, EguiSchedule, PrimaryEguiContext, egui,
    input::WindowToEguiContextMap, render::EguiCameraView, setup_primary_egui_context_system,
};

use super::FluidInspector;

/// The pass of a context that the window has to itself, beside the program's primary one.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct InspectorPass;

/// The context of the window.
#[derive(Resource, Default)]
pub(super) struct InspectorContext {
    /// Whether the program has windows of its own, and keeps the primary context that the camera
    /// was given while the inspector was open.
    is_shared: bool,
    /// The camera that shows the window.
    camera: Option<Entity>,
    /// The camera that was given a context here.
    own: Option<Entity>,
    /// Where windows and sections were in the last context, which may have ended with its camera.
    last: Option<egui::Context>,
}

impl InspectorContext {
    /// The camera that shows the window, if it is open and any camera can.
    pub(super) fn camera(&self) -> Option<Entity> {
        self.camera
    }
}

/// Run condition: whether the window is part of the primary context.
pub(super) fn is_primary(
    shown: Res<InspectorContext>,
    primary: Query<(), With<PrimaryEguiContext>>,
) -> bool {
    shown.camera.is_some_and(|camera| primary.contains(camera))
}

pub(super) fn plugin(app: &mut App, is_shared: bool) {
    app.insert_resource(InspectorContext {
        is_shared,
        ..default()
    })
    .add_observer(leave_to_the_program)
    .add_systems(
        PreUpdate,
        (
            choose_camera
                .after(setup_primary_egui_context_system)
                .before(WindowToEguiContextMap::on_egui_context_added_system),
            (follow_windows, forget_textures)
                .chain()
                .after(WindowToEguiContextMap::on_egui_context_removed_system),
        )
            .in_set(EguiPreUpdateSet::InitContexts),
    );
    if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
        render_app.add_systems(ExtractSchedule, forget_closed_views);
    }
}

/// What cameras may be seen on.
#[derive(SystemParam)]
struct Screens<'w, 's> {
    windows: Query<'w, 's, (), With<Window>>,
    primary: Query<'w, 's, Entity, With<PrimaryWindow>>,
    images: Res<'w, Assets<Image>>,
}

impl Screens<'_, '_> {
    /// The window of a target, whether it is open or not.
    fn window(&self, target: &RenderTarget) -> Option<Entity> {
        let RenderTarget::Window(window) = target else {
            return None;
        };
        let window = window.normalize(self.primary.single().ok())?;
        Some(window.entity())
    }

    fn show(&self, camera: &Camera, target: &RenderTarget) -> bool {
        let is_there = match target {
            RenderTarget::Window(_) => self
                .window(target)
                .is_some_and(|window| self.windows.contains(window)),
            RenderTarget::Image(image) => self.images.contains(&image.handle),
            RenderTarget::TextureView(_) => true,
            RenderTarget::None { .. } => false,
        };
        is_there && camera.is_active
    }
}

/// Chooses the camera that shows the window: that of the primary context if it can be seen, or the
/// one that is drawn last, which is given a context while the window is open. An idle context would
/// still run a pass, on the CPU and on the GPU, every frame.
fn choose_camera(
    inspector: Res<FluidInspector>,
    mut state: ResMut<InspectorContext>,
    cameras: Query<(Entity, &Camera, &RenderTarget, Has<EguiContext>)>,
    screens: Screens,
    mut contexts: Query<&mut EguiContext>,
    primary: Query<Entity, With<PrimaryEguiContext>>,
    mut commands: Commands,
) {
    let state = state.bypass_change_detection();
    let primary = primary.iter().next();
    let is_seen = |camera: Entity| {
        let camera = cameras.get(camera);
        camera.is_ok_and(|(_, camera, target, _)| screens.show(camera, target))
    };
    state.own = state.own.filter(|own| contexts.contains(*own));
    if let Some(own) = state.own {
        let is_alone = primary.is_none_or(|primary| primary == own || !is_seen(primary));
        let is_needed = if inspector.open {
            is_alone && is_seen(own)
        } else {
            state.is_shared && primary == Some(own)
        };
        state.camera = Some(own).filter(|_| is_needed && inspector.open);
        if !is_needed {
            // It is given another in the next frame: `bevy_egui` confuses what comes with what goes
            // in the same one.
            state.own = None;
            release(own, &mut commands);
        }
        return;
    }
    state.camera = primary.filter(|_| inspector.open);
    if !inspector.open || primary.is_some_and(is_seen) {
        if let Some(camera) = state.camera
            && let Ok(mut context) = contexts.get_mut(camera)
        {
            state.last = Some(context.get_mut().clone());
        }
        return;
    }
    let free = cameras
        .iter()
        .filter(|(_, camera, target, has_context)| !has_context && screens.show(camera, target));
    let last = free.max_by_key(|(entity, camera, target, _)| {
        let in_window = matches!(target, RenderTarget::Window(_));
        (in_window, camera.order, core::cmp::Reverse(*entity))
    });
    let Some((camera, ..)) = last else {
        return;
    };
    let mut context = EguiContext::default();
    if let Some(last) = &state.last {
        let memory = last.memory(Clone::clone);
        context.get_mut().memory_mut(|it| *it = memory);
    }
    state.last = Some(context.get_mut().clone());
    (state.camera, state.own) = (Some(camera), Some(camera));
    let mut camera = commands.entity(camera);
    if primary.is_none() {
        camera.insert((context, PrimaryEguiContext));
    } else {
        camera.insert((context, EguiSchedule::new(InspectorPass)));
    }
}

fn release(camera: Entity, commands: &mut Commands) {
    commands
        .entity(camera)
        .remove_with_requires::<(EguiContext, PrimaryEguiContext)>();
}

/// Takes the primary context away from the camera that was given it, as soon as the program gives
/// one to another: there may only be one.
fn leave_to_the_program(
    added: On<Add, PrimaryEguiContext>,
    mut state: ResMut<InspectorContext>,
    primary: Query<(), With<PrimaryEguiContext>>,
    mut commands: Commands,
) {
    let own = state
        .own
        .take_if(|own| *own != added.entity && primary.contains(*own));
    if let Some(own) = own {
        release(own, &mut commands);
    }
}

/// Keeps the windows of contexts: `bevy_egui` knows the one in which a context began.
fn follow_windows(
    contexts: Query<(Entity, &RenderTarget), With<EguiContext>>,
    screens: Screens,
    mut map: ResMut<WindowToEguiContextMap>,
) {
    for (context, target) in &contexts {
        let window = screens.window(target);
        let before = map.context_to_window.get(&context).copied();
        if window == before {
            continue;
        }
        if let Some(before) = before
            && let Some(contexts) = map.window_to_contexts.get_mut(&before)
        {
            contexts.remove(&context);
        }
        map.context_to_window.remove(&context);
        if let Some(window) = window {
            map.context_to_window.insert(context, window);
            let contexts = map.window_to_contexts.entry(window).or_default();
            contexts.insert(context);
        }
    }
}

/// Drops the textures of contexts that have ended, which `bevy_egui` keeps.
fn forget_textures(
    mut ended: RemovedComponents<EguiContext>,
    contexts: Query<(), With<EguiContext>>,
    mut textures: ResMut<EguiManagedTextures>,
) {
    if ended.read().count() > 0 {
        textures.retain(|(context, _), _| contexts.contains(*context));
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
