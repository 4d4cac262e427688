//! Depth layers held against ellipsoids in f64.

use bevy::math::UVec2;
use fluid_stage::TextureData;

use super::{Ellipsoid, Ray, View, pixels};

/// Nothing there, as `types.wgsl` has it.
pub(crate) const NOTHING: [f32; 2] = [0.0, -2.0];
/// The front of a ray that starts in the liquid.
pub(crate) const INSIDE: f32 = 1.0;

/// How much larger or smaller than it is an ellipsoid may look: enough for f32 to round a ray to
/// the other side of a silhouette, where depth jumps.
const PLAY: f64 = 2e-4;

/// Front and back of the union along one ray, as distances from the near plane.
pub(crate) fn union(bodies: &[Ellipsoid], ray: &Ray, scale: f64) -> Option<[f64; 2]> {
    let crossings = bodies
        .iter()
        .filter_map(|body| body.scaled_crossings(ray, scale));
    crossings
        .filter(|[_, back]| *back > 0.0)
        .reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

/// Bodies that miss a pixel's centre are met in their own middle by the pixel that holds it.
fn held(view: &View, bodies: &[Ellipsoid], pixel: UVec2, ray: &Ray) -> Option<[f64; 2]> {
    let held = bodies.iter().filter_map(|body| {
        let center = view.project(body.center())?;
        let holds = (center - View::center(pixel)).abs().max_element() <= 0.5 + PLAY;
        let own = view.ray(center);
        let crossings = body.crossings(&own).filter(|_| holds)?;
        Some(crossings.map(|t| {
            let at = view.unproject(View::center(pixel), view.device(own.at(t)));
            (at - ray.origin).dot(ray.direction)
        }))
    });
    held.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

/// Compares all pixels: depths may be off by `tolerance` (m). The larger the bodies, the nearer
/// their fronts and the farther their backs, so the layers lie between those of slightly larger
/// and of slightly smaller ones.
pub(crate) fn assert_layers(view: &View, got: &TextureData, bodies: &[Ellipsoid], tolerance: f64) {
    let covered = compare_layers(view, got, bodies, tolerance);
    assert!(covered > 20, "too little is seen to tell: {covered} pixels");
}

/// The same where little or nothing may be seen; returns how many pixels are covered.
pub(crate) fn compare_layers(
    view: &View,
    got: &TextureData,
    bodies: &[Ellipsoid],
    tolerance: f64,
) -> usize {
    let mut covered = 0;
    for pixel in pixels(view.size) {
        let [front, back] = got.f32x2(pixel.x, pixel.y);
        let ray = view.ray(View::center(pixel));
        let [larger, smaller] = [1.0 + PLAY, 1.0 - PLAY].map(|scale| union(bodies, &ray, scale));
        let larger = larger.into_iter().chain(held(view, bodies, pixel, &ray));
        let larger = larger.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        if front == NOTHING[0] {
            assert_eq!([front, back], NOTHING, "{pixel}");
            assert!(smaller.is_none(), "{pixel} is covered");
            continue;
        }
        let larger = larger.unwrap_or_else(|| panic!("{pixel} is not covered: {front} {back}"));
        let smaller = smaller.unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
        covered += 1;
        // From depths to distances along the ray.
        let [near, far] = [front, -back].map(|device| {
            let at = view.unproject(View::center(pixel), device);
            (at - ray.origin).dot(ray.direction)
        });
        if front == INSIDE {
            assert!(larger[0] <= tolerance, "{pixel} starts outside");
        } else {
            let range = larger[0] - tolerance..=smaller[0] + tolerance;
            assert!(
                range.contains(&near),
                "{pixel}: front {near} is not in {range:?}"
            );
        }
        let range = smaller[1] - tolerance..=larger[1] + tolerance;
        assert!(
            range.contains(&far),
            "{pixel}: back {far} is not in {range:?}"
        );
    }
    covered
}
