//! The textures of a body in a view.

use bevy::{
    prelude::*,
    render::{
        render_resource::{Texture, TextureFormat, TextureView},
        renderer::RenderDevice,
        texture::{CachedTexture, TextureCache},
    },
};

use super::{
    plan::Plan,
    scene_textures::view_texture,
    smooth::SmoothSteps,
    support::{FluidSupport, LAYER_FORMAT},
};

use crate::settings::{FluidDebugView, Smoothing};

/// Front and back normals, octahedral, both towards the viewer.
pub(crate) const NORMAL_FORMAT: TextureFormat = TextureFormat::Rgba16Float;
/// Radiance and transmission.
pub(crate) const LIGHT_FORMAT: TextureFormat = TextureFormat::Rgba16Float;
/// The exit ray and the flags of a path.
pub(crate) const EXIT_FORMAT: TextureFormat = TextureFormat::Rgba32Uint;
/// Layers and their slopes along x, between the two halves of a separable fit.
pub(crate) const SLOPE_FORMAT: TextureFormat = TextureFormat::Rgba32Float;
/// Depths of the fallback's depth-only draws.
pub(crate) const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;

/// The textures that a body's passes draw into, all of the size of the view's target.
///
/// Layers hold (device depth of the front, −device depth of the back); (0, −2) means nothing. A
/// front of exactly 1 means that the ray starts inside the liquid.
pub struct Layers {
    /// The bulk's layers as splatted; smoothing writes to the two in turn.
    pub(crate) bulk: [CachedTexture; 2],
    /// Which of the two holds the final layers.
    pub(crate) smoothed: usize,
    pub(crate) slopes: Option<CachedTexture>,
    pub(crate) bulk_normals: CachedTexture,
    /// The bulk's normals before they are averaged.
    pub(crate) splat_normals: Option<CachedTexture>,
    pub(crate) spray: CachedTexture,
    pub(crate) spray_normals: CachedTexture,
    pub(crate) radiance: CachedTexture,
    pub(crate) transmission: CachedTexture,
    pub(crate) exits: CachedTexture,
    /// The accumulated path length through all particles, if it is needed.
    pub(crate) thickness: Option<CachedTexture>,
    /// The number of splats, if a debug view shows it.
    pub(crate) overdraw: Option<CachedTexture>,
    /// Front and back, for adapters that cannot blend.
    pub(crate) depths: Option<[CachedTexture; 2]>,
}

impl Layers {
    pub(crate) fn new(
        cache: &mut TextureCache,
        device: &RenderDevice,
        size: UVec2,
        plan: &Plan,
        steps: &SmoothSteps,
        support: &FluidSupport,
        placeholder: &CachedTexture,
        debug_view: Option<FluidDebugView>,
    ) -> Self {
        let mut texture = |label, format| view_texture(cache, device, label, size, format);
        let mut class = |there: bool, label, normals| {
            let mut wanted = |there, label, format| {
                if there {
                    texture(label, format)
                } else {
                    placeholder.clone()
                }
            };
            (
                wanted(there, label, LAYER_FORMAT),
                wanted(there && !plan.accumulated, normals, NORMAL_FORMAT),
            )
        };
        let (bulk, bulk_normals) = class(plan.bulk, "fluid_bulk_layers", "fluid_bulk_normals");
        let (spray, spray_normals) = class(plan.spray, "fluid_spray_layers", "fluid_spray_normals");
        let other = if steps.is_empty() {
            bulk.clone()
        } else {
            texture("fluid_bulk_layers_smoothed", LAYER_FORMAT)
        };
        Self {
            bulk: [bulk, other],
            smoothed: steps.last_target(),
            slopes: steps
                .needs_slopes()
                .then(|| texture("fluid_bulk_slopes", SLOPE_FORMAT)),
            bulk_normals,
            splat_normals: matches!(plan.smoothing, Smoothing::NormalAverage(_))
                .then(|| texture("fluid_bulk_splat_normals", NORMAL_FORMAT)),
            spray,
            spray_normals,
            radiance: texture("fluid_radiance", LIGHT_FORMAT),
            transmission: texture("fluid_transmission", LIGHT_FORMAT),
            exits: texture("fluid_exits", EXIT_FORMAT),
            thickness: plan
                .accumulated
                .then(|| texture("fluid_thickness", support.thickness_format)),
            overdraw: (debug_view == Some(FluidDebugView::Overdraw))
                .then(|| texture("fluid_overdraw", support.thickness_format)),
            depths: (!support.max_blend).then(|| {
                [
                    texture("fluid_front_depth", DEPTH_FORMAT),
                    texture("fluid_back_depth", DEPTH_FORMAT),
                ]
            }),
        }
    }

    /// The bulk's layers after smoothing.
    pub fn bulk(&self) -> &Texture {
        &self.bulk[self.smoothed].texture
    }

    /// The bulk's normals: front in rg, back in ba.
    pub fn bulk_normals(&self) -> &Texture {
        &self.bulk_normals.texture
    }

    /// The spray's layers.
    pub fn spray(&self) -> &Texture {
        &self.spray.texture
    }

    /// The spray's normals: front in rg, back in ba.
    pub fn spray_normals(&self) -> &Texture {
        &self.spray_normals.texture
    }

    /// The liquid's own radiance: reflected, in-scattered and emitted light.
    pub fn radiance(&self) -> &Texture {
        &self.radiance.texture
    }

    /// The transmitted fraction of the background's light.
    pub fn transmission(&self) -> &Texture {
        &self.transmission.texture
    }

    /// Exit rays and flags, in the layout of `pack_exit` in `refract.wgsl`.
    pub fn exits(&self) -> &Texture {
        &self.exits.texture
    }

    /// The accumulated path length through all particles in m, if it is summed up.
    pub fn thickness(&self) -> Option<&Texture> {
        self.thickness.as_ref().map(|cached| &cached.texture)
    }

    /// Number of splats drawn at each pixel, if a camera has [`FluidDebugView::Overdraw`].
    pub fn overdraw(&self) -> Option<&Texture> {
        self.overdraw.as_ref().map(|cached| &cached.texture)
    }

    pub(crate) fn bulk_view(&self) -> &TextureView {
        &self.bulk[self.smoothed].default_view
    }
}
