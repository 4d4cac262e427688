//! Layers for adapters that cannot blend 32-bit floats: the depth test keeps the nearest front and
//! the farthest back, and a pass merges the two.

use bevy::{
    app::SubApp,
    asset::load_embedded_asset,
    core_pipeline::FullscreenShader,
    prelude::*,
    render::{
        Render, RenderStartup, RenderSystems,
        render_resource::{
            BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedRenderPipelineId, LoadOp,
            Operations, PipelineCache, RenderPassDepthStencilAttachment, RenderPassDescriptor,
            RenderPipelineDescriptor, ShaderStages, StoreOp, TextureFormat,
            binding_types::texture_depth_2d,
        },
        renderer::RenderContext,
    },
};

use super::{
    super::{
        frame::{
            Gpu, Group, Input, Layers, Target, cleared, ensure,
            pipelines::{NO_LAYERS, fragment},
            support::{FluidSupport, LAYER_FORMAT},
        },
        surface::{Surface, SurfaceSystems},
    },
    ClassDraw,
};

/// Of the depth-only draws.
pub(super) const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;

/// The pass that merges depths.
#[derive(Resource)]
pub(in super::super) struct DepthDraws {
    layout: BindGroupLayoutDescriptor,
    merge: CachedRenderPipelineId,
}

/// Front and back of one class at a time.
#[derive(Component, Default)]
pub(in super::super) struct DepthTextures {
    front: Option<Target>,
    back: Option<Target>,
    group: Group,
}

pub(super) fn plugin(render_app: &mut SubApp) {
    render_app
        .add_systems(RenderStartup, init_merge)
        .add_systems(
            Render,
            (
                wait_for_merge.in_set(SurfaceSystems::Request),
                prepare_textures.in_set(RenderSystems::PrepareBindGroups),
            ),
        );
    let world = render_app.world_mut();
    world.register_required_components::<Surface, DepthTextures>();
}

fn init_merge(
    mut commands: Commands,
    assets: Res<AssetServer>,
    fullscreen: Res<FullscreenShader>,
    cache: Res<PipelineCache>,
) {
    let layout = BindGroupLayoutDescriptor::new(
        "fluid_merge_layout",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::FRAGMENT,
            (texture_depth_2d(), texture_depth_2d()),
        ),
    );
    let shader = load_embedded_asset!(assets.as_ref(), "merge.wgsl");
    let merge = cache.queue_render_pipeline(RenderPipelineDescriptor {
        label: Some("fluid_merge_pipeline".into()),
        layout: vec![layout.clone()],
        vertex: fullscreen.to_vertex_state(),
        fragment: Some(fragment(&shader, vec![], &[LAYER_FORMAT], None)),
        ..default()
    });
    commands.insert_resource(DepthDraws { layout, merge });
}

fn wait_for_merge(
    mut surfaces: Query<&mut Surface>,
    support: Res<FluidSupport>,
    depth_draws: Res<DepthDraws>,
    cache: Res<PipelineCache>,
) {
    if support.max_blend || cache.get_render_pipeline(depth_draws.merge).is_some() {
        return;
    }
    for mut surface in &mut surfaces {
        surface.waiting = true;
    }
}

fn prepare_textures(
    mut surfaces: Query<(&Layers, &mut DepthTextures)>,
    support: Res<FluidSupport>,
    depth_draws: Res<DepthDraws>,
    gpu: Gpu,
) {
    if support.max_blend {
        return;
    }
    for (layers, mut textures) in &mut surfaces {
        let there = layers.size() != UVec2::ZERO;
        let DepthTextures { front, back, group } = &mut *textures;
        for (target, label) in [
            (&mut *front, "fluid_front_depth"),
            (&mut *back, "fluid_back_depth"),
        ] {
            ensure(target, there, &gpu, label, layers.size(), DEPTH_FORMAT);
        }
        let inputs = [
            Input::texture(front.as_ref()),
            Input::texture(back.as_ref()),
        ];
        group.prepare(&gpu, "fluid_merge", &depth_draws.layout, &inputs);
    }
}

impl DepthDraws {
    /// Front and back of a class, then both into its layers.
    pub(super) fn record(
        &self,
        ctx: &mut RenderContext,
        draw: &ClassDraw,
        textures: &DepthTextures,
        layers: &Target,
        [front, back]: [Option<CachedRenderPipelineId>; 2],
    ) {
        let (Some(near), Some(far), Some(group)) =
            (&textures.front, &textures.back, textures.group.get())
        else {
            return;
        };
        for (target, pipeline, clear) in [(near, front, 0.0), (far, back, 1.0)] {
            let depth = RenderPassDepthStencilAttachment {
                view: &target.view,
                depth_ops: Some(Operations {
                    load: LoadOp::Clear(clear),
                    store: StoreOp::Store,
                }),
                stencil_ops: None,
            };
            match pipeline {
                Some(pipeline) => draw.record(ctx, None, Some(depth), pipeline),
                // Cleared, but empty.
                None => drop(ctx.begin_tracked_render_pass(RenderPassDescriptor {
                    label: Some("fluid_no_backs"),
                    depth_stencil_attachment: Some(depth),
                    ..default()
                })),
            }
        }
        let Some(pipeline) = draw.splats.cache.get_render_pipeline(self.merge) else {
            return;
        };
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("fluid_merge"),
            color_attachments: &[cleared(layers, NO_LAYERS)],
            ..default()
        });
        pass.set_render_pipeline(pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.draw(0..3, 0..1);
    }
}
