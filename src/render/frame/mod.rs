//! What all stages share below them: the screen as shaders know it, textures, bind groups,
//! pipelines, and passes over the tiles that hold liquid.

mod groups;
mod layers;
mod pass;
pub(crate) mod pipelines;
pub(crate) mod splats;
mod stage;
pub(crate) mod support;
mod targets;
pub(crate) mod tiles;
mod uniforms;

use bevy::{
    asset::{embedded_asset, load_embedded_asset},
    core_pipeline::prepass::ViewPrepassTextures,
    prelude::*,
    render::{
        GpuResourceAppExt, Render, RenderApp, RenderStartup, RenderSystems,
        render_resource::{
            AddressMode, BindGroupLayoutDescriptor, BindGroupLayoutEntries, FilterMode, Sampler,
            SamplerDescriptor, ShaderStages, ShaderType, TextureFormat,
            binding_types::uniform_buffer,
        },
        renderer::RenderDevice,
        view::{ViewUniform, ViewUniformOffset, ViewUniforms},
    },
    shader::load_shader_library,
};

pub(crate) use self::{
    groups::{Gpu, Group, Input},
    layers::{
        COVERAGE_FORMAT, EXIT_FORMAT, LIGHT_FORMAT, NORMAL_FORMAT, RADIANCE_FORMAT,
        TRANSMISSION_FORMAT,
    },
    pass::{Frame, cleared},
    stage::{Inputs, Kept, NoUniform, Stage, add_stage, timed},
    targets::{Placeholder, Target, ensure},
    uniforms::{Offset, UniformArray},
};
pub use self::{layers::Layers, targets::TextureMemory};
use super::surface::{GpuSurface, Surface, SurfaceSystems, ViewSurfaces};

/// The Rust twin of `FluidFrame` in `frame.wgsl`.
#[derive(Clone, Copy, Default, PartialEq, ShaderType)]
pub(crate) struct GpuFrame {
    view_size: Vec2,
    view_origin: Vec2,
    size: IVec2,
    origin: IVec2,
    scene_origin: IVec2,
    multisampled: u32,
}

/// (nearest, farthest) of a pixel's samples, in device depth.
pub(crate) const SCENE_DEPTH_FORMAT: TextureFormat = TextureFormat::Rg32Float;

/// The opaque scene's depth in a multisampled view, resolved, or in a view without a prepass, where
/// it is new and thus empty. Others are read as they are.
#[derive(Component, Default)]
pub(crate) struct SceneDepth {
    pub(crate) resolved: Option<Target>,
    is_known: bool,
}

/// The layout of group 0, and the sampler of all that is filtered.
#[derive(Resource, Clone)]
pub(crate) struct FrameLayout {
    pub(crate) layout: BindGroupLayoutDescriptor,
    /// Linear filtering, clamped at the border.
    pub(crate) linear: Sampler,
    /// The vertex stage of passes over tiles.
    pub(crate) tiles: Handle<Shader>,
}

pub(crate) fn plugin(app: &mut App, blending: support::LayerBlending) {
    load_shader_library!(app, "frame.wgsl");
    load_shader_library!(app, "functions.wgsl");
    load_shader_library!(app, "straight.wgsl");
    load_shader_library!(app, "slopes.wgsl");
    load_shader_library!(app, "ellipsoid.wgsl");
    embedded_asset!(app, "tiles.wgsl");
    embedded_asset!(app, "splat_normals.wgsl");
    let memory = TextureMemory::default();
    app.insert_resource(memory.clone());
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .insert_resource(memory)
        .insert_resource(support::WantedBlending(blending))
        .init_gpu_resource::<UniformArray<GpuFrame>>()
        .init_gpu_resource::<UniformArray<GpuSurface>>()
        .add_systems(
            RenderStartup,
            (
                support::init_support,
                init_layout,
                targets::init_placeholder,
            )
                .in_set(FrameStartup),
        )
        .add_systems(
            Render,
            (
                (layers::prepare_layers, prepare_frames)
                    .chain()
                    .in_set(SurfaceSystems::Resources),
                prepare_groups.in_set(RenderSystems::PrepareBindGroups),
            ),
        );
    splats::plugin(render_app);
    render_app
        .world_mut()
        .register_required_components::<Surface, Layers>();
    render_app
        .world_mut()
        .register_required_components::<Surface, Frame>();
    render_app
        .world_mut()
        .register_required_components::<ViewSurfaces, SceneDepth>();
    tiles::plugin(app);
}

/// What stages need when they make their layouts.
#[derive(SystemSet, Clone, Copy, Debug, Hash, PartialEq, Eq)]
pub(crate) struct FrameStartup;

fn init_layout(mut commands: Commands, assets: Res<AssetServer>, device: Res<RenderDevice>) {
    commands.insert_resource(FrameLayout {
        layout: BindGroupLayoutDescriptor::new(
            "fluid_frame_layout",
            &BindGroupLayoutEntries::sequential(
                ShaderStages::VERTEX_FRAGMENT | ShaderStages::COMPUTE,
                (
                    uniform_buffer::<ViewUniform>(true),
                    uniform_buffer::<GpuFrame>(true),
                    uniform_buffer::<GpuSurface>(true),
                    pipelines::unfiltered(),
                    pipelines::unfiltered(),
                ),
            ),
        ),
        linear: device.create_sampler(&SamplerDescriptor {
            label: Some("fluid_sampler"),
            address_mode_u: AddressMode::ClampToEdge,
            address_mode_v: AddressMode::ClampToEdge,
            mag_filter: FilterMode::Linear,
            min_filter: FilterMode::Linear,
            ..default()
        }),
        tiles: load_embedded_asset!(assets.as_ref(), "tiles.wgsl"),
    });
}

/// Writes what shaders know of the screen and of each surface.
fn prepare_frames(
    mut views: Query<(&ViewSurfaces, &ViewUniformOffset, &mut SceneDepth)>,
    mut surfaces: Query<(&Surface, &Layers, &mut Frame)>,
    mut frames: ResMut<UniformArray<GpuFrame>>,
    mut uniforms: ResMut<UniformArray<GpuSurface>>,
    gpu: Gpu,
) {
    frames.clear();
    uniforms.clear();
    for (view, view_offset, mut scene_depth) in &mut views {
        let resolves = view.resolves_depth();
        let own = resolves || !view.scene_depth;
        if scene_depth.is_known != view.scene_depth {
            *scene_depth = SceneDepth {
                resolved: None,
                is_known: view.scene_depth,
            };
        }
        let size = view.viewport.size();
        ensure(
            &mut scene_depth.resolved,
            own,
            &gpu,
            "fluid_scene_depth",
            size,
            SCENE_DEPTH_FORMAT,
        );
        let view_origin = view.viewport.min;
        for &surface in &view.surfaces {
            let Ok((surface, layers, mut frame)) = surfaces.get_mut(surface) else {
                continue;
            };
            let of_frame = frames.push(GpuFrame {
                view_size: size.as_vec2(),
                view_origin: view_origin.as_vec2(),
                size: layers.size().as_ivec2(),
                origin: layers.origin(),
                scene_origin: if own {
                    IVec2::ZERO
                } else {
                    view_origin.as_ivec2()
                },
                multisampled: u32::from(resolves),
            });
            let of_surface = uniforms.push(surface.uniform);
            frame.place(
                [view_offset.offset, of_frame.bytes(), of_surface.bytes()],
                surface,
                layers,
                view,
            );
        }
    }
    frames.write(&gpu);
    uniforms.write(&gpu);
}

fn prepare_groups(
    views: Query<(&ViewSurfaces, Option<&ViewPrepassTextures>, &SceneDepth)>,
    mut surfaces: Query<(&mut Frame, &Layers)>,
    layout: Res<FrameLayout>,
    view_uniforms: Res<ViewUniforms>,
    frames: Res<UniformArray<GpuFrame>>,
    uniforms: Res<UniformArray<GpuSurface>>,
    gpu: Gpu,
) {
    for (view, prepass, scene_depth) in &views {
        let resolved = scene_depth.resolved.as_ref().map(|it| &it.view);
        let Some(scene_depth) = resolved.or(prepass.and_then(|prepass| prepass.depth_view()))
        else {
            continue;
        };
        for &surface in &view.surfaces {
            let Ok((mut frame, layers)) = surfaces.get_mut(surface) else {
                continue;
            };
            frame.group.prepare(
                &gpu,
                "fluid_frame",
                &layout.layout,
                &[
                    Input::dynamic(&view_uniforms.uniforms),
                    frames.input(),
                    uniforms.input(),
                    Input::view(scene_depth),
                    Input::texture(layers.tiles()),
                ],
            );
        }
    }
}
