//! A pool with waves on it.

use glam::{DVec2, DVec3};

use super::{Crossing, Cuboid, Figure, Nearest, Surface, crossing};
use crate::Ray;

/// A standing sine wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Greatest height above the level, m.
    pub amplitude: f64,
    /// Radians per m along x and z.
    pub wave_vector: DVec2,
    /// Radians at the origin.
    pub phase: f64,
}

/// A box of liquid whose top is a sum of waves.
#[derive(Clone, Debug, PartialEq)]
pub struct RippledPool {
    /// Least corner, m.
    pub min: DVec3,
    /// Greatest corner, m; its y is the mean level.
    pub max: DVec3,
    /// The waves, which must be lower than the pool is deep.
    pub waves: Vec<Wave>,
}

/// A part of the ray this short (m) that may still hold a root is one.
const SHORTEST: f64 = 1e-13;

impl RippledPool {
    /// Height of the top (m) at x and z.
    pub fn height(&self, at: DVec2) -> f64 {
        let waves = self.waves.iter();
        self.max.y + waves.map(|w| w.amplitude * w.angle(at).sin()).sum::<f64>()
    }

    /// Slope of the top along x and z.
    pub fn slope(&self, at: DVec2) -> DVec2 {
        let waves = self.waves.iter();
        waves
            .map(|w| w.amplitude * w.angle(at).cos() * w.wave_vector)
            .sum()
    }

    /// Upward unit normal of the top at x and z.
    pub fn normal(&self, at: DVec2) -> DVec3 {
        let slope = self.slope(at);
        DVec3::new(-slope.x, 1.0, -slope.y).normalize()
    }

    /// Height of a point of the ray above the top, m.
    fn above(&self, ray: &Ray, t: f64) -> f64 {
        let at = ray.at(t);
        at.y - self.height(across(at))
    }

    fn climb(&self, ray: &Ray, t: f64) -> f64 {
        ray.direction.y - self.slope(across(ray.at(t))).dot(across(ray.direction))
    }

    /// All distances in `low..high` where the ray goes through the top, in order.
    ///
    /// Intervals are halved until the bounds of the waves' derivatives prove that there is no
    /// root or that there is at most one: none can be missed.
    fn roots(&self, ray: &Ray, low: f64, high: f64, out: &mut Vec<f64>) {
        let middle = 0.5 * (low + high);
        let half = 0.5 * (high - low);
        let speed = |w: &Wave| w.wave_vector.dot(across(ray.direction)).abs();
        let steepest: f64 = self
            .waves
            .iter()
            .map(|w| w.amplitude.abs() * speed(w))
            .sum();
        let curviest = |w: &Wave| w.amplitude.abs() * speed(w) * speed(w);
        let curviest: f64 = self.waves.iter().map(curviest).sum();
        if self.above(ray, middle).abs() > (steepest + ray.direction.y.abs()) * half {
            return;
        }
        if self.climb(ray, middle).abs() > curviest * half || half < SHORTEST {
            let [start, end] = [low, high].map(|t| self.above(ray, t));
            if (start < 0.0) != (end < 0.0) {
                out.push(self.root(ray, low, high));
            }
            return;
        }
        self.roots(ray, low, middle, out);
        self.roots(ray, middle, high, out);
    }

    /// The one root between two points on different sides: Newton's steps, halving where they
    /// lead outside.
    fn root(&self, ray: &Ray, mut low: f64, mut high: f64) -> f64 {
        let starts_below = self.above(ray, low) < 0.0;
        let mut t = 0.5 * (low + high);
        for _ in 0..100 {
            let value = self.above(ray, t);
            if (value < 0.0) == starts_below {
                low = t;
            } else {
                high = t;
            }
            let newton = t - value / self.climb(ray, t);
            let next = if newton > low && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
            if (next - t).abs() <= 1e-16 * t.abs() {
                return next;
            }
            t = next;
        }
        t
    }

    /// The point of the waves nearest to another: there the normal leads to it.
    fn nearest_on_top(&self, point: DVec3) -> Nearest {
        let mut foot = across(point);
        let mut nearest = Nearest {
            distance: 0.0,
            normal: DVec3::Y,
        };
        for _ in 0..50 {
            let normal = self.normal(foot);
            let from_foot = point - DVec3::new(foot.x, self.height(foot), foot.y);
            let distance = from_foot.dot(normal);
            nearest = Nearest { distance, normal };
            foot = across(point - distance * normal);
        }
        nearest
    }

    /// The box up to above the crests.
    fn hull(&self) -> Cuboid {
        let crest: f64 = self.waves.iter().map(|w| w.amplitude.abs()).sum();
        // Higher than any wave, so that its own top is never met inside.
        Cuboid::between(self.min, self.max + DVec3::Y * (1.01 * crest + 1e-3))
    }
}

impl Surface for RippledPool {
    fn crossings(&self, ray: &Ray, out: &mut Vec<Crossing>) {
        let Some([first, last]) = self.hull().span(ray) else {
            return;
        };
        let starts_below = self.above(ray, first.t) < 0.0;
        out.extend(starts_below.then_some(first));
        let mut roots = Vec::new();
        self.roots(ray, first.t, last.t, &mut roots);
        let mut below = starts_below;
        for t in roots {
            below = !below;
            let top = crossing(ray, t, self.normal(across(ray.at(t))));
            out.push(Crossing {
                entering: below,
                ..top
            });
        }
        out.extend(below.then_some(last));
    }

    fn inside(&self, point: DVec3) -> Option<usize> {
        self.hull()
            .inside(point)
            .filter(|_| point.y < self.height(across(point)))
    }

    fn nearest(&self, point: DVec3) -> Option<Nearest> {
        let top = self.nearest_on_top(point);
        let walls = self.hull().nearest(point)?;
        Some(if top.distance > walls.distance {
            top
        } else {
            walls
        })
    }

    fn figures(&self) -> Vec<Figure> {
        vec![Figure::Pool(self.clone())]
    }
}

impl Wave {
    fn angle(&self, at: DVec2) -> f64 {
        self.wave_vector.dot(at) + self.phase
    }
}

fn across(v: DVec3) -> DVec2 {
    DVec2::new(v.x, v.z)
}
