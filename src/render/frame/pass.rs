//! Passes over a surface.

use bevy::{
    prelude::*,
    render::{
        render_phase::TrackedRenderPass,
        render_resource::{
            ComputePass, LoadOp, Operations, RenderPassColorAttachment,
            RenderPassDepthStencilAttachment, RenderPassDescriptor, RenderPipeline, StoreOp,
        },
        renderer::RenderContext,
    },
};

use super::{Group, Layers, Target};
use crate::render::surface::{Surface, ViewSurfaces};

/// A surface's place on screen, for its passes.
#[derive(Component, Default)]
pub(crate) struct Frame {
    pub(super) group: Group,
    offsets: [u32; 3],
    /// In the surface's textures.
    rect: URect,
    /// In the camera's target.
    camera_rect: URect,
    viewport: URect,
    tiles: u32,
}

impl Frame {
    pub(super) fn place(
        &mut self,
        offsets: [u32; 3],
        surface: &Surface,
        layers: &Layers,
        view: &ViewSurfaces,
    ) {
        self.offsets = offsets;
        let min = (surface.rect.min.as_ivec2() - layers.origin()).as_uvec2();
        self.rect = URect::from_corners(min, min + surface.rect.size());
        let min = view.viewport.min + surface.rect.min;
        self.camera_rect = URect::from_corners(min, min + surface.rect.size());
        self.viewport = view.viewport;
        self.tiles = layers.tile_count().element_product();
    }

    /// The dynamic offset of its [`GpuFrame`](super::GpuFrame).
    pub(crate) fn frame_offset(&self) -> u32 {
        self.offsets[1]
    }

    /// The surface's rectangle in the camera's target.
    pub(crate) fn camera_rect(&self) -> URect {
        self.camera_rect
    }

    /// Begins a pass over the surface's own textures.
    pub(crate) fn begin<'a>(
        &'a self,
        ctx: &'a mut RenderContext,
        label: &'static str,
        colors: &[Option<RenderPassColorAttachment>],
        depth: Option<RenderPassDepthStencilAttachment>,
        pipeline: &'a RenderPipeline,
    ) -> TrackedRenderPass<'a> {
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some(label),
            color_attachments: colors,
            depth_stencil_attachment: depth,
            ..default()
        });
        confine(&mut pass, self.rect);
        self.set(&mut pass, pipeline);
        pass
    }

    /// Confines a pass over the camera's target to the surface.
    pub(crate) fn enter<'a>(
        &'a self,
        pass: &mut TrackedRenderPass<'a>,
        pipeline: &'a RenderPipeline,
    ) {
        let (min, size) = (self.viewport.min, self.viewport.size());
        pass.set_viewport(
            min.x as f32,
            min.y as f32,
            size.x as f32,
            size.y as f32,
            0.0,
            1.0,
        );
        confine(pass, self.camera_rect);
        self.set(pass, pipeline);
    }

    /// The surface's own bind group, for a pass that computes.
    pub(crate) fn bind(&self, pass: &mut ComputePass) {
        if let Some(group) = self.group.get() {
            pass.set_bind_group(0, group, &self.offsets);
        }
    }

    fn set<'a>(&'a self, pass: &mut TrackedRenderPass<'a>, pipeline: &'a RenderPipeline) {
        pass.set_render_pipeline(pipeline);
        if let Some(group) = self.group.get() {
            pass.set_bind_group(0, group, &self.offsets);
        }
    }

    /// Draws the pixels of all tiles that hold liquid.
    pub(crate) fn draw_tiles(&self, pass: &mut TrackedRenderPass) {
        pass.draw(0..4, 0..self.tiles);
    }
}

fn confine(pass: &mut TrackedRenderPass, rect: URect) {
    pass.set_scissor_rect(rect.min.x, rect.min.y, rect.width(), rect.height());
}

/// An attachment that is cleared first.
pub(crate) fn cleared(
    target: &Target,
    [r, g, b, a]: [f32; 4],
) -> Option<RenderPassColorAttachment<'_>> {
    Some(RenderPassColorAttachment {
        view: &target.view,
        depth_slice: None,
        resolve_target: None,
        ops: Operations {
            load: LoadOp::Clear(LinearRgba::new(r, g, b, a).into()),
            store: StoreOp::Store,
        },
    })
}
