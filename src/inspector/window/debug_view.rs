//! The list of debug views.

use bevy::prelude::*;
use bevy_egui::egui::{ComboBox, Ui};

use crate::{
    inspector::widgets::{self, Field, row},
    settings::FluidDebugView,
};

/// What a camera shows in place of the picture.
pub(super) fn debug_view(ui: &mut Ui, world: &mut World, camera: Entity) {
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
