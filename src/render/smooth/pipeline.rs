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

#[cfg(feature = "published")]
use super::published::PublishedShaders;
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

impl GpuSmoothing {
    /// For particles of `radius` in view units.
    pub(super) fn new(smoothing: &Smoothing, radius: f32) -> Self {
        let (window_radii, range, bound, flow_step) = match *smoothing {
            Smoothing::None => (0.0, 1.0, 0.0, 0.0),
            Smoothing::PlaneFit(fit) => (radii(fit.window), fit.range, fit.bound, 0.0),
            #[cfg(feature = "published")]
            _ => super::published::parameters(smoothing),
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
pub(super) fn radii(window: Window) -> f32 {
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
    #[cfg(feature = "published")]
    published: PublishedShaders,
}

pub(super) fn load_shaders(app: &mut App) {
    load_shader_library!(app, "window.wgsl");
    embedded_asset!(app, "plane_fit.wgsl");
    embedded_asset!(app, "plane_fit_tls.wgsl");
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
        #[cfg(feature = "published")]
        published: PublishedShaders::load(&assets),
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
            SmoothKernel::Rows => Some(0),
            SmoothKernel::Columns => Some(1),
            #[cfg(feature = "published")]
            SmoothKernel::NarrowRows => Some(0),
            #[cfg(feature = "published")]
            SmoothKernel::NarrowColumns => Some(1),
            _ => None,
        };
        shader_defs.extend(line.map(|line| ShaderDefVal::Int("LINE".into(), line)));
        let shader = match step.kernel {
            SmoothKernel::TotalLeastSquares => &self.plane_fit_tls,
            SmoothKernel::DeviceDepth | SmoothKernel::Rows | SmoothKernel::Columns => {
                &self.plane_fit
            }
            #[cfg(feature = "published")]
            _ => self.published.of(step.kernel),
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
