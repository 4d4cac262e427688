//! Rays through the field, step by step.

use super::ImplicitSurface;
use crate::{Crossing, Ray};

/// First step, in shortest semi-axes.
const STEP: f64 = 0.1;
/// Greatest change of a crossing that ends the halving of steps, in particle radii.
const CHANGE: f64 = 1e-3;
/// How often the step is halved at most.
const HALVINGS: u32 = 6;

/// What a march found, and how sure it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Marched {
    /// The crossings from the ray's origin on, in order.
    pub crossings: Vec<Crossing>,
    /// The last step, m.
    pub step: f64,
    /// How far crossings moved in the last halving of the step, in particle radii; infinite if
    /// their number changed.
    pub change: f64,
}

/// The kernels that a ray goes through: from where, to where, which.
type Spans = Vec<([f64; 2], usize)>;

impl ImplicitSurface {
    /// Marches along a ray in steps of a tenth of the shortest semi-axis, closes in on every
    /// change of side by bisection, and halves the step until nothing moves by more than a
    /// thousandth of a particle's radius.
    pub fn march(&self, ray: &Ray) -> Marched {
        let spans = self.spans(ray);
        let mut step = STEP * self.minor;
        let mut crossings = self.march_by(ray, &spans, step);
        let mut change = f64::INFINITY;
        for _ in 0..HALVINGS {
            step *= 0.5;
            let finer = self.march_by(ray, &spans, step);
            change = moved(&crossings, &finer) / self.radius;
            crossings = finer;
            if change < CHANGE {
                break;
            }
        }
        Marched {
            crossings,
            step,
            change,
        }
    }

    fn spans(&self, ray: &Ray) -> Spans {
        let mut spans = Vec::new();
        self.boxes.met(ray, |index| {
            let span = self.items[index].0.span(ray, Self::SUPPORT);
            let ahead = span.filter(|[_, end]| *end > 0.0);
            spans.extend(ahead.map(|[start, end]| ([start.max(0.0), end], index)));
        });
        spans.sort_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]));
        spans
    }

    fn march_by(&self, ray: &Ray, spans: &Spans, step: f64) -> Vec<Crossing> {
        let mut out = Vec::new();
        let Some(&([mut t, _], _)) = spans.first() else {
            return out;
        };
        let mut next = 0;
        let mut active: Spans = Vec::new();
        let mut was_inside = self.field(ray.at(t)) > Self::ISO;
        while next < spans.len() || !active.is_empty() {
            if active.is_empty() {
                // Over the empty space to the next kernel.
                t = t.max(spans[next].0[0]);
            }
            let end = t + step;
            while next < spans.len() && spans[next].0[0] <= end {
                active.push(spans[next]);
                next += 1;
            }
            let above = |t: f64| {
                let point = ray.at(t);
                let sum: f64 = active
                    .iter()
                    .map(|&(_, index)| self.kernel(index, point))
                    .sum();
                sum - Self::ISO
            };
            let is_inside = above(end) > 0.0;
            if is_inside != was_inside {
                let at = bisect(above, t, end);
                let normal = self.normal(active.iter().map(|&(_, index)| index), ray.at(at));
                out.push(Crossing {
                    t: at,
                    normal,
                    entering: is_inside,
                    body: 0,
                });
            }
            was_inside = is_inside;
            t = end;
            active.retain(|([_, end], _)| *end > t);
        }
        out
    }
}

fn bisect(value: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let positive = value(low) > 0.0;
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if (value(middle) > 0.0) == positive {
            low = middle;
        } else {
            high = middle;
        }
    }
}

fn moved(before: &[Crossing], after: &[Crossing]) -> f64 {
    if before.len() != after.len() {
        return f64::INFINITY;
    }
    let pairs = before.iter().zip(after);
    pairs.fold(0.0, |most, (a, b)| most.max((a.t - b.t).abs()))
}
