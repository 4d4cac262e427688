//! Layers for adapters that cannot blend 32-bit floats: the depth test keeps the nearest front and
//! the farthest back, and a pass merges the two.

use bevy::{
    asset::load_embedded_asset,
    core_pipeline::{FullscreenShader, core_3d::CORE_3D_DEPTH_FORMAT},
    prelude::*,
    render::{
        render_resource::{
            BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedRenderPipelineId, LoadOp,
            Operations, RenderPassDepthStencilAttachment, RenderPassDescriptor,
            RenderPipelineDescriptor, ShaderStages, StoreOp, VertexState,
            binding_types::texture_depth_2d,
        },
        renderer::RenderContext,
    },
};

use super::super::{
    frame::{
        Frame, Gpu, Group, Input, Layers, Target, cleared, ensure,
        pipelines::{NO_LAYERS, fragment},
        splats::{Class, SplatPass, Splats},
        support::LAYER_FORMAT,
    },
    surface::Surface,
};

/// The pass that merges depths.
pub(super) struct Merge {
    fullscreen: VertexState,
    layout: BindGroupLayoutDescriptor,
    shader: Handle<Shader>,
}

impl FromWorld for Merge {
    fn from_world(world: &mut World) -> Self {
        Self {
            fullscreen: world.resource::<FullscreenShader>().to_vertex_state(),
            layout: BindGroupLayoutDescriptor::new(
                "fluid_merge_layout",
                &BindGroupLayoutEntries::sequential(
                    ShaderStages::FRAGMENT,
                    (texture_depth_2d(), texture_depth_2d()),
                ),
            ),
            shader: load_embedded_asset!(world, "merge.wgsl"),
        }
    }
}

impl Merge {
    pub(super) fn descriptor(&self) -> RenderPipelineDescriptor {
        RenderPipelineDescriptor {
            label: Some("fluid_merge_pipeline".into()),
            layout: vec![self.layout.clone()],
            vertex: self.fullscreen.clone(),
            fragment: Some(fragment(&self.shader, vec![], &[LAYER_FORMAT], None)),
            ..default()
        }
    }
}

/// Front and back of one class at a time.
#[derive(Default)]
pub(crate) struct DepthTextures {
    front: Option<Target>,
    back: Option<Target>,
    group: Group,
}

impl DepthTextures {
    pub(super) fn prepare(&mut self, merge: &Merge, layers: &Layers, gpu: &Gpu) {
        let size = layers.size();
        let (front, back) = (&mut self.front, &mut self.back);
        for (target, label) in [
            (&mut *front, "fluid_front_depth"),
            (&mut *back, "fluid_back_depth"),
        ] {
            ensure(
                target,
                size != UVec2::ZERO,
                gpu,
                label,
                size,
                CORE_3D_DEPTH_FORMAT,
            );
        }
        let depths = [front, back].map(|it| Input::texture(it.as_ref()));
        self.group
            .prepare(gpu, "fluid_merge", &merge.layout, &depths);
    }

    /// Front and back of a class, then both into its layers.
    pub(super) fn record(
        &self,
        ctx: &mut RenderContext,
        (splats, class): (&Splats, Class),
        of: (&Surface, &Frame),
        layers: &Target,
        (depths, merge): (
            [Option<CachedRenderPipelineId>; 2],
            Option<CachedRenderPipelineId>,
        ),
    ) {
        let merge = merge.and_then(|id| splats.cache.get_render_pipeline(id));
        let (Some(near), Some(far), Some(group), Some(merge)) =
            (&self.front, &self.back, self.group.get(), merge)
        else {
            return;
        };
        for ((target, clear), pipeline) in [(near, 0.0), (far, 1.0)].into_iter().zip(depths) {
            let depth = Some(RenderPassDepthStencilAttachment {
                view: &target.view,
                depth_ops: Some(Operations {
                    load: LoadOp::Clear(clear),
                    store: StoreOp::Store,
                }),
                stencil_ops: None,
            });
            let label = "fluid_depths";
            if pipeline.is_some() {
                let pass = SplatPass {
                    label,
                    pipeline,
                    depth,
                    ..default()
                };
                splats.record(ctx, of, pass, &[class]);
            } else {
                // Cleared, but empty.
                drop(ctx.begin_tracked_render_pass(RenderPassDescriptor {
                    label: Some(label),
                    depth_stencil_attachment: depth,
                    ..default()
                }));
            }
        }
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("fluid_merge"),
            color_attachments: &[cleared(layers, NO_LAYERS)],
            ..default()
        });
        pass.set_render_pipeline(merge);
        pass.set_bind_group(0, group, &[]);
        pass.draw(0..3, 0..1);
    }
}
