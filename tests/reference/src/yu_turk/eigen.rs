//! Eigenvalues of symmetric matrices.

use glam::{DMat3, DVec3};

/// Eigenvalues in no order and their unit eigenvectors as columns: cyclic Jacobi to the end.
pub(super) fn eigen(mut a: DMat3) -> (DVec3, DMat3) {
    let mut vectors = DMat3::IDENTITY;
    for sweep in 0..50 {
        let rest = a.y_axis.x.abs() + a.z_axis.x.abs() + a.z_axis.y.abs();
        if rest == 0.0 || sweep == 49 {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = a.col(q)[p];
            if off == 0.0 {
                continue;
            }
            let theta = 0.5 * (2.0 * off).atan2(a.col(q)[q] - a.col(p)[p]);
            let (sin, cos) = theta.sin_cos();
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(p)[p] = cos;
            turn.col_mut(q)[q] = cos;
            turn.col_mut(q)[p] = sin;
            turn.col_mut(p)[q] = -sin;
            a = turn.transpose() * a * turn;
            // By construction; rounding leaves a trace.
            a.col_mut(q)[p] = 0.0;
            a.col_mut(p)[q] = 0.0;
            vectors *= turn;
        }
    }
    let values = DVec3::new(a.x_axis.x, a.y_axis.y, a.z_axis.z);
    (values, vectors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn values_and_vectors_make_up_the_matrix() {
        let turn = DMat3::from_quat(DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.1));
        for values in [
            DVec3::new(3.0, 2.0, 1.0),
            DVec3::ONE,
            DVec3::new(1.0, 1.0, 0.0),
            DVec3::new(1e-20, 3e-20, 3e-20),
            DVec3::ZERO,
        ] {
            let matrix = turn * DMat3::from_diagonal(values) * turn.transpose();
            let (found, vectors) = eigen(matrix);
            let scale = values.max_element().max(f64::MIN_POSITIVE);
            let back = vectors * DMat3::from_diagonal(found) * vectors.transpose();
            assert!((back - matrix).abs_diff_eq(DMat3::ZERO, 1e-14 * scale));
            let unit = vectors.transpose() * vectors;
            assert!(unit.abs_diff_eq(DMat3::IDENTITY, 1e-14));
        }
    }
}
