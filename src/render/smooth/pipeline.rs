//! Pipelines and parameters of smoothing passes.

use bevy::{
    asset::{embedded_asset, load_embedded_asset},
    prelude::*,
    render::render_resource::{
        BindGroupLayoutDescriptor, BindGroupLayoutEntries, BindGroupLayoutEntryBuilder,
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
            EXIT_FORMAT, FrameLayout, Input, Inputs, Layers, NORMAL_FORMAT, Stage,
            pipelines::{Tiles, defs, fragment, tile_pipeline, unfiltered},
            support::LAYER_FORMAT,
        },
        surface::{Surface, Variant},
    },
    SPAN, Smooth,
    steps::{Buffer, SmoothKernel, Step, radii, steps},
};
use crate::settings::Smoothing;

/// `Smoothing` in `window.wgsl`.
#[derive(Clone, Copy, Default, PartialEq, ShaderType)]
pub(crate) struct GpuSmoothing {
    window_radii: f32,
    min_half_width: f32,
    range: f32,
    bound: f32,
    flow_step: f32,
}

/// Half of the smallest window. Unit: pixels.
const MIN_HALF_WIDTH: f32 = 3.0;
/// The same of repeated plane fits together, whose taps fade towards the border.
const MIN_FADING: f32 = 4.0;

impl GpuSmoothing {
    /// For particles of `radius` in view units.
    pub(super) fn new(smoothing: &Smoothing, radius: f32) -> Self {
        let (window_radii, range, bound, flow_step) = match *smoothing {
            Smoothing::None => (0.0, 1.0, 0.0, 0.0),
            Smoothing::PlaneFit(fit) => (radii(fit.window), fit.range, fit.bound, 0.0),
            #[cfg(feature = "published")]
            _ => super::published::parameters(smoothing),
        };
        let min_half_width = match *smoothing {
            // Variances of windows add up.
            Smoothing::PlaneFit(fit) => MIN_FADING / (fit.iterations as f32).sqrt(),
            _ => MIN_HALF_WIDTH,
        };
        Self {
            window_radii,
            min_half_width,
            range: range * radius,
            bound: bound * radius,
            flow_step,
        }
    }
}

#[derive(Resource)]
pub(crate) struct SmoothPipeline {
    frame: FrameLayout,
    layout: BindGroupLayoutDescriptor,
    /// For a pass that reads [`Buffer::Slopes`].
    slopes_layout: BindGroupLayoutDescriptor,
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

/// Of a pass that reads one texture and the parameters.
pub(super) fn layout(texture: BindGroupLayoutEntryBuilder) -> BindGroupLayoutDescriptor {
    let entries = (texture, uniform_buffer::<GpuSmoothing>(true));
    let entries = BindGroupLayoutEntries::sequential(ShaderStages::FRAGMENT, entries);
    BindGroupLayoutDescriptor::new("fluid_smooth_layout", &entries)
}

impl FromWorld for SmoothPipeline {
    fn from_world(world: &mut World) -> Self {
        Self {
            frame: world.resource::<FrameLayout>().clone(),
            layout: layout(unfiltered()),
            slopes_layout: layout(texture_2d(TextureSampleType::Uint)),
            plane_fit: load_embedded_asset!(world, "plane_fit.wgsl"),
            plane_fit_tls: load_embedded_asset!(world, "plane_fit_tls.wgsl"),
            #[cfg(feature = "published")]
            published: PublishedShaders::load(world),
        }
    }
}

impl SpecializedRenderPipeline for SmoothPipeline {
    type Key = Step;

    fn specialize(&self, step: Step) -> RenderPipelineDescriptor {
        let mut shader_defs = defs([
            ("NORMALS", step.normals),
            ("FROM_SLOPES", step.from == Buffer::Slopes),
            ("TO_SLOPES", step.to == Buffer::Slopes),
            ("WIDE", step.wide),
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
    const LABEL: &'static str = SPAN;
    type Uniform = GpuSmoothing;
    type State = Smooth;

    fn keys(&self, variant: &Variant) -> Vec<Step> {
        let mut steps = steps(&variant.plan.smoothing);
        for step in &mut steps {
            step.normals &= !variant.plan.index_one;
            // No slope is needed.
            step.wide &= !variant.plan.index_one;
        }
        steps
    }

    fn uniform(surface: &Surface) -> Option<GpuSmoothing> {
        let smoothing = &surface.plan()?.smoothing;
        Some(GpuSmoothing::new(smoothing, surface.uniform.radius))
    }

    fn prepare(&self, groups: &mut Smooth, _: &Surface, layers: &Layers, inputs: &Inputs) {
        for (group, texture, layout) in [
            (&mut groups.layers, &layers.bulk, &self.layout),
            (&mut groups.scratch, &layers.scratch, &self.layout),
            (&mut groups.slopes, &layers.exits, &self.slopes_layout),
        ] {
            let read = [Input::texture(texture.as_ref()), inputs.uniform.clone()];
            group.prepare(inputs.gpu, SPAN, layout, &read);
        }
    }
}
