//! What the descriptors of pipelines have in common.

use bevy::{
    core_pipeline::core_3d::CORE_3D_DEPTH_FORMAT,
    prelude::*,
    render::render_resource::{
        BindGroupLayoutDescriptor, BindGroupLayoutEntries, BlendComponent, BlendFactor,
        BlendOperation, BlendState, ColorTargetState, ColorWrites, CompareFunction,
        DepthStencilState, FragmentState, FrontFace, PolygonMode, PrimitiveState,
        PrimitiveTopology, RenderPipelineDescriptor, ShaderStages, TextureFormat,
        TextureSampleType, VertexState, binding_types::texture_2d,
    },
    shader::ShaderDefVal,
};

use super::FrameLayout;

/// The tiles that a pass covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Tiles {
    /// Those with bulk.
    Bulk,
    /// Those with liquid.
    Liquid,
    /// Those with liquid, in the camera's target.
    LiquidInCamera,
    /// Every one, in the camera's target.
    AllInCamera,
}

/// A pass over tiles: `layouts` are those of groups 1 and up.
pub(crate) fn tile_pipeline(
    label: &'static str,
    frame: &FrameLayout,
    layouts: impl IntoIterator<Item = BindGroupLayoutDescriptor>,
    tiles: Tiles,
    fragment: FragmentState,
) -> RenderPipelineDescriptor {
    let mut shader_defs = defs([
        ("BULK_TILES", tiles == Tiles::Bulk),
        ("ALL_TILES", tiles == Tiles::AllInCamera),
        (
            "TO_CAMERA",
            matches!(tiles, Tiles::LiquidInCamera | Tiles::AllInCamera),
        ),
    ]);
    shader_defs.push(tile_size());
    RenderPipelineDescriptor {
        label: Some(label.into()),
        layout: [frame.layout.clone()].into_iter().chain(layouts).collect(),
        vertex: VertexState {
            shader: frame.tiles.clone(),
            shader_defs,
            entry_point: Some("vertex".into()),
            buffers: vec![],
        },
        primitive: QUAD,
        fragment: Some(fragment),
        ..default()
    }
}

/// The state for a depth attachment of [`CORE_3D_DEPTH_FORMAT`], such as the camera's.
pub(crate) fn depth_state(write: bool, compare: CompareFunction) -> Option<DepthStencilState> {
    Some(DepthStencilState {
        format: CORE_3D_DEPTH_FORMAT,
        depth_write_enabled: Some(write),
        depth_compare: Some(compare),
        stencil: default(),
        bias: default(),
    })
}

/// Quads of four corners, one instance per splat or tile.
pub(crate) const QUAD: PrimitiveState = PrimitiveState {
    topology: PrimitiveTopology::TriangleStrip,
    strip_index_format: None,
    front_face: FrontFace::Ccw,
    cull_mode: None,
    unclipped_depth: false,
    polygon_mode: PolygonMode::Fill,
    conservative: false,
};

/// The entry of a texture of 32-bit floats.
pub(crate) fn unfiltered() -> bevy::render::render_resource::BindGroupLayoutEntryBuilder {
    texture_2d(TextureSampleType::Float { filterable: false })
}

/// The layout of a pass that reads one texture of 32-bit floats.
pub(crate) fn one_texture_layout(label: &'static str) -> BindGroupLayoutDescriptor {
    BindGroupLayoutDescriptor::new(
        label,
        &BindGroupLayoutEntries::single(ShaderStages::FRAGMENT, unfiltered()),
    )
}

/// Edge of a tile. Unit: pixels.
pub(super) const TILE: u32 = 16;

/// The same for shaders.
pub(crate) fn tile_size() -> ShaderDefVal {
    ShaderDefVal::Int("TILE".into(), TILE as i32)
}

/// Names a shader variant's conditions.
pub(crate) fn defs<'a>(names: impl IntoIterator<Item = (&'a str, bool)>) -> Vec<ShaderDefVal> {
    names
        .into_iter()
        .filter(|(_, on)| *on)
        .map(|(name, _)| name.into())
        .collect()
}

/// A fragment stage with an entry point named `fragment`.
pub(crate) fn fragment(
    shader: &Handle<Shader>,
    shader_defs: Vec<ShaderDefVal>,
    formats: &[TextureFormat],
    blend: Option<BlendState>,
) -> FragmentState {
    FragmentState {
        shader: shader.clone(),
        shader_defs,
        entry_point: Some("fragment".into()),
        targets: formats
            .iter()
            .map(|&format| {
                Some(ColorTargetState {
                    format,
                    blend,
                    write_mask: ColorWrites::ALL,
                })
            })
            .collect(),
    }
}

const fn both(operation: BlendOperation) -> BlendState {
    let component = BlendComponent {
        src_factor: BlendFactor::One,
        dst_factor: BlendFactor::One,
        operation,
    };
    BlendState {
        color: component,
        alpha: component,
    }
}

/// Keeps the larger of the old and the new value.
pub(crate) const MAX_BLEND: BlendState = both(BlendOperation::Max);

/// Keeps the sum of the old and the new value.
pub(crate) const SUM_BLEND: BlendState = both(BlendOperation::Add);

/// The layer value for "nothing": `NO_FRONT`, `NO_BACK` of `types.wgsl`.
pub(crate) const NO_LAYERS: [f32; 4] = [0.0, -2.0, 0.0, 0.0];
