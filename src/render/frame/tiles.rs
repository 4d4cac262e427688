//! Tiles: squares of a surface's textures, and whether they hold liquid. Passes over its pixels
//! leave out empty ones.

use bevy::{
    app::SubApp,
    asset::load_embedded_asset,
    core_pipeline::FullscreenShader,
    prelude::*,
    render::{
        Render, RenderStartup, RenderSystems,
        render_resource::{
            BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedRenderPipelineId,
            PipelineCache, RenderPassDescriptor, RenderPipelineDescriptor, ShaderStages,
            SpecializedRenderPipeline, TextureFormat, VertexState,
        },
        renderer::{RenderContext, ViewQuery},
    },
};

use super::{
    FrameStartup, Gpu, Group, Input, Kept, Layers, Stage, add_stage, cleared,
    pipelines::{defs, fragment, unfiltered},
    targets::Placeholder,
};
use crate::render::surface::{Surface, Variant, ViewSurfaces};

/// Edge of a tile. Unit: pixels.
pub(crate) const TILE: u32 = 16;

/// 1 where there is (bulk, spray).
pub(super) const TILE_FORMAT: TextureFormat = TextureFormat::Rg8Unorm;

#[derive(Resource)]
pub(crate) struct TilePipeline {
    fullscreen: VertexState,
    layout: BindGroupLayoutDescriptor,
    shader: Handle<Shader>,
}

#[derive(Component, Default)]
pub(crate) struct TileGroup(Group);

pub(super) fn plugin(render_app: &mut SubApp) {
    render_app
        .add_systems(RenderStartup, init_pipeline.in_set(FrameStartup))
        .add_systems(
            Render,
            prepare_groups.in_set(RenderSystems::PrepareBindGroups),
        );
    add_stage::<TilePipeline>(render_app);
    let world = render_app.world_mut();
    world.register_required_components::<Surface, TileGroup>();
}

fn init_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    fullscreen: Res<FullscreenShader>,
) {
    commands.insert_resource(TilePipeline {
        fullscreen: fullscreen.to_vertex_state(),
        layout: BindGroupLayoutDescriptor::new(
            "fluid_tiles_layout",
            &BindGroupLayoutEntries::sequential(
                ShaderStages::FRAGMENT,
                (unfiltered(), unfiltered()),
            ),
        ),
        shader: load_embedded_asset!(assets.as_ref(), "mark_tiles.wgsl"),
    });
}

impl SpecializedRenderPipeline for TilePipeline {
    /// Whether there are bulk and spray.
    type Key = [bool; 2];

    fn specialize(&self, [bulk, spray]: [bool; 2]) -> RenderPipelineDescriptor {
        let classes = defs([("BULK_LAYERS", bulk), ("SPRAY_LAYERS", spray)]);
        RenderPipelineDescriptor {
            label: Some("fluid_tiles_pipeline".into()),
            layout: vec![self.layout.clone()],
            vertex: self.fullscreen.clone(),
            fragment: Some(fragment(&self.shader, classes, &[TILE_FORMAT], None)),
            ..default()
        }
    }
}

impl Stage for TilePipeline {
    type Pipelines = CachedRenderPipelineId;

    fn pipelines(
        &self,
        variant: &Variant,
        mut request: impl FnMut([bool; 2]) -> CachedRenderPipelineId,
    ) -> CachedRenderPipelineId {
        request([variant.plan.bulk, variant.plan.spray])
    }

    fn ids(pipeline: &CachedRenderPipelineId) -> impl Iterator<Item = CachedRenderPipelineId> {
        [*pipeline].into_iter()
    }
}

fn prepare_groups(
    mut surfaces: Query<(&Layers, &mut TileGroup)>,
    pipeline: Res<TilePipeline>,
    placeholder: Res<Placeholder>,
    gpu: Gpu,
) {
    for (layers, mut group) in &mut surfaces {
        let inputs = [
            Input::texture_or(layers.splatted(), &placeholder),
            Input::texture_or(&layers.spray, &placeholder),
        ];
        group
            .0
            .prepare(&gpu, "fluid_tiles", &pipeline.layout, &inputs);
    }
}

/// The pass: marks the tiles of all surfaces.
pub(crate) fn mark_tiles(
    view: ViewQuery<&ViewSurfaces>,
    surfaces: Query<(&Surface, &Layers, &TileGroup, &Kept<TilePipeline>)>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    for (surface, layers, group, pipelines) in surfaces.iter_many(&view.into_inner().surfaces) {
        let pipeline = pipelines.drawn(surface);
        let (Some(target), Some(group), Some(pipeline)) = (
            layers.tiles(),
            group.0.get(),
            pipeline.and_then(|&id| cache.get_render_pipeline(id)),
        ) else {
            continue;
        };
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("fluid_tiles"),
            color_attachments: &[cleared(target, [0.0; 4])],
            ..default()
        });
        pass.set_render_pipeline(pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.draw(0..3, 0..1);
    }
}
