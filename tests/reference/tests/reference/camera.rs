//! The camera against the matrices that Bevy gives the GPU.

use crate::common::Random;
use fluid_reference::{Camera, Lens};
use glam::{DMat4, DVec2, DVec3, UVec2};

const LENSES: [Lens; 3] = [
    Lens::Perspective {
        fov: 0.8,
        near: 0.1,
    },
    Lens::Perspective {
        fov: 2.6,
        near: 3.0,
    },
    Lens::Orthographic {
        height: 4.0,
        near: -1.0,
        far: 20.0,
    },
];

fn cameras() -> impl Iterator<Item = Camera> {
    LENSES.into_iter().map(|lens| {
        Camera::new(UVec2::new(64, 48), lens)
            .looking_at(DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.2, -0.3, 0.1))
    })
}

#[test]
fn pixels_and_depths_are_those_of_the_clip_matrix() {
    let mut random = Random(1);
    for camera in cameras() {
        let clip_from_world = camera.clip_from_view() * DMat4::from(camera.view_from_world());
        for _ in 0..1000 {
            let point = (DVec2::new(random.next(), random.next()) + 1.0) * DVec2::new(32.0, 24.0);
            let ray = camera.ray(point);
            let world = ray.at(random.next() + 1.0);
            let clip = clip_from_world * world.extend(1.0);
            let ndc = clip.truncate() / clip.w;
            let on_screen = (ndc.truncate() * DVec2::new(0.5, -0.5) + 0.5) * DVec2::new(64.0, 48.0);
            assert!(on_screen.distance(point) < 1e-9, "{on_screen} {point}");
            let depth = camera.view_depth(world);
            assert!((camera.device_depth(depth) - ndc.z).abs() < 1e-12);
            assert!((camera.view_from_device(ndc.z) - depth).abs() < 1e-9);
        }
    }
}

#[test]
fn points_come_back_from_the_screen() {
    let mut random = Random(2);
    for camera in cameras() {
        for _ in 0..1000 {
            let world = random.point();
            let Some((point, depth)) = camera.project(world) else {
                panic!("{world} is in front");
            };
            assert!(camera.unproject(point, depth).distance(world) < 1e-12);
        }
    }
    let behind = DVec3::new(1.1, 2.3, 3.3);
    assert!(cameras().next().unwrap().project(behind).is_none());
}

#[test]
fn rays_start_on_the_near_plane() {
    for camera in cameras() {
        let start = camera.pixel_ray(UVec2::new(3, 40)).origin;
        assert!((camera.device_depth(camera.view_depth(start)) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_camera_turns_as_bevy_turns_it() {
    for target in [DVec3::new(0.2, -0.3, 0.1), DVec3::new(1.0, -5.0, 3.0)] {
        let eye = DVec3::new(1.0, 2.0, 3.0);
        let camera = Camera::new(UVec2::ONE, LENSES[0]).looking_at(eye, target);
        let forward = camera.world_from_view.transform_vector3(DVec3::NEG_Z);
        assert!(forward.distance((target - eye).normalize()) < 1e-12);
        let right = camera.world_from_view.transform_vector3(DVec3::X);
        assert!(right.y.abs() < 1e-12);
        // Straight down there is no telling what is right; Bevy takes −z.
        assert!(target.y > -1.0 || right.distance(DVec3::NEG_Z) < 1e-12);
        assert!(camera.world_from_view.matrix3.determinant() > 0.0);
    }
}

#[test]
fn a_pixel_is_as_large_as_the_distance_between_two() {
    for camera in cameras() {
        let [a, b] = [7.5, 8.5].map(|y| camera.unproject(DVec2::new(9.5, y), 4.0));
        assert!((a.distance(b) - camera.pixel_size(4.0)).abs() < 1e-12);
    }
}
