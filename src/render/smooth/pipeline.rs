//! Pipelines and parameters of smoothing passes.

use bevy::{
    asset::{embedded_asset, load_embedded_asset},
    prelude::*,
    render::render_resource::{
        BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedRenderPipelineId,
        RenderPipelineDescriptor, ShaderStages, ShaderType, SpecializedRenderPipeline,
        TextureSampleType,
        binding_types::{texture_2d, uniform_buffer},
    },
    shader::{ShaderDefVal, load_shader_library},
};

use super::{
    super::{
        frame::{
            EXIT_FORMAT, FrameLayout, NORMAL_FORMAT, Stage,
            pipelines::{Tiles, defs, fragment, tile_pipeline, unfiltered},
            support::LAYER_FORMAT,
        },
        surface::Variant,
    },
    steps::{Buffer, SmoothKernel, Step, steps},
};
use crate::settings::{Smoothing, Window};

/// `Smoothing` in `window.wgsl`.
#[derive(Clone, Copy, Default, PartialEq, ShaderType)]
pub(crate) struct GpuSmoothing {
    window_radii: f32,
    range: f32,
    bound: f32,
    flow_step: f32,
}

/// For methods without a bound. Unit: particle radii.
const UNBOUND: f32 = 1e6;

impl GpuSmoothing {
    /// For particles of `radius` in view units.
    pub(super) fn new(smoothing: &Smoothing, radius: f32) -> Self {
        let mut flow_step = 0.0;
        let (window_radii, range, bound) = match *smoothing {
            Smoothing::None => (0.0, 1.0, UNBOUND),
            Smoothing::PlaneFit(fit) => (radii(fit.window), fit.range, fit.bound),
            // exp(−Δ² / 2σ²) is exp(−(Δ / √2σ)²).
            Smoothing::Bilateral(filter) => (
                radii(filter.window),
                filter.range * core::f32::consts::SQRT_2,
                UNBOUND,
            ),
            Smoothing::NormalAverage(average) => (radii(average.window), 1.0, UNBOUND),
            Smoothing::NarrowRange(filter) => (radii(filter.window), filter.range, UNBOUND),
            Smoothing::CurvatureFlow(flow) => {
                flow_step = flow.step;
                (0.0, flow.range, UNBOUND)
            }
        };
        Self {
            window_radii,
            range: range * radius,
            bound: bound * radius,
            flow_step,
        }
    }
}

/// Half window in radii; 0 means one pixel per tap.
fn radii(window: Window) -> f32 {
    match window {
        Window::Radii(radii) => radii,
        Window::Pixels => 0.0,
    }
}

#[derive(Resource)]
pub(crate) struct SmoothPipeline {
    pub(super) frame: FrameLayout,
    pub(super) layout: BindGroupLayoutDescriptor,
    /// For a pass that reads [`Buffer::Slopes`].
    pub(super) slopes_layout: BindGroupLayoutDescriptor,
    plane_fit: Handle<Shader>,
    plane_fit_tls: Handle<Shader>,
    bilateral: Handle<Shader>,
    narrow_range: Handle<Shader>,
    curvature_flow: Handle<Shader>,
}

pub(super) fn load_shaders(app: &mut App) {
    load_shader_library!(app, "window.wgsl");
    embedded_asset!(app, "plane_fit.wgsl");
    embedded_asset!(app, "plane_fit_tls.wgsl");
    embedded_asset!(app, "bilateral.wgsl");
    embedded_asset!(app, "narrow_range.wgsl");
    embedded_asset!(app, "curvature_flow.wgsl");
    embedded_asset!(app, "average_normals.wgsl");
}

pub(super) fn init_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    frame: Res<FrameLayout>,
) {
    let layout = |label, texture| {
        let entries = (texture, uniform_buffer::<GpuSmoothing>(true));
        let entries = BindGroupLayoutEntries::sequential(ShaderStages::FRAGMENT, entries);
        BindGroupLayoutDescriptor::new(label, &entries)
    };
    let slopes = texture_2d(TextureSampleType::Uint);
    commands.insert_resource(SmoothPipeline {
        frame: frame.clone(),
        layout: layout("fluid_smooth_layout", unfiltered()),
        slopes_layout: layout("fluid_slopes_layout", slopes),
        plane_fit: load_embedded_asset!(assets.as_ref(), "plane_fit.wgsl"),
        plane_fit_tls: load_embedded_asset!(assets.as_ref(), "plane_fit_tls.wgsl"),
        bilateral: load_embedded_asset!(assets.as_ref(), "bilateral.wgsl"),
        narrow_range: load_embedded_asset!(assets.as_ref(), "narrow_range.wgsl"),
        curvature_flow: load_embedded_asset!(assets.as_ref(), "curvature_flow.wgsl"),
    });
}

impl SpecializedRenderPipeline for SmoothPipeline {
    type Key = Step;

    fn specialize(&self, step: Step) -> RenderPipelineDescriptor {
        let mut shader_defs = defs([
            ("NORMALS", step.normals),
            ("FROM_SLOPES", step.from == Buffer::Slopes),
            ("TO_SLOPES", step.to == Buffer::Slopes),
            ("WHOLE_WINDOW", step.kernel == SmoothKernel::DeviceDepth),
        ]);
        shader_defs.push(ShaderDefVal::Int("HALF_TAPS".into(), step.half_taps as i32));
        let line = match step.kernel {
            SmoothKernel::Rows | SmoothKernel::NarrowRows => Some(0),
            SmoothKernel::Columns | SmoothKernel::NarrowColumns => Some(1),
            _ => None,
        };
        shader_defs.extend(line.map(|line| ShaderDefVal::Int("LINE".into(), line)));
        let shader = match step.kernel {
            SmoothKernel::TotalLeastSquares => &self.plane_fit_tls,
            SmoothKernel::Bilateral => &self.bilateral,
            SmoothKernel::NarrowRows | SmoothKernel::NarrowColumns => &self.narrow_range,
            SmoothKernel::CurvatureFlow => &self.curvature_flow,
            SmoothKernel::DeviceDepth | SmoothKernel::Rows | SmoothKernel::Columns => {
                &self.plane_fit
            }
        };
        let formats: &[_] = match (step.to, step.normals) {
            (Buffer::Slopes, _) => &[EXIT_FORMAT],
            (_, false) => &[LAYER_FORMAT],
            (_, true) => &[LAYER_FORMAT, NORMAL_FORMAT],
        };
        let layout = if step.from == Buffer::Slopes {
            &self.slopes_layout
        } else {
            &self.layout
        };
        tile_pipeline(
            "fluid_smooth_pipeline",
            &self.frame,
            [layout.clone()],
            Tiles::Bulk,
            fragment(shader, shader_defs, formats, None),
        )
    }
}

impl Stage for SmoothPipeline {
    type Pipelines = Vec<(Step, CachedRenderPipelineId)>;

    fn pipelines(
        &self,
        variant: &Variant,
        mut request: impl FnMut(Step) -> CachedRenderPipelineId,
    ) -> Self::Pipelines {
        let steps = steps(&variant.plan.smoothing).into_iter();
        steps.map(|step| (step, request(step))).collect()
    }

    fn ids(pipelines: &Self::Pipelines) -> impl Iterator<Item = CachedRenderPipelineId> {
        pipelines.iter().map(|(_, id)| *id)
    }
}
