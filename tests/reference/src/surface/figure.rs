//! Bodies in figures, from which another program can build them anew.

use super::{Cuboid, RippledPool, Sphere};

/// A body of a simple form.
#[derive(Clone, Debug, PartialEq)]
pub enum Figure {
    /// A ball.
    Sphere(Sphere),
    /// A box.
    Cuboid(Cuboid),
    /// A box with waves on it.
    Pool(RippledPool),
}
