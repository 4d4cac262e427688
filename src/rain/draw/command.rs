//! Render commands that run while Bevy draws the view.

use bevy::{
    core_pipeline::core_3d::Transparent3d,
    ecs::{
        query::{ROQueryItem, With},
        system::{
            SystemParamItem,
            lifetimeless::{Read, SRes},
        },
    },
    render::{
        diagnostic::RecordDiagnostics,
        render_phase::{
            PhaseItem, PhaseItemExtraIndex, RenderCommand, RenderCommandResult, SetItemPipeline,
            TrackedRenderPass,
        },
        render_resource::IndexFormat,
        renderer::{RenderContext, ViewQuery},
        view::ViewDepthTexture,
    },
};

use super::{
    buffers::RainBuffers,
    quads::{BACKDROP, DROPS, RainQuads},
};
use crate::render::ViewSurfaces;

/// Copies the scene's depth, including liquids, before transparent objects are drawn.
pub(crate) fn copy_scene_depth(
    view: ViewQuery<(&RainQuads, &ViewDepthTexture)>,
    mut ctx: RenderContext,
) {
    let (quads, depth) = view.into_inner();
    copy(quads, depth, &mut ctx);
}

/// Copies the scene's depth without liquids, in views that draw some.
pub(crate) fn copy_scene_depth_behind_liquid(
    view: ViewQuery<(&RainQuads, &ViewDepthTexture), With<ViewSurfaces>>,
    mut ctx: RenderContext,
) {
    let (quads, depth) = view.into_inner();
    copy(quads, depth, &mut ctx);
}

fn copy(quads: &RainQuads, depth: &ViewDepthTexture, ctx: &mut RenderContext) {
    let (Some(copy), Some(_)) = (&quads.depth, &quads.bind_group) else {
        return;
    };
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let span = recorder.time_span(ctx.command_encoder(), "rain_scene_depth");
    ctx.command_encoder().copy_texture_to_texture(
        depth.texture.as_image_copy(),
        copy.texture.as_image_copy(),
        depth.texture.size(),
    );
    span.end(ctx.command_encoder());
}

pub(crate) type DrawRain = (SetItemPipeline, DrawItem);

/// One shell of voxels, the backdrop, or the drops near the eye.
pub(crate) struct DrawItem;

impl RenderCommand<Transparent3d> for DrawItem {
    type Param = SRes<RainBuffers>;
    type ViewQuery = Read<RainQuads>;
    type ItemQuery = ();

    fn render<'w>(
        item: &Transparent3d,
        quads: ROQueryItem<'w, '_, Self::ViewQuery>,
        _: Option<()>,
        buffers: SystemParamItem<'w, '_, Self::Param>,
        pass: &mut TrackedRenderPass<'w>,
    ) -> RenderCommandResult {
        let (PhaseItemExtraIndex::DynamicOffset(index), Some(group)) =
            (item.extra_index(), &quads.bind_group)
        else {
            return RenderCommandResult::Skip;
        };
        pass.set_bind_group(0, &group.group, &[quads.view_offset, quads.uniform_offset]);
        let index = index as usize;
        if index == BACKDROP {
            pass.draw(0..3, 0..1);
            return RenderCommandResult::Success;
        }
        let Some(instances) = quads.instances.buffer() else {
            return RenderCommandResult::Skip;
        };
        pass.set_vertex_buffer(0, instances.slice(..));
        if index == DROPS {
            let Some(indices) = &buffers.into_inner().drop_indices else {
                return RenderCommandResult::Skip;
            };
            pass.set_index_buffer(indices.slice(..), IndexFormat::Uint32);
            pass.draw_indexed(0..quads.drop_indices, 0, quads.cells.clone());
        } else if let Some(shell) = quads.shells.get(index) {
            pass.draw(0..4, shell.instances.clone());
        }
        RenderCommandResult::Success
    }
}
