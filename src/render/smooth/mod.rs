//! Smoothing of the bulk's layers, which removes the bumps of single particles.

use bevy::{
    asset::load_embedded_asset,
    core_pipeline::FullscreenShader,
    prelude::*,
    render::{
        diagnostic::RecordDiagnostics,
        render_resource::{
            BindGroup, BindGroupEntries, BindGroupLayoutDescriptor, CachedRenderPipelineId,
            PipelineCache, RenderPassDescriptor, RenderPipelineDescriptor,
            SpecializedRenderPipeline, SpecializedRenderPipelines, TextureView, VertexState,
        },
        renderer::{RenderContext, RenderDevice, ViewQuery},
    },
    shader::{Shader, ShaderDefVal},
};

use super::{
    bindings::{NO_LAYERS, cleared, common_layout, defs, fragment, one_texture_layout},
    bodies::ViewBodies,
    layers::{Layers, NORMAL_FORMAT, SLOPE_FORMAT},
    support::LAYER_FORMAT,
};
use crate::settings::{PlaneFitForm, Smoothing, Window};

/// What one smoothing pass computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum SmoothKernel {
    TotalLeastSquares,
    DeviceDepth,
    Rows,
    Columns,
    Bilateral,
    NarrowRows,
    NarrowColumns,
    CurvatureFlow,
}

/// Where a pass writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum SmoothTarget {
    Layers,
    /// Layers and their slope along x.
    Slopes,
    /// Layers and normals.
    Normals,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct SmoothKey {
    pub(crate) kernel: SmoothKernel,
    pub(crate) target: SmoothTarget,
    pub(crate) half_taps: u32,
}

#[derive(Resource)]
pub(crate) struct SmoothPipeline {
    fullscreen: VertexState,
    layout: BindGroupLayoutDescriptor,
    plane_fit: Handle<Shader>,
    plane_fit_tls: Handle<Shader>,
    bilateral: Handle<Shader>,
    narrow_range: Handle<Shader>,
    curvature_flow: Handle<Shader>,
}

pub(crate) fn init_smooth_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    fullscreen: Res<FullscreenShader>,
) {
    commands.insert_resource(SmoothPipeline {
        fullscreen: fullscreen.to_vertex_state(),
        layout: one_texture_layout("fluid_smooth_layout"),
        plane_fit: load_embedded_asset!(assets.as_ref(), "plane_fit.wgsl"),
        plane_fit_tls: load_embedded_asset!(assets.as_ref(), "plane_fit_tls.wgsl"),
        bilateral: load_embedded_asset!(assets.as_ref(), "bilateral.wgsl"),
        narrow_range: load_embedded_asset!(assets.as_ref(), "narrow_range.wgsl"),
        curvature_flow: load_embedded_asset!(assets.as_ref(), "curvature_flow.wgsl"),
    });
}

impl SpecializedRenderPipeline for SmoothPipeline {
    type Key = SmoothKey;

    fn specialize(&self, key: SmoothKey) -> RenderPipelineDescriptor {
        let mut shader_defs = defs([
            ("NORMALS", key.target == SmoothTarget::Normals),
            ("WHOLE_WINDOW", key.kernel == SmoothKernel::DeviceDepth),
        ]);
        shader_defs.push(ShaderDefVal::Int("HALF_TAPS".into(), key.half_taps as i32));
        let line = match key.kernel {
            SmoothKernel::Rows | SmoothKernel::NarrowRows => Some(0),
            SmoothKernel::Columns | SmoothKernel::NarrowColumns => Some(1),
            _ => None,
        };
        shader_defs.extend(line.map(|line| ShaderDefVal::Int("LINE".into(), line)));
        let shader = match key.kernel {
            SmoothKernel::TotalLeastSquares => &self.plane_fit_tls,
            SmoothKernel::Bilateral => &self.bilateral,
            SmoothKernel::NarrowRows | SmoothKernel::NarrowColumns => &self.narrow_range,
            SmoothKernel::CurvatureFlow => &self.curvature_flow,
            SmoothKernel::DeviceDepth | SmoothKernel::Rows | SmoothKernel::Columns => {
                &self.plane_fit
            }
        };
        let formats: &[_] = match key.target {
            SmoothTarget::Layers => &[LAYER_FORMAT],
            SmoothTarget::Slopes => &[SLOPE_FORMAT],
            SmoothTarget::Normals => &[LAYER_FORMAT, NORMAL_FORMAT],
        };
        RenderPipelineDescriptor {
            label: Some("fluid_smooth_pipeline".into()),
            layout: vec![common_layout(), self.layout.clone()],
            vertex: self.fullscreen.clone(),
            fragment: Some(fragment(shader, shader_defs, formats, None)),
            ..default()
        }
    }
}

/// A texture that smoothing reads or writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Buffer {
    /// One of the two bulk layers.
    Bulk(usize),
    Slopes,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Step {
    kernel: SmoothKernel,
    target: SmoothTarget,
    from: Buffer,
    to: Buffer,
}

/// The passes of a smoothing, in order.
#[derive(Clone, Debug, Default)]
pub(crate) struct SmoothSteps {
    steps: Vec<Step>,
    half_taps: u32,
}

impl SmoothSteps {
    pub(crate) fn new(smoothing: &Smoothing) -> Self {
        let (kernels, half_taps, iterations, normals): (&[_], _, _, _) = match smoothing {
            // Averaging normals leaves the layers as they are.
            Smoothing::None | Smoothing::NormalAverage(_) => return Self::default(),
            Smoothing::PlaneFit(fit) => (
                match fit.form {
                    PlaneFitForm::TotalLeastSquares => &[SmoothKernel::TotalLeastSquares],
                    PlaneFitForm::DeviceDepth => &[SmoothKernel::DeviceDepth],
                    PlaneFitForm::Separable => &[SmoothKernel::Rows, SmoothKernel::Columns],
                },
                fit.half_taps,
                fit.iterations.clamp(1, 8),
                true,
            ),
            Smoothing::Bilateral(filter) => (
                &[SmoothKernel::Bilateral],
                filter.half_taps,
                filter.iterations.clamp(1, 64),
                false,
            ),
            Smoothing::NarrowRange(filter) => (
                &[SmoothKernel::NarrowRows, SmoothKernel::NarrowColumns],
                filter.half_taps,
                filter.iterations.clamp(1, 8),
                false,
            ),
            Smoothing::CurvatureFlow(flow) => (
                &[SmoothKernel::CurvatureFlow],
                1,
                flow.iterations.clamp(1, 200),
                false,
            ),
        };
        let total = kernels.len() * iterations as usize;
        let mut from = Buffer::Bulk(0);
        let steps = (0..total)
            .map(|i| {
                let kernel = kernels[i % kernels.len()];
                // The last fit passes its slopes to the normals.
                let slopes = kernel == SmoothKernel::Rows && i + 2 == total;
                let to = match from {
                    _ if slopes => Buffer::Slopes,
                    Buffer::Bulk(i) => Buffer::Bulk(1 - i),
                    Buffer::Slopes => Buffer::Bulk(0),
                };
                let target = if slopes {
                    SmoothTarget::Slopes
                } else if normals && i + 1 == total {
                    SmoothTarget::Normals
                } else {
                    SmoothTarget::Layers
                };
                let step = Step {
                    kernel,
                    target,
                    from,
                    to,
                };
                from = to;
                step
            })
            .collect();
        Self {
            steps,
            half_taps: half_taps.clamp(1, 8),
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    pub(crate) fn needs_slopes(&self) -> bool {
        self.steps.iter().any(|step| step.to == Buffer::Slopes)
    }

    /// Which of the two bulk textures ends up with the result.
    pub(crate) fn last_target(&self) -> usize {
        match self.steps.last().map(|step| step.to) {
            Some(Buffer::Bulk(i)) => i,
            _ => 0,
        }
    }

    /// Whether the last pass writes normals too.
    pub(crate) fn yields_normals(&self) -> bool {
        self.steps
            .last()
            .is_some_and(|step| step.target == SmoothTarget::Normals)
    }

    pub(crate) fn pipelines(
        &self,
        cache: &PipelineCache,
        pipelines: &mut SpecializedRenderPipelines<SmoothPipeline>,
        pipeline: &SmoothPipeline,
    ) -> Vec<CachedRenderPipelineId> {
        let key = |step: &Step| SmoothKey {
            kernel: step.kernel,
            target: step.target,
            half_taps: self.half_taps,
        };
        self.steps
            .iter()
            .map(|step| pipelines.specialize(cache, pipeline, key(step)))
            .collect()
    }

    /// A bind group for each texture that is read; none without steps.
    pub(crate) fn bind_groups(
        &self,
        device: &RenderDevice,
        cache: &PipelineCache,
        pipeline: &SmoothPipeline,
        layers: &Layers,
    ) -> SmoothGroups {
        if self.is_empty() {
            return SmoothGroups::default();
        }
        let layout = cache.get_bind_group_layout(&pipeline.layout);
        let group = |view: &TextureView| {
            device.create_bind_group("fluid_smooth", &layout, &BindGroupEntries::single(view))
        };
        SmoothGroups {
            bulk: layers
                .bulk
                .each_ref()
                .map(|bulk| Some(group(&bulk.default_view))),
            slopes: layers
                .slopes
                .as_ref()
                .map(|slopes| group(&slopes.default_view)),
        }
    }
}

/// The input bind groups of the passes, by texture: many passes read the same texture.
#[derive(Default)]
pub(crate) struct SmoothGroups {
    bulk: [Option<BindGroup>; 2],
    slopes: Option<BindGroup>,
}

impl SmoothGroups {
    fn get(&self, from: Buffer) -> Option<&BindGroup> {
        match from {
            Buffer::Bulk(i) => self.bulk[i].as_ref(),
            Buffer::Slopes => self.slopes.as_ref(),
        }
    }
}

fn texture(layers: &Layers, buffer: Buffer) -> &TextureView {
    match (buffer, &layers.slopes) {
        (Buffer::Slopes, Some(slopes)) => &slopes.default_view,
        (Buffer::Slopes, None) => &layers.bulk[0].default_view,
        (Buffer::Bulk(i), _) => &layers.bulk[i].default_view,
    }
}

/// Half window in radii, for the shaders; 0 means one pixel per tap.
pub(crate) fn window_radii(window: Window) -> f32 {
    match window {
        Window::Radii(radii) if radii.is_finite() => radii.clamp(0.05, 4.0),
        Window::Radii(_) | Window::Pixels => 0.0,
    }
}

/// The pass: the bulk of all bodies.
pub(crate) fn smooth(
    view: ViewQuery<&ViewBodies>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let bodies = view.into_inner();
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let span = recorder.time_span(ctx.command_encoder(), "fluid_smooth");
    for body in bodies.ready() {
        for (step, &pipeline) in body.steps.steps.iter().zip(&body.pipelines.smooth) {
            let (Some(pipeline), Some(group)) = (
                cache.get_render_pipeline(pipeline),
                body.groups.smooth.get(step.from),
            ) else {
                continue;
            };
            let target = cleared(texture(&body.layers, step.to), NO_LAYERS);
            let normals = cleared(&body.layers.bulk_normals.default_view, [0.0; 4]);
            let targets = [Some(target), Some(normals)];
            let with_normals = step.target == SmoothTarget::Normals;
            let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
                label: Some("fluid_smooth"),
                color_attachments: &targets[..if with_normals { 2 } else { 1 }],
                ..default()
            });
            body.set_scissor(&mut pass);
            pass.set_render_pipeline(pipeline);
            body.set_common(&mut pass);
            pass.set_bind_group(1, group, &[]);
            pass.draw(0..3, 0..1);
        }
    }
    span.end(ctx.command_encoder());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{Bilateral, PlaneFit};

    #[test]
    fn steps_chain_and_end_with_normals_where_the_fit_yields_them() {
        let forms = [
            (PlaneFitForm::TotalLeastSquares, 3),
            (PlaneFitForm::DeviceDepth, 3),
            (PlaneFitForm::Separable, 6),
        ];
        for (form, count) in forms {
            let steps = SmoothSteps::new(&Smoothing::PlaneFit(PlaneFit {
                form,
                iterations: 3,
                ..PlaneFit::DEFAULT
            }));
            assert_eq!(steps.steps.len(), count);
            assert!(steps.yields_normals());
            assert_eq!(steps.needs_slopes(), form == PlaneFitForm::Separable);
            assert_eq!(steps.steps[0].from, Buffer::Bulk(0));
            for pair in steps.steps.windows(2) {
                assert_eq!(pair[0].to, pair[1].from);
            }
            assert!(steps.steps.iter().all(|step| step.from != step.to));
        }
        let bilateral = SmoothSteps::new(&Smoothing::Bilateral(Bilateral::THESIS));
        assert_eq!(bilateral.steps.len(), 22);
        assert!(!bilateral.yields_normals());
        assert!(SmoothSteps::new(&Smoothing::None).is_empty());
    }
}
