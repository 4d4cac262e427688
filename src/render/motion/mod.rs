//! Motion vectors of the liquid, where Bevy's temporal antialiasing and motion blur read them. Only
//! cameras with a [`MotionVectorPrepass`](bevy::core_pipeline::prepass::MotionVectorPrepass) have them,
//! which both effects add.
//!
//! The nearest splat of a pixel tells how far the liquid has moved there since the frame before, and
//! the finished layers where it is.

mod displacements;
mod fluid;
mod pipeline;

use bevy::{
    asset::embedded_asset,
    core_pipeline::prepass::ViewPrepassTextures,
    prelude::*,
    render::{
        RenderApp,
        render_resource::{
            LoadOp, Operations, RenderPassDepthStencilAttachment, RenderPassDescriptor, StoreOp,
        },
        renderer::{RenderContext, ViewQuery},
        view::ViewDepthTexture,
    },
};

#[cfg(all(test, feature = "published"))]
pub(super) use self::pipeline::MotionKey;
pub(super) use self::pipeline::MotionPipeline;
use self::{displacements::measure_displacements, fluid::FluidMotion};
use super::{
    frame::{
        Frame, Kept, add_stage, cleared,
        splats::{Class, SplatPass, Splats},
        timed,
    },
    surface::{Surface, ViewSurfaces},
};
use crate::{schedule::FluidSystems, source::particles::shape_fluids};

/// Name of the pass's time span.
pub(crate) const SPAN: &str = "fluid_motion";

pub(super) fn plugin(app: &mut App) {
    embedded_asset!(app, "splat_motion.wgsl");
    embedded_asset!(app, "motion_vectors.wgsl");
    app.add_systems(
        PostUpdate,
        measure_displacements
            .in_set(FluidSystems::Shape)
            .after(shape_fluids),
    );
    if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
        fluid::plugin(render_app);
    }
    add_stage::<MotionPipeline>(app);
}

/// The pass: motion vectors of all surfaces of the view, wherever their depth has been written.
pub(super) fn motion(
    view: ViewQuery<(
        &ViewDepthTexture,
        Option<&ViewPrepassTextures>,
        &ViewSurfaces,
    )>,
    surfaces: Query<(&Surface, &Frame, &Kept<MotionPipeline>)>,
    fluids: Query<&FluidMotion>,
    splats: Splats,
    mut ctx: RenderContext,
) {
    let (depth, prepass, view) = view.into_inner();
    let vectors = prepass.and_then(|textures| textures.motion_vectors.as_ref());
    timed(&mut ctx, SPAN, |ctx| {
        let Some(vectors) = vectors else {
            return;
        };
        for (surface, frame, kept) in surfaces.iter_many(&view.surfaces) {
            let id = |to_camera| kept.id(surface, |key| key.is_to_camera() == to_camera);
            let (Some(on_splats), Some(to_camera)) = (id(false), id(true)) else {
                continue;
            };
            let (Some(displacement), Some(nearest), Some(group), Some(pipeline)) = (
                &kept.state.displacement,
                &kept.state.nearest,
                kept.state.group.get(),
                splats.cache.get_render_pipeline(to_camera),
            ) else {
                continue;
            };
            let mut members = surface.fluids.iter();
            let moves = members.any(|fluid| {
                let motion = fluids.get(fluid.entity);
                motion.is_ok_and(FluidMotion::moves)
            });
            let pass = SplatPass {
                label: SPAN,
                pipeline: Some(on_splats),
                color: cleared(displacement, [0.0; 4]),
                depth: Some(RenderPassDepthStencilAttachment {
                    view: &nearest.view,
                    depth_ops: Some(Operations {
                        load: LoadOp::Clear(0.0),
                        store: StoreOp::Discard,
                    }),
                    stencil_ops: None,
                }),
                of_fluid: Some(&|fluid| fluids.get(fluid).ok()?.get()),
                ..default()
            };
            // Where nothing moves, the texture is cleared alone.
            let classes: &[_] = if moves {
                &[Class::Bulk, Class::Spray]
            } else {
                &[]
            };
            splats.record(ctx, (surface, frame), pass, classes);

            let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
                label: Some("fluid_motion_vectors"),
                color_attachments: &[Some(vectors.get_attachment())],
                depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
                ..default()
            });
            frame.enter(&mut pass, pipeline);
            pass.set_bind_group(1, group, &[kept.offset.bytes()]);
            frame.draw_tiles(&mut pass);
        }
    });
}
