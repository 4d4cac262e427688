//! Cameras on one target, one over the other.

use bevy::{
    camera::{Hdr, NormalizedRenderTarget, RenderTarget},
    platform::collections::HashSet,
    prelude::*,
    window::PrimaryWindow,
};

use crate::settings::ScreenSpaceFluid;

type Drawing<'a> = (Entity, &'a Camera, &'a RenderTarget, &'a Msaa, Has<Hdr>);

/// Cameras draw over each other's pictures only in textures of the same kind, and liquids need
/// [`Hdr`]: a camera below one that draws liquids over its picture gets it too.
pub(super) fn share_targets(
    over: Query<(Entity, &Camera, &RenderTarget, &Msaa), (With<ScreenSpaceFluid>, With<Hdr>)>,
    cameras: Query<Drawing>,
    window: Query<Entity, With<PrimaryWindow>>,
    mut warned: Local<HashSet<[Entity; 2]>>,
    mut commands: Commands,
) {
    let window = window.single().ok();
    let of = |target: &RenderTarget| -> Option<NormalizedRenderTarget> { target.normalize(window) };
    for (upper, camera, target, msaa) in &over {
        if !camera.is_active || !matches!(camera.clear_color, ClearColorConfig::None) {
            continue;
        }
        for (lower, below, target_below, msaa_below, hdr) in &cameras {
            let is_below = below.is_active && below.order < camera.order;
            if lower == upper || !is_below || of(target_below) != of(target) {
                continue;
            }
            if !hdr {
                info!("camera {lower} gets `Hdr`: {upper} draws liquids over its picture");
                commands.entity(lower).insert(Hdr);
            }
            if msaa != msaa_below && warned.insert([lower, upper]) {
                warn!(
                    "camera {upper} draws liquids over the picture of {lower}, but does not see it: \
                    the two differ in `Msaa`"
                );
            }
        }
    }
}
