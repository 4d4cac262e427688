//! The mean of the splats' normals over a window, in place of smoother layers (Takahashi & Doi).

use bevy::{
    app::SubApp,
    asset::load_embedded_asset,
    prelude::*,
    render::{
        Render, RenderStartup, RenderSystems,
        render_resource::{
            BindGroupLayoutDescriptor, CachedRenderPipelineId, RenderPipelineDescriptor,
            SpecializedRenderPipeline,
        },
        renderer::{RenderContext, ViewQuery},
    },
    shader::ShaderDefVal,
};

use super::{
    super::{
        frame::{
            Frame, FrameLayout, FrameStartup, Gpu, Group, Input, Kept, Layers, NORMAL_FORMAT,
            Stage, Target, add_stage, cleared, ensure,
            pipelines::{Tiles, fragment, one_texture_layout, tile_pipeline},
            splats::{Class, SplatLayouts, Splats, normals_pipeline},
        },
        surface::{Surface, SurfaceSystems, Variant, ViewSurfaces},
    },
    SPAN, Smooth, SmoothPipeline,
};
use crate::settings::Smoothing;

#[derive(Resource)]
pub(in super::super) struct AveragePipeline {
    frame: FrameLayout,
    splats: SplatLayouts,
    window: BindGroupLayoutDescriptor,
    normals: BindGroupLayoutDescriptor,
    shader: Handle<Shader>,
}

/// The normals before they are averaged.
#[derive(Component, Default)]
pub(in super::super) struct SplatNormals {
    target: Option<Target>,
    group: Group,
    /// The bulk's layers.
    finished: Group,
}

pub(super) fn plugin(render_app: &mut SubApp) {
    render_app
        .add_systems(
            RenderStartup,
            init_pipeline
                .after(super::pipeline::init_pipeline)
                .after(FrameStartup),
        )
        .add_systems(
            Render,
            (
                prepare_target.in_set(SurfaceSystems::Resources),
                prepare_groups.in_set(RenderSystems::PrepareBindGroups),
            ),
        );
    add_stage::<AveragePipeline>(render_app);
    let world = render_app.world_mut();
    world.register_required_components::<Surface, SplatNormals>();
}

fn init_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    frame: Res<FrameLayout>,
    splats: Res<SplatLayouts>,
    smooth: Res<SmoothPipeline>,
) {
    commands.insert_resource(AveragePipeline {
        frame: frame.clone(),
        splats: splats.clone(),
        window: smooth.layout.clone(),
        normals: one_texture_layout("fluid_average_normals_layout"),
        shader: load_embedded_asset!(assets.as_ref(), "average_normals.wgsl"),
    });
}

impl SpecializedRenderPipeline for AveragePipeline {
    /// Taps to each side of the average; none for the normals themselves.
    type Key = Option<u32>;

    fn specialize(&self, half_taps: Option<u32>) -> RenderPipelineDescriptor {
        let Some(half_taps) = half_taps else {
            return normals_pipeline(&self.frame, &self.splats);
        };
        let taps = vec![ShaderDefVal::Int("HALF_TAPS".into(), half_taps as i32)];
        tile_pipeline(
            "fluid_average_normals_pipeline",
            &self.frame,
            [self.window.clone(), self.normals.clone()],
            Tiles::Bulk,
            fragment(&self.shader, taps, &[NORMAL_FORMAT], None),
        )
    }
}

impl Stage for AveragePipeline {
    /// Of the normals and of their average.
    type Pipelines = Option<[CachedRenderPipelineId; 2]>;

    fn pipelines(
        &self,
        variant: &Variant,
        request: impl FnMut(Option<u32>) -> CachedRenderPipelineId,
    ) -> Self::Pipelines {
        let half_taps = half_taps(variant)?;
        Some([None, Some(half_taps)].map(request))
    }

    fn ids(pipelines: &Self::Pipelines) -> impl Iterator<Item = CachedRenderPipelineId> {
        pipelines.iter().flatten().copied()
    }
}

/// Taps to each side, if normals are averaged.
fn half_taps(variant: &Variant) -> Option<u32> {
    match variant.plan.smoothing {
        Smoothing::NormalAverage(average) if !variant.plan.index_one => Some(average.half_taps),
        _ => None,
    }
}

fn prepare_target(mut surfaces: Query<(&Surface, &Layers, &mut SplatNormals)>, gpu: Gpu) {
    for (surface, layers, mut normals) in &mut surfaces {
        ensure(
            &mut normals.target,
            surface
                .drawn
                .as_ref()
                .is_some_and(|it| half_taps(it).is_some()),
            &gpu,
            "fluid_splat_normals",
            layers.size(),
            NORMAL_FORMAT,
        );
    }
}

fn prepare_groups(
    mut surfaces: Query<(&Layers, &mut SplatNormals)>,
    pipeline: Res<AveragePipeline>,
    gpu: Gpu,
) {
    for (layers, mut normals) in &mut surfaces {
        let SplatNormals {
            target,
            group,
            finished,
        } = &mut *normals;
        if target.is_none() {
            continue;
        }
        for (group, texture) in [(group, &*target), (finished, &layers.bulk)] {
            let inputs = [Input::texture(texture.as_ref())];
            group.prepare(&gpu, "fluid_splat_normals", &pipeline.normals, &inputs);
        }
    }
}

/// The pass: the bulk's normals of surfaces that average them.
pub(in super::super) fn average_normals(
    view: ViewQuery<&ViewSurfaces>,
    surfaces: Query<(
        &Surface,
        &Frame,
        &Layers,
        &Smooth,
        &SplatNormals,
        &Kept<AveragePipeline>,
    )>,
    splats: Splats,
    mut ctx: RenderContext,
) {
    let surfaces = surfaces.iter_many(&view.into_inner().surfaces);
    for (surface, frame, layers, smooth, normals, pipelines) in surfaces {
        let Some(Some([draw, average])) = pipelines.drawn(surface) else {
            continue;
        };
        let (finished, target) = (&normals.finished, &normals.target);
        splats.normals(
            &mut ctx,
            (surface, frame),
            finished,
            target,
            *draw,
            Class::Bulk,
        );
        let (Some(pipeline), Some(window), Some(group), Some(target)) = (
            splats.cache.get_render_pipeline(*average),
            smooth.group(super::Buffer::Layers).get(),
            normals.group.get(),
            &layers.bulk_normals,
        ) else {
            continue;
        };
        let targets = [cleared(target, [0.0; 4])];
        let mut pass = frame.begin(&mut ctx, SPAN, &targets, None, pipeline);
        pass.set_bind_group(1, window, &[smooth.offset.bytes()]);
        pass.set_bind_group(2, group, &[]);
        frame.draw_tiles(&mut pass);
    }
}
