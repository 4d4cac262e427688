//! What is left out is not missed: pictures with and without.

use bevy_fluid::{
    prelude::{FluidPlugin, SurfaceKernel},
    render::Plan,
};
use image::RgbaImage;

use super::*;

const VIEW: View = View {
    size: uvec2(128, 96),
    lens: Lens::Perspective {
        fov: 0.7,
        near: 0.1,
    },
    pose: Transform::IDENTITY,
};
const RADIUS: f32 = 0.08;

/// A block with droplets about it, in front of a wall and lit from above.
fn scene(world: &mut World, material: FluidMaterial) {
    let block = lattice(8, 2.0 * RADIUS, 0.1);
    let shifted = block.iter().map(|p| p + vec3(-0.56, -0.9, -4.6));
    let drops = [vec3(0.3, 0.7, -4.0), vec3(-0.4, 0.6, -4.2)];
    let particles = FluidParticles::new(shifted.chain(drops).collect(), RADIUS);
    world.spawn((particles, SurfaceKernel::default(), material));
    world.spawn((
        DirectionalLight::default(),
        Transform::default().looking_to(vec3(-0.4, -1.0, -0.6), Vec3::Y),
    ));
    // Behind all of it: rays that go straight look up the picture, others the environment.
    let wall = Transform::from_xyz(0.3, 0.2, -6.0);
    spawn_box(world, vec3(8.0, 8.0, 0.1), wall);
}

/// The picture and the plan with shortcuts and without.
fn both(material: FluidMaterial) -> [(RgbaImage, Plan); 2] {
    [true, false].map(|shortcuts| {
        let plugin = FluidPlugin {
            shortcuts,
            ..default()
        };
        let mut app = show_with(plugin, &VIEW, ScreenSpaceFluid::default(), |world| {
            scene(world, material);
        });
        furnace(&mut app, 0.4 * white());
        (capture(&mut app).unwrap(), *surface(&app).0.plan().unwrap())
    })
}

/// The share of pixels with a channel that differs by more than `steps` of 255.
fn share(a: &RgbaImage, b: &RgbaImage, steps: u8) -> f64 {
    assert_eq!(a.dimensions(), b.dimensions());
    let differ = |(a, b): &(&image::Rgba<u8>, &image::Rgba<u8>)| {
        a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > steps)
    };
    let pairs = a.pixels().zip(b.pixels());
    pairs.filter(differ).count() as f64 / (a.width() * a.height()) as f64
}

#[test]
fn an_opaque_medium_needs_neither_back_layers_nor_search() {
    let [(quick, plan), (whole, traced)] = both(FluidMaterial::MILK);
    assert!(plan.opaque && !plan.backs() && plan.interfaces == 1);
    assert!(!traced.opaque && traced.backs() && traced.interfaces == 4);
    // A particle of milk of 8 cm lets nothing through. Only where a search finds the liquid thinner
    // than can be told, at a rim, does a pixel in ten thousand.
    let differ = share(&quick, &whole, 1);
    println!("opaque: {differ} of the pixels differ by more than 1/255");
    assert!(differ < 3e-4, "{differ}");
    let white = quick.pixels().filter(|p| p.0[..3].iter().all(|&c| c > 100));
    assert!(white.count() > 1000, "the milk is in the picture");
}

#[test]
fn refractive_index_one_needs_no_search() {
    let fog = Medium::scattering(LinearRgba::WHITE, 0.5)
        + Medium::absorbing(LinearRgba::rgb(0.3, 0.6, 0.9), 1.0)
        + Medium::emitting(LinearRgba::rgb(0.1, 0.02, 0.01) * white(), 1.0);
    let [(quick, plan), (whole, traced)] = both(unbent(fog));
    assert!(plan.index_one && !traced.index_one);
    // The search stops a fiftieth of a radius early, some millimetres; only at the block's rim,
    // where a ray leaves the layer and comes back, may the two ways through differ.
    let (small, large) = (share(&quick, &whole, 3), share(&quick, &whole, 24));
    println!("index 1: {small} of the pixels differ by more than 3/255, {large} by more than 24");
    assert!(small < 0.03 && large < 0.005, "{small} {large}");
}

#[test]
fn terms_that_are_zero_need_no_code() {
    for medium in [
        Medium::CLEAR,
        Medium::scattering(LinearRgba::BLACK, 1.0),
        Medium::emitting(LinearRgba::rgb(0.1, 0.2, 0.3) * white(), 1.0),
    ] {
        let material = FluidMaterial {
            medium,
            ..FluidMaterial::CLEAR_WATER
        };
        let [(quick, plan), (whole, traced)] = both(material);
        assert_ne!(plan.terms, traced.terms);
        // Two programs may round the same sum differently.
        assert_eq!(share(&quick, &whole, 1), 0.0, "{medium:?}");
    }
}
