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
