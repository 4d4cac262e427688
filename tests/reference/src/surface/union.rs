//! Several bodies as one.

use glam::DVec3;

use super::{Crossing, Figure, Nearest, Sphere, Surface};
use crate::Ray;

/// Bodies that merge where they overlap: only the outermost surface is left.
pub struct Union(pub Vec<Box<dyn Surface>>);

impl Surface for Union {
    fn crossings(&self, ray: &Ray, out: &mut Vec<Crossing>) {
        let start = out.len();
        let mut depth = 0;
        for body in &self.0 {
            let first = out.len();
            body.crossings(ray, out);
            // A body that is left before it is entered holds the start of the line.
            depth += i32::from(out.get(first).is_some_and(|crossing| !crossing.entering));
        }
        keep_outermost(out, start, depth);
    }

    fn inside(&self, point: DVec3) -> Option<usize> {
        self.0.iter().find_map(|body| body.inside(point)).map(|_| 0)
    }

    /// Of the body that is nearest; where bodies overlap, of the one that the point is deepest in.
    fn nearest(&self, point: DVec3) -> Option<Nearest> {
        let known = self.0.iter().filter_map(|body| body.nearest(point));
        known.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    /// Of all bodies but balls that lie in another one; bodies that overlap stay as they are.
    fn figures(&self) -> Vec<Figure> {
        let is_hidden = |figure: &Figure| match figure {
            Figure::Sphere(Sphere { center, radius }) => {
                let holds = |body: &dyn Surface| {
                    let nearest = body.nearest(*center);
                    nearest.is_some_and(|nearest| nearest.distance < -radius)
                };
                // Of itself, it is one radius below the surface, and no more.
                self.0.iter().any(|body| holds(&**body))
            }
            _ => false,
        };
        let figures: Vec<_> = self.0.iter().map(|body| body.figures()).collect();
        if figures.iter().any(Vec::is_empty) {
            return Vec::new();
        }
        let figures = figures.into_iter().flatten();
        figures.filter(|figure| !is_hidden(figure)).collect()
    }
}

/// Sorts the crossings from `start` on and keeps those of the union, as crossings of body 0.
/// `depth`: how many bodies the line is in before the first.
pub(crate) fn keep_outermost(crossings: &mut Vec<Crossing>, start: usize, mut depth: i32) {
    // In before out: bodies that touch are one.
    crossings[start..].sort_by(|a, b| a.t.total_cmp(&b.t).then(b.entering.cmp(&a.entering)));
    let mut kept = start;
    for index in start..crossings.len() {
        let crossing = crossings[index];
        let before = depth;
        depth += if crossing.entering { 1 } else { -1 };
        if before == 0 || depth == 0 {
            crossings[kept] = Crossing {
                body: 0,
                ..crossing
            };
            kept += 1;
        }
    }
    crossings.truncate(kept);
}
