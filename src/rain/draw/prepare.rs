//! Preparation of each view's rain for a frame.

use bevy::{
    camera::visibility::RenderLayers,
    core_pipeline::core_3d::{CORE_3D_DEPTH_FORMAT, Transparent3d, TransparentSortingInfo3d},
    pbr::{DistanceFog, ExtractedDirectionalLight, ExtractedPointLight},
    prelude::*,
    render::{
        camera::ExtractedCamera,
        render_asset::RenderAssets,
        render_phase::{DrawFunctions, PhaseItemExtraIndex, ViewSortedRenderPhases},
        render_resource::{
            BindGroupEntries, Buffer, BufferInitDescriptor, BufferUsages, Extent3d, PipelineCache,
            SpecializedRenderPipelines, TextureDescriptor, TextureDimension, TextureUsages,
        },
        renderer::{RenderDevice, RenderQueue},
        texture::{FallbackImage, GpuImage, TextureCache},
        view::{ExtractedView, ViewUniformOffset, ViewUniforms},
    },
};

use super::{
    buffers::RainBuffers,
    command::DrawRain,
    extract::{EnvironmentMap, ExtractedRain, Shelters},
    gpu_types::{GpuQuad, GpuRain},
    lattice::{ALL_CELLS, Content, Eye, NEAR_CELLS, add_voxels, fall_axis},
    lights::suns,
    pipeline::{RainKey, RainPart, RainPipeline, RainScene},
    quads::{BACKDROP, DROPS, RainBindGroup, RainQuads},
    view::Plan,
};
use crate::{fog::GpuFog, render::ViewSurfaces};

/// Enough for 200 mm/h, the highest rate.
const MAX_DROPS: u32 = 6000;

/// Selects the voxels and queues them among the transparent items.
pub(crate) fn queue_rain(
    mut views: Query<(
        &ExtractedView,
        &ExtractedRain,
        &mut RainQuads,
        &Msaa,
        Option<&RenderLayers>,
        Option<&DistanceFog>,
        Has<ViewSurfaces>,
    )>,
    lamps: Query<(&ExtractedPointLight, &RenderLayers)>,
    sun_lights: Query<(&ExtractedDirectionalLight, &RenderLayers)>,
    shelters: Res<Shelters>,
    mut buffers: ResMut<RainBuffers>,
    mut phases: ResMut<ViewSortedRenderPhases<Transparent3d>>,
    functions: Res<DrawFunctions<Transparent3d>>,
    pipeline: Res<RainPipeline>,
    mut pipelines: ResMut<SpecializedRenderPipelines<RainPipeline>>,
    images: Res<RenderAssets<GpuImage>>,
    mut cache: ResMut<PipelineCache>,
) {
    let buffers = &mut *buffers;
    buffers.uniforms.clear();
    let draw = functions.read().id::<DrawRain>();
    for (view, extracted, mut quads, msaa, layers, fog, liquid) in &mut views {
        let quads = &mut *quads;
        quads.instances.clear();
        quads.shells.clear();
        quads.cells = 0..0;
        let rain = &extracted.rain;
        let axis = fall_axis(extracted.clock.lean);
        let eye = Eye::new(
            &view.world_from_view,
            &view.clip_from_view,
            rain.distance,
            axis,
        );
        let (Some(eye), Some(phase)) = (eye, phases.get_mut(&view.retained_view_entity)) else {
            continue;
        };
        let place = view.world_from_view.translation();
        let plan = Plan::new(rain.method, rain.distance, &eye);
        let mut gpu = GpuRain::new(extracted, &plan, &view.world_from_view, &eye, axis);
        let reach = rain.distance.max(rain.extent);
        buffers.dry.gather(&shelters, place, &eye, axis, reach);
        gpu.shelters = buffers.dry.gpu();
        let layers = layers.unwrap_or_default();
        (gpu.suns, gpu.sun_count) = suns(sun_lights.iter(), layers);
        buffers.near.gather(lamps.iter(), layers, place, &eye);
        gpu.lights = buffers.near.gpu();
        gpu.fog = GpuFog::new(fog);
        if let Some(map) = environment_of(extracted, &images) {
            // Cubemaps are left-handed.
            gpu.environment_from_world =
                Mat3::from_diagonal(vec3(1.0, 1.0, -1.0)) * Mat3::from_quat(map.rotation.inverse());
            gpu.environment_intensity = map.intensity;
        }

        // Without light from all around, rain that no lamp reaches is dark: its faint shade is left
        // out.
        let always = gpu.ambient != Vec3::ZERO
            || gpu.environment_intensity > 0.0
            || gpu.sun_count > 0
            || rain.brightness <= 0.0;
        let (near, dry) = (&buffers.near, &buffers.dry);
        let keep = |content: Content| {
            move |quad: &mut GpuQuad| {
                let reach = content.lit_reach(quad.size, axis);
                let Some(shelters) = dry.around(quad.center, reach) else {
                    return false;
                };
                quad.shelters = shelters;
                if !near.is_empty() {
                    quad.lamps = near.reaching(quad.center, reach);
                }
                always || quad.lamps != 0
            }
        };
        let instances = quads.instances.values_mut();
        let clock = &extracted.clock;
        let mut too_many = plan.levels.is_some_and(|levels| {
            let content = Content::Streaks;
            let keep = keep(content);
            add_voxels(
                instances,
                &eye,
                clock,
                &levels,
                content,
                rain.distance,
                keep,
            )
        });
        let voxels = quads.instances.len();
        quads.cut_shells(rain.distance, phase.items.is_empty() && !liquid);
        if plan.drops_end > 0.0 {
            let cells = if plan.levels.is_some() {
                NEAR_CELLS
            } else {
                ALL_CELLS
            };
            let (instances, content) =
                (quads.instances.values_mut(), Content::Drops(gpu.longest()));
            let keep = keep(content);
            too_many |= add_voxels(
                instances,
                &eye,
                clock,
                &[cells],
                content,
                plan.drops_reach,
                keep,
            );
            let drops = gpu.drops * cells.size.powi(3);
            quads.drop_indices = 6 * (drops.ceil() as u32).min(MAX_DROPS);
            quads.cells = voxels as u32..quads.instances.len() as u32;
        }
        if too_many {
            bevy::utils::once!(warn!(
                "a view is too wide for its rain: not all of it is drawn"
            ));
        }
        quads.uniform_offset = buffers.uniforms.push(&gpu);
        let scene = RainScene {
            suns: gpu.sun_count > 0,
            lamps: !buffers.near.is_empty(),
            // In sight or not: few shaders are compiled as the camera turns.
            shelters: !shelters.0.is_empty(),
        };
        let target = (view.target_format, msaa.samples());
        let other_target = quads.target.replace(target).is_some_and(|it| it != target);
        let [backdrop, billboards, drops] =
            [RainPart::Backdrop, RainPart::Billboards, RainPart::Drops].map(|part| {
                let mut of = |scene| {
                    let key = RainKey {
                        part,
                        format: target.0,
                        samples: target.1,
                        scene,
                    };
                    pipelines.specialize(&cache, &pipeline, key)
                };
                // The backdrop is lit by the surroundings alone.
                let wanted = of(if part == RainPart::Backdrop {
                    RainScene {
                        shelters: scene.shelters,
                        ..RainScene::NOTHING
                    }
                } else {
                    scene
                });
                // When the first lamp appears, rain must not vanish until its shader is compiled.
                let pipeline = match cache.get_render_pipeline(wanted) {
                    Some(_) => wanted,
                    None => of(RainScene::ALL),
                };
                // Nor when the target changes: better a slow frame than one without rain.
                if other_target {
                    cache.block_on_render_pipeline(pipeline);
                }
                pipeline
            });

        let mut add = |item: usize, distance: f32, pipeline| {
            phase.add_transient(Transparent3d {
                sorting_info: TransparentSortingInfo3d::Sorted {
                    mesh_center: place + eye.forward * distance,
                    depth_bias: 0.0,
                },
                distance: 0.0,
                pipeline,
                entity: (buffers.items[item], view.retained_view_entity.main_entity),
                draw_function: draw,
                batch_range: 0..1,
                // Which item it is.
                extra_index: PhaseItemExtraIndex::DynamicOffset(item as u32),
                indexed: false,
            });
        };
        if rain.extent > rain.distance || plan.leaves_some(eye.steepest()) {
            add(BACKDROP, rain.distance + 1.0, backdrop);
        }
        for (shell_index, shell) in quads.shells.iter().enumerate() {
            add(shell_index, shell.distance, billboards);
        }
        if !quads.cells.is_empty() && quads.drop_indices > 0 {
            // At the middle of the volume that they fill.
            add(DROPS, 0.75 * plan.drops_end.min(rain.distance), drops);
        }
    }
}

fn environment_of(
    extracted: &ExtractedRain,
    images: &RenderAssets<GpuImage>,
) -> Option<EnvironmentMap> {
    extracted.environment.filter(|map| {
        images
            .get(map.image)
            .is_some_and(|image| image.texture_descriptor.size.depth_or_array_layers == 6)
    })
}

/// The scene's depth is copied: it cannot be read where it is attached.
pub(crate) fn allow_depth_copies(mut cameras: Query<&mut Camera3d, With<ExtractedRain>>) {
    for mut camera in &mut cameras {
        camera.depth_texture_usages.0 |= TextureUsages::COPY_SRC.bits();
    }
}

pub(crate) fn prepare_rain(
    mut views: Query<(&ExtractedCamera, &mut RainQuads, &Msaa)>,
    mut buffers: ResMut<RainBuffers>,
    mut textures: ResMut<TextureCache>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    buffers.uniforms.write_buffer(&device, &queue);
    for (camera, mut quads, msaa) in &mut views {
        let Some(size) = camera.physical_target_size else {
            continue;
        };
        if !quads.cells.is_empty() && buffers.drop_indices.is_none() {
            buffers.drop_indices = Some(drop_indices(&device));
        }
        let capacity = quads.instances.len().next_power_of_two();
        quads.instances.reserve(capacity, &device);
        quads.instances.write_buffer(&device, &queue);
        quads.depth = Some(textures.get(
            &device,
            TextureDescriptor {
                label: Some("rain_scene_depth"),
                size: Extent3d {
                    width: size.x,
                    height: size.y,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: msaa.samples(),
                dimension: TextureDimension::D2,
                format: CORE_3D_DEPTH_FORMAT,
                // Multisampled textures must be attachable.
                usage: TextureUsages::TEXTURE_BINDING
                    | TextureUsages::COPY_DST
                    | TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            },
        ));
    }
}

fn drop_indices(device: &RenderDevice) -> Buffer {
    let indices: Vec<u32> = (0..MAX_DROPS)
        .flat_map(|drop| [0, 1, 2, 2, 1, 3].map(|corner| 4 * drop + corner))
        .collect();
    device.create_buffer_with_data(&BufferInitDescriptor {
        label: Some("rain_drop_indices"),
        contents: bytemuck::cast_slice(&indices),
        usage: BufferUsages::INDEX,
    })
}

pub(crate) fn prepare_rain_bind_groups(
    mut views: Query<(&ExtractedRain, &mut RainQuads, &Msaa, &ViewUniformOffset)>,
    buffers: Res<RainBuffers>,
    pipeline: Res<RainPipeline>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    view_uniforms: Res<ViewUniforms>,
    images: Res<RenderAssets<GpuImage>>,
    fallback: Res<FallbackImage>,
) {
    for (extracted, mut quads, msaa, view_offset) in &mut views {
        quads.view_offset = view_offset.offset;
        let environment = environment_of(extracted, &images)
            .and_then(|map| images.get(map.image))
            .unwrap_or(&fallback.cube);
        let sources = (|| {
            Some((
                view_uniforms.uniforms.buffer()?.id(),
                buffers.uniforms.buffer()?.id(),
                view_uniforms.uniforms.binding()?,
                buffers.uniforms.binding()?,
                &quads.depth.as_ref()?.default_view,
                images.get(&extracted.streaks.image)?,
            ))
        })();
        let Some((views_id, rain_id, views, rain, depth, streaks)) = sources else {
            quads.bind_group = None;
            continue;
        };
        let ids = (
            [views_id, rain_id],
            [
                depth.id(),
                environment.texture_view.id(),
                streaks.texture_view.id(),
            ],
        );
        if let Some(known) = &quads.bind_group
            && (known.buffers, known.textures) == ids
        {
            continue;
        }
        let multisampled = usize::from(msaa.samples() > 1);
        let group = device.create_bind_group(
            "rain",
            &cache.get_bind_group_layout(&pipeline.layouts[multisampled]),
            &BindGroupEntries::sequential((
                views,
                rain,
                depth,
                &environment.texture_view,
                &environment.sampler,
                &streaks.texture_view,
                &streaks.sampler,
            )),
        );
        let (buffers, textures) = ids;
        quads.bind_group = Some(RainBindGroup {
            group,
            buffers,
            textures,
        });
    }
}
