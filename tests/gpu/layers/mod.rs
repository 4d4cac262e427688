//! Splats → depth layers, held against ellipsoids in f64.

mod equal;

use crate::common::*;
use bevy::{prelude::*, render::render_resource::Texture};
use bevy_fluid::{prelude::SurfaceKernel, render::Layers};

const PERSPECTIVE: Lens = Lens::Perspective {
    fov: 0.7,
    near: 0.1,
};
const PARALLEL: Lens = Lens::Orthographic {
    height: 4.0,
    near: 0.0,
    far: 12.0,
};
const LENSES: [Lens; 2] = [PERSPECTIVE, PARALLEL];

fn bulk_and_spray() -> [(SurfaceKernel, fn(&Layers) -> Option<&Texture>); 2] {
    [(BULK, Layers::bulk), (SPRAY, Layers::spray)]
}

fn scattered(count: usize, center: Vec3, spread: f32) -> Vec<Vec3> {
    let mut random = Random(7);
    (0..count)
        .map(|_| center + spread * (2.0 * random.point() - 1.0))
        .collect()
}

#[test]
fn one_sphere_is_met_where_geometry_says() {
    let mut view = View::new(96, PERSPECTIVE);
    let mut app = show(&view, RAW, |_| {});
    for lens in LENSES {
        view.lens = lens;
        look(&mut app, view.projection());
        // In the middle, and cut by the corner of the view.
        for center in [vec3(0.0, 0.0, -6.0), vec3(1.6, -1.7, -5.0)] {
            for (kernel, layers) in bulk_and_spray() {
                pour(&mut app, fluid(&[center], 1.0, kernel));
                let bodies = Ellipsoid::spheres(&view, &[center], 1.0);
                assert_layers(&view, &read(&app, layers), &bodies, 1e-3);
            }
        }
    }
}

#[test]
fn overlapping_spheres_keep_the_nearest_front_and_the_farthest_back() {
    let positions = scattered(300, vec3(0.2, 0.1, -6.0), 1.5);
    let radius = 0.3;
    let mut view = View::new(96, PERSPECTIVE);
    // Looked at from aside, so that no axis is special.
    view.pose = Transform::from_xyz(2.0, 3.0, -2.0).looking_at(positions[0], Vec3::Y);
    let mut app = show(&view, RAW, |_| {});
    for lens in LENSES {
        view.lens = lens;
        look(&mut app, view.projection());
        for (kernel, layers) in bulk_and_spray() {
            pour(&mut app, fluid(&positions, radius, kernel));
            let bodies = Ellipsoid::spheres(&view, &positions, radius);
            assert_layers(
                &view,
                &read(&app, layers),
                &bodies,
                1e-3 * f64::from(radius),
            );
        }
    }
}

#[test]
fn a_scaled_and_turned_fluid_has_ellipsoids() {
    let mut view = View::new(96, PERSPECTIVE);
    let positions = scattered(8, Vec3::ZERO, 1.0);
    let place = Transform {
        translation: vec3(0.0, 0.2, -6.0),
        rotation: Quat::from_euler(EulerRot::XYZ, 0.4, 0.9, -0.3),
        scale: vec3(2.0, 0.3, 0.9),
    };
    let mut app = show(&view, RAW, |world| {
        world.spawn((fluid(&positions, 0.5, BULK), place));
    });
    for lens in LENSES {
        view.lens = lens;
        look(&mut app, view.projection());
        let bodies: Vec<_> = positions
            .iter()
            .map(|&p| Ellipsoid::new(&view, &place, p, 0.5))
            .collect();
        assert_layers(&view, &read(&app, Layers::bulk), &bodies, 0.5e-3);
    }
}

#[test]
fn a_thousand_radii_away_spheres_keep_their_shape() {
    let center = vec3(0.0, 0.0, -1e3);
    // Some fifty pixels across, in both projections.
    let lenses = [
        Lens::Perspective {
            fov: 4e-3,
            near: 0.1,
        },
        Lens::Orthographic {
            height: 4.0,
            near: 0.0,
            far: 2e3,
        },
    ];
    let mut view = View::new(96, lenses[0]);
    view.pose = Transform::from_xyz(100.0, 70.0, 30.0);
    let center = view.pose.translation + center + vec3(0.3, -0.2, 0.0);
    let mut app = show(&view, RAW, |world| {
        world.spawn(fluid(&[center], 1.0, SPRAY));
    });
    for lens in lenses {
        view.lens = lens;
        look(&mut app, view.projection());
        let bodies = Ellipsoid::spheres(&view, &[center], 1.0);
        assert_layers(&view, &read(&app, Layers::spray), &bodies, 1e-3);
    }
}

#[test]
fn a_sphere_cut_by_the_near_plane_shows_its_inside() {
    for lens in [
        Lens::Perspective {
            fov: 1.2,
            near: 0.8,
        },
        Lens::Orthographic {
            height: 2.0,
            near: 0.8,
            far: 12.0,
        },
    ] {
        let view = View::new(96, lens);
        // From behind the near plane to before it.
        let center = vec3(0.3, 0.2, -0.9);
        let app = show(&view, RAW, |world| {
            world.spawn(fluid(&[center], 0.5, SPRAY));
        });
        let layers = read(&app, Layers::spray);
        let inside = layers
            .texels()
            .filter(|&[front, _]: &[f32; 2]| front == INSIDE);
        assert!(inside.count() > 100);
        let bodies = Ellipsoid::spheres(&view, &[center], 0.5);
        assert_layers(&view, &layers, &bodies, 0.5e-3);
    }
}

#[test]
fn from_inside_every_pixel_has_the_far_surface() {
    let view = View::new(64, PERSPECTIVE);
    let center = vec3(0.2, -0.1, 0.3);
    for (kernel, layers) in bulk_and_spray() {
        let app = show(&view, RAW, |world| {
            world.spawn(fluid(&[center], 2.0, kernel));
        });
        let layers = read(&app, layers);
        assert!(layers.texels().all(|[front, _]: [f32; 2]| front == INSIDE));
        assert_layers(
            &view,
            &layers,
            &Ellipsoid::spheres(&view, &[center], 2.0),
            2e-3,
        );
    }
}

#[test]
fn nothing_behind_the_camera_is_drawn() {
    let view = View::new(64, PERSPECTIVE);
    // The second is ahead, so that the body is not left out altogether.
    let [behind, ahead] = [vec3(0.0, 0.0, 2.0), vec3(0.0, 0.0, -5.0)];
    let app = show(&view, RAW, |world| {
        world.spawn(fluid(&[behind, ahead], 0.5, SPRAY));
    });
    let bodies = Ellipsoid::spheres(&view, &[ahead], 0.5);
    assert_layers(&view, &read(&app, Layers::spray), &bodies, 0.5e-3);
    let app = show(&view, RAW, |world| {
        world.spawn(fluid(&[behind], 0.5, SPRAY));
    });
    assert!(view_surfaces(&app).is_none());
}

#[test]
fn the_sprays_normals_are_its_spheres() {
    for lens in LENSES {
        let view = View::new(96, lens);
        let center = vec3(0.5, -0.4, -5.0);
        let app = show(&view, RAW, |world| {
            world.spawn(fluid(&[center], 1.0, SPRAY));
        });
        let normals = read(&app, Layers::spray_normals);
        let [sphere] = Ellipsoid::spheres(&view, &[center], 1.0)[..] else {
            unreachable!("one particle");
        };
        let mut seen = 0;
        for pixel in pixels(view.size) {
            let ray = view.ray(View::center(pixel));
            let Some(crossings) = sphere.crossings(&ray) else {
                continue;
            };
            let normal = crossings.map(|t| sphere.normal(ray.at(t)));
            // Within some pixels of the silhouette the normal turns by degrees a pixel.
            if normal[0].dot(ray.direction) > -0.1 {
                continue;
            }
            seen += 1;
            let [fx, fy, bx, by] = normals.f16x4(pixel.x, pixel.y);
            // Two halves have 11 bits each: 0.05°. The rest is for rounding near the silhouette.
            let front = angle(decode_normal([fx, fy]), normal[0]);
            let back = angle(-decode_normal([bx, by]), normal[1]);
            assert!(front < 0.2 && back < 0.2, "{pixel}: {front}° {back}°");
        }
        assert!(seen > 500, "{seen}");
    }
}

#[test]
fn bulk_and_spray_go_to_their_own_layers() {
    let view = View::new(96, PERSPECTIVE);
    let radius = 0.1;
    let cluster: Vec<_> = lattice(6, 2.0 * radius, 0.2)
        .iter()
        .map(|p| p + vec3(-1.0, -0.5, -5.0))
        .collect();
    let droplet = vec3(0.9, 0.6, -4.5);
    // The least of the cluster's corners has four neighbours.
    let kernel = SurfaceKernel {
        spray_threshold: 2,
        ..BULK
    };
    let all = [&cluster[..], &[droplet]].concat();
    let app = show(&view, RAW, |world| {
        world.spawn(fluid(&all, radius, kernel));
    });
    let [bulk, spray] = [&cluster[..], &[droplet]].map(|p| Ellipsoid::spheres(&view, p, radius));
    assert_layers(&view, &read(&app, Layers::bulk), &bulk, 1e-4);
    assert_layers(&view, &read(&app, Layers::spray), &spray, 1e-4);
}

#[test]
fn a_wall_hides_fronts_but_keeps_backs() {
    let view = View::new(64, PERSPECTIVE);
    let center = vec3(0.0, 0.0, -6.0);
    for msaa in [Msaa::Off, Msaa::Sample4] {
        let mut app = show(&view, RAW, |world| {
            world.spawn(fluid(&[center], 1.0, SPRAY));
            // Before the left half.
            spawn_box(
                world,
                vec3(4.0, 8.0, 0.2),
                Transform::from_xyz(-2.0, 0.0, -3.0),
            );
        });
        look(&mut app, msaa);
        let layers = read(&app, Layers::spray);
        let row = |x: u32| layers.f32x2(x, 32);
        let [hidden, open] = [row(28), row(36)];
        assert_eq!(hidden[0], NOTHING[0]);
        assert!(open[0] > 0.0);
        // The wall's edge passes through the middle: left and right mirror each other.
        let mirrored = row(63 - 28)[1];
        assert!(
            (hidden[1] - mirrored).abs() < 1e-6 * mirrored.abs(),
            "{hidden:?} {mirrored}"
        );
    }
}
