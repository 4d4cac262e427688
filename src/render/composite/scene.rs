//! The scene's colour for rays to look up while the camera's target is written. The copy lives in
//! the one of the view's two main textures that post-processing will write to later.

use bevy::{
    core_pipeline::blit::{BlitPipeline, BlitPipelineKey},
    prelude::*,
    render::{
        Render, RenderApp, RenderStartup, RenderSystems,
        render_resource::{
            BindGroup, BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedRenderPipelineId,
            Extent3d, LoadOp, Operations, PipelineCache, RenderPassColorAttachment,
            RenderPassDescriptor, SamplerBindingType, ShaderStages, SpecializedRenderPipelines,
            StoreOp, TextureSampleType, TextureViewId,
            binding_types::{sampler, texture_2d},
        },
        renderer::RenderContext,
        view::ViewTarget,
    },
};

use super::SPAN;
use crate::render::{
    frame::{FrameLayout, FrameStartup, Gpu, Group, Input, Target, ensure},
    surface::{Surface, SurfaceSystems, ViewSurfaces, reasons::Waiting},
};

/// A view's copies of the scene's colour.
#[derive(Component, Default)]
pub(crate) struct SceneColor {
    /// The colour before any surface is painted, where there are several.
    before: Option<Target>,
    blit: Option<CachedRenderPipelineId>,
    /// For either main texture as the one that is written.
    sides: [Side; 2],
}

#[derive(Default)]
struct Side {
    written: Option<TextureViewId>,
    /// Copies the written texture.
    source: Group,
    /// Reads the copy.
    scene: Group,
}

/// The layout of the group that holds the scene's colour as it is, and as it was before any surface.
#[derive(Resource)]
pub(super) struct SceneColorLayout(pub(super) BindGroupLayoutDescriptor);

fn init_layout(mut commands: Commands) {
    let filtered = || texture_2d(TextureSampleType::Float { filterable: true });
    commands.insert_resource(SceneColorLayout(BindGroupLayoutDescriptor::new(
        "fluid_scene_color_layout",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::FRAGMENT | ShaderStages::COMPUTE,
            (
                filtered(),
                filtered(),
                sampler(SamplerBindingType::Filtering),
            ),
        ),
    )));
}

pub(super) fn plugin(app: &mut App) {
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app.add_systems(RenderStartup, init_layout.in_set(FrameStartup));
    render_app.add_systems(
        Render,
        (
            wait_for_blit.in_set(SurfaceSystems::Request),
            prepare.in_set(RenderSystems::PrepareBindGroups),
        ),
    );
    let world = render_app.world_mut();
    world.register_required_components::<ViewSurfaces, SceneColor>();
}

fn wait_for_blit(
    mut views: Query<(&ViewSurfaces, &mut SceneColor)>,
    mut surfaces: Query<&mut Surface>,
    blit: Res<BlitPipeline>,
    mut specialized: ResMut<SpecializedRenderPipelines<BlitPipeline>>,
    mut cache: ResMut<PipelineCache>,
) {
    for (view, mut scene) in &mut views {
        let mut surfaces = surfaces.iter_many_mut(&view.surfaces);
        while let Some(mut surface) = surfaces.fetch_next() {
            let key = BlitPipelineKey {
                target_format: surface.wanted.format,
                blend_state: None,
                samples: 1,
                source_space: None,
            };
            let id = specialized.specialize(&cache, &blit, key);
            scene.blit = Some(id);
            if surface.vanishes() {
                cache.block_on_render_pipeline(id);
            }
            if cache.get_render_pipeline(id).is_none() {
                surface.waiting = Some(Waiting::new(SPAN, cache.get_render_pipeline_state(id)));
            }
        }
    }
}

fn prepare(
    mut views: Query<(&ViewSurfaces, &ViewTarget, &mut SceneColor)>,
    layout: Res<SceneColorLayout>,
    blit: Res<BlitPipeline>,
    frame: Res<FrameLayout>,
    gpu: Gpu,
) {
    for (view, target, mut scene) in &mut views {
        let size = target.main_texture().size();
        ensure(
            &mut scene.before,
            view.several(),
            &gpu,
            "fluid_scene_before",
            uvec2(size.width, size.height),
            target.main_texture_format(),
        );
        let (this, other) = (target.main_texture_view(), target.main_texture_other_view());
        let SceneColor { before, sides, .. } = &mut *scene;
        for (side, (written, copy)) in sides.iter_mut().zip([(this, other), (other, this)]) {
            side.written = Some(written.id());
            side.source.prepare(
                &gpu,
                "fluid_scene_source",
                &blit.layout,
                &[Input::view(written), Input::sampler(&blit.sampler)],
            );
            let before = before.as_ref().map_or(copy, |before| &before.view);
            side.scene.prepare(
                &gpu,
                "fluid_scene_color",
                &layout.0,
                &[
                    Input::view(copy),
                    Input::view(before),
                    Input::sampler(&frame.linear),
                ],
            );
        }
    }
}

impl SceneColor {
    fn side(&self, target: &ViewTarget) -> Option<&Side> {
        let written = Some(target.main_texture_view().id());
        self.sides.iter().find(|side| side.written == written)
    }

    /// The group to read the copies.
    pub(super) fn group(&self, target: &ViewTarget) -> Option<&BindGroup> {
        self.side(target)?.scene.get()
    }

    /// Keeps the colour before any surface, where there are several.
    pub(super) fn keep(&self, ctx: &mut RenderContext, target: &ViewTarget, region: URect) {
        let Some(before) = &self.before else {
            return;
        };
        let mut from = target.main_texture().as_image_copy();
        (from.origin.x, from.origin.y) = (region.min.x, region.min.y);
        let mut to = before.texture.as_image_copy();
        to.origin = from.origin;
        let size = Extent3d {
            width: region.width(),
            height: region.height(),
            depth_or_array_layers: 1,
        };
        ctx.command_encoder()
            .copy_texture_to_texture(from, to, size);
    }

    /// Copies a region of the colour as it is now.
    pub(super) fn copy(
        &self,
        ctx: &mut RenderContext,
        target: &ViewTarget,
        region: URect,
        cache: &PipelineCache,
    ) {
        let (Some(pipeline), Some(source)) = (
            self.blit.and_then(|id| cache.get_render_pipeline(id)),
            self.side(target).and_then(|side| side.source.get()),
        ) else {
            return;
        };
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("fluid_scene_color"),
            color_attachments: &[Some(RenderPassColorAttachment {
                view: target.main_texture_other_view(),
                depth_slice: None,
                resolve_target: None,
                ops: Operations {
                    load: LoadOp::Load,
                    store: StoreOp::Store,
                },
            })],
            ..default()
        });
        let URect { min, max } = region;
        pass.set_scissor_rect(min.x, min.y, max.x - min.x, max.y - min.y);
        pass.set_render_pipeline(pipeline);
        pass.set_bind_group(0, source, &[]);
        pass.draw(0..3, 0..1);
    }
}
