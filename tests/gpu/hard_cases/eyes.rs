//! h15 to h18: where the eye is with respect to the liquid.

use bevy::prelude::*;
use bevy_fluid::{
    prelude::*,
    render::{Layers, SearchStatus},
    settings::Refractions,
};

use super::*;

const RADIUS: f32 = 0.1;
const TRACED: ScreenSpaceFluid = ScreenSpaceFluid {
    refractions: Refractions::Four,
    ..RAW
};

/// A block of 3 m about the origin.
fn block(jitter: f32) -> Vec<Vec3> {
    let size = 15;
    let middle = Vec3::splat(RADIUS * (size - 1) as f32);
    let block = lattice(size, 2.0 * RADIUS, jitter);
    block.iter().map(|p| p - middle).collect()
}

#[test]
fn h15_inside_the_bulk_rays_start_in_liquid() {
    let mut view = View::new(64, PERSPECTIVE);
    let mut app = show(&view, ScreenSpaceFluid::default(), walls);
    let mut random = Random(5);
    for jitter in [0.0, 0.15, 0.3] {
        pour(
            &mut app,
            fluid(&block(jitter), RADIUS, SurfaceKernel::default()),
        );
        // The gaps of a lattice are in the middle of its cells; the rest is anywhere, up to five
        // radii below the outermost particles.
        let corner = Vec3::splat(RADIUS);
        let anywhere = [(); 4].map(|()| (2.0 * random.point() - 1.0) * (14.0 - 5.0) * RADIUS);
        for at in [Vec3::ZERO, corner, corner * vec3(1.0, 1.0, 0.0)]
            .into_iter()
            .chain(anywhere)
        {
            let direction = 2.0 * random.point() - 1.0;
            view.pose = Transform::from_translation(at).looking_to(direction, Vec3::Y);
            look(&mut app, view.pose);
            assert_sound(&app);
            let layers = read(&app, Layers::bulk);
            let outside = layers
                .texels()
                .filter(|&[front, _]: &[f32; 2]| front != INSIDE);
            let holes = layers
                .texels()
                .filter(|&[_, back]: &[f32; 2]| back == NOTHING[1]);
            let [outside, holes] = [outside.count(), holes.count()];
            assert_eq!(
                [outside, holes],
                [0, 0],
                "pixels outside, holes; jitter {jitter}, at {at}"
            );
        }
    }
}

#[test]
fn h16_inside_a_droplet_rays_find_the_far_root() {
    let view = View::new(64, PERSPECTIVE);
    let center = vec3(0.2, -0.1, -0.3);
    let app = show(&view, TRACED, |world| {
        world.spawn(fluid(&[center], 1.0, SPRAY));
    });
    assert_sound(&app);
    let layers = read(&app, Layers::spray);
    assert!(layers.texels().all(|[front, _]: [f32; 2]| front == INSIDE));
    let spheres = Ellipsoid::spheres(&view, &[center], 1.0);
    assert_layers(&view, &layers, &spheres, 1e-3);
    let exits = read(&app, Layers::exits);
    for pixel in pixels(view.size) {
        let exit = Exit::at(&view, &exits, pixel.x, pixel.y).unwrap();
        assert_eq!((exit.searches[0], exit.interfaces), (SearchStatus::Hit, 1));
        let ray = view.ray(View::center(pixel));
        let [_, far] = spheres[0].crossings(&ray).unwrap();
        // The search may stop a fiftieth of the radius before it.
        let apart = exit.position.distance(ray.at(far));
        assert!(apart < 0.02, "{pixel}: {apart} m from the far root");
    }
}

#[test]
fn h17_the_near_plane_cuts_ellipsoids_without_hole_or_flash() {
    // Every step from before the near plane to behind the eye, in both projections.
    let place = Transform::from_rotation(Quat::from_euler(EulerRot::XYZ, 0.4, 0.9, -0.3))
        .with_scale(vec3(0.6, 0.25, 0.4));
    let parallel = Lens::Orthographic {
        height: 2.0,
        near: 0.5,
        far: 12.0,
    };
    for lens in [
        Lens::Perspective {
            fov: 1.2,
            near: 0.5,
        },
        parallel,
    ] {
        let view = View::new(64, lens);
        let mut app = show(&view, RAW, |_| {});
        let mut cut = 0;
        for step in 0..24 {
            let center = vec3(0.1, 0.05, -1.5 + 0.0731 * step as f32);
            let place = Transform {
                translation: center,
                ..place
            };
            pour(&mut app, (fluid(&[Vec3::ZERO], 1.0, SPRAY), place));
            assert_sound(&app);
            if view_surfaces(&app).is_none() {
                assert!(center.z > -0.5, "{center} is in view");
                continue;
            }
            let layers = read(&app, Layers::spray);
            let body = Ellipsoid::new(&view, &place, Vec3::ZERO, 1.0);
            compare_layers(&view, &layers, &[body], 1e-3);
            cut += usize::from(layers.texels().any(|[front, _]: [f32; 2]| front == INSIDE));
        }
        assert!(cut > 5, "{cut} steps are cut");
    }
}

#[test]
fn h18_everything_behind_the_camera_is_culled() {
    let view = View::new(64, PERSPECTIVE);
    let mut app = show(&view, ScreenSpaceFluid::default(), walls);
    let empty = picture(&mut app);
    // Behind the eye, and between the eye and the near plane.
    for (center, radius) in [(vec3(0.0, 0.0, 3.0), 0.1), (vec3(0.0, 0.0, -0.04), 0.01)] {
        let positions: Vec<_> = lattice(4, 2.0 * radius, 0.2)
            .iter()
            .map(|p| center + (p - 3.0 * radius) * if radius < 0.1 { 0.3 } else { 1.0 })
            .collect();
        pour(
            &mut app,
            fluid(&positions, radius, SurfaceKernel::default()),
        );
        assert!(view_surfaces(&app).is_none(), "at {center}");
        assert!(picture(&mut app) == empty, "at {center}");
    }
    // Some behind, one ahead: only that is drawn.
    let ahead = vec3(0.0, 0.0, -4.0);
    let mut app = show(&view, RAW, |_| {});
    let fluid = (&[vec3(0.0, 0.0, 2.0), ahead][..], 0.5, SPRAY);
    assert!(assert_drawn(&view, &mut app, fluid, 1e-3) > 100);
}
