//! Random cameras, projections and ellipsoids: nothing of an ellipsoid lies outside of the quad that
//! bounds it, and its depths are those of geometry.

use std::cell::{Cell, RefCell};

use crate::common::*;
use bevy::{camera::CameraProjection, prelude::*};
use bevy_fluid::{prelude::SurfaceKernel, render::Layers};
use proptest::{prelude::*, test_runner::TestRunner};

/// Any lens at all: of any angle, parallel, off-centre, mirrored, oblique.
fn lenses() -> impl Strategy<Value = Lens> {
    let plain =
        (0.05_f32..2.8, 0.01_f32..1.0).prop_map(|(fov, near)| Lens::Perspective { fov, near });
    let parallel =
        (0.5_f32..20.0, -2.0_f32..2.0, 20.0_f32..50.0).prop_map(|(height, near, depth)| {
            Lens::Orthographic {
                height,
                near,
                far: near + depth,
            }
        });
    let tilt = (-2.0_f32..2.0, -2.0_f32..2.0, 0.3_f32..3.0);
    let any = (
        0.3_f32..2.5,
        tilt,
        -0.8_f32..0.8,
        -0.8_f32..0.8,
        any::<bool>(),
        any::<bool>(),
    );
    let near_is_ahead = "the near plane lies ahead of the eye in every pixel";
    let any = any.prop_filter_map(
        near_is_ahead,
        |(fov, (a, b, near), x, y, mirrored, oblique)| {
            let tilted = vec3(a, b, -1.0).normalize().extend(-near);
            let mut matrix = PerspectiveProjection {
                fov,
                aspect_ratio: 1.0,
                near: 0.1,
                near_clip_plane: if oblique {
                    tilted
                } else {
                    vec4(0.0, 0.0, -1.0, -0.1)
                },
                ..default()
            }
            .get_clip_from_view();
            if !oblique {
                matrix.z_axis.x = x;
                matrix.z_axis.y = y;
            }
            // Where a wide lens sees past a tilted plane, all is nearer than it and there are no rays.
            let over_w = matrix.inverse().row(3);
            let mirror = Mat4::from_scale(vec3(if mirrored { -1.0 } else { 1.0 }, 1.0, 1.0));
            (over_w.z + over_w.w > over_w.x.abs() + over_w.y.abs())
                .then_some(Lens::Matrix(mirror * matrix))
        },
    );
    prop_oneof![2 => plain, 2 => parallel, 3 => any]
}

#[derive(Clone, Debug)]
struct Scene {
    lens: Lens,
    eye: Transform,
    place: Transform,
    positions: Vec<Vec3>,
    spray: bool,
}

fn scenes() -> impl Strategy<Value = Scene> {
    let unit = || -1.0_f32..1.0;
    let vector = move || (unit(), unit(), unit()).prop_map(Vec3::from);
    let axis = || prop_oneof![3 => 0.3_f32..2.0, 1 => 0.02_f32..0.1, 1 => -2.0_f32..-0.3];
    let scale = (axis(), axis(), axis()).prop_map(Vec3::from);
    let turn = (unit(), unit(), unit())
        .prop_map(|(x, y, z)| Quat::from_euler(EulerRot::XYZ, 3.0 * x, 3.0 * y, 3.0 * z));
    let positions = prop::collection::vec(vector(), 1..12);
    let poses = (vector(), turn.clone(), vector(), turn, scale, 0.0_f32..8.0);
    (lenses(), poses, positions, any::<bool>()).prop_map(
        |(lens, (from, look, at, turn, scale, distance), positions, spray)| {
            let eye = Transform::from_translation(3.0 * from).with_rotation(look);
            // Ahead, around the eye, or partly behind it.
            let ahead = eye.rotation * vec3(at.x, at.y, -distance);
            let place = Transform {
                translation: eye.translation + ahead,
                rotation: turn,
                scale,
            };
            Scene {
                lens,
                eye,
                place,
                positions,
                spray,
            }
        },
    )
}

#[test]
fn nothing_of_an_ellipsoid_is_outside_of_its_quad() {
    let view = View::new(
        48,
        Lens::Perspective {
            fov: 0.7,
            near: 0.1,
        },
    );
    let app = RefCell::new(show(&view, RAW, |_| {}));
    let covered = Cell::new(0);
    let mut runner = TestRunner::new(ProptestConfig {
        cases: 150,
        failure_persistence: None,
        // A scene takes a tenth of a second.
        max_shrink_iters: 20,
        ..default()
    });
    let result = runner.run(&scenes(), |scene| {
        let app = &mut *app.borrow_mut();
        let mut view = view;
        (view.lens, view.pose) = (scene.lens, scene.eye);
        let radius = 0.4;
        let kernel: SurfaceKernel = if scene.spray { SPRAY } else { BULK };
        look(app, (view.projection(), view.pose));
        pour(app, (fluid(&scene.positions, radius, kernel), scene.place));
        assert_sound(app);
        let bodies: Vec<_> = scene
            .positions
            .iter()
            .map(|&p| Ellipsoid::new(&view, &scene.place, p, radius))
            .collect();
        if view_surfaces(app).is_none() {
            // Then no pixel's ray may meet any of it.
            for pixel in pixels(view.size) {
                let ray = view.ray(View::center(pixel));
                let met = union(&bodies, &ray, 1.0 - 1e-3);
                prop_assert!(met.is_none(), "{pixel} is covered");
            }
            return Ok(());
        }
        let layers = read(
            app,
            if scene.spray {
                Layers::spray
            } else {
                Layers::bulk
            },
        );
        // 2 mm: silhouettes of discs a centimetre thick are steep.
        covered.set(covered.get() + compare_layers(&view, &layers, &bodies, 2e-3));
        Ok(())
    });
    result.unwrap();
    // Most scenes are in view.
    assert!(covered.get() > 10_000, "{} pixels", covered.get());
}
