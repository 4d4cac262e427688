//! Work that the plan skipped for the camera's fluids, and why.

use bevy::{prelude::*, reflect::TypeRegistry};
use bevy_egui::egui::{CollapsingHeader, RichText, Ui};

use super::{
    presets::ReflectPresets,
    widgets::{LABEL, WIDTH, digits},
};
use crate::{
    particles::ShapedFluid,
    render::{PlanReports, Skipped, SurfaceReport, Waiting},
};

/// A section; it shows the report of the last frames for which one was requested.
pub(super) fn show(
    ui: &mut Ui,
    world: &World,
    camera: Entity,
    fluids: &[(Entity, String)],
    types: &TypeRegistry,
) {
    let Some(reports) = world.get_resource::<PlanReports>() else {
        return;
    };
    let header = CollapsingHeader::new("Left out in this frame").show_unindented(ui, |ui| {
        reports.ask();
        let views = reports.latest();
        let Some(view) = views.into_iter().find(|view| view.camera == camera) else {
            ui.weak("This camera draws no fluid.");
            return;
        };
        if view.surfaces.is_empty() {
            ui.weak("There is no fluid: no pass runs.");
        }
        for surface in &view.surfaces {
            show_body(ui, world, surface, fluids, types);
        }
    });
    header
        .header_response
        .on_hover_text("Work that the scene makes needless, surface by surface, and why.");
}

fn show_body(
    ui: &mut Ui,
    world: &World,
    surface: &SurfaceReport,
    fluids: &[(Entity, String)],
    types: &TypeRegistry,
) {
    let name = |entity: &Entity| fluids.iter().find(|(fluid, _)| fluid == entity);
    let names: Vec<_> = surface
        .fluids
        .iter()
        .filter_map(|it| Some(name(it)?.1.as_str()))
        .collect();
    let material = ReflectPresets::of(&surface.material, types)
        .and_then(|presets| presets.name_of(&surface.material))
        .unwrap_or("custom material");
    ui.label(RichText::new(format!("{} ({material})", names.join(", "))).strong());
    if let Some(Waiting { stage, failed }) = surface.waiting {
        let why = if failed {
            "its pipeline cannot be made: see the log"
        } else {
            "its pipeline is being compiled"
        };
        line(ui, stage, why);
    }
    for Skipped { work, why } in &surface.skipped {
        line(ui, work, why);
    }
    let outside = 100.0 * (1.0 - f64::from(surface.covered));
    if outside >= 1.0 {
        let pixels = format!("{} % of the pixels", digits(outside.round()));
        line(ui, &pixels, "they are outside its box on screen");
    }
    let unchanged = surface.fluids.iter().all(|fluid| {
        let fluid = world.get_entity(*fluid).ok();
        fluid.is_some_and(|it| {
            it.get_ref::<ShapedFluid>()
                .is_some_and(|it| !it.is_changed())
        })
    });
    if unchanged {
        line(ui, "shaping, upload", "no particle has changed");
    }
}

fn line(ui: &mut Ui, work: &str, why: &str) {
    ui.horizontal(|ui| {
        let label = ui.label(work);
        ui.add_space((LABEL - label.rect.width()).max(0.0));
        ui.set_max_width(WIDTH);
        ui.label(RichText::new(why).weak());
    });
}
