//! Glass and transparent objects behind liquid. Bevy draws them after the liquid, whose depth hides
//! them: those behind a surface are drawn before it instead, so that they are seen through it.

use bevy::{
    camera::{MainPassResolutionOverride, Viewport},
    core_pipeline::{
        core_3d::{Transparent3d, TransparentSortingInfo3d},
        oit::OrderIndependentTransparencySettings,
    },
    image::ToExtents,
    pbr::{ScreenSpaceTransmission, Transmissive3d, ViewTransmissionTexture},
    prelude::*,
    render::{
        camera::ExtractedCamera,
        render_phase::{
            DrawFunctions, PhaseItemExtraIndex, RenderCommand, RenderCommandResult,
            SortedPhaseItem, SortedRenderPhase, TrackedRenderPass, ViewSortedRenderPhases,
        },
        render_resource::{CachedRenderPipelineId, RenderPassDescriptor, StoreOp},
        renderer::{RenderContext, ViewQuery},
        view::{ExtractedView, ViewDepthTexture, ViewTarget},
    },
};

use crate::render::surface::{Surface, ViewSurfaces};

/// Items taken out of the phases of the view that is drawn, until both phases are drawn.
#[derive(Resource, Default)]
pub(crate) struct BehindLiquid {
    glass: Taken<Transmissive3d>,
    transparent: Taken<Transparent3d>,
}

/// Items from far to near.
struct Taken<I: SortedPhaseItem> {
    phase: SortedRenderPhase<I>,
    /// For each surface, from far to near, how many lie behind it.
    behind: Vec<usize>,
}

impl<I: SortedPhaseItem> Default for Taken<I> {
    fn default() -> Self {
        Self {
            phase: default(),
            behind: Vec::new(),
        }
    }
}

/// An item whose place in the order is known.
trait Placed: SortedPhaseItem {
    /// z in view space.
    fn z(&self) -> f32;

    /// Whether it only marks where a surface ends.
    fn is_mark(&self) -> bool {
        false
    }
}

impl Placed for Transmissive3d {
    fn z(&self) -> f32 {
        self.distance
    }
}

impl Placed for Transparent3d {
    fn z(&self) -> f32 {
        self.distance
    }

    fn is_mark(&self) -> bool {
        self.pipeline == CachedRenderPipelineId::INVALID
    }
}

impl<I: Placed> Taken<I> {
    /// `surfaces` are the depths from which to which they reach, from far to near.
    fn take(
        &mut self,
        phase: Option<&mut SortedRenderPhase<I>>,
        surfaces: impl Iterator<Item = Vec2> + Clone,
    ) {
        let Some(phase) = phase else {
            return;
        };
        let mut count = 0;
        for (index, depths) in surfaces.clone().enumerate() {
            // Among what is painted already it would be in front of all of it.
            let is_among_painted = |depth: f32| {
                let mut painted = surfaces.clone().take(index);
                painted.any(|of| (of.x..=of.y).contains(&depth))
            };
            let is_behind = |index: usize| {
                phase.items.get_index(index).is_some_and(|(_, item)| {
                    let depth = -item.z();
                    item.is_mark() || depth > depths.y && !is_among_painted(depth)
                })
            };
            // A batch is drawn by its first item, and all at once.
            while let Some((_, item)) = phase.items.get_index(count) {
                let batch = count..count + item.batch_range().len().max(1);
                if !batch.clone().all(is_behind) {
                    break;
                }
                count = batch.end;
            }
            self.behind.push(count);
        }
        self.phase.items.extend(phase.items.drain(..count));
    }

    /// The order is made anew in every frame.
    fn give_back(&mut self, phase: Option<&mut SortedRenderPhase<I>>) {
        self.behind.clear();
        match phase {
            Some(phase) => phase.items.extend(self.phase.items.drain(..)),
            None => self.phase.items.clear(),
        }
    }

    /// The items behind a surface that are not behind the one before; none if all only mark ends.
    fn of(&self, surface: usize) -> core::ops::Range<usize> {
        let end = |index: usize| self.behind.get(index).copied().unwrap_or(0);
        let start = surface.checked_sub(1).map_or(0, end);
        let range = start..end(surface);
        let items = self.phase.items.get_range(range.clone());
        if items.is_some_and(|items| items.values().any(|item| !item.is_mark())) {
            range
        } else {
            start..start
        }
    }
}

/// Stands in the order where a surface ends, so that Bevy joins nothing behind it with things before
/// it in one batch. It draws nothing.
pub(super) struct DrawNothing;

impl RenderCommand<Transparent3d> for DrawNothing {
    type Param = ();
    type ViewQuery = ();
    type ItemQuery = ();

    fn render<'w>(
        _: &Transparent3d,
        (): (),
        _: Option<()>,
        (): (),
        _: &mut TrackedRenderPass<'w>,
    ) -> RenderCommandResult {
        RenderCommandResult::Success
    }
}

/// Where surfaces ended in the last frame; whoever has come between since then waits for a frame.
pub(super) fn mark_ends(
    views: Query<(&ExtractedView, &ViewSurfaces)>,
    surfaces: Query<&Surface>,
    mut phases: ResMut<ViewSortedRenderPhases<Transparent3d>>,
    functions: Res<DrawFunctions<Transparent3d>>,
) {
    let draw_function = functions.read().id::<DrawNothing>();
    for (view, surfaces_of) in &views {
        let Some(phase) = phases.get_mut(&view.retained_view_entity) else {
            continue;
        };
        // Without meshes there is nothing to keep apart, and no pass to draw.
        if phase.items.is_empty() {
            continue;
        }
        for &entity in &surfaces_of.surfaces {
            let Ok(surface) = surfaces.get(entity) else {
                continue;
            };
            let end = vec3(0.0, 0.0, -surface.depths.y);
            phase.add_transient(Transparent3d {
                sorting_info: TransparentSortingInfo3d::Sorted {
                    mesh_center: view.world_from_view.transform_point(end),
                    depth_bias: 0.0,
                },
                distance: 0.0,
                pipeline: CachedRenderPipelineId::INVALID,
                entity: (entity, view.retained_view_entity.main_entity),
                draw_function,
                batch_range: 0..1,
                extra_index: PhaseItemExtraIndex::None,
                indexed: false,
            });
        }
    }
}

pub(crate) fn take_behind(
    view: ViewQuery<(
        &ExtractedView,
        &ViewSurfaces,
        Has<OrderIndependentTransparencySettings>,
    )>,
    surfaces: Query<&Surface>,
    mut glass: ResMut<ViewSortedRenderPhases<Transmissive3d>>,
    mut transparent: ResMut<ViewSortedRenderPhases<Transparent3d>>,
    mut behind: ResMut<BehindLiquid>,
) {
    let (view, surfaces_of, resolves_transparency) = view.into_inner();
    let view = &view.retained_view_entity;
    let depths = surfaces_of.surfaces.iter().filter_map(|&surface| {
        let surface = surfaces.get(surface).ok()?;
        Some(surface.depths)
    });
    behind.glass.take(glass.get_mut(view), depths.clone());
    // Where transparency is independent of order, all of it is resolved at the end.
    if !resolves_transparency {
        behind.transparent.take(transparent.get_mut(view), depths);
    }
}

pub(crate) fn give_back(
    view: ViewQuery<(&ExtractedView, &ViewSurfaces)>,
    mut glass: ResMut<ViewSortedRenderPhases<Transmissive3d>>,
    mut transparent: ResMut<ViewSortedRenderPhases<Transparent3d>>,
    mut behind: ResMut<BehindLiquid>,
) {
    let (view, _) = view.into_inner();
    let view = &view.retained_view_entity;
    behind.glass.give_back(glass.get_mut(view));
    behind.transparent.give_back(transparent.get_mut(view));
}

/// What it takes to draw a view's items.
pub(super) struct ViewItems<'a> {
    pub(super) world: &'a World,
    pub(super) entity: Entity,
    pub(super) camera: &'a ExtractedCamera,
    pub(super) target: &'a ViewTarget,
    pub(super) depth: &'a ViewDepthTexture,
    pub(super) resolution: Option<&'a MainPassResolutionOverride>,
    pub(super) transmission: Option<(&'a ScreenSpaceTransmission, &'a ViewTransmissionTexture)>,
}

impl BehindLiquid {
    /// Draws what lies behind a surface of the view; tells whether there was anything.
    pub(super) fn draw(&self, ctx: &mut RenderContext, view: &ViewItems, surface: usize) -> bool {
        let (glass, transparent) = (self.glass.of(surface), self.transparent.of(surface));
        let something = !glass.is_empty() || !transparent.is_empty();
        // Glass shows what was drawn before it.
        if !glass.is_empty()
            && let (Some(size), Some((settings, copy))) =
                (view.camera.physical_target_size, view.transmission)
            && settings.steps > 0
        {
            ctx.command_encoder().copy_texture_to_texture(
                view.target.main_texture().as_image_copy(),
                copy.texture.as_image_copy(),
                size.to_extents(),
            );
        }
        view.draw(ctx, &self.glass.phase, glass);
        view.draw(ctx, &self.transparent.phase, transparent);
        something
    }
}

impl ViewItems<'_> {
    fn draw<I: SortedPhaseItem>(
        &self,
        ctx: &mut RenderContext,
        phase: &SortedRenderPhase<I>,
        items: core::ops::Range<usize>,
    ) {
        if items.is_empty() {
            return;
        }
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("behind_liquid"),
            color_attachments: &[Some(self.target.get_color_attachment())],
            depth_stencil_attachment: Some(self.depth.get_attachment(StoreOp::Store)),
            ..default()
        });
        let viewport = self.camera.viewport.as_ref();
        if let Some(viewport) = Viewport::from_viewport_and_override(viewport, self.resolution) {
            pass.set_camera_viewport(&viewport);
        }
        if let Err(error) = phase.render_range(&mut pass, self.world, self.entity, items) {
            bevy::utils::once!(error!("an object behind liquid is not drawn: {error:?}"));
        }
    }
}
