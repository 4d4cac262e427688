//! Where emitters and colliders were last, when they or the whole world have been put elsewhere.

use bevy::prelude::*;

use super::{colliders::ColliderPath, emission::Emission};
use crate::relocation::{self, Relocated, Teleports};

struct RelocatePlugin;

impl Plugin for RelocatePlugin {
    fn build(&self, app: &mut App) {
        relocation::on_shift(app, shift);
        relocation::on_teleport(app, teleport);
    }
}

/// Adds the systems of this file. Each plugin that emits does so, as it may be the only one.
pub(crate) fn relocated(app: &mut App) {
    if !app.is_plugin_added::<RelocatePlugin>() {
        app.add_plugins(RelocatePlugin);
    }
}

fn shift(
    mut emitters: Query<&mut Emission>,
    mut colliders: Query<&mut ColliderPath>,
    relocated: Res<Relocated>,
) {
    for mut emission in &mut emitters {
        emission.shift(relocated.shift);
    }
    for mut path in &mut colliders {
        path.shift(relocated.shift);
    }
}

/// They have not come from anywhere.
fn teleport(
    mut emitters: Query<(Entity, &mut Emission)>,
    mut colliders: Query<(Entity, &mut ColliderPath)>,
    teleports: Teleports,
) {
    for (entity, mut emission) in &mut emitters {
        if teleports.of(entity).is_some() {
            emission.forget_place();
        }
    }
    for (entity, mut path) in &mut colliders {
        if teleports.of(entity).is_some() {
            *path = ColliderPath::default();
        }
    }
}
