use super::*;

const DISTANCE: f32 = 10.0;

fn perspective() -> Mat4 {
    Mat4::perspective_infinite_reverse_rh(0.8, 1.5, 0.1)
}

fn eye_at(place: Vec3, target: Vec3, projection: Mat4) -> Eye {
    let pose = Transform::from_translation(place).looking_at(target, Vec3::Y);
    Eye::new(&pose.into(), &projection, DISTANCE, Vec3::Y).unwrap()
}

fn quads(eye: &Eye, clock: &RainClock) -> Vec<GpuQuad> {
    let mut quads = Vec::new();
    let content = Content::Streaks;
    assert!(!add_voxels(
        &mut quads,
        eye,
        clock,
        &LEVELS,
        content,
        DISTANCE,
        |_| true
    ));
    quads
}

/// Cells of individually drawn drops, whose streaks may be 0.3 m long.
fn cells(eye: &Eye, clock: &RainClock) -> Vec<GpuQuad> {
    let mut quads = Vec::new();
    let content = Content::Drops(0.3);
    assert!(!add_voxels(
        &mut quads,
        eye,
        clock,
        &[NEAR_CELLS],
        content,
        DISTANCE,
        |_| true
    ));
    quads
}

/// Every point near the eye and in view lies in exactly one drawn cell; so do the heads of streaks
/// that are below the view.
#[test]
fn cells_of_drops_fill_the_air_near_the_eye() {
    for clock in [
        RainClock::default(),
        RainClock {
            lean: vec2(0.5, -0.3),
            anchor: bevy::math::dvec2(0.2, 7.9),
            height: 3.0,
            ..default()
        },
    ] {
        let place = vec3(0.3, 1.7, -0.2);
        let eye = eye_at(place, place + vec3(1.0, -0.3, -0.5), perspective());
        let cells = cells(&eye, &clock);
        let axis = fall_axis(clock.lean);
        let forward = eye.forward;
        let half = 0.5 * NEAR_CELLS.size;
        let mut checked = 0;
        for i in 0..40_000 {
            let random = |k: u32| (hash([i, k, 5]) >> 8) as f32 / 8_388_608.0 - 1.0;
            let point = vec3(random(0), random(1), random(2)) * 4.0;
            let off = (point - point.dot(axis) * axis).length();
            let ahead = point.dot(forward);
            // A cone within the view.
            if off > NEAR || ahead < 0.92 * point.length() {
                continue;
            }
            checked += 1;
            for head in [point, point - 0.29 * axis] {
                let holding = cells.iter().filter(|cell| {
                    let mut way = head - cell.center;
                    way -= axis / axis.y * way.y;
                    let up = (head - cell.center).y;
                    way.abs().max_element() <= half && up.abs() <= half
                });
                assert_eq!(holding.count(), 1, "{head}");
            }
        }
        assert!(checked > 100, "{checked}");
    }
}

#[test]
fn voxels_are_in_view() {
    let eye = eye_at(vec3(0.3, 1.7, -0.2), vec3(2.0, 1.5, -9.0), perspective());
    let quads = quads(&eye, &RainClock::default());
    assert!(quads.len() > 50 && quads.len() < 2000, "{}", quads.len());
    for quad in &quads {
        assert!(quad.center.dot(eye.forward) > -quad.size);
        assert!(quad.radius <= DISTANCE + quad.size);
    }
}

/// The voxels along a ray add up to its length beyond the individually drawn drops. Counted as in
/// the billboards' shader, over many places of the eye.
#[test]
fn every_ray_goes_through_as_much_rain_as_it_is_long() {
    for (clock, pitch) in [
        (RainClock::default(), 0.0),
        (RainClock::default(), 0.5),
        (
            RainClock {
                lean: vec2(0.4, -0.3),
                ..default()
            },
            0.2,
        ),
    ] {
        let axis = fall_axis(clock.lean);
        let (mut sum, mut wanted, rays) = (0.0, 0.0, 3000);
        for i in 0..rays {
            let random = |k: u32| (hash([i, k, 9]) >> 8) as f32 / 16_777_216.0;
            let place = vec3(random(0), random(1), random(2)) * 16.0;
            let turn = Quat::from_rotation_y(random(3) * core::f32::consts::TAU)
                * Quat::from_rotation_x(pitch);
            let ray = turn * Vec3::NEG_Z;
            let eye = eye_at(place, place + ray, perspective());
            wanted += f64::from(DISTANCE - NEAR / (1.0 - ray.dot(axis).powi(2)).sqrt());
            for quad in quads(&eye, &clock) {
                sum += f64::from(way_in(&quad, ray, axis));
            }
        }
        assert!(
            (sum / wanted - 1.0).abs() < 0.02,
            "pitch {pitch}: {sum} m of {wanted} m"
        );
    }
}

/// Length of a ray from the eye that `billboards.wgsl` counts for a voxel. Unit: m.
fn way_in(quad: &GpuQuad, ray: Vec3, axis: Vec3) -> f32 {
    let across = |way: Vec3| way - way.dot(axis) * axis;
    let normal = across(quad.center).normalize();
    let t = quad.center.dot(normal) / ray.dot(normal);
    if t <= 0.0 {
        return 0.0;
    }
    let hit = ray * t - quad.center;
    let side = axis.cross(quad.center).normalize();
    if hit.dot(side).abs() > 0.5 * quad.size || (hit.dot(axis) * axis.y).abs() > 0.5 * quad.size {
        return 0.0;
    }
    let level = LEVELS[quad.level as usize];
    let steepness = (1.0 - ray.dot(axis).powi(2)).sqrt();
    let distance = t * steepness;
    if !(level.start..level.end).contains(&distance) {
        return 0.0;
    }
    let end = level.end.min(DISTANCE * steepness);
    let half = 0.5 * quad.size;
    let within = |at: f32| ((at + half).min(end) - (at - half).max(level.start)).max(0.0);
    let mirrored = [level.start, level.end].map(|border| within(2.0 * border - distance));
    let part = within(distance) + mirrored[0] + mirrored[1];
    let facing = (distance / quad.radius).min(4.0);
    part * facing * axis.y / steepness
}

#[test]
fn a_jump_of_a_kilometre_is_like_any_other_place() {
    let far = vec3(1000.0, 0.0, -1000.0);
    let here = quads(
        &eye_at(Vec3::ZERO, Vec3::NEG_Z, perspective()),
        &RainClock::default(),
    );
    let there = quads(
        &eye_at(far, far + Vec3::NEG_Z, perspective()),
        &RainClock::default(),
    );
    // 1000 m are whole voxels of every size but the largest, which do not reach this near.
    assert_eq!(here.len(), there.len());
    for quad in &here {
        let same = there.iter().any(|other| {
            other.center.distance(quad.center) < 1e-3
                && (other.tile, other.level) == (quad.tile, quad.level)
        });
        assert!(same, "{quad:?}");
    }
    // Yet the drops differ.
    let shared = here
        .iter()
        .filter(|q| there.iter().any(|o| o.hash == q.hash))
        .count();
    assert!(shared * 10 < here.len(), "{shared} of {}", here.len());
}

#[test]
fn voxels_stand_still_while_the_camera_moves() {
    let clock = RainClock {
        lean: vec2(0.2, 0.1),
        ..default()
    };
    let place = vec3(0.37, 1.6, 0.81);
    let step = vec3(0.05, -0.02, 0.03);
    let before = quads(&eye_at(place, place + Vec3::X, perspective()), &clock);
    let after = quads(
        &eye_at(place + step, place + step + Vec3::X, perspective()),
        &clock,
    );
    let known = after
        .iter()
        .filter(|quad| {
            before.iter().any(|other| {
                other.hash == quad.hash
                    && (other.center - step).distance(quad.center) < 1e-4
                    && other.tile == quad.tile
            })
        })
        .count();
    assert!(10 * known > 9 * after.len(), "{known} of {}", after.len());
}

#[test]
fn an_orthographic_eye_sees_rain_all_over() {
    let projection = Mat4::orthographic_rh(-8.0, 8.0, -5.0, 5.0, 50.0, 0.0);
    let eye = eye_at(vec3(0.0, 2.0, 0.0), vec3(0.0, 1.0, -5.0), projection);
    assert!(!eye.perspective);
    let quads = quads(&eye, &RainClock::default());
    let right = eye.forward.cross(Vec3::Y).normalize();
    let sides: Vec<f32> = quads.iter().map(|quad| quad.center.dot(right)).collect();
    assert!(sides.iter().any(|&x| x < -7.0) && sides.iter().any(|&x| x > 7.0));
    // The view is tilted by a fifth: billboards that lean against its plane may be a little
    // farther.
    assert!(
        quads
            .iter()
            .all(|quad| quad.radius < DISTANCE + 1.5 * quad.size)
    );
}

/// Straight up, individually drawn drops end where they are points.
#[test]
fn steep_views_cost_no_more_the_farther_they_see() {
    let count = |distance: f32| {
        let pose = Transform::default().looking_to(Vec3::Y, Vec3::Z);
        let eye = Eye::new(&pose.into(), &perspective(), distance, Vec3::Y).unwrap();
        let (mut cells, clock) = (Vec::new(), RainClock::default());
        let reach = distance.min(NEAR_REACH);
        let content = Content::Drops(0.3);
        assert!(!add_voxels(
            &mut cells,
            &eye,
            &clock,
            &[NEAR_CELLS],
            content,
            reach,
            |_| true
        ));
        cells.len()
    };
    let (near, far) = (count(NEAR_REACH), count(100.0));
    assert!(near > 1000 && near == far && near < 10_000, "{near}, {far}");
}

#[test]
fn matrices_without_sense_see_nothing() {
    for projection in [Mat4::ZERO, Mat4::from_cols_array(&[f32::NAN; 16])] {
        assert!(Eye::new(&GlobalTransform::IDENTITY, &projection, 5.0, Vec3::Y).is_none());
    }
    let nowhere = GlobalTransform::from_xyz(f32::NAN, 0.0, 0.0);
    assert!(Eye::new(&nowhere, &perspective(), 5.0, Vec3::Y).is_none());
}

#[test]
fn the_number_of_voxels_is_bounded() {
    let projection = Mat4::orthographic_rh(-4000.0, 4000.0, -4000.0, 4000.0, 50.0, 0.0);
    let eye = eye_at(Vec3::ZERO, Vec3::NEG_Z, projection);
    let mut quads = Vec::new();
    let content = Content::Streaks;
    let clock = RainClock::default();
    assert!(add_voxels(
        &mut quads,
        &eye,
        &clock,
        &LEVELS,
        content,
        DISTANCE,
        |_| true
    ));
    assert!(quads.len() <= MAX_QUADS);
}
