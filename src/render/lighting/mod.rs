//! The light that falls on the surfaces of a view.

mod aerial;
mod extract;

use bevy::{
    camera::visibility::RenderLayers,
    pbr::{
        DistanceFog, ExtractedDirectionalLight, GpuAtmosphereSettings,
        resources::{AtmosphereTextures, GpuAtmosphere},
    },
    prelude::*,
    render::{
        GpuResourceAppExt, Render, RenderApp, RenderStartup, RenderSystems,
        camera::ExtractedCamera,
        render_asset::RenderAssets,
        render_resource::{
            BindGroup, BindGroupLayoutDescriptor, BindGroupLayoutEntries, SamplerBindingType,
            ShaderStages, ShaderType, TextureSampleType,
            binding_types::{sampler, texture_2d, texture_3d, texture_cube, uniform_buffer},
        },
        texture::{FallbackImage, GpuImage},
        view::ExtractedView,
    },
    shader::load_shader_library,
};

use self::aerial::GpuAerial;
use self::extract::{ViewSurroundings, extract_surroundings};
use super::{
    frame::{FrameLayout, FrameStartup, Gpu, Group, Input, Offset, UniformArray},
    surface::{SurfaceSystems, ViewSurfaces, views::FluidView},
};
use crate::{
    fog::{FogShaderPlugin, GpuFog},
    suns::suns_in_view,
};

/// Directional lights that give highlights: the brightest.
const MAX_LIGHTS: usize = 4;

/// A light that gives highlights: `DirectionalLight` in `optics.wgsl`.
#[derive(Clone, Copy, Default, PartialEq, ShaderType)]
struct GpuDirectionalLight {
    direction_to_light: Vec3,
    illuminance: Vec3,
}

/// `Lighting` in `optics.wgsl`.
#[derive(Clone, Copy, Default, PartialEq, ShaderType)]
struct GpuLighting {
    environment_from_world: Mat3,
    clear_color: Vec4,
    environment_intensity: f32,
    even_light: Vec3,
    diffuse_intensity: f32,
    lights: [GpuDirectionalLight; MAX_LIGHTS],
    fog: GpuFog,
    aerial: GpuAerial,
}

/// The layout of group 2 of passes that need light.
#[derive(Resource)]
pub(crate) struct LightingLayout(pub(crate) BindGroupLayoutDescriptor);

/// A view's light.
#[derive(Component, Default)]
pub(crate) struct ViewLighting {
    /// Of the distant surroundings, and the light that falls on a matte surface.
    cubemaps: [Option<AssetId<Image>>; 2],
    offset: Offset,
    group: Group,
}

impl ViewLighting {
    /// The bind group, and its dynamic offset.
    pub(crate) fn get(&self) -> Option<(&BindGroup, [u32; 1])> {
        Some((self.group.get()?, [self.offset.bytes()]))
    }
}

pub(super) fn plugin(app: &mut App) {
    FogShaderPlugin::add(app);
    load_shader_library!(app, "medium.wgsl");
    load_shader_library!(app, "optics.wgsl");
    load_shader_library!(app, "aerial.wgsl");
    load_shader_library!(app, "haze.wgsl");
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .init_gpu_resource::<UniformArray<GpuLighting>>()
        .add_systems(RenderStartup, init_layout.in_set(FrameStartup))
        .add_systems(ExtractSchedule, extract_surroundings)
        .add_systems(
            Render,
            (
                prepare_lighting.in_set(SurfaceSystems::Resources),
                prepare_groups.in_set(RenderSystems::PrepareBindGroups),
            ),
        );
    let world = render_app.world_mut();
    world.register_required_components::<ViewSurfaces, ViewLighting>();
}

fn init_layout(mut commands: Commands) {
    let cube = || texture_cube(TextureSampleType::Float { filterable: true });
    commands.insert_resource(LightingLayout(BindGroupLayoutDescriptor::new(
        "fluid_lighting_layout",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::FRAGMENT | ShaderStages::COMPUTE,
            (
                uniform_buffer::<GpuLighting>(true),
                cube(),
                cube(),
                sampler(SamplerBindingType::Filtering),
                texture_3d(TextureSampleType::Float { filterable: true }),
                texture_2d(TextureSampleType::Float { filterable: true }),
            ),
        ),
    )));
}

fn prepare_lighting(
    mut views: Query<(
        &ExtractedCamera,
        &FluidView,
        &ExtractedView,
        Option<&ViewSurroundings>,
        Option<&DistanceFog>,
        Option<(&GpuAtmosphere, &GpuAtmosphereSettings)>,
        &mut ViewLighting,
    )>,
    lights: Query<(&ExtractedDirectionalLight, &RenderLayers)>,
    clear_color: Res<ClearColor>,
    images: Res<RenderAssets<GpuImage>>,
    mut uniforms: ResMut<UniformArray<GpuLighting>>,
    gpu: Gpu,
) {
    let is_cubemap = |id: &AssetId<Image>| {
        let image = images.get(*id);
        image.is_some_and(|image| image.texture.depth_or_array_layers() == 6)
    };
    uniforms.clear();
    for (camera, view, place, surroundings, fog, atmosphere, mut lighting) in &mut views {
        let clear_color = match camera.clear_color {
            ClearColorConfig::Custom(color) => color,
            _ => clear_color.0,
        };
        let (suns, sum) = suns_in_view(lights.iter(), &view.layers);
        let ambient = surroundings.map_or(Vec3::ZERO, |it| it.ambient);
        // The light from one direction, averaged over the sphere.
        let even_light = sum / (4.0 * core::f32::consts::PI) + ambient;
        let mut light = GpuLighting {
            clear_color: clear_color.to_linear().to_vec4(),
            even_light: even_light * camera.exposure,
            lights: suns.map(|sun| GpuDirectionalLight {
                direction_to_light: sun.direction_to_light,
                illuminance: sun.illuminance,
            }),
            fog: GpuFog::new(fog),
            aerial: atmosphere.map_or_else(default, |(atmosphere, settings)| {
                GpuAerial::new(atmosphere, settings, place.world_from_view.translation())
            }),
            ..default()
        };
        lighting.cubemaps = default();
        if let Some(map) = surroundings.and_then(|it| it.map.as_ref()) {
            lighting.cubemaps = [Some(map.image), map.diffuse].map(|id| id.filter(is_cubemap));
            // Cubemaps are left-handed.
            light.environment_from_world =
                Mat3::from_diagonal(vec3(1.0, 1.0, -1.0)) * Mat3::from_quat(map.rotation.inverse());
            let [environment, diffuse] = lighting.cubemaps.map(|cubemap| {
                let intensity = map.intensity * camera.exposure;
                if cubemap.is_some() { intensity } else { 0.0 }
            });
            light.environment_intensity = environment;
            light.diffuse_intensity = diffuse;
        }
        lighting.offset = uniforms.push(light);
    }
    uniforms.write(&gpu);
}

fn prepare_groups(
    mut views: Query<(&mut ViewLighting, Option<&AtmosphereTextures>)>,
    layout: Res<LightingLayout>,
    frame: Res<FrameLayout>,
    uniforms: Res<UniformArray<GpuLighting>>,
    images: Res<RenderAssets<GpuImage>>,
    fallback: Res<FallbackImage>,
    gpu: Gpu,
) {
    for (mut lighting, tables) in &mut views {
        let (inscattering, transmittance) = tables.map_or(
            (&fallback.d3.texture_view, &fallback.d2.texture_view),
            |tables| {
                (
                    &tables.aerial_view_lut.default_view,
                    &tables.transmittance_lut.default_view,
                )
            },
        );
        // The fallback is white; an intensity of 0 hides it.
        let [environment, diffuse] = lighting.cubemaps.map(|id| {
            let image = id.and_then(|id| images.get(id)).unwrap_or(&fallback.cube);
            Input::view(&image.texture_view)
        });
        lighting.group.prepare(
            &gpu,
            "fluid_lighting",
            &layout.0,
            &[
                uniforms.input(),
                environment,
                diffuse,
                Input::sampler(&frame.linear),
                Input::view(inscattering),
                Input::view(transmittance),
            ],
        );
    }
}
