//! Extraction into the render world. Particles are swapped, never copied.

use bevy::{
    camera::visibility::RenderLayers,
    ecs::query::QueryItem,
    light::Skybox,
    math::Mat3A,
    prelude::*,
    render::{
        Extract, MainWorld,
        extract_component::ExtractComponent,
        render_resource::{BindGroup, Buffer, BufferDescriptor, BufferUsages},
        renderer::{RenderDevice, RenderQueue},
        sync_component::SyncComponent,
        sync_world::RenderEntity,
    },
};

use super::{
    bounds::Bounds,
    gpu_types::{GpuDirectionalLight, MAX_LIGHTS},
    support::FluidSupport,
};
use crate::{
    material::FluidMaterial,
    settings::{FluidDebugView, ScreenSpaceFluid},
    shape::Splat,
    source::particles::{FluidParticles, ShapedFluid},
};

impl SyncComponent for ScreenSpaceFluid {
    type Target = (Self, ViewSurroundings);
}

impl ExtractComponent for ScreenSpaceFluid {
    type QueryData = (
        &'static Self,
        Option<&'static EnvironmentMapLight>,
        Option<&'static Skybox>,
        Option<&'static RenderLayers>,
        Option<&'static AmbientLight>,
    );
    type QueryFilter = With<Camera3d>;
    type Out = (Self, ViewSurroundings);

    fn extract_component(
        (settings, light, skybox, layers, ambient): QueryItem<'_, '_, Self::QueryData>,
    ) -> Option<Self::Out> {
        let map = light
            .map(|light| EnvironmentMap {
                image: light.specular_map.clone(),
                diffuse: Some(light.diffuse_map.clone()),
                intensity: light.intensity,
                rotation: light.rotation,
            })
            .or_else(|| {
                let skybox = skybox?;
                Some(EnvironmentMap {
                    image: skybox.image.clone()?,
                    // Like meshes, the medium is not lit by the sky box.
                    diffuse: None,
                    intensity: skybox.brightness,
                    rotation: skybox.rotation,
                })
            });
        let surroundings = ViewSurroundings {
            map,
            layers: layers.cloned().unwrap_or_default(),
            ambient: ambient.map(|light| luminance(light.color, light.brightness)),
        };
        Some((*settings, surroundings))
    }
}

impl SyncComponent for FluidDebugView {
    type Target = Self;
}

impl ExtractComponent for FluidDebugView {
    type QueryData = &'static Self;
    type QueryFilter = With<ScreenSpaceFluid>;
    type Out = Self;

    fn extract_component(view: QueryItem<'_, '_, Self::QueryData>) -> Option<Self> {
        Some(*view)
    }
}

/// A cubemap of the distant surroundings.
#[derive(Clone)]
pub(crate) struct EnvironmentMap {
    pub(crate) image: Handle<Image>,
    /// The diffuse light by the normal of a matte surface.
    pub(crate) diffuse: Option<Handle<Image>>,
    /// cd/m² per texel value.
    pub(crate) intensity: f32,
    pub(crate) rotation: Quat,
}

/// The surroundings of the fluid in a view.
#[doc(hidden)]
#[derive(Component, Clone)]
pub struct ViewSurroundings {
    pub(crate) map: Option<EnvironmentMap>,
    pub(crate) layers: RenderLayers,
    /// The camera's own ambient light, cd/m².
    pub(crate) ambient: Option<Vec3>,
}

/// The scene's distant lights.
#[derive(Resource, Default)]
pub(crate) struct FluidLights {
    /// Unused slots are dark.
    pub(crate) lights: [GpuDirectionalLight; MAX_LIGHTS],
    /// Mean over all directions of all directional lights, cd/m².
    mean: Vec3,
    /// Ambient light for cameras without their own, cd/m².
    ambient: Vec3,
}

impl FluidLights {
    /// The mean luminance over all directions, without environment maps; `ambient` is the camera's
    /// own.
    pub(crate) fn even(&self, ambient: Option<Vec3>) -> Vec3 {
        self.mean + ambient.unwrap_or(self.ambient)
    }
}

fn luminance(color: Color, brightness: f32) -> Vec3 {
    color.to_linear().to_vec3() * brightness
}

pub(crate) fn extract_lights(
    lights: Extract<Query<(&DirectionalLight, &GlobalTransform, &ViewVisibility)>>,
    ambient: Extract<Option<Res<GlobalAmbientLight>>>,
    mut extracted: ResMut<FluidLights>,
) {
    extracted.lights = default();
    extracted.mean = Vec3::ZERO;
    extracted.ambient = ambient
        .as_ref()
        .map_or(Vec3::ZERO, |light| luminance(light.color, light.brightness));
    let visible = lights.iter().filter(|(_, _, visibility)| visibility.get());
    for (slot, (light, transform, _)) in visible.enumerate() {
        let illuminance = luminance(light.color, light.illuminance);
        // The light from one direction, averaged over the sphere.
        extracted.mean += illuminance / (4.0 * core::f32::consts::PI);
        if let Some(slot) = extracted.lights.get_mut(slot) {
            *slot = GpuDirectionalLight {
                direction_to_light: transform.back().into(),
                illuminance,
            };
        }
    }
}

/// A fluid in the render world: its transform, material and splats.
#[doc(hidden)]
#[derive(Component, Default)]
pub struct ExtractedFluid {
    pub(crate) transform: GlobalTransform,
    pub(crate) material: FluidMaterial,
    pub(crate) layers: RenderLayers,
    pub(crate) visible: bool,
    /// Particle radius in world units.
    pub(crate) radius: f32,
    /// Particle radius in the fluid's own units.
    pub(crate) local_radius: f32,
    pub(crate) bounds: Bounds,
    pub(crate) bulk: u32,
    pub(crate) interior: u32,
    pub(crate) spray: u32,
    splats: Vec<Splat>,
    fresh: bool,
}

impl Default for Bounds {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl SyncComponent for FluidParticles {
    type Target = (ExtractedFluid, GpuSplats);
}

/// Splats in a storage buffer, uploaded only when they have changed.
#[derive(Component, Default)]
pub struct GpuSplats {
    pub(crate) buffer: Option<Buffer>,
    /// Offset of the fluid's transform in the buffer of all fluids' transforms.
    pub(crate) offset: u32,
    pub(crate) bind_group: Option<BindGroup>,
    /// Number of times that splats have been uploaded.
    pub uploads: u64,
}

/// Extracts transforms and materials every frame, splats only when they were reshaped: the two
/// worlds swap their buffers.
pub(crate) fn extract_fluids(
    mut main: ResMut<MainWorld>,
    mut state: Local<
        Option<
            QueryState<(
                RenderEntity,
                &GlobalTransform,
                Option<&FluidMaterial>,
                &FluidParticles,
                &InheritedVisibility,
                Option<&RenderLayers>,
                &mut ShapedFluid,
            )>,
        >,
    >,
    mut fluids: Query<&mut ExtractedFluid>,
    mut commands: Commands,
) {
    let state = state.get_or_insert_with(|| main.query());
    for (entity, transform, material, particles, visibility, layers, mut shaped) in
        state.iter_mut(&mut main)
    {
        let mut new = None;
        let mut known = fluids.get_mut(entity).ok();
        let fluid = match known.as_deref_mut() {
            Some(fluid) => fluid,
            None => new.insert(ExtractedFluid::default()),
        };
        fluid.transform = particles.world_from_particles(transform);
        fluid.material = material.copied().unwrap_or_default().clamped();
        fluid.visible = visibility.get();
        fluid.local_radius = particles.radius;
        fluid.radius = particles.radius * mean_scale(&fluid.transform.affine().matrix3);
        fluid
            .layers
            .clone_from(layers.unwrap_or(&RenderLayers::layer(0)));
        // Taking the splats must not trigger change detection.
        let shaped = shaped.bypass_change_detection();
        if shaped.take_fresh() {
            let splats = &mut shaped.splats;
            core::mem::swap(&mut fluid.splats, &mut splats.splats);
            fluid.bounds = Bounds {
                min: splats.min,
                max: splats.max,
            };
            (fluid.bulk, fluid.interior, fluid.spray) =
                (splats.bulk, splats.interior, splats.spray);
            fluid.fresh = true;
        }
        if let Some(fluid) = new {
            commands
                .entity(entity)
                .insert((fluid, GpuSplats::default()));
        }
    }
}

/// The scale of a sphere of the same volume.
pub(crate) fn mean_scale(matrix: &Mat3A) -> f32 {
    let volume = matrix.determinant().abs();
    if volume.is_finite() && volume > 0.0 {
        volume.cbrt()
    } else {
        1.0
    }
}

/// Drops the buffers of a lost device; the splats are still available.
pub(crate) fn forget_buffers(mut fluids: Query<&mut GpuSplats>) {
    for mut gpu in &mut fluids {
        gpu.buffer = None;
        gpu.bind_group = None;
    }
}

pub(crate) fn upload_splats(
    mut fluids: Query<(&mut ExtractedFluid, &mut GpuSplats)>,
    support: Res<FluidSupport>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    if !support.drawing {
        return;
    }
    for (mut fluid, mut gpu) in &mut fluids {
        if !fluid.fresh && (gpu.buffer.is_some() || fluid.splats.is_empty()) {
            continue;
        }
        fluid.fresh = false;
        if fluid.splats.is_empty() {
            continue;
        }
        let limit = device.limits();
        let room = limit
            .max_storage_buffer_binding_size
            .min(limit.max_buffer_size) as usize
            / size_of::<Splat>();
        if fluid.splats.len() > room {
            bevy::utils::once!(warn!(
                "a fluid of {} particles exceeds the adapter's buffers: the first {room} are drawn",
                fluid.splats.len()
            ));
            fluid.bulk = fluid.bulk.min(room as u32);
            fluid.interior = fluid.interior.min(room as u32 - fluid.bulk);
            fluid.spray = fluid.spray.min(room as u32 - fluid.bulk - fluid.interior);
            fluid.splats.truncate(room);
        }
        let bytes: &[u8] = bytemuck::cast_slice(&fluid.splats);
        let needed = bytes.len() as u64;
        if gpu.buffer.as_ref().is_none_or(|b| b.size() < needed) {
            let capacity = fluid.splats.len().next_power_of_two().min(room);
            gpu.buffer = Some(device.create_buffer(&BufferDescriptor {
                label: Some("fluid_splats"),
                size: (capacity * size_of::<Splat>()) as u64,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
        }
        if let Some(buffer) = &gpu.buffer {
            queue.write_buffer(buffer, 0, bytes);
        }
        gpu.uploads += 1;
    }
}
