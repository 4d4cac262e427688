//! Eigenvalues and eigenvectors of eight symmetric 3×3 matrices at a time.

use std::array;

use wide::f32x8;

/// Sweeps that reach the precision of f32 from any start: convergence is quadratic.
const SWEEPS: usize = 4;

/// Keeps 0/0 out of the rotations; far below the rounding of entries scaled to 1.
const TINY: f32 = 1e-20;

/// Entries below this count as zero: the next sweep would square them into subnormal
/// numbers, which are a hundred times slower.
const ZERO: f32 = 1e-12;

/// Eigenvalues, in no particular order, and the unit eigenvector of each.
pub(super) struct Eigen {
    pub(super) values: [f32x8; 3],
    pub(super) vectors: [[f32x8; 3]; 3],
}

/// Decomposes the symmetric matrices (xx, xy, xz, yy, yz, zz) by cyclic Jacobi rotations
/// (Golub & Van Loan, Matrix Computations, section 8.5).
///
/// Finite matrices of any scale and rank give finite results, within 2e-6 of the largest
/// entry. Closed forms lose half their digits where eigenvalues nearly coincide, as they do
/// in the middle of a liquid.
pub(super) fn eigen([xx, xy, xz, yy, yz, zz]: [f32x8; 6]) -> Eigen {
    let scale = [xx, xy, xz, yy, yz, zz]
        .map(f32x8::abs)
        .into_iter()
        .fold(f32x8::splat(f32::MIN_POSITIVE), f32x8::fast_max);
    let mut matrix = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(|row| row.map(|a| a / scale));
    let [zero, one] = [f32x8::ZERO, f32x8::ONE];
    let mut vectors = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
    for _ in 0..SWEEPS {
        rotate::<0, 1>(&mut matrix, &mut vectors);
        rotate::<0, 2>(&mut matrix, &mut vectors);
        rotate::<1, 2>(&mut matrix, &mut vectors);
    }
    Eigen {
        values: [0, 1, 2].map(|k| matrix[k][k] * scale),
        vectors,
    }
}

/// Turns axes p and q so that the entry between them becomes zero. Without branches: an
/// entry that is zero already gives the rotation by zero.
#[inline(always)]
fn rotate<const P: usize, const Q: usize>(a: &mut [[f32x8; 3]; 3], vectors: &mut [[f32x8; 3]; 3]) {
    let [p, q, r] = [P, Q, 3 - P - Q];
    let difference = a[q][q] - a[p][p];
    let entry = a[p][q];
    let twice = entry.abs().simd_gt(f32x8::splat(ZERO)) & (entry + entry);
    let hypotenuse = (difference * difference + twice * twice).sqrt();
    let tangent = twice / (difference.abs() + hypotenuse + f32x8::splat(TINY));
    let tangent = difference.simd_lt(f32x8::ZERO).select(-tangent, tangent);
    let cosine = f32x8::ONE / (f32x8::ONE + tangent * tangent).sqrt();
    let sine = tangent * cosine;
    let turn = |u: f32x8, v: f32x8| (cosine * u - sine * v, sine * u + cosine * v);

    let moved = tangent * entry;
    a[p][p] -= moved;
    a[q][q] += moved;
    a[p][q] = f32x8::ZERO;
    a[q][p] = f32x8::ZERO;
    (a[p][r], a[q][r]) = turn(a[p][r], a[q][r]);
    (a[r][p], a[r][q]) = (a[p][r], a[q][r]);
    let [u, v] = [vectors[p], vectors[q]];
    let turned: [_; 3] = array::from_fn(|axis| turn(u[axis], v[axis]));
    vectors[p] = turned.map(|(u, _)| u);
    vectors[q] = turned.map(|(_, v)| v);
}
