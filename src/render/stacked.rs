//! Cameras on one target, one over the other.

use bevy::{
    camera::{Hdr, RenderTarget},
    core_pipeline::tonemapping::Tonemapping,
    platform::collections::HashSet,
    prelude::*,
    window::PrimaryWindow,
};

use crate::settings::ScreenSpaceFluid;

type Drawing<'a> = (
    Entity,
    &'a Camera,
    &'a RenderTarget,
    &'a Msaa,
    Option<&'a Tonemapping>,
    Has<Hdr>,
    Has<ScreenSpaceFluid>,
);

/// Cameras draw over each other's pictures only in textures of the same kind, and liquids need
/// [`Hdr`]: a camera below or above one that draws liquids gets it too. Light is then mapped to
/// tones once, by the camera above.
pub(super) fn share_targets(
    cameras: Query<Drawing>,
    window: Query<Entity, With<PrimaryWindow>>,
    mut warned: Local<HashSet<[Entity; 2]>>,
    mut commands: Commands,
) {
    let window = window.single().ok();
    for (above, camera, target, msaa, tones, hdr, liquid) in &cameras {
        if !camera.is_active || !matches!(camera.clear_color, ClearColorConfig::None) {
            continue;
        }
        for (below, other, other_target, other_msaa, other_tones, other_hdr, other_liquid) in
            &cameras
        {
            let is_below = other.is_active && other.order < camera.order;
            let is_shared = target.normalize(window) == other_target.normalize(window);
            if !is_below || !is_shared || !(liquid || other_liquid) {
                continue;
            }
            if hdr != other_hdr {
                let (named, draws) = if hdr { (below, above) } else { (above, below) };
                info!(
                    "camera {named} gets `Hdr`: it shares its picture with {draws}, which draws liquids"
                );
                commands.entity(named).insert(Hdr);
                let maps = |tones: Option<&Tonemapping>| tones.is_some_and(Tonemapping::is_enabled);
                if maps(tones) && maps(other_tones) {
                    commands.entity(below).insert(Tonemapping::None);
                }
            }
            if msaa != other_msaa && warned.insert([below, above]) {
                warn!(
                    "camera {above} draws over the picture of {below}, but does not see it: they \
                    differ in `Msaa`"
                );
            }
        }
    }
}
