//! Surfaces of this frame: found again or spawned, planned, and put in order.

use bevy::{
    camera::MainPassResolutionOverride,
    core_pipeline::prepass::{DepthPrepass, MotionVectorPrepass, PreviousViewData},
    math::{Affine3A, DMat4, Vec3A},
    pbr::{DistanceFog, GpuAtmosphereSettings, PrepassPipeline, resources::AtmosphereTextures},
    prelude::*,
    render::{camera::ExtractedCamera, renderer::RenderDevice, view::ExtractedView},
};

use super::{
    DrawnFluid, GpuSurface, MARGIN, Shortcuts, Surface, Variant, ViewSurfaces,
    bounds::{Bounds, sort_far_to_near},
    fluids::{ExtractedFluid, mean_scale},
    grouping::{Group, Member, group},
    plan::{PlanInput, plan},
    reasons::{Reporter, ViewReport},
    uniforms::SHEET,
    views::FluidView,
};

/// Kept from frame to frame, so that a steady one allocates nothing.
#[derive(Default)]
pub(super) struct Scratch {
    members: Vec<Member>,
    groups: Vec<Group>,
    /// The surfaces of a view, from far to near.
    painted: Vec<Entity>,
    /// The surfaces of all views.
    seen: Vec<Entity>,
    /// Cameras that the log has named because they lack something.
    without_depth: Vec<Entity>,
    without_hdr: Vec<Entity>,
}

/// Warns once when a camera comes to lack something.
fn warn_if(named: &mut Vec<Entity>, camera: Entity, lacks: bool, warning: &str) {
    let known = named.iter().position(|it| *it == camera);
    match (known, lacks) {
        (Some(index), false) => {
            named.swap_remove(index);
        }
        (None, true) => {
            named.push(camera);
            warn!("camera {camera} {warning}");
        }
        _ => {}
    }
}

/// Groups the fluids of every view into surfaces and plans their passes.
pub(super) fn prepare_surfaces(
    mut commands: Commands,
    views: Query<(
        Entity,
        &ExtractedView,
        &ExtractedCamera,
        &Msaa,
        &FluidView,
        Option<&MainPassResolutionOverride>,
        Has<DepthPrepass>,
        (Has<MotionVectorPrepass>, Option<&PreviousViewData>),
        Has<DistanceFog>,
        Has<AtmosphereTextures>,
        // Of an atmosphere that has ended, only the textures stay.
        Has<GpuAtmosphereSettings>,
    )>,
    prepass: Option<Res<PrepassPipeline>>,
    mut painted: Query<(Entity, &mut ViewSurfaces)>,
    mut surfaces: Query<(Entity, &mut Surface)>,
    fluids: Query<(Entity, &ExtractedFluid)>,
    shortcuts: Res<Shortcuts>,
    reporter: Reporter,
    device: Res<RenderDevice>,
    mut scratch: Local<Scratch>,
) {
    let scratch = &mut *scratch;
    let mut report = reporter.begin();
    let largest = UVec2::splat(device.limits().max_texture_dimension_2d - 2 * MARGIN);
    scratch.seen.clear();
    for (_, mut view) in &mut painted {
        view.surfaces.clear();
    }
    for (
        entity,
        view,
        camera,
        msaa,
        fluid_view,
        resolution,
        has_prepass,
        (motion_vectors, before),
        fog,
        air,
        has_air,
    ) in &views
    {
        if camera.physical_target_size.is_none() {
            continue;
        }
        let mut viewport = view.viewport;
        if let Some(size) = resolution {
            (viewport.z, viewport.w) = (size.x, size.y);
        }
        let scene_depth = has_prepass && prepass.is_some();
        let main_camera = view.retained_view_entity.main_entity.id();
        warn_if(
            &mut scratch.without_depth,
            main_camera,
            !scene_depth,
            "has no `DepthPrepass`, or `PbrPlugin` makes no prepasses: its liquids are drawn \
             without refraction",
        );
        warn_if(
            &mut scratch.without_hdr,
            main_camera,
            !camera.hdr,
            "has no `Hdr`: its liquids are not tone mapped",
        );
        let eye = Eye::new(view);
        let clip_from_view = motion_vectors.then(|| clip_from_view(view, before));
        if let Some(views) = &mut report {
            views.push(ViewReport {
                camera: main_camera,
                surfaces: Vec::new(),
            });
        }
        scratch.members.clear();
        scratch.members.extend(
            fluids
                .iter()
                .filter(|(_, fluid)| fluid.visible && fluid.layers.intersects(&fluid_view.layers))
                .map(|(entity, fluid)| eye.member(entity, fluid)),
        );
        group(&mut scratch.members, &mut scratch.groups, eye.rays_from);
        sort_far_to_near(&mut scratch.groups, |group| group.bounds, eye.rays_from);

        scratch.painted.clear();
        let mut behind = None;
        for Group { members, bounds } in &scratch.groups {
            let members = &scratch.members[members.clone()];
            let material = members[0].material;
            let rect = bounds.rect(&eye.clip_from_eye, viewport.zw());
            // A target as large as any texture loses some pixels to the margin.
            let rect = rect.map(|it| URect::from_corners(it.min, it.max.min(it.min + largest)));
            let count = |of: fn(&DrawnFluid) -> u32| {
                members.iter().map(|member| of(&member.fluid)).sum::<u32>()
            };
            let radius = members.iter().map(|it| it.radius).fold(0.0, f32::max);
            let input = PlanInput {
                in_view: rect.is_some(),
                near_plane_cuts: bounds.near_plane_cuts(&eye.clip_from_eye),
                bulk: count(|fluid| fluid.bulk),
                interior: count(|fluid| fluid.interior),
                spray: count(|fluid| fluid.spray),
                radius,
                material,
                shortcuts: shortcuts.0,
                scene_depth,
                motion_vectors,
                settings: fluid_view.settings,
            };
            let leading = members[0].fluid.entity;
            let is_known = |surface: &Surface| {
                surface.view == entity
                    && surface.fluids.first().map(|it| it.entity) == Some(leading)
            };
            if let Some(view) = report.as_mut().and_then(|views| views.last_mut()) {
                let fluids = members.iter().map(|member| member.fluid.entity);
                let known = surfaces.iter().find(|(_, surface)| is_known(surface));
                let waiting = known.and_then(|(_, surface)| surface.waiting);
                let report = reporter.surface(&input, fluids, waiting, rect, viewport.zw());
                view.surfaces.push(report);
            }
            let (Some(plan), Some(rect)) = (plan(&input), rect) else {
                continue;
            };
            let mut uniform = GpuSurface::new(
                &material,
                &fluid_view.settings,
                radius,
                eye.view_scale,
                camera.exposure,
            );
            if members.iter().all(|it| it.sheets) {
                uniform.sheet = SHEET * uniform.radius;
            }
            if let Some(center) = behind.replace(bounds.center()) {
                let center = eye.view_from_eye.transform_point3(center);
                uniform.behind = center.extend(1.0);
            }
            let wanted = Variant {
                plan,
                settings: fluid_view.settings,
                debug_view: fluid_view.debug_view,
                format: view.target_format,
                samples: msaa.samples(),
                scene_depth,
                fog,
                atmosphere: air && has_air,
                several: scratch.groups.len() > 1,
            };
            let depths = eye.depths(bounds);
            let known = surfaces.iter_mut().find(|(_, surface)| is_known(surface));
            let surface = if let Some((surface, mut known)) = known {
                known.fluids.clear();
                known.fluids.extend(members.iter().map(|it| it.fluid));
                known.waiting = None;
                known.wanted = wanted;
                known.rect = rect;
                known.depths = depths;
                known.uniform = uniform;
                known.clip_from_view = clip_from_view;
                surface
            } else {
                let is_member =
                    |fluid: &DrawnFluid| members.iter().any(|it| it.fluid.entity == fluid.entity);
                let before = surfaces.iter().find(|(_, surface)| {
                    surface.view == entity && surface.fluids.iter().any(is_member)
                });
                let new = Surface {
                    view: entity,
                    fluids: members.iter().map(|it| it.fluid).collect(),
                    wanted,
                    drawn: before.and_then(|(_, surface)| surface.drawn),
                    waiting: None,
                    rect,
                    depths,
                    uniform,
                    clip_from_view,
                };
                commands.spawn(new).id()
            };
            scratch.painted.push(surface);
        }
        scratch.seen.extend(&scratch.painted);
        if scratch.painted.is_empty() {
            continue;
        }
        let viewport = URect::from_corners(viewport.xy(), viewport.xy() + viewport.zw());
        let samples = msaa.samples();
        if let Ok((_, mut known)) = painted.get_mut(entity) {
            known.surfaces.extend(&scratch.painted);
            known.viewport = viewport;
            known.samples = samples;
            known.scene_depth = scene_depth;
        } else {
            commands.entity(entity).insert(ViewSurfaces {
                surfaces: scratch.painted.clone(),
                viewport,
                samples,
                scene_depth,
            });
        }
    }
    // Also of cameras that no longer draw fluids or are inactive.
    for (view, _) in painted.iter().filter(|(_, it)| it.surfaces.is_empty()) {
        commands.entity(view).remove_with_requires::<ViewSurfaces>();
    }
    for (surface, _) in &surfaces {
        if !scratch.seen.contains(&surface) {
            commands.entity(surface).despawn();
        }
    }
    reporter.end(report);
}

/// See [`Surface::clip_from_view`].
fn clip_from_view(view: &ExtractedView, before: Option<&PreviousViewData>) -> [Mat4; 2] {
    let now = view.clip_from_view;
    let before = before.map(|before| {
        // Far from the origin, the two transforms cancel each other out.
        let world_from_view = view.world_from_view.to_matrix().as_dmat4();
        let view_from_view = before.view_from_world.as_dmat4() * world_from_view;
        let clip_from_view: DMat4 = before.clip_from_view.as_dmat4() * view_from_view;
        clip_from_view.as_mat4()
    });
    [now, before.unwrap_or(now)]
}

/// A view's geometry. Everything is relative to the eye: far from the origin, a product of large
/// numbers would lose metres.
struct Eye {
    position: Vec3,
    view_from_eye: Affine3A,
    clip_from_eye: Mat4,
    /// Where all rays come from: for orthographic views far behind.
    rays_from: Vec3,
    /// A scaled camera's metres differ from the world's.
    view_scale: f32,
}

impl Eye {
    fn new(view: &ExtractedView) -> Self {
        let position = view.world_from_view.translation();
        let view_from_eye =
            Affine3A::from_mat3(view.world_from_view.affine().matrix3.inverse().into());
        let orthographic = view.clip_from_view.w_axis.w == 1.0;
        Self {
            position,
            view_from_eye,
            clip_from_eye: match view.clip_from_world {
                Some(clip_from_world) => clip_from_world * Mat4::from_translation(position),
                None => view.clip_from_view * Mat4::from(view_from_eye),
            },
            rays_from: if orthographic {
                view.world_from_view.back() * 1e6
            } else {
                Vec3::ZERO
            },
            view_scale: mean_scale(&view_from_eye.matrix3),
        }
    }

    fn member(&self, entity: Entity, fluid: &ExtractedFluid) -> Member {
        let mut eye_from_local = fluid.transform.affine();
        eye_from_local.translation -= Vec3A::from(self.position);
        let drawn = DrawnFluid {
            entity,
            bulk: fluid.bulk,
            interior: fluid.interior,
            spray: fluid.spray,
            partial: fluid.partial,
        };
        let bounds = fluid.bounds.transformed(&eye_from_local);
        Member::new(drawn, fluid.material, fluid.radius, fluid.sheets, bounds)
    }

    /// Nearest and farthest depth of a box.
    fn depths(&self, bounds: &Bounds) -> Vec2 {
        let in_view = bounds.transformed(&self.view_from_eye);
        let near = (-in_view.max.z).max(0.0);
        vec2(near, (-in_view.min.z).max(near + 1e-6))
    }
}
