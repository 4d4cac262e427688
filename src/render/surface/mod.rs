//! Surfaces: fluids of equal material in a view, which are drawn as one. What is known of them
//! before anything is drawn: who belongs together, where they are, what work they need.

pub(crate) mod bounds;
pub(crate) mod fluids;
mod grouping;
pub(crate) mod plan;
mod prepare;
pub(crate) mod reasons;
mod sight;
mod uniforms;
mod variant;
pub(crate) mod views;

use bevy::{
    prelude::*,
    render::{
        ExtractSchedule, Render, RenderApp, RenderStartup, RenderSystems,
        sync_component::SyncComponentPlugin,
    },
    shader::load_shader_library,
};

use self::{
    fluids::extract_fluids,
    reasons::{PlanReports, Waiting},
    views::extract_views,
};
pub(crate) use self::{
    uniforms::{GpuFluid, GpuSurface},
    variant::Variant,
};
use crate::{settings::ScreenSpaceFluid, source::particles::FluidParticles};

/// Texels on each side of a surface's textures that are never drawn to, so that all that reads beyond
/// finds nothing.
pub(crate) const MARGIN: u32 = 2;

/// The steps that prepare surfaces for drawing, in this order, in
/// [`RenderSystems::PrepareResources`]. Bind groups follow in [`RenderSystems::PrepareBindGroups`].
#[derive(SystemSet, Clone, Copy, Debug, Hash, PartialEq, Eq)]
pub(crate) enum SurfaceSystems {
    /// Fluids are grouped to surfaces, and their passes planned.
    Plan,
    /// Stages request the pipelines of the wanted variants.
    Request,
    /// Each surface settles for a variant whose pipelines are compiled.
    Choose,
    /// Stages prepare textures and uniforms for that variant.
    Resources,
}

/// Fluids of equal material in a view: an entity of the render world that lives while it is seen.
///
/// It is known by its view and the first of its fluids. Stages add their components as required
/// components.
#[derive(Component)]
pub struct Surface {
    pub(crate) view: Entity,
    pub(crate) fluids: Vec<DrawnFluid>,
    /// The variant for this frame.
    pub(crate) wanted: Variant,
    /// The variant to draw: the last one whose pipelines are all compiled.
    pub(crate) drawn: Option<Variant>,
    /// Pipelines of the wanted variant that are not there.
    pub(crate) waiting: Option<Waiting>,
    /// The pixels of the view that it may cover.
    pub(crate) rect: URect,
    /// Nearest and farthest depth of its bounding box. Unit: m, in the view.
    pub(crate) depths: Vec2,
    pub(crate) uniform: GpuSurface,
    /// From this frame's view space to the screen, without jitter: of this frame and of the one before.
    /// For motion vectors.
    pub(crate) clip_from_view: Option<[Mat4; 2]>,
}

impl Surface {
    /// The plan that it is drawn by; `None` while its first pipelines are being compiled.
    pub fn plan(&self) -> Option<&plan::Plan> {
        self.drawn.as_ref().map(|variant| &variant.plan)
    }

    /// Whether what is drawn now cannot be drawn to the wanted target: better a slow frame, for the
    /// pipelines that it takes, than one without the liquid.
    pub(crate) fn vanishes(&self) -> bool {
        self.drawn.is_some_and(|drawn| !drawn.fits(&self.wanted))
    }

    /// The pixels of the view, from its upper left, that it may cover.
    pub fn rect(&self) -> URect {
        self.rect
    }
}

/// Which splats of a fluid are drawn: they lie in the order bulk, interior, spray. The first of the
/// bulk and the last of the spray are `partial`: their particles are in the other class as well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DrawnFluid {
    pub(crate) entity: Entity,
    pub(crate) bulk: u32,
    pub(crate) interior: u32,
    pub(crate) spray: u32,
    pub(crate) partial: [u32; 2],
}

/// The surfaces of a view; a view without any lacks this component, and all that stages require
/// with it.
#[derive(Component)]
pub struct ViewSurfaces {
    /// Entities with a [`Surface`], from far to near.
    pub surfaces: Vec<Entity>,
    /// The view's rectangle in the camera's target.
    pub(crate) viewport: URect,
    pub(crate) samples: u32,
    /// Whether the opaque scene's depth is known.
    pub(crate) scene_depth: bool,
}

impl ViewSurfaces {
    /// The view's rectangle in the camera's target. Unit: pixels.
    pub fn viewport(&self) -> URect {
        self.viewport
    }

    /// Whether the scene's depth must be resolved.
    pub(crate) fn resolves_depth(&self) -> bool {
        self.scene_depth && self.samples > 1
    }

    /// Whether surfaces may be seen through each other.
    pub(crate) fn several(&self) -> bool {
        self.surfaces.len() > 1
    }
}

/// Whether plans may leave out unnecessary work, in the render world.
#[derive(Resource, Clone, Copy, Debug)]
pub(crate) struct Shortcuts(pub(crate) bool);

/// `can_draw` tells whether the adapter can draw fluids at all.
pub(crate) fn plugin<M>(app: &mut App, shortcuts: bool, can_draw: impl SystemCondition<M>) {
    load_shader_library!(app, "types.wgsl");
    let reports = PlanReports::default();
    app.insert_resource(reports.clone());
    // Synced components need a renderer, if only to be despawned.
    if app.get_sub_app(RenderApp).is_some() {
        app.add_plugins((
            SyncComponentPlugin::<ScreenSpaceFluid>::default(),
            SyncComponentPlugin::<FluidParticles>::default(),
        ));
        sight::plugin(app);
    }
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .insert_resource(reports)
        .insert_resource(Shortcuts(shortcuts))
        .add_systems(RenderStartup, forget_surfaces)
        .add_systems(ExtractSchedule, (extract_fluids, extract_views))
        .configure_sets(
            Render,
            (
                SurfaceSystems::Plan,
                SurfaceSystems::Request,
                SurfaceSystems::Choose,
                SurfaceSystems::Resources,
            )
                .chain()
                .in_set(RenderSystems::PrepareResources)
                .after(bevy::render::view::prepare_view_uniforms),
        )
        .add_systems(
            Render,
            (
                prepare::prepare_surfaces
                    .in_set(SurfaceSystems::Plan)
                    .run_if(can_draw),
                choose_variants.in_set(SurfaceSystems::Choose),
            ),
        );
}

/// Everything of a lost device is dropped; the next frame makes it anew.
fn forget_surfaces(
    surfaces: Query<Entity, With<Surface>>,
    views: Query<Entity, With<ViewSurfaces>>,
    mut commands: Commands,
) {
    for surface in &surfaces {
        commands.entity(surface).despawn();
    }
    for view in &views {
        commands.entity(view).remove_with_requires::<ViewSurfaces>();
    }
}

/// While the pipelines of the wanted variant are being compiled, a surface is drawn in its last
/// one, so that the liquid does not vanish meanwhile.
fn choose_variants(mut surfaces: Query<&mut Surface>) {
    for mut surface in &mut surfaces {
        let wanted = surface.wanted;
        if surface.waiting.is_none() {
            surface.drawn = Some(wanted);
        } else if surface.vanishes() {
            surface.drawn = None;
        }
    }
}
