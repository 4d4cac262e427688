//! Cameras.

use bevy::{camera::Hdr, math::bounding::Aabb3d, prelude::*};
use bevy_panorbit_camera::PanOrbitCamera;
/// The systems that move the cameras of [`orbit_camera`], in `PostUpdate`.
pub use bevy_panorbit_camera::PanOrbitCameraSystemSet;

/// From the box towards the eye: from the right and a little above.
const TOWARDS_EYE: Vec3 = Vec3::new(0.45, 0.42, 1.0);
/// Size of the framed part over that of the box.
const MARGIN: f32 = 1.15;

/// A camera at `eye` that looks at `target`; in a window the mouse turns it around the target.
pub fn orbit_camera(eye: Vec3, target: Vec3) -> impl Bundle {
    (
        Camera3d::default(),
        // Else Bevy tone-maps the scene but not the sky behind it.
        Hdr,
        Transform::from_translation(eye).looking_at(target, Vec3::Y),
        // Without a window no plugin moves it, and it is only data.
        PanOrbitCamera {
            focus: target,
            ..default()
        },
    )
}

/// Turns the cameras of [`orbit_camera`] around their targets by an angle (radians), to the right: what
/// the mouse does in a window.
pub fn turn_cameras(world: &mut World, angle: f32) {
    let turn = Quat::from_rotation_y(angle);
    let mut cameras = world.query::<(&mut Transform, &PanOrbitCamera)>();
    for (mut transform, orbit) in cameras.iter_mut(world) {
        transform.rotate_around(orbit.focus, turn);
    }
}

/// The nearest `(eye, target)` in a three-quarter view that shows all of `inside`, with a small
/// margin.
///
/// `fov` is the vertical field of view in radians (as in `PerspectiveProjection`), `aspect` the
/// width over the height of the view.
pub fn frame_camera(inside: Aabb3d, fov: f32, aspect: f32) -> (Vec3, Vec3) {
    let (min, max) = (Vec3::from(inside.min), Vec3::from(inside.max));
    let target = (min + max) / 2.0;
    let half_size = (max - min) / 2.0 * MARGIN;
    let view = Transform::default().looking_to(-TOWARDS_EYE, Vec3::Y);
    let tangent = Vec2::new((fov / 2.0).tan() * aspect, (fov / 2.0).tan());

    let corners = (0..8).map(|corner| {
        let sign = |axis: i32| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
        half_size * Vec3::new(sign(0), sign(1), sign(2))
    });
    let distance = corners
        .map(|corner| {
            let seen = Vec2::new(corner.dot(*view.right()), corner.dot(*view.up())).abs() / tangent;
            seen.max_element() + corner.dot(*view.back())
        })
        .fold(0.0, f32::max);
    (target + view.back() * distance, target)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_turn_around_their_targets() {
        let mut world = World::new();
        let target = Vec3::new(1.0, 0.5, 0.0);
        let camera = world
            .spawn(orbit_camera(Vec3::new(1.0, 0.5, 2.0), target))
            .id();
        let other = world.spawn(Transform::from_xyz(3.0, 0.0, 0.0)).id();
        turn_cameras(&mut world, std::f32::consts::FRAC_PI_2);
        let turned = world.get::<Transform>(camera).unwrap();
        assert!(turned.translation.distance(Vec3::new(3.0, 0.5, 0.0)) < 1e-5);
        assert!(turned.forward().distance(Vec3::NEG_X) < 1e-5);
        let unmoved = world.get::<Transform>(other).unwrap();
        assert_eq!(*unmoved, Transform::from_xyz(3.0, 0.0, 0.0));
    }

    #[test]
    fn every_corner_is_in_view_and_one_nearly_at_the_border() {
        let inside = Aabb3d::new(Vec3::new(3.0, -1.0, 2.0), Vec3::new(2.0, 0.5, 1.0));
        for (fov, aspect) in [(0.8_f32, 1.8), (0.4, 0.5), (1.5, 1.0)] {
            let (eye, target) = frame_camera(inside, fov, aspect);
            let view_from_world = Mat4::look_at_rh(eye, target, Vec3::Y);
            let clip_from_view = Mat4::perspective_rh(fov, aspect, 0.1, 100.0);
            let farthest = (0..8)
                .map(|corner| {
                    let of = |axis| {
                        if corner >> axis & 1 == 0 {
                            inside.min
                        } else {
                            inside.max
                        }
                    };
                    let corner = Vec3::new(of(0).x, of(1).y, of(2).z);
                    (clip_from_view * view_from_world)
                        .project_point3(corner)
                        .truncate()
                        .abs()
                        .max_element()
                })
                .fold(0.0, f32::max);
            assert!((0.75..1.0).contains(&farthest), "{farthest}");
        }
    }
}
