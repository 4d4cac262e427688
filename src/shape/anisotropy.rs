//! Neighbourhoods → ellipsoids (Yu & Turk 2013, sections 4 and 5; thesis 4.1).

use std::{array, ops::Range, slice::IterMut};

use bevy::math::Vec3;
use half::{f16, slice::HalfFloatSliceExt};
use wide::f32x8;

use super::{
    CHUNK, Splat, SurfaceKernel,
    classify::{Class, Classes, bulk_weight, scales},
    eigen::{Eigen, eigen},
    grid::Grid,
    neighborhood::Neighborhood,
    splats::{PARTS, Part},
};

/// Ellipsoids made at a time.
const LANES: usize = 8;

/// Trace of the covariance, in R², up to which the neighbours count as one point, which
/// gives no direction, and from which they count as spread out.
const SPREAD: [f32; 2] = [1e-4, 1e-3];

/// Distance of a particle from the mean of its neighbours, in R, up to which it is inside and
/// from which it is at a surface: at most 0.04 one spacing (2 radii) below a flat one, 0.15 to
/// 0.25 at it, for particles moved by up to 0.2 spacings from a lattice.
const SURFACE: [f32; 2] = [0.05, 0.15];

/// How far the splats at a sheet's rim move outwards, as a part of those at a body's surface: they are
/// longer that way.
const RIM_OFFSET: f32 = 0.57;

/// Radius, in particle radii, of the sphere that represents an interior particle. It is visible
/// only to an eye among the particles, where it marks the presence of liquid: it reaches over the
/// gaps between particles (√3 on a lattice, more where they are moved), but not to the surface,
/// which is at least [`SHELL`](super::classify::SHELL) away.
const INTERIOR_RADIUS: f32 = 2.4;

/// f16 rounds the axes by up to 1/2048 and the bounding box must hold them.
const BOX_MARGIN: f32 = 1.001;

/// Corners of a bounding box.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub(super) min: Vec3,
    pub(super) max: Vec3,
}

impl Bounds {
    pub(super) const EMPTY: Self = Self {
        min: Vec3::MAX,
        max: Vec3::MIN,
    };

    fn around(center: Vec3, half_size: Vec3) -> Self {
        Self {
            min: center - half_size,
            max: center + half_size,
        }
    }

    fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }
}

/// Inputs of the splats.
pub(super) struct Splatting<'a> {
    pub(super) grid: &'a Grid,
    pub(super) neighborhoods: &'a [Neighborhood],
    pub(super) classes: &'a Classes,
    pub(super) kernel: &'a SurfaceKernel,
    pub(super) radius: f32,
}

impl Splatting<'_> {
    /// Writes the splats of the chunks into one slice per part and returns their bounds.
    ///
    /// The halves run in parallel. The place of each splat depends on the counts alone, so the
    /// splats are deterministic for any number of threads.
    pub(super) fn splat(&self, chunks: Range<usize>, out: [&mut [Splat]; PARTS]) -> Bounds {
        match chunks.len() {
            0 => return Bounds::EMPTY,
            1 => return self.splat_chunk(chunks.start, out),
            _ => {}
        }
        let middle = chunks.start + chunks.len() / 2;
        let mut rest: [&mut [Splat]; PARTS] = Default::default();
        let mut part = 0;
        let firsts = out.map(|splats| {
            let counts = &self.classes.counts[chunks.start..middle];
            let size = counts.iter().map(|counts| counts[part]).sum();
            let (first, second) = splats.split_at_mut(size);
            rest[part] = second;
            part += 1;
            first
        });
        let (left, right) = rayon::join(
            || self.splat(chunks.start..middle, firsts),
            || self.splat(middle..chunks.end, rest),
        );
        left.union(right)
    }

    fn splat_chunk(&self, chunk: usize, out: [&mut [Splat]; PARTS]) -> Bounds {
        let first = chunk * CHUNK;
        let classes = &self.classes.of[first..self.grid.len().min(first + CHUNK)];
        let mut out = out.map(|splats| splats.iter_mut());
        let mut bounds = Bounds::EMPTY;
        let mut batch = Batch::default();
        let interior_radius = if self.kernel.anisotropic {
            self.kernel.radius_scale.max(INTERIOR_RADIUS) * self.radius
        } else {
            self.radius
        };
        for (sorted, &class) in (first..).zip(classes) {
            let mut sphere = |part: Part, radius: f32| {
                let center = self.grid.position(sorted);
                bounds = bounds.union(Bounds::around(center, Vec3::splat(radius * BOX_MARGIN)));
                if let Some(splat) = out[part as usize].next() {
                    *splat = Splat::sphere(center, radius, self.grid.order[sorted]);
                }
            };
            if class == Class::Interior {
                sphere(Part::Interior, interior_radius);
                continue;
            }
            let weight = self.bulk_weight(sorted);
            let [bulk, spray] = scales(weight);
            if let Some(part) = Part::spray(weight) {
                sphere(part, spray * self.radius);
            }
            if let Some(part) = Part::bulk(weight) {
                if !self.kernel.anisotropic {
                    sphere(part, bulk * self.radius);
                } else if batch.push(sorted) {
                    bounds = bounds.union(self.ellipsoids(&mut batch, &mut out));
                }
            }
        }
        bounds.union(self.ellipsoids(&mut batch, &mut out))
    }

    fn bulk_weight(&self, sorted: usize) -> f32 {
        bulk_weight(
            self.neighborhoods[sorted].crowd(),
            self.kernel.spray_threshold,
        )
    }

    /// Makes a bulk splat of every particle of the batch and empties it.
    fn ellipsoids(&self, batch: &mut Batch, out: &mut [IterMut<Splat>; PARTS]) -> Bounds {
        let lanes = |value: &dyn Fn(&Neighborhood) -> f32| {
            f32x8::new(
                batch
                    .particles
                    .map(|sorted| value(&self.neighborhoods[sorted])),
            )
        };
        let covariance = array::from_fn(|entry| lanes(&|n| n.covariance[entry]));
        let blend = self.blend(
            lanes(&Neighborhood::crowd),
            covariance[0] + covariance[3] + covariance[5],
        );
        let flatness = lanes(&|n| n.flatness);
        let (axes, scale) = self.axes(covariance, blend, flatness);
        let offset = self.kernel.surface_offset * self.radius;
        let distance = lanes(&|n| Vec3::from(n.mean).length());
        // Along the mean: inwards to it, and outwards again by a length that depends on where the
        // surface is, not on how the particle itself lies in it.
        let at_surface = smoothstep(SURFACE[0], SURFACE[1] - SURFACE[0], distance);
        let offset =
            f32x8::splat(offset) * (f32x8::ONE - flatness * f32x8::splat(1.0 - RIM_OFFSET));
        let outwards = offset * at_surface / distance.fast_max(f32x8::splat(1e-6));
        let inwards = f32x8::splat(self.kernel.center_shift * self.reach());
        let shift = blend * (inwards - outwards);

        let mut flat = [0.0; 6 * LANES];
        for (entry, values) in axes.iter().enumerate() {
            for (lane, value) in values.to_array().into_iter().enumerate() {
                flat[lane * 6 + entry] = value;
            }
        }
        let mut halves = [f16::ZERO; 6 * LANES];
        halves.convert_from_f32_slice(&flat);

        let scale = scale.to_array();
        let shift = shift.to_array();
        let mut bounds = Bounds::EMPTY;
        let particles = &batch.particles[..batch.len];
        for (lane, &sorted) in particles.iter().enumerate() {
            let weight = self.bulk_weight(sorted);
            let scale = scale[lane] * scales(weight)[0];
            let mean = Vec3::from(self.neighborhoods[sorted].mean);
            let center = self.grid.position(sorted) + mean * shift[lane];
            let [xx, xy, xz, yy, yz, zz] = array::from_fn(|entry| flat[lane * 6 + entry]);
            let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
            let half_size = Vec3::from(rows.map(|row| Vec3::from(row).length()));
            let half_size = half_size * (scale * BOX_MARGIN);
            bounds = bounds.union(Bounds::around(center, half_size));
            let splat = Part::bulk(weight).and_then(|part| out[part as usize].next());
            if let Some(splat) = splat {
                *splat = Splat {
                    center: center.to_array(),
                    scale,
                    axes: array::from_fn(|entry| halves[lane * 6 + entry]),
                    particle: self.grid.order[sorted],
                };
            }
        }
        batch.len = 0;
        bounds
    }

    /// Weight of the anisotropy: 0 gives the sphere at the particle.
    fn blend(&self, count: f32x8, trace: f32x8) -> f32x8 {
        let [sphere, full] = [self.kernel.sphere_neighbors, self.kernel.full_neighbors];
        let width = full.saturating_sub(sphere).max(1);
        smoothstep(sphere as f32, width as f32, count)
            * smoothstep(SPREAD[0], SPREAD[1] - SPREAD[0], trace)
    }

    /// Symmetric matrices with a largest eigenvalue of 1, and the largest semi-axis (m).
    fn axes(&self, covariance: [f32x8; 6], blend: f32x8, flatness: f32x8) -> ([f32x8; 6], f32x8) {
        let Eigen { values, vectors } = eigen(covariance);
        let largest = values[0].fast_max(values[1]).fast_max(values[2]);
        let per_largest = f32x8::ONE / largest.fast_max(f32x8::splat(f32::MIN_POSITIVE));
        let least = f32x8::splat(1.0 / self.kernel.max_ratio);
        // The eigenvalues themselves, not their roots, and from the sphere by the blend.
        let semi_axes = values.map(|value| {
            let clamped = (value * per_largest).fast_max(least);
            f32x8::ONE - blend + blend * clamped
        });
        let [a, b, c] = semi_axes;
        let growth = f32x8::splat(self.kernel.radius_scale - 1.0);
        let radius = f32x8::splat(self.radius) * (f32x8::ONE + blend * growth);
        let scale = radius / (a * b * c).cbrt();
        // A sheet of one particle is as thick as it, however much its discs overlap.
        let thickness = flatness * (f32x8::splat(self.radius) / scale).fast_min(f32x8::ONE);
        let semi_axes = semi_axes.map(|length| length.fast_max(thickness));
        let mut axes = [f32x8::ZERO; 6];
        for (length, [x, y, z]) in semi_axes.into_iter().zip(vectors) {
            let [lx, ly, lz] = [length * x, length * y, length * z];
            let outer = [lx * x, lx * y, lx * z, ly * y, ly * z, lz * z];
            axes = array::from_fn(|entry| axes[entry] + outer[entry]);
        }
        (axes, scale)
    }

    fn reach(&self) -> f32 {
        self.kernel.neighbor_radius * self.radius
    }
}

/// 0 up to `start`, 1 from `start` + `width`, and smooth in between.
fn smoothstep(start: f32, width: f32, value: f32x8) -> f32x8 {
    let t = (value - f32x8::splat(start)) * f32x8::splat(1.0 / width);
    let t = t.fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
    t * t * (f32x8::splat(3.0) - t - t)
}

/// Bulk particles that wait until there are enough to fill the lanes.
#[derive(Default)]
struct Batch {
    /// Sorted particles; those beyond `len` are left from before and only fill lanes.
    particles: [usize; LANES],
    len: usize,
}

impl Batch {
    /// Adds a particle; true if the batch is full now.
    fn push(&mut self, sorted: usize) -> bool {
        self.particles[self.len] = sorted;
        self.len += 1;
        self.len == LANES
    }
}
