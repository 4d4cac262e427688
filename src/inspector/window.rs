//! The window: times, then the camera with its settings, then the fluid with its.

use bevy::{
    diagnostic::DiagnosticsStore,
    ecs::{reflect::ReflectComponent, reflect::ReflectResource},
    prelude::*,
    reflect::{PartialReflect, TypeRegistration, TypeRegistry},
};
use bevy_egui::{
    EguiContext, PrimaryEguiContext,
    egui::{self, CollapsingHeader, ComboBox, RichText, ScrollArea, Ui},
};
use core::any::TypeId;

use super::{
    FluidInspector, rust_code, skipped, times,
    walker::Walker,
    widgets::{self, Field, WIDTH, row},
};
use crate::{FluidDebugView, FluidParticles, ScreenSpaceFluid, ShapedFluid};

/// Shows the window in the primary context.
pub(super) fn show(world: &mut World, mut clock: Local<times::Clock>) {
    let mut contexts = world.query_filtered::<&mut EguiContext, With<PrimaryEguiContext>>();
    let Ok(mut context) = contexts.single_mut(world) else {
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

/// Entities that have something to show.
#[derive(Default)]
struct Subjects {
    cameras: Vec<(Entity, String)>,
    fluids: Vec<(Entity, String)>,
    others: Vec<(Entity, String)>,
    resources: Vec<Entity>,
}

impl Subjects {
    fn find(world: &mut World, inspector: &FluidInspector, types: &TypeRegistry) -> Self {
        let components: Vec<_> = inspector
            .types()
            .iter()
            .filter_map(|id| Some((world.components().get_id(*id)?, types.get(*id)?)))
            .collect();
        if components.is_empty() {
            return Self::default();
        }
        let mut query = QueryBuilder::<EntityRef>::new(world);
        query.or(|any| {
            for (id, _) in &components {
                any.with_id(*id);
            }
        });
        let mut found = Self::default();
        for entity in query.build().iter(world) {
            let is_resource = components.iter().any(|(id, registration)| {
                entity.contains_id(*id) && registration.contains::<ReflectResource>()
            });
            let (list, kind) = if is_resource {
                found.resources.push(entity.id());
                continue;
            } else if entity.contains::<Camera>() {
                (&mut found.cameras, "camera")
            } else if entity.contains::<FluidParticles>() {
                (&mut found.fluids, "fluid")
            } else {
                (&mut found.others, "entity")
            };
            let name = match entity.get::<Name>() {
                Some(name) => name.to_string(),
                None => format!("{kind} {}", entity.id()),
            };
            list.push((entity.id(), name));
        }
        for list in [&mut found.cameras, &mut found.fluids, &mut found.others] {
            list.sort();
        }
        found
    }
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
    let camera = choose(ui, "Camera", &subjects.cameras, &mut inspector.camera);
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
    let fluid = choose(ui, "Fluid", &subjects.fluids, &mut inspector.fluid);
    if let Some(fluid) = fluid {
        counts(ui, world, fluid, subjects);
        components(ui, world, fluid);
    } else {
        ui.label("No entity has FluidParticles.");
    }

    if !subjects.others.is_empty() {
        ui.separator();
        if let Some(other) = choose(ui, "Beside", &subjects.others, &mut inspector.other) {
            components(ui, world, other);
        }
    }
    if !subjects.resources.is_empty() {
        ui.separator();
        ui.strong("For all");
        for resource in &subjects.resources {
            components(ui, world, *resource);
        }
    }
}

/// A list of entities by name; what is chosen, or the first.
fn choose(
    ui: &mut Ui,
    kind: &str,
    entities: &[(Entity, String)],
    chosen: &mut Option<Entity>,
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
            .width(widgets::VALUE)
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
    });
    Some(entity)
}

/// What a camera shows in place of the picture.
fn debug_view(ui: &mut Ui, world: &mut World, camera: Entity) {
    let now = world.get::<FluidDebugView>(camera).copied();
    let mut next = now;
    let field = Field {
        name: "shown",
        docs: Some("The picture, or an intermediate result in its place."),
        range: None,
        depth: 0,
    };
    let name = |view: Option<FluidDebugView>| match view {
        Some(view) => widgets::words(&format!("{view:?}")),
        None => "picture".into(),
    };
    let output = row(ui, field, now.is_some(), |ui, label| {
        ComboBox::from_id_salt("debug view")
            .width(widgets::VALUE)
            .height(320.0)
            .selected_text(name(now))
            .show_ui(ui, |ui| {
                for view in [None].into_iter().chain(FluidDebugView::ALL.map(Some)) {
                    let item = ui.selectable_label(now == view, name(view));
                    if widgets::explained(item, view.and_then(docs_of)).clicked() {
                        next = view;
                    }
                }
            })
            .response
            .labelled_by(label);
        false
    });
    if output.reset {
        next = None;
    }
    if next != now {
        let mut camera = world.entity_mut(camera);
        match next {
            Some(view) => camera.insert(view),
            None => camera.remove::<FluidDebugView>(),
        };
    }
}

fn docs_of(view: FluidDebugView) -> Option<&'static str> {
    use bevy::reflect::{
        Typed,
        enums::{Enum, VariantInfo},
    };
    let info = FluidDebugView::type_info().as_enum().ok()?;
    info.variant(view.variant_name())
        .and_then(VariantInfo::docs)
}

/// Particles by class, of the fluid and of all.
fn counts(ui: &mut Ui, world: &World, fluid: Entity, subjects: &Subjects) {
    let of = |entity: Entity| {
        world.get::<ShapedFluid>(entity).map_or([0; 5], |shaped| {
            let classes = [
                shaped.bulk(),
                shaped.interior(),
                shaped.spray(),
                shaped.dropped(),
            ];
            let [bulk, interior, spray, dropped] = classes.map(u64::from);
            [
                bulk + interior + spray + dropped,
                bulk,
                interior,
                spray,
                dropped,
            ]
        })
    };
    let one = of(fluid);
    let mut all = [0; 5];
    for (entity, _) in &subjects.fluids {
        for (sum, count) in all.iter_mut().zip(of(*entity)) {
            *sum += count;
        }
    }
    CollapsingHeader::new("Counts")
        .default_open(true)
        .show_unindented(ui, |ui| {
            times::heading_row(ui, ["", "this fluid", "all"]);
            let names = ["particles", "bulk", "interior", "spray", "dropped"];
            for ((name, one), all) in names.into_iter().zip(one).zip(all) {
                times::figures_row(ui, RichText::new(name), [one, all].map(|it| it.to_string()));
            }
        });
}

/// A section for a component, if the entity has it.
fn component(
    ui: &mut Ui,
    world: &mut World,
    entity: Entity,
    registration: &TypeRegistration,
    types: &TypeRegistry,
) {
    let Some(data) = registration.data::<ReflectComponent>() else {
        return;
    };
    if !data.contains(world.entity(entity)) {
        return;
    }
    let info = registration.type_info();
    let name = info.type_path_table().short_path();
    let header = CollapsingHeader::new(name)
        .id_salt((name, entity))
        .default_open(opens(info.type_id()))
        .show_unindented(ui, |ui| {
            // Lists of one name are in more than one section.
            ui.push_id(name, |ui| {
                let Some(mut value) = data.reflect_mut(world.entity_mut(entity)) else {
                    return;
                };
                let edited = section(ui, value.bypass_change_detection(), types);
                if edited {
                    value.set_changed();
                }
            });
        });
    widgets::explained(header.header_response, info.docs());
}

/// What one looks for first.
fn opens(id: TypeId) -> bool {
    id == TypeId::of::<ScreenSpaceFluid>() || id == TypeId::of::<crate::FluidMaterial>()
}

/// Presets, reset and copy above all fields.
fn section(ui: &mut Ui, value: &mut dyn Reflect, types: &TypeRegistry) -> bool {
    let walker = Walker { registry: types };
    let default = walker.default_of(value.reflect_type_info().type_id());
    let default = default.as_deref().map(PartialReflect::as_partial_reflect);
    let value = value.as_partial_reflect_mut();
    let mut edited = false;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        let label = ui.weak("preset");
        edited |= walker.presets(ui, label.id, value, 120.0);
        if let Some(default) = default
            && ui
                .button("Reset")
                .on_hover_text("all to the defaults")
                .clicked()
        {
            edited |= value.try_apply(default).is_ok();
        }
        let copy = ui.button("Copy as Rust");
        if copy
            .on_hover_text("what differs from the defaults, as code")
            .clicked()
        {
            ui.ctx().copy_text(rust_code(value, types));
        }
    });
    edited | walker.parts(ui, value, default, 0)
}
