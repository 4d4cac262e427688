//! Tiles: squares of a surface's textures, and whether they hold liquid. Passes over its pixels
//! leave out empty ones.

use bevy::{
    asset::{embedded_asset, load_embedded_asset},
    core_pipeline::FullscreenShader,
    prelude::*,
    render::{
        render_resource::{
            BindGroupLayoutDescriptor, BindGroupLayoutEntries, PipelineCache, RenderPassDescriptor,
            RenderPipelineDescriptor, ShaderStages, SpecializedRenderPipeline, VertexState,
        },
        renderer::{RenderContext, ViewQuery},
    },
};

use super::{
    Group, Inputs, Kept, Layers, NoUniform, Stage, add_stage, cleared,
    layers::TILE_FORMAT,
    pipelines::{defs, fragment, tile_size, unfiltered},
    timed,
};
use crate::render::surface::{Surface, Variant, ViewSurfaces};

/// Name of the pass's time span.
pub(crate) const SPAN: &str = "fluid_tiles";

#[derive(Resource)]
pub(crate) struct TilePipeline {
    fullscreen: VertexState,
    layout: BindGroupLayoutDescriptor,
    shader: Handle<Shader>,
}

pub(super) fn plugin(app: &mut App) {
    embedded_asset!(app, "mark_tiles.wgsl");
    add_stage::<TilePipeline>(app);
}

impl FromWorld for TilePipeline {
    fn from_world(world: &mut World) -> Self {
        Self {
            fullscreen: world.resource::<FullscreenShader>().to_vertex_state(),
            layout: BindGroupLayoutDescriptor::new(
                "fluid_tiles_layout",
                &BindGroupLayoutEntries::sequential(
                    ShaderStages::FRAGMENT,
                    (unfiltered(), unfiltered(), unfiltered()),
                ),
            ),
            shader: load_embedded_asset!(world, "mark_tiles.wgsl"),
        }
    }
}

impl SpecializedRenderPipeline for TilePipeline {
    /// Whether there are bulk, spray and coverage.
    type Key = [bool; 3];

    fn specialize(&self, [bulk, spray, covers]: [bool; 3]) -> RenderPipelineDescriptor {
        let mut shader_defs = defs([
            ("BULK_LAYERS", bulk),
            ("SPRAY_LAYERS", spray),
            ("COVERAGE", covers),
        ]);
        shader_defs.push(tile_size());
        RenderPipelineDescriptor {
            label: Some("fluid_tiles_pipeline".into()),
            layout: vec![self.layout.clone()],
            vertex: self.fullscreen.clone(),
            fragment: Some(fragment(&self.shader, shader_defs, &[TILE_FORMAT], None)),
            ..default()
        }
    }
}

impl Stage for TilePipeline {
    const LABEL: &'static str = SPAN;
    type Uniform = NoUniform;
    type State = Group;

    fn keys(&self, variant: &Variant) -> Vec<[bool; 3]> {
        let plan = &variant.plan;
        vec![[plan.bulk, plan.spray, plan.antialiasing.covers()]]
    }

    fn prepare(&self, group: &mut Group, _: &Surface, layers: &Layers, inputs: &Inputs) {
        let layers = [
            inputs.or_nothing(layers.splatted()),
            inputs.or_nothing(&layers.spray),
            inputs.or_nothing(&layers.coverage),
        ];
        group.prepare(inputs.gpu, SPAN, &self.layout, &layers);
    }
}

/// The pass: marks the tiles of all surfaces.
pub(crate) fn mark_tiles(
    view: ViewQuery<&ViewSurfaces>,
    surfaces: Query<(&Surface, &Layers, &Kept<TilePipeline>)>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    timed(&mut ctx, SPAN, |ctx| {
        for (surface, layers, kept) in surfaces.iter_many(&view.into_inner().surfaces) {
            let (Some(target), Some(group), Some(pipeline)) =
                (layers.tiles(), kept.state.get(), kept.only(surface, &cache))
            else {
                continue;
            };
            let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
                label: Some(SPAN),
                color_attachments: &[cleared(target, [0.0; 4])],
                ..default()
            });
            pass.set_render_pipeline(pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.draw(0..3, 0..1);
        }
    });
}
