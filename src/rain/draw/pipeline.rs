//! The pipelines and their shared layouts.

use bevy::{
    asset::load_embedded_asset,
    core_pipeline::core_3d::CORE_3D_DEPTH_FORMAT,
    mesh::{VertexBufferLayout, VertexFormat},
    prelude::*,
    render::{
        render_resource::{
            BindGroupLayoutDescriptor, BindGroupLayoutEntries, BlendState, ColorTargetState,
            ColorWrites, CompareFunction, DepthStencilState, FragmentState, MultisampleState,
            PrimitiveState, PrimitiveTopology, RenderPipelineDescriptor, SamplerBindingType,
            ShaderStages, SpecializedRenderPipeline, TextureFormat, TextureSampleType, VertexState,
            VertexStepMode,
            binding_types::{
                sampler, texture_2d_array, texture_cube, texture_depth_2d,
                texture_depth_2d_multisampled, uniform_buffer,
            },
        },
        view::ViewUniform,
    },
    shader::{Shader, ShaderDefVal},
};

use super::gpu_types::GpuRain;

/// The parts of rain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum RainPart {
    /// The fading background beyond the streaks.
    Backdrop,
    /// Voxels of streaks.
    Billboards,
    /// Individually drawn drops.
    Drops,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct RainKey {
    pub(crate) part: RainPart,
    pub(crate) format: TextureFormat,
    pub(crate) samples: u32,
    pub(crate) scene: RainScene,
}

/// Which lights and shelters the scene has. Shaders are compiled without the others: a loop over no
/// lamps still costs, on a software renderer as much as all the rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct RainScene {
    pub(crate) suns: bool,
    pub(crate) lamps: bool,
    pub(crate) shelters: bool,
}

impl RainScene {
    pub(crate) const NOTHING: Self = Self {
        suns: false,
        lamps: false,
        shelters: false,
    };
    pub(crate) const ALL: Self = Self {
        suns: true,
        lamps: true,
        shelters: true,
    };
}

#[derive(Resource)]
pub(crate) struct RainPipeline {
    /// Without and with multisampling.
    pub(crate) layouts: [BindGroupLayoutDescriptor; 2],
    backdrop: Handle<Shader>,
    billboards: Handle<Shader>,
    drops: Handle<Shader>,
}

pub(crate) fn init_rain_pipeline(mut commands: Commands, assets: Res<AssetServer>) {
    let layouts = [false, true].map(|multisampled| {
        BindGroupLayoutDescriptor::new(
            "rain_layout",
            &BindGroupLayoutEntries::sequential(
                ShaderStages::VERTEX_FRAGMENT,
                (
                    uniform_buffer::<ViewUniform>(true),
                    uniform_buffer::<GpuRain>(true),
                    if multisampled {
                        texture_depth_2d_multisampled()
                    } else {
                        texture_depth_2d()
                    },
                    texture_cube(TextureSampleType::Float { filterable: true }),
                    sampler(SamplerBindingType::Filtering),
                    texture_2d_array(TextureSampleType::Float { filterable: true }),
                    sampler(SamplerBindingType::Filtering),
                ),
            ),
        )
    });
    commands.insert_resource(RainPipeline {
        layouts,
        backdrop: load_embedded_asset!(assets.as_ref(), "backdrop.wgsl"),
        billboards: load_embedded_asset!(assets.as_ref(), "billboards.wgsl"),
        drops: load_embedded_asset!(assets.as_ref(), "drops.wgsl"),
    });
}

impl SpecializedRenderPipeline for RainPipeline {
    type Key = RainKey;

    fn specialize(&self, key: RainKey) -> RenderPipelineDescriptor {
        let multisampled = key.samples > 1;
        let RainScene {
            suns,
            lamps,
            shelters,
        } = key.scene;
        let shader_defs: Vec<ShaderDefVal> = [
            (multisampled, "MULTISAMPLED"),
            (suns, "SUNS"),
            (lamps, "LAMPS"),
            (shelters, "SHELTERS"),
            // The position of a drop on its ray matters.
            (lamps || shelters, "LAMPS_OR_SHELTERS"),
        ]
        .into_iter()
        .filter(|(is_there, _)| *is_there)
        .map(|(_, name)| name.into())
        .collect();
        let (label, shader, topology) = match key.part {
            RainPart::Backdrop => (
                "rain_backdrop",
                &self.backdrop,
                PrimitiveTopology::TriangleList,
            ),
            RainPart::Billboards => (
                "rain_billboards",
                &self.billboards,
                PrimitiveTopology::TriangleStrip,
            ),
            RainPart::Drops => ("rain_drops", &self.drops, PrimitiveTopology::TriangleList),
        };
        let buffers = match key.part {
            RainPart::Backdrop => vec![],
            RainPart::Billboards | RainPart::Drops => vec![quad_layout()],
        };
        RenderPipelineDescriptor {
            label: Some(label.into()),
            layout: vec![self.layouts[usize::from(multisampled)].clone()],
            vertex: VertexState {
                shader: shader.clone(),
                shader_defs: shader_defs.clone(),
                entry_point: Some("vertex".into()),
                buffers,
            },
            primitive: PrimitiveState {
                topology,
                ..default()
            },
            // The shaders test the scene's depth themselves: a voxel may reach in front of it.
            depth_stencil: Some(DepthStencilState {
                format: CORE_3D_DEPTH_FORMAT,
                depth_write_enabled: Some(false),
                depth_compare: Some(CompareFunction::Always),
                stencil: default(),
                bias: default(),
            }),
            multisample: MultisampleState {
                count: key.samples,
                ..default()
            },
            fragment: Some(FragmentState {
                shader: shader.clone(),
                shader_defs,
                entry_point: Some("fragment".into()),
                targets: vec![Some(ColorTargetState {
                    format: key.format,
                    blend: Some(BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                    write_mask: ColorWrites::ALL,
                })],
            }),
            ..default()
        }
    }
}

/// `GpuQuad`, one an instance.
fn quad_layout() -> VertexBufferLayout {
    VertexBufferLayout::from_vertex_formats(
        VertexStepMode::Instance,
        [
            VertexFormat::Float32x3,
            VertexFormat::Float32,
            VertexFormat::Float32,
            VertexFormat::Float32,
            VertexFormat::Sint32,
            VertexFormat::Uint32,
            VertexFormat::Uint32,
            VertexFormat::Uint32,
            VertexFormat::Uint32x2,
        ],
    )
}
