//! The adapter's capabilities, queried once.

use bevy::{
    prelude::*,
    render::{
        render_resource::{TextureFormat, TextureFormatFeatureFlags, TextureUsages, WgpuFeatures},
        renderer::{RenderAdapter, RenderAdapterInfo, RenderDevice},
        settings::{Backends, WgpuLimits},
    },
};

/// Format of the depth layers: (front, −back) in device depth.
pub(crate) const LAYER_FORMAT: TextureFormat = TextureFormat::Rg32Float;

/// How the four layers are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum LayerBlending {
    /// `MaxBlend` if the adapter supports it, else `DepthDraws`.
    #[default]
    Auto,
    /// One draw per class; a `max` blend of 32-bit floats keeps both depths.
    MaxBlend,
    /// Two depth-only draws per class. Works everywhere.
    DepthDraws,
}

/// The capabilities and the methods chosen for them.
#[derive(Resource, Clone, Copy, Debug)]
pub(crate) struct FluidSupport {
    /// Whether fluids can be drawn at all.
    pub(crate) drawing: bool,
    pub(crate) max_blend: bool,
    /// Format of sums over particles.
    pub(crate) thickness_format: TextureFormat,
}

/// The setting of [`FluidPlugin`](crate::FluidPlugin), in the render world.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub(crate) struct WantedBlending(pub(crate) LayerBlending);

/// Whether fluids can be drawn: a run condition.
pub(crate) fn can_draw_fluids(support: Option<Res<FluidSupport>>) -> bool {
    support.is_some_and(|support| support.drawing)
}

pub(crate) fn init_support(
    mut commands: Commands,
    wanted: Res<WantedBlending>,
    device: Res<RenderDevice>,
    adapter: Res<RenderAdapter>,
    info: Res<RenderAdapterInfo>,
) {
    let layers = adapter.get_texture_format_features(LAYER_FORMAT);
    let drawing = can_draw(&device.limits(), layers.allowed_usages);
    if !drawing {
        warn!(
            "fluids are not drawn: {} has no storage buffers in vertex shaders or cannot render to {LAYER_FORMAT:?}",
            info.name
        );
    }
    // OpenGL reports it without checking.
    let trusted = Backends::from(info.backend) != Backends::GL;
    let can_blend_in = |format| {
        let own = adapter.get_texture_format_features(format).flags;
        trusted && can_blend(device.features(), own)
    };
    let can_blend = can_blend_in(LAYER_FORMAT);
    let max_blend = can_blend && wanted.0 != LayerBlending::DepthDraws;
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

fn can_draw(limits: &WgpuLimits, layers: TextureUsages) -> bool {
    limits.max_storage_buffers_per_shader_stage > 0
        && layers.contains(TextureUsages::RENDER_ATTACHMENT)
}

/// Either of two features is enough: one is for this alone, the other enables an adapter's own
/// format features.
fn can_blend(features: WgpuFeatures, layers: TextureFormatFeatureFlags) -> bool {
    features.contains(WgpuFeatures::FLOAT32_BLENDABLE)
        || (features.contains(WgpuFeatures::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES)
            && layers.contains(TextureFormatFeatureFlags::BLENDABLE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        FluidPlugin,
        prelude::{FluidParticles, ScreenSpaceFluid},
        render::ViewSurfaces,
    };
    use bevy::render::RenderApp;
    use fluid_stage::{capture, headless_app, settle};

    #[test]
    fn drawing_takes_storage_buffers_and_layers_that_can_be_drawn_to() {
        let [none, some] = [0, 1].map(|count| WgpuLimits {
            max_storage_buffers_per_shader_stage: count,
            ..default()
        });
        let all = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
        assert!(can_draw(&some, all));
        assert!(!can_draw(&none, all));
        assert!(!can_draw(&some, TextureUsages::TEXTURE_BINDING));
    }

    #[test]
    fn blending_takes_one_feature_or_the_adapters_own_word() {
        let blendable = TextureFormatFeatureFlags::BLENDABLE;
        let nothing = TextureFormatFeatureFlags::empty();
        let own = WgpuFeatures::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES;
        assert!(can_blend(WgpuFeatures::FLOAT32_BLENDABLE, nothing));
        assert!(can_blend(own, blendable));
        assert!(!can_blend(own, nothing));
        assert!(!can_blend(WgpuFeatures::empty(), blendable));
    }

    /// A scene on a device that cannot draw fluids looks as if there were none.
    #[test]
    fn without_support_nothing_is_drawn_and_nothing_goes_wrong() {
        let mut pictures = [true, false].map(|fluids| {
            let mut app = headless_app(UVec2::splat(32), |app| {
                app.add_plugins(FluidPlugin::default());
                app.world_mut()
                    .spawn((Camera3d::default(), ScreenSpaceFluid::default()));
            })
            .unwrap();
            settle(&mut app).unwrap();
            let render_app = app.sub_app_mut(RenderApp).world_mut();
            render_app.resource_mut::<FluidSupport>().drawing = false;
            if fluids {
                let ahead = vec![Vec3::NEG_Z * 3.0];
                app.world_mut().spawn(FluidParticles::new(ahead, 1.0));
            }
            settle(&mut app).unwrap();
            let views = app.sub_app(RenderApp).world().iter_entities();
            assert_eq!(views.filter(EntityRef::contains::<ViewSurfaces>).count(), 0);
            // Fails if the GPU's validation has reported an error.
            capture(&mut app).unwrap()
        });
        let [with, without] = &mut pictures;
        assert!(with == without);
    }
}
