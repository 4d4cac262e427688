//! The columns of a fluid's particles.

use bevy::prelude::*;
use bevy_fluid::{
    FluidPlugin,
    particles::{FluidParticles, ShapedFluid},
};
use fluid_stage::log;

#[test]
fn a_column_of_another_length_is_ignored_and_logged_once() {
    log::listen();
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .add_plugins(FluidPlugin::default());
    app.finish();
    app.cleanup();
    let fluid = FluidParticles {
        ids: vec![1, 2, 3],
        ..FluidParticles::new(vec![Vec3::ZERO, Vec3::X], 0.1)
    };
    let entity = app.world_mut().spawn(fluid).id();
    for _ in 0..3 {
        app.update();
        let mut fluid = app.world_mut().get_mut::<FluidParticles>(entity).unwrap();
        fluid.positions[0].y += 0.1;
    }
    let shaped = app.world().get::<ShapedFluid>(entity).unwrap();
    assert_eq!((shaped.generation(), shaped.spray()), (3, 2));
    let said = format!("fluid {entity}: 2 particles and 3 ids");
    assert_eq!(log::count(&said), 1);
    // Mended and broken again, it is said again.
    for ids in [vec![1, 2], vec![1, 2, 3]] {
        app.world_mut()
            .get_mut::<FluidParticles>(entity)
            .unwrap()
            .ids = ids;
        app.update();
    }
    assert_eq!(log::count(&said), 2);
}
