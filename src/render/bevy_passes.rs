//! Bevy's own passes, in an order with the composite that Bevy leaves open.

use bevy::{
    app::SubApp,
    core_pipeline::{
        Core3d,
        core_3d::{main_opaque_pass_3d, main_transparent_pass_3d},
        mip_generation::experimental::depth::late_downsample_depth,
    },
    ecs::schedule::{
        InternedSystemSet, IntoSystemSet, NodeId, ScheduleCleanupPolicy, ScheduleGraph,
        graph::Direction,
    },
    pbr::main_transmissive_pass_3d,
    prelude::*,
};

use super::FluidPasses;

/// Call it when all plugins have added their passes.
pub(super) fn order(render_app: &mut SubApp) {
    keep_liquid_out_of_occlusion_culling(render_app);
    let mut between = Vec::new();
    render_app.edit_schedule(Core3d, |schedule| {
        between = between_opaque_and_transparent(schedule.graph());
    });
    for pass in between {
        render_app.configure_sets(Core3d, FluidPasses::Composite.after(pass));
    }
}

/// Whatever runs between the opaque and the transparent pass, but in no order with the composite:
/// Bevy's `render_sky`, which is private and in no set, and passes of others. The liquid is drawn
/// after them, so that it shows them.
fn between_opaque_and_transparent(graph: &ScheduleGraph) -> Vec<InternedSystemSet> {
    let node = |set: InternedSystemSet| graph.system_sets.get_key(set).map(NodeId::Set);
    let (Some(opaque), Some(transparent), Some(composite)) = (
        node(main_opaque_pass_3d.into_system_set().intern()),
        node(main_transparent_pass_3d.into_system_set().intern()),
        node(FluidPasses::Composite.intern()),
    ) else {
        return Vec::new();
    };
    let transmissive = main_transmissive_pass_3d.into_system_set().intern();
    let dependencies = graph.dependency().graph();
    dependencies
        .neighbors_directed(opaque, Direction::Outgoing)
        .filter(|&pass| {
            dependencies.contains_edge(pass, transparent)
                && !dependencies.contains_edge(pass, composite)
                && !dependencies.contains_edge(composite, pass)
        })
        .filter_map(|pass| graph.systems.get(pass.as_system()?))
        .flat_map(|pass| pass.system().default_system_sets())
        .filter(|&set| set != transmissive)
        .collect()
}

/// The depth that tells which meshes are hidden in the next frame is taken before the liquid is in
/// it: meshes behind clear water are seen.
fn keep_liquid_out_of_occlusion_culling(render_app: &mut SubApp) {
    let policy = ScheduleCleanupPolicy::RemoveSystemsOnly;
    let moved = render_app.remove_systems_in_set(Core3d, late_downsample_depth, policy);
    if moved.is_ok_and(|systems| systems > 0) {
        render_app.add_systems(
            Core3d,
            late_downsample_depth
                .after(main_opaque_pass_3d)
                .before(FluidPasses::Composite),
        );
    }
}

#[cfg(all(test, feature = "published"))]
mod tests {
    use bevy::{ecs::schedule::Schedules, render::RenderApp};
    use fluid_stage::headless_app;

    use super::*;
    use crate::FluidPlugin;

    /// Bevy's own, without naming it: it is private.
    #[test]
    fn the_sky_is_drawn_before_the_liquid() {
        let app = headless_app(UVec2::splat(16), |app| {
            app.add_plugins(FluidPlugin::default());
        })
        .unwrap();
        let world = app.sub_app(RenderApp).world();
        let schedules = world.resource::<Schedules>();
        let graph = schedules.get(Core3d).unwrap().graph();
        let node = |set| NodeId::Set(graph.system_sets.get_key(set).unwrap());
        let between = between_opaque_and_transparent(graph);
        assert_eq!(between.len(), 1, "{between:?}");
        let edges = graph.dependency().graph();
        assert!(edges.contains_edge(node(between[0]), node(FluidPasses::Composite.intern())));
        let occlusion = node(late_downsample_depth.into_system_set().intern());
        let late: Vec<_> = graph.hierarchy().graph().neighbors(occlusion).collect();
        assert_eq!(late.len(), 1, "it was moved, not doubled");
    }
}
