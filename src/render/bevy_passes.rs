//! Bevy's own passes, in an order with the composite that Bevy leaves open.

use bevy::{
    app::SubApp,
    core_pipeline::{
        Core3d,
        core_3d::{main_opaque_pass_3d, main_transparent_pass_3d},
        mip_generation::experimental::depth::late_downsample_depth,
    },
    ecs::schedule::{
        InternedSystemSet, IntoSystemSet, NodeId, ScheduleCleanupPolicy, ScheduleGraph, SystemKey,
        graph::Direction,
    },
    pbr::main_transmissive_pass_3d,
    prelude::*,
};

use super::FluidPasses;

/// Call it when all plugins have added their passes.
pub(super) fn order(render_app: &mut SubApp) {
    let mut between: Vec<InternedSystemSet> = Vec::new();
    // First: systems leave the graph when the schedule is built.
    render_app.edit_schedule(Core3d, |schedule| {
        let graph = schedule.graph();
        let passes = between_opaque_and_transparent(graph);
        let systems = passes.filter_map(|pass| graph.systems.get(pass));
        between.extend(systems.flat_map(|it| it.system().default_system_sets()));
    });
    for pass in between {
        render_app.configure_sets(Core3d, FluidPasses::Composite.after(pass));
    }
    keep_liquid_out_of_occlusion_culling(render_app);
}

/// Whatever runs between the opaque and the transparent pass, and not after the composite: Bevy's
/// `render_sky`, which is private and in no set, and passes of others. The liquid is drawn after
/// them, so that it shows them.
fn between_opaque_and_transparent(graph: &ScheduleGraph) -> impl Iterator<Item = SystemKey> {
    let node = |set: InternedSystemSet| graph.system_sets.get_key(set).map(NodeId::Set);
    let opaque = node(main_opaque_pass_3d.into_system_set().intern());
    let transparent = node(main_transparent_pass_3d.into_system_set().intern());
    let transmissive = node(main_transmissive_pass_3d.into_system_set().intern());
    let composite = node(FluidPasses::Composite.intern());
    let (order, members) = (graph.dependency().graph(), graph.hierarchy().graph());
    let not_before: Vec<NodeId> = [composite, transmissive]
        .into_iter()
        .flatten()
        .flat_map(|set| with_what_follows(graph, set))
        .collect();
    opaque
        .into_iter()
        .flat_map(|opaque| order.neighbors_directed(opaque, Direction::Outgoing))
        .filter(move |&pass| {
            transparent.is_some_and(|transparent| order.contains_edge(pass, transparent))
                && !composite.is_some_and(|set| members.contains_edge(set, pass))
                && !not_before.contains(&pass)
        })
        .filter_map(|pass| pass.as_system())
}

/// A set with its members, and all that runs after any of them.
fn with_what_follows(graph: &ScheduleGraph, set: NodeId) -> Vec<NodeId> {
    let (order, members) = (graph.dependency().graph(), graph.hierarchy().graph());
    let mut found = vec![set];
    let mut next = 0;
    while let Some(&node) = found.get(next) {
        next += 1;
        // Sets that hold it are ordered for it, too.
        let mut holders = vec![node];
        let mut holder = 0;
        while let Some(&of) = holders.get(holder) {
            holder += 1;
            holders.extend(members.neighbors_directed(of, Direction::Incoming));
        }
        let later = holders.into_iter().flat_map(|it| order.neighbors(it));
        for node in members.neighbors(node).chain(later) {
            if !found.contains(&node) {
                found.push(node);
            }
        }
    }
    found
}

/// The depth that tells which meshes are hidden in the next frame is taken before the liquid is in
/// it: meshes behind clear water are seen.
fn keep_liquid_out_of_occlusion_culling(render_app: &mut SubApp) {
    let policy = ScheduleCleanupPolicy::RemoveSystemsOnly;
    let moved = render_app.remove_systems_in_set(Core3d, late_downsample_depth, policy);
    let moved = moved.unwrap_or_else(|error| {
        error!("occlusion culling may hide what is behind liquid: {error}");
        0
    });
    if moved > 0 {
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
        let (order, members) = (graph.dependency().graph(), graph.hierarchy().graph());
        let sky: Vec<_> = between_opaque_and_transparent(graph).collect();
        assert_eq!(sky.len(), 1);
        let composite = node(FluidPasses::Composite.intern());
        let is_before = |set| order.contains_edge(set, composite);
        let mut sets = members.neighbors_directed(NodeId::System(sky[0]), Direction::Incoming);
        assert!(sets.any(is_before));
        let occlusion = node(late_downsample_depth.into_system_set().intern());
        assert_eq!(
            members.neighbors(occlusion).count(),
            1,
            "moved, not doubled"
        );
        assert!(
            order.contains_edge(occlusion, composite) || {
                let mut late = members.neighbors(occlusion);
                late.any(is_before)
            }
        );
    }
}
