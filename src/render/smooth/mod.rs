//! Smoothing of the bulk's layers, which removes the bumps of single particles.

#[cfg(feature = "published")]
mod average;
mod pipeline;
#[cfg(feature = "published")]
mod published;
pub(crate) mod steps;

use bevy::{
    prelude::*,
    render::{
        GpuResourceAppExt, Render, RenderApp, RenderStartup, RenderSystems,
        render_resource::{CachedRenderPipelineId, PipelineCache},
        renderer::{RenderContext, ViewQuery},
    },
};

#[cfg(all(test, feature = "published"))]
pub(super) use self::average::AveragePipeline;
#[cfg(feature = "published")]
pub(super) use self::average::average_normals;
pub(super) use self::pipeline::{GpuSmoothing, SmoothPipeline};
use self::steps::{Buffer, Step};
use super::{
    frame::{
        Frame, FrameStartup, Gpu, Group, Input, Kept, Layers, Offset, Target, UniformArray,
        add_stage, cleared, pipelines::NO_LAYERS, timed,
    },
    surface::{Surface, SurfaceSystems, ViewSurfaces},
};

/// Name of the pass's time span.
pub(crate) const SPAN: &str = "fluid_smooth";

/// "Nothing here" as bits: [`NO_LAYERS`] in a texture of integers.
const NO_SLOPES: [f32; 4] = [0.0, 0xc000_0000_u32 as f32, 0.0, 0.0];

/// A surface's smoothing: a bind group for each texture that is read.
#[derive(Component, Default)]
pub(super) struct Smooth {
    offset: Offset,
    layers: Group,
    scratch: Group,
    slopes: Group,
}

pub(super) fn plugin(app: &mut App) {
    pipeline::load_shaders(app);
    #[cfg(feature = "published")]
    published::embed_shaders(app);
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .init_gpu_resource::<UniformArray<GpuSmoothing>>()
        .add_systems(RenderStartup, pipeline::init_pipeline.after(FrameStartup))
        .add_systems(
            Render,
            (
                prepare_uniforms.in_set(SurfaceSystems::Resources),
                prepare_groups.in_set(RenderSystems::PrepareBindGroups),
            ),
        );
    add_stage::<SmoothPipeline>(render_app);
    let world = render_app.world_mut();
    world.register_required_components::<Surface, Smooth>();
    #[cfg(feature = "published")]
    average::plugin(render_app);
}

fn prepare_uniforms(
    mut surfaces: Query<(&Surface, &mut Smooth)>,
    mut uniforms: ResMut<UniformArray<GpuSmoothing>>,
    gpu: Gpu,
) {
    uniforms.clear();
    for (surface, mut smooth) in &mut surfaces {
        if let Some(plan) = surface.plan() {
            let radius = surface.uniform.radius;
            smooth.offset = uniforms.push(GpuSmoothing::new(&plan.smoothing, radius));
        }
    }
    uniforms.write(&gpu);
}

fn prepare_groups(
    mut surfaces: Query<(&Layers, &mut Smooth)>,
    pipeline: Res<SmoothPipeline>,
    uniforms: Res<UniformArray<GpuSmoothing>>,
    gpu: Gpu,
) {
    for (layers, mut smooth) in &mut surfaces {
        let Smooth {
            layers: of_layers,
            scratch,
            slopes,
            ..
        } = &mut *smooth;
        for (group, texture, layout) in [
            (of_layers, &layers.bulk, &pipeline.layout),
            (scratch, &layers.scratch, &pipeline.layout),
            (slopes, &layers.exits, &pipeline.slopes_layout),
        ] {
            let inputs = [Input::texture(texture.as_ref()), uniforms.input()];
            group.prepare(&gpu, "fluid_smooth", layout, &inputs);
        }
    }
}

impl Smooth {
    fn group(&self, buffer: Buffer) -> &Group {
        match buffer {
            Buffer::Layers => &self.layers,
            Buffer::Scratch => &self.scratch,
            Buffer::Slopes => &self.slopes,
        }
    }
}

fn target(layers: &Layers, buffer: Buffer) -> Option<&Target> {
    match buffer {
        Buffer::Layers => layers.bulk.as_ref(),
        Buffer::Scratch => layers.scratch.as_ref(),
        Buffer::Slopes => layers.exits.as_ref(),
    }
}

/// The pass: the bulk of all surfaces.
pub(super) fn smooth(
    view: ViewQuery<&ViewSurfaces>,
    surfaces: Query<(&Surface, &Frame, &Layers, &Smooth, &Kept<SmoothPipeline>)>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    timed(&mut ctx, SPAN, |ctx| {
        let surfaces = surfaces.iter_many(&view.into_inner().surfaces);
        for (surface, frame, layers, smooth, pipelines) in surfaces {
            for (step, pipeline) in pipelines.drawn(surface).into_iter().flatten() {
                record(ctx, (frame, layers, smooth), step, *pipeline, &cache);
            }
        }
    });
}

fn record(
    ctx: &mut RenderContext,
    (frame, layers, smooth): (&Frame, &Layers, &Smooth),
    step: &Step,
    pipeline: CachedRenderPipelineId,
    cache: &PipelineCache,
) {
    let (Some(pipeline), Some(group), Some(to)) = (
        cache.get_render_pipeline(pipeline),
        smooth.group(step.from).get(),
        target(layers, step.to),
    ) else {
        return;
    };
    let nothing = if step.to == Buffer::Slopes {
        NO_SLOPES
    } else {
        NO_LAYERS
    };
    let normals = layers.bulk_normals.as_ref().filter(|_| step.normals);
    let targets = [
        cleared(to, nothing),
        normals.and_then(|normals| cleared(normals, [0.0; 4])),
    ];
    let targets = &targets[..1 + usize::from(normals.is_some())];
    let mut pass = frame.begin(ctx, SPAN, targets, None, pipeline);
    pass.set_bind_group(1, group, &[smooth.offset.bytes()]);
    frame.draw_tiles(&mut pass);
}
