//! The bodies of a view: fluids of equal material, with their plans and resources for the frame.

use core::ops::Range;

use bevy::{
    camera::{ClearColorConfig, MainPassResolutionOverride},
    math::{Affine3A, Vec3A},
    prelude::*,
    render::{
        camera::ExtractedCamera,
        render_asset::RenderAssets,
        render_phase::TrackedRenderPass,
        render_resource::{BindGroup, DynamicUniformBuffer, PipelineCache},
        renderer::{RenderDevice, RenderQueue},
        texture::{CachedTexture, GpuImage, TextureCache},
        view::{ExtractedView, ViewUniformOffset},
    },
};

use super::{
    bounds::{Bounds, far_to_near},
    composite::{CompositeKey, CompositePart},
    extract::{ExtractedFluid, FluidLights, GpuSplats, ViewSurroundings, mean_scale},
    gpu_types::{GpuBody, GpuFluid},
    grouping::{Group, Member, groups},
    layers::Layers,
    lighting::{Cubemaps, Lighting},
    pipelines::{BodyPipelines, Pipelines, Variant},
    plan::{Plan, PlanInput, plan},
    scene_depth::SCENE_DEPTH_FORMAT,
    scene_textures::{Placeholders, view_texture},
    skipped::{Reporter, ViewReport},
    smooth::{SmoothGroups, SmoothSteps},
    support::{FluidSupport, Shortcuts},
};
use crate::settings::{FluidDebugView, ScreenSpaceFluid};

/// Fluids of equal material in a view, and everything their passes need.
pub struct Body {
    /// The work planned for this frame.
    pub plan: Plan,
    /// The textures that its passes draw into.
    pub layers: Layers,
    /// The pixels it may cover.
    pub scissor: URect,
    pub(crate) fluids: Vec<BodyFluid>,
    pub(crate) steps: SmoothSteps,
    pub(crate) pipelines: BodyPipelines,
    pub(crate) groups: BodyGroups,
    pub(crate) debug: bool,
    pub(crate) depth_range_offset: u32,
    pub(crate) cubemaps: Cubemaps,
    view_offset: u32,
    body_offset: u32,
    ready: bool,
}

/// Which splats of a fluid are drawn.
pub(crate) struct BodyFluid {
    pub(crate) entity: Entity,
    pub(crate) bulk: Range<u32>,
    pub(crate) spray: Range<u32>,
}

#[derive(Default)]
pub(crate) struct BodyGroups {
    pub(crate) common: Option<BindGroup>,
    pub(crate) merge: Option<BindGroup>,
    pub(crate) smooth: SmoothGroups,
    pub(crate) bulk_layers: Option<BindGroup>,
    pub(crate) splat_normals: Option<BindGroup>,
    pub(crate) spray_layers: Option<BindGroup>,
    pub(crate) refract: Option<BindGroup>,
    pub(crate) composite: Option<BindGroup>,
}

impl Body {
    pub(crate) fn set_scissor(&self, pass: &mut TrackedRenderPass) {
        let URect { min, max } = self.scissor;
        pass.set_scissor_rect(min.x, min.y, max.x - min.x, max.y - min.y);
    }

    pub(crate) fn set_common<'a>(&'a self, pass: &mut TrackedRenderPass<'a>) {
        if let Some(group) = &self.groups.common {
            pass.set_bind_group(0, group, &[self.view_offset, self.body_offset]);
        }
    }

    /// Called once the bind groups exist. A body whose pipelines are still compiling is not drawn.
    pub(crate) fn mark_ready(&mut self, cache: &PipelineCache, scene_depth: bool) {
        self.ready = scene_depth && self.groups.common.is_some() && self.pipelines.ready(cache);
    }
}

/// The bodies in a view. A view without bodies lacks this component.
#[derive(Component)]
pub struct ViewBodies {
    /// From far to near.
    pub bodies: Vec<Body>,
    pub(crate) viewport: URect,
    /// The colour that a body is painted over; none in debug views.
    pub(crate) scene_color: Option<CachedTexture>,
    /// The colour before any body is painted, where there are several.
    pub(crate) scene_before: Option<CachedTexture>,
    pub(crate) scene_depth: CachedTexture,
    pub(crate) scene_depth_group: Option<BindGroup>,
    pub(crate) multisampled: bool,
}

impl ViewBodies {
    pub(crate) fn ready(&self) -> impl Iterator<Item = &Body> {
        self.bodies.iter().filter(|body| body.ready)
    }
}

/// Uniforms of all bodies and fluids of the frame.
#[derive(Resource, Default)]
pub(crate) struct FluidUniforms {
    pub(crate) bodies: DynamicUniformBuffer<GpuBody>,
    pub(crate) fluids: DynamicUniformBuffer<GpuFluid>,
    /// For debug views: nearest and farthest view depth.
    pub(crate) depth_ranges: DynamicUniformBuffer<Vec4>,
}

/// Writes the transform of every fluid.
pub(crate) fn prepare_fluids(
    mut fluids: Query<(&ExtractedFluid, &mut GpuSplats)>,
    mut uniforms: ResMut<FluidUniforms>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    uniforms.fluids.clear();
    for (fluid, mut gpu) in &mut fluids {
        gpu.offset = uniforms.fluids.push(&GpuFluid {
            world_from_local: fluid.transform.to_matrix(),
            radius: fluid.local_radius,
        });
    }
    uniforms.fluids.write_buffer(&device, &queue);
}

/// Groups the fluids of every view into bodies, plans their passes and allocates their textures.
pub(crate) fn prepare_bodies(
    mut commands: Commands,
    views: Query<(
        Entity,
        &ExtractedView,
        &ExtractedCamera,
        &ViewUniformOffset,
        &Msaa,
        &ScreenSpaceFluid,
        &ViewSurroundings,
        Option<&FluidDebugView>,
        Option<&MainPassResolutionOverride>,
    )>,
    stale: Query<Entity, With<ViewBodies>>,
    fluids: Query<(Entity, &ExtractedFluid)>,
    lights: Res<FluidLights>,
    images: Res<RenderAssets<GpuImage>>,
    clear_color: Res<ClearColor>,
    support: Res<FluidSupport>,
    shortcuts: Res<Shortcuts>,
    reporter: Reporter,
    placeholders: Res<Placeholders>,
    mut pipelines: Pipelines,
    mut textures: ResMut<TextureCache>,
    mut uniforms: ResMut<FluidUniforms>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    uniforms.bodies.clear();
    uniforms.depth_ranges.clear();
    let mut report = reporter.begin();
    // Also for cameras that no longer draw fluids or are inactive.
    for entity in &stale {
        commands.entity(entity).remove::<ViewBodies>();
    }
    for (entity, view, camera, offset, msaa, settings, surroundings, debug_view, resolution) in
        &views
    {
        let Some(target_size) = camera.physical_target_size else {
            continue;
        };
        if !support.drawing {
            continue;
        }
        let mut viewport = view.viewport;
        if let Some(size) = resolution {
            (viewport.z, viewport.w) = (size.x, size.y);
        }
        // Everything is relative to the eye: far from the origin, a product of large numbers would
        // lose metres.
        let eye = view.world_from_view.translation();
        let view_from_eye =
            Affine3A::from_mat3(view.world_from_view.affine().matrix3.inverse().into());
        let clip_from_eye = match view.clip_from_world {
            Some(clip_from_world) => clip_from_world * Mat4::from_translation(eye),
            None => view.clip_from_view * Mat4::from(view_from_eye),
        };
        // Orthographic: all rays come from far behind.
        let rays_from = if view.clip_from_view.w_axis.w == 1.0 {
            view.world_from_view.back() * 1e6
        } else {
            Vec3::ZERO
        };

        let lighting = Lighting {
            surroundings,
            lights: &lights,
            images: &images,
            clear_color: match camera.clear_color {
                ClearColorConfig::Custom(color) => color,
                _ => clear_color.0,
            },
            exposure: camera.exposure,
        };

        if let Some(views) = &mut report {
            views.push(ViewReport {
                camera: view.retained_view_entity.main_entity.id(),
                bodies: Vec::new(),
            });
        }
        let mut bodies = Vec::new();
        let visible = fluids
            .iter()
            .filter(|(_, fluid)| fluid.visible && fluid.layers.intersects(&surroundings.layers))
            .map(|(entity, fluid)| {
                let mut eye_from_local = fluid.transform.affine();
                eye_from_local.translation -= Vec3A::from(eye);
                Member {
                    entity,
                    fluid,
                    bounds: fluid.bounds.transformed(&eye_from_local),
                }
            });
        let groups = groups(visible, rays_from);
        let boxes: Vec<_> = groups.iter().map(Group::bounds).collect();
        let several = groups.len() > 1;
        let mut behind = None;
        for i in far_to_near(rays_from, &boxes) {
            let (Group { material, members }, bounds) = (&groups[i], boxes[i]);
            let scissor = bounds.scissor(&clip_from_eye, viewport);
            let count = |of: fn(&ExtractedFluid) -> u32| {
                members.iter().map(|member| of(member.fluid)).sum::<u32>()
            };
            let radius = members.iter().map(|it| it.fluid.radius).fold(0.0, f32::max);
            let input = PlanInput {
                in_view: scissor.is_some(),
                near_plane_cuts: bounds.near_plane_cuts(&clip_from_eye),
                bulk: count(|fluid| fluid.bulk),
                interior: count(|fluid| fluid.interior),
                spray: count(|fluid| fluid.spray),
                radius,
                material: *material,
                shortcuts: shortcuts.0,
                settings: *settings,
            };
            if let Some(view) = report.as_mut().and_then(|views| views.last_mut()) {
                let fluids = members.iter().map(|member| member.entity);
                view.bodies
                    .push(reporter.body(&input, fluids, scissor, viewport));
            }
            let (Some(plan), Some(scissor)) = (plan(&input), scissor) else {
                continue;
            };
            let composite = CompositeKey {
                debug_view: debug_view.copied(),
                format: view.target_format,
                samples: msaa.samples(),
                part: if debug_view.is_none() && (several || plan.index_one) {
                    CompositePart::Light
                } else {
                    CompositePart::Whole
                },
                several,
                accumulated: plan.accumulated && debug_view == Some(&FluidDebugView::Thickness),
            };
            let wanted = Variant {
                plan,
                settings: *settings,
                composite,
            };
            let (Variant { plan, settings, .. }, pipelines) =
                pipelines.choose(entity, members, wanted, &support);
            let steps = SmoothSteps::new(&plan.smoothing);
            // A scaled camera's metres differ from the world's.
            let view_scale = mean_scale(&view_from_eye.matrix3);
            let mut body = GpuBody::new(material, radius * view_scale, &settings, &plan.smoothing);
            let cubemaps = lighting.shine_on(&mut body, material.medium.emission);
            body.scale_lengths(view_scale);
            if let Some(center) = behind.replace(bounds.center()) {
                let center = view_from_eye.transform_point3(center);
                body.behind = center.extend(1.0);
            }
            let layers = Layers::new(
                &mut textures,
                &device,
                target_size,
                &plan,
                &steps,
                &support,
                &placeholders.layers,
                debug_view.copied(),
            );
            let depths = view_depths(&bounds, &view_from_eye);
            bodies.push(Body {
                plan,
                layers,
                scissor,
                fluids: members
                    .iter()
                    .map(|member| drawn(member, plan.interior))
                    .collect(),
                steps,
                pipelines,
                groups: BodyGroups::default(),
                debug: debug_view.is_some(),
                depth_range_offset: uniforms.depth_ranges.push(&depths),
                cubemaps,
                view_offset: offset.offset,
                body_offset: uniforms.bodies.push(&body),
                ready: false,
            });
        }
        if bodies.is_empty() {
            continue;
        }
        let mut texture =
            |label, format| view_texture(&mut textures, &device, label, target_size, format);
        commands.entity(entity).insert(ViewBodies {
            bodies,
            viewport: URect::from_corners(viewport.xy(), viewport.xy() + viewport.zw()),
            scene_color: debug_view
                .is_none()
                .then(|| texture("fluid_scene_color", view.target_format)),
            scene_before: (several && debug_view.is_none())
                .then(|| texture("fluid_scene_before", view.target_format)),
            scene_depth: texture("fluid_scene_depth", SCENE_DEPTH_FORMAT),
            scene_depth_group: None,
            multisampled: msaa.samples() > 1,
        });
    }
    reporter.end(report);
    pipelines.end_frame();
    uniforms.bodies.write_buffer(&device, &queue);
    uniforms.depth_ranges.write_buffer(&device, &queue);
}

/// Splats lie in the order bulk, interior, spray.
fn drawn(member: &Member, interior: bool) -> BodyFluid {
    let fluid = member.fluid;
    let surface = fluid.bulk;
    let bulk = surface + fluid.interior;
    BodyFluid {
        entity: member.entity,
        bulk: 0..if interior { bulk } else { surface },
        spray: bulk..bulk + fluid.spray,
    }
}

/// Nearest and farthest depth of the box, for debug views.
fn view_depths(bounds: &Bounds, view_from_eye: &Affine3A) -> Vec4 {
    let in_view = bounds.transformed(view_from_eye);
    let near = (-in_view.max.z).max(0.0);
    vec4(near, (-in_view.min.z).max(near + 1e-6), 0.0, 0.0)
}
