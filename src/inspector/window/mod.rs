//! The window: times, then the camera and its settings, then the fluid and its settings.

mod counts;
mod debug_view;
mod section;
#[cfg(any(feature = "recordings", feature = "salva"))]
mod sources;
mod subjects;

use bevy::{diagnostic::DiagnosticsStore, prelude::*, reflect::TypeRegistry};
use bevy_egui::{
    EguiContext,
    egui::{self, CollapsingHeader, ComboBox, ScrollArea, Ui},
};

use self::{counts::counts, debug_view::debug_view, section::component, subjects::Subjects};
use super::{
    FluidInspector,
    context::InspectorContext,
    skipped, spawn_code, times,
    widgets::{self, WIDTH},
};
use crate::settings::ScreenSpaceFluid;

/// Shows the window in the context of the camera chosen for it.
pub(in crate::inspector) fn show(world: &mut World, mut clock: Local<times::Clock>) {
    let camera = world.resource::<InspectorContext>().camera();
    let Some(mut context) = camera.and_then(|it| world.get_mut::<EguiContext>(it)) else {
        return;
    };
    // A handle to the same context.
    let context = context.get_mut().clone();
    let types = world.resource::<AppTypeRegistry>().clone();
    let types = types.read();
    world.resource_scope(|world, mut inspector: Mut<FluidInspector>| {
        let state = inspector.bypass_change_detection();
        let mut open = true;
        let height = context.content_rect().height();
        egui::Window::new("Fluid inspector")
            .id(egui::Id::new("bevy_fluid_inspector"))
            .open(&mut open)
            .default_pos([8.0, 8.0])
            .resizable([false, true])
            .default_height(height - 60.0)
            .max_height(height - 60.0)
            .show(&context, |ui| {
                ScrollArea::vertical()
                    .auto_shrink([false, true])
                    .show(ui, |ui| {
                        ui.set_width(WIDTH);
                        let subjects = Subjects::find(world, state, &types);
                        contents(ui, world, state, &subjects, &types, &mut clock);
                    });
            });
        state.open = open;
    });
}

fn contents(
    ui: &mut Ui,
    world: &mut World,
    inspector: &mut FluidInspector,
    subjects: &Subjects,
    types: &TypeRegistry,
    clock: &mut times::Clock,
) {
    let shown = inspector.types.clone();
    let components = |ui: &mut Ui, world: &mut World, entity| {
        for id in &shown {
            if let Some(registration) = types.get(*id) {
                component(ui, world, entity, registration, types);
            }
        }
    };
    CollapsingHeader::new("Times")
        .default_open(true)
        .show_unindented(ui, |ui| {
            times::show(ui, world.resource::<DiagnosticsStore>(), clock);
        });

    ui.separator();
    let code = |world: &World, entity| spawn_code(world.entity(entity), &shown, types);
    let copy = ui.button("Copy all as Rust");
    if copy
        .on_hover_text("cameras, fluids and all else, as the code that spawns them")
        .clicked()
    {
        let all: Vec<_> = subjects.all().map(|entity| code(world, entity)).collect();
        ui.ctx().copy_text(all.join("\n"));
    }
    let camera = choose(
        ui,
        "Camera",
        &subjects.cameras,
        &mut inspector.camera,
        |it| code(world, it),
    );
    if let Some(camera) = camera {
        if world.entity(camera).contains::<ScreenSpaceFluid>() {
            debug_view(ui, world, camera);
        }
        components(ui, world, camera);
        skipped::show(ui, world, camera, &subjects.fluids, types);
    } else {
        ui.label("No camera has ScreenSpaceFluid or Rain.");
    }

    ui.separator();
    let fluid = choose(ui, "Fluid", &subjects.fluids, &mut inspector.fluid, |it| {
        code(world, it)
    });
    if let Some(fluid) = fluid {
        counts(ui, world, fluid, subjects);
        #[cfg(feature = "recordings")]
        sources::recordings(ui, world, fluid);
        components(ui, world, fluid);
    } else {
        ui.label("No entity has FluidParticles.");
    }

    if !subjects.others.is_empty() {
        ui.separator();
        let other = choose(ui, "Beside", &subjects.others, &mut inspector.other, |it| {
            code(world, it)
        });
        if let Some(other) = other {
            components(ui, world, other);
        }
    }
    if !subjects.resources.is_empty() {
        ui.separator();
        ui.strong("For all");
        for resource in &subjects.resources {
            components(ui, world, *resource);
        }
        #[cfg(feature = "salva")]
        sources::live(ui, world);
    }
}

/// A list of entities by name, with a button that copies the chosen one as code. Returns the chosen
/// entity, or the first.
fn choose(
    ui: &mut Ui,
    kind: &str,
    entities: &[(Entity, String)],
    chosen: &mut Option<Entity>,
    code: impl FnOnce(Entity) -> String,
) -> Option<Entity> {
    let (entity, name) = entities
        .iter()
        .find(|(entity, _)| Some(*entity) == *chosen)
        .or(entities.first())?;
    let mut entity = *entity;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = widgets::GAP;
        let label = ui.strong(kind);
        ui.add_space(widgets::LABEL - label.rect.width());
        ComboBox::from_id_salt(kind)
            .width(widgets::VALUE - widgets::COPY)
            .selected_text(name)
            .truncate()
            .show_ui(ui, |ui| {
                for (other, name) in entities {
                    if ui.selectable_label(*other == entity, name).clicked() {
                        *chosen = Some(*other);
                        entity = *other;
                    }
                }
            })
            .response
            .labelled_by(label.id);
        if widgets::copy_button(ui, kind) {
            ui.ctx().copy_text(code(entity));
        }
    });
    Some(entity)
}
