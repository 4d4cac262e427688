//! How many particles there are, and how much memory pictures of them take.

use bevy::prelude::*;
use bevy_egui::egui::{CollapsingHeader, RichText, Ui};

use super::Subjects;
use crate::{inspector::times, particles::ShapedFluid, render::TextureMemory};

/// Particles by class, of the fluid and of all.
pub(super) fn counts(ui: &mut Ui, world: &World, fluid: Entity, subjects: &Subjects) {
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
            if let Some(memory) = world.get_resource::<TextureMemory>() {
                let mebibytes = memory.bytes() as f64 / f64::from(1 << 20);
                let figures = [String::new(), format!("{mebibytes:.1}")];
                times::figures_row(ui, RichText::new("textures, MiB"), figures);
            }
        });
}
