//! The mean of the splats' normals over a window, in place of smoother layers (Takahashi & Doi).

use bevy::{
    asset::load_embedded_asset,
    prelude::*,
    render::{
        render_resource::{
            BindGroupLayoutDescriptor, RenderPipelineDescriptor, SpecializedRenderPipeline,
        },
        renderer::{RenderContext, ViewQuery},
    },
    shader::ShaderDefVal,
};

use super::{
    super::{
        frame::{
            Frame, FrameLayout, Group, Input, Inputs, Kept, Layers, NORMAL_FORMAT, NoUniform,
            Stage, Target, cleared, ensure,
            pipelines::{Tiles, fragment, one_texture_layout, tile_pipeline, unfiltered},
            splats::{Class, SplatLayouts, SplatPass, Splats, normals_pipeline},
            timed,
        },
        surface::{Surface, Variant, ViewSurfaces},
    },
    Buffer, SmoothPipeline,
    pipeline::layout,
};
use crate::settings::Smoothing;

/// Name of the pass's time span.
const AVERAGE_SPAN: &str = "fluid_average_normals";

#[derive(Resource)]
pub(in super::super) struct AveragePipeline {
    frame: FrameLayout,
    splats: SplatLayouts,
    window: BindGroupLayoutDescriptor,
    normals: BindGroupLayoutDescriptor,
    shader: Handle<Shader>,
}

/// The normals before they are averaged.
#[derive(Default)]
pub(in super::super) struct SplatNormals {
    target: Option<Target>,
    group: Group,
    /// The bulk's layers.
    finished: Group,
}

impl FromWorld for AveragePipeline {
    fn from_world(world: &mut World) -> Self {
        Self {
            frame: world.resource::<FrameLayout>().clone(),
            splats: world.resource::<SplatLayouts>().clone(),
            window: layout(unfiltered()),
            normals: one_texture_layout("fluid_average_normals_layout"),
            shader: load_embedded_asset!(world, "average_normals.wgsl"),
        }
    }
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
    const LABEL: &'static str = AVERAGE_SPAN;
    type Uniform = NoUniform;
    type State = SplatNormals;

    fn keys(&self, variant: &Variant) -> Vec<Option<u32>> {
        let half_taps = half_taps(variant);
        half_taps.map_or(vec![], |half_taps| vec![None, Some(half_taps)])
    }

    fn prepare(
        &self,
        state: &mut SplatNormals,
        surface: &Surface,
        layers: &Layers,
        inputs: &Inputs,
    ) {
        let wanted = surface.drawn.as_ref().and_then(half_taps).is_some();
        let (gpu, label) = (inputs.gpu, AVERAGE_SPAN);
        let (target, size) = (&mut state.target, layers.size());
        ensure(target, wanted, gpu, label, size, NORMAL_FORMAT);
        if !wanted {
            *state = default();
        } else {
            for (group, texture) in [
                (&mut state.group, &state.target),
                (&mut state.finished, &layers.bulk),
            ] {
                let texture = [Input::texture(texture.as_ref())];
                group.prepare(gpu, label, &self.normals, &texture);
            }
        }
    }
}

/// Taps to each side, if normals are averaged.
fn half_taps(variant: &Variant) -> Option<u32> {
    match variant.plan.smoothing {
        Smoothing::NormalAverage(average) if !variant.plan.index_one => Some(average.half_taps),
        _ => None,
    }
}

/// The pass: the bulk's normals of surfaces that average them.
pub(in super::super) fn average_normals(
    view: ViewQuery<&ViewSurfaces>,
    surfaces: Query<(
        &Surface,
        &Frame,
        &Layers,
        &Kept<SmoothPipeline>,
        &Kept<AveragePipeline>,
    )>,
    splats: Splats,
    mut ctx: RenderContext,
) {
    timed(&mut ctx, AVERAGE_SPAN, |ctx| {
        let surfaces = surfaces.iter_many(&view.into_inner().surfaces);
        for (surface, frame, layers, smooth, kept) in surfaces {
            let SplatNormals {
                target: normals,
                group,
                finished,
            } = &kept.state;
            let ([(_, draw), (_, average)], Some(finished)) =
                (kept.pipelines(surface), finished.get())
            else {
                continue;
            };
            let pass = SplatPass::normals(finished, normals, *draw);
            splats.record(ctx, (surface, frame), pass, &[Class::Bulk]);
            let (Some(pipeline), Some(window), Some(group), Some(target)) = (
                splats.cache.get_render_pipeline(*average),
                smooth.state.group(Buffer::Layers).get(),
                group.get(),
                &layers.bulk_normals,
            ) else {
                continue;
            };
            let targets = [cleared(target, [0.0; 4])];
            let mut pass = frame.begin(ctx, AVERAGE_SPAN, &targets, None, pipeline);
            pass.set_bind_group(1, window, &[smooth.offset.bytes()]);
            pass.set_bind_group(2, group, &[]);
            frame.draw_tiles(&mut pass);
        }
    });
}
