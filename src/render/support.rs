//! What the adapter can do, asked once.

use bevy::{
    prelude::*,
    render::{
        render_resource::{TextureFormat, TextureFormatFeatureFlags, TextureUsages, WgpuFeatures},
        renderer::{RenderAdapter, RenderAdapterInfo, RenderDevice},
    },
};

/// Format of the depth layers: (front, −back) in device depth.
pub(crate) const LAYER_FORMAT: TextureFormat = TextureFormat::Rg32Float;

/// How the four layers are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum LayerBlending {
    /// `MaxBlend` where the adapter can, else `DepthDraws`.
    #[default]
    Auto,
    /// One draw per class; a `max` blend of 32-bit floats keeps both depths.
    MaxBlend,
    /// Two depth-only draws per class. Works everywhere.
    DepthDraws,
}

/// What was found, and what is done about it.
#[derive(Resource, Clone, Copy, Debug)]
pub(crate) struct FluidSupport {
    /// Fluids can be drawn at all.
    pub(crate) drawing: bool,
    pub(crate) max_blend: bool,
    /// What sums over particles are kept in.
    pub(crate) thickness_format: TextureFormat,
}

/// The wish of [`FluidPlugin`](crate::FluidPlugin), in the render world.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub(crate) struct WantedBlending(pub(crate) LayerBlending);

/// Whether the plan may leave work out, likewise.
#[derive(Resource, Clone, Copy, Debug)]
pub(crate) struct Shortcuts(pub(crate) bool);

pub(crate) fn init_support(
    mut commands: Commands,
    wanted: Res<WantedBlending>,
    device: Res<RenderDevice>,
    adapter: Res<RenderAdapter>,
    info: Res<RenderAdapterInfo>,
) {
    let limits = device.limits();
    let drawing = limits.max_storage_buffers_per_shader_stage > 0
        && adapter
            .get_texture_format_features(LAYER_FORMAT)
            .allowed_usages
            .contains(TextureUsages::RENDER_ATTACHMENT);
    if !drawing {
        warn!(
            "fluids are not drawn: {} has no storage buffers in vertex shaders or cannot render to {LAYER_FORMAT:?}",
            info.name
        );
    }
    let can_blend_in = |format| can_blend(&device, &adapter, &info, format);
    let can_blend = can_blend_in(LAYER_FORMAT);
    let max_blend = match wanted.0 {
        LayerBlending::DepthDraws => false,
        LayerBlending::Auto | LayerBlending::MaxBlend => can_blend,
    };
    if wanted.0 == LayerBlending::MaxBlend && !can_blend {
        warn!(
            "{} cannot blend {LAYER_FORMAT:?}: fluid layers are drawn twice instead",
            info.name
        );
    }
    // Halves can be blended everywhere; they hold a sum to a two thousandth at best.
    let thickness_format = if max_blend && can_blend_in(TextureFormat::R32Float) {
        TextureFormat::R32Float
    } else {
        TextureFormat::R16Float
    };
    commands.insert_resource(FluidSupport {
        drawing,
        max_blend,
        thickness_format,
    });
}

fn can_blend(
    device: &RenderDevice,
    adapter: &RenderAdapter,
    info: &RenderAdapterInfo,
    format: TextureFormat,
) -> bool {
    // OpenGL claims it without looking.
    if format!("{:?}", info.backend) == "Gl" {
        return false;
    }
    let features = device.features();
    features.contains(WgpuFeatures::FLOAT32_BLENDABLE)
        || (features.contains(WgpuFeatures::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES)
            && adapter
                .get_texture_format_features(format)
                .flags
                .contains(TextureFormatFeatureFlags::BLENDABLE))
}
