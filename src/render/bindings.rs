//! Bindings shared by every pass of a body: view, body and the scene's depth. See `bindings.wgsl`.

use bevy::{
    prelude::*,
    render::{
        render_resource::{
            BindGroupLayoutDescriptor, BindGroupLayoutEntries, BlendComponent, BlendFactor,
            BlendOperation, BlendState, ColorTargetState, ColorWrites, FragmentState, LoadOp,
            Operations, RenderPassColorAttachment, ShaderStages, StoreOp, TextureFormat,
            TextureSampleType, TextureView,
            binding_types::{texture_2d, uniform_buffer},
        },
        view::ViewUniform,
    },
    shader::ShaderDefVal,
};

use super::gpu_types::GpuBody;

/// The layout of group 0.
pub(crate) fn common_layout() -> BindGroupLayoutDescriptor {
    BindGroupLayoutDescriptor::new(
        "fluid_common_layout",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::VERTEX_FRAGMENT,
            (
                uniform_buffer::<ViewUniform>(true),
                uniform_buffer::<GpuBody>(true),
                texture_2d(TextureSampleType::Float { filterable: false }),
            ),
        ),
    )
}

/// The layout of a pass that reads one texture of 32-bit floats.
pub(crate) fn one_texture_layout(label: &'static str) -> BindGroupLayoutDescriptor {
    BindGroupLayoutDescriptor::new(
        label,
        &BindGroupLayoutEntries::single(
            ShaderStages::FRAGMENT,
            texture_2d(TextureSampleType::Float { filterable: false }),
        ),
    )
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

/// Keeps the larger of the old and the new value.
pub(crate) const MAX_BLEND: BlendState = {
    let max = BlendComponent {
        src_factor: BlendFactor::One,
        dst_factor: BlendFactor::One,
        operation: BlendOperation::Max,
    };
    BlendState {
        color: max,
        alpha: max,
    }
};

/// Keeps the sum of the old and the new value.
pub(crate) const SUM_BLEND: BlendState = {
    let sum = BlendComponent {
        src_factor: BlendFactor::One,
        dst_factor: BlendFactor::One,
        operation: BlendOperation::Add,
    };
    BlendState {
        color: sum,
        alpha: sum,
    }
};

/// The layer value for "nothing": `NO_FRONT`, `NO_BACK` of `types.wgsl`.
pub(crate) const NO_LAYERS: [f32; 4] = [0.0, -2.0, 0.0, 0.0];

/// An attachment that is cleared first.
pub(crate) fn cleared(view: &TextureView, [r, g, b, a]: [f32; 4]) -> RenderPassColorAttachment<'_> {
    RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: Operations {
            load: LoadOp::Clear(LinearRgba::new(r, g, b, a).into()),
            store: StoreOp::Store,
        },
    }
}
