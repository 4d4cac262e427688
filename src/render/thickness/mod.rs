//! The accumulated path length through bodies without refraction.

use bevy::{
    asset::load_embedded_asset,
    prelude::*,
    render::{
        render_resource::{
            BindGroupLayoutDescriptor, PipelineCache, RenderPipelineDescriptor,
            SpecializedRenderPipeline, TextureFormat, VertexState,
        },
        renderer::{RenderContext, ViewQuery},
    },
    shader::Shader,
};

use super::{
    bindings::{SUM_BLEND, common_layout, defs, fragment},
    extract::GpuSplats,
    splat::{Class, SPLAT_QUAD, SplatPipeline, SplatSum, SplatView},
};

#[derive(Resource)]
pub(crate) struct ThicknessPipeline {
    shader: Handle<Shader>,
    splats: BindGroupLayoutDescriptor,
}

/// Needs the layout of the splats.
pub(crate) fn init_thickness_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    splat: Res<SplatPipeline>,
) {
    commands.insert_resource(ThicknessPipeline {
        shader: load_embedded_asset!(assets.as_ref(), "thickness.wgsl"),
        splats: splat.fluid_layout.clone(),
    });
}

impl SpecializedRenderPipeline for ThicknessPipeline {
    /// Format of the sums.
    type Key = TextureFormat;

    fn specialize(&self, format: TextureFormat) -> RenderPipelineDescriptor {
        // Path lengths are in metres, which needs view space.
        let shader_defs = defs([("VIEW_SPACE", true)]);
        RenderPipelineDescriptor {
            label: Some("fluid_thickness_pipeline".into()),
            layout: vec![common_layout(), self.splats.clone()],
            vertex: VertexState {
                shader: self.shader.clone(),
                shader_defs: shader_defs.clone(),
                entry_point: Some("vertex".into()),
                buffers: vec![],
            },
            primitive: SPLAT_QUAD,
            fragment: Some(fragment(
                &self.shader,
                shader_defs,
                &[format],
                Some(SUM_BLEND),
            )),
            ..default()
        }
    }
}

/// The pass: all bodies that need it.
pub(crate) fn thickness(
    view: ViewQuery<SplatView>,
    fluids: Query<&'static GpuSplats>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let sum = SplatSum {
        label: "fluid_thickness",
        fluids: &fluids,
        cache: &cache,
        classes: &[Class::All],
    };
    sum.draw(view.into_inner(), &mut ctx, |body| {
        Some((body.layers.thickness.as_ref()?, body.pipelines.thickness?))
    });
}
