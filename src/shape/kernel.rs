//! Settings for the shape of the splats.

use bevy::prelude::{Component, Reflect, ReflectComponent, ReflectDefault};

use crate::settings::{Checked, SettingError, SettingRange, Settings};

/// How the particles of one fluid are classified and shaped into ellipsoids (anisotropic kernels).
///
/// Lengths are in particle radii, so one kernel suits scenes of any scale. The defaults suit
/// particles about two radii apart, as SPH keeps them at rest. Values out of range are logged once
/// and clamped.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone)]
#[require(Checked<Self>)]
pub struct SurfaceKernel {
    /// Distance within which particles are neighbours (R = 2h in the papers).
    ///
    /// Unit: particle radii. Range: 1 to 10. Default: 4, which is 28 neighbours at rest, 32 with those
    /// that count in part.
    /// Higher: smoother shapes, at a cost that grows with the cube.
    /// Lower: every particle keeps more of its own bump; below 3 most are spray.
    #[reflect(@SettingRange::new(1.0, 10.0).unit("radii"))]
    pub neighbor_radius: f32,

    /// Number of neighbours from which a particle is bulk. With three fewer, or none, it is spray; in
    /// between it is drawn as both, one of them smaller, so that it does not pop from one to the other.
    ///
    /// A neighbour at the distance d counts as min(1, 10 (1 − d/R)), R being `neighbor_radius`: whole up
    /// to 0.9 R, in part over the outer tenth. In a sheet of one particle neighbours count for more, as there
    /// are none before and behind it: 5 at its rim are as many as 13.
    ///
    /// Unit: particles. Range: any; 0 makes every particle bulk. Default: 7.
    /// Higher: thin sheets and threads come apart into droplets.
    /// Lower: droplets join the bulk and are smoothed with it.
    #[reflect(@SettingRange::new(0.0, 64.0).unit("particles").open())]
    pub spray_threshold: u32,

    /// Whether splats are stretched and shifted to follow the surface.
    ///
    /// Default: true. False: every splat is a sphere of the particle's radius at the
    /// particle's position; the classes stay as they are.
    pub anisotropic: bool,

    /// How far a splat moves towards the mean of its neighbours (λ of Yu & Turk).
    ///
    /// Unit: none. Range: 0 to 1. Default: 0.9.
    /// Higher: a smoother surface; it also sinks, which `surface_offset` compensates.
    /// Lower: the particles show through as bumps.
    #[reflect(@SettingRange::new(0.0, 1.0))]
    pub center_shift: f32,

    /// How far the splats of particles at a surface move outwards again; at a sheet's rim 0.57 of it.
    ///
    /// Unit: particle radii. Range: 0 to 4. Default: 1.15, which draws flat surfaces where the
    /// outermost particles' own surfaces end, so that liquid touches the walls beside it. 0 (Yu &
    /// Turk): flat surfaces are drawn about that much deeper. Higher: the liquid swells, and gaps
    /// between the outermost particles become pits.
    #[reflect(@SettingRange::new(0.0, 4.0).unit("radii"))]
    pub surface_offset: f32,

    /// Largest ratio of an ellipsoid's longest axis to its shortest (`k_r` of Yu & Turk).
    ///
    /// A sheet of one particle stays as thick as its particles.
    ///
    /// Unit: none. Range: 1 to 16. Default: 4.
    /// Higher: flatter discs, which tile a surface better and stick out more at corners.
    /// Lower: rounder splats; 1 makes all of them spheres, still shifted and scaled.
    #[reflect(@SettingRange::new(1.0, 16.0))]
    pub max_ratio: f32,

    /// Radius of the sphere that has the volume of a fully anisotropic splat.
    ///
    /// Unit: particle radii. Range: 0.1 to 10. Default: 1.24, the volume (2r)³ that a
    /// particle fills at rest.
    /// Higher: neighbours overlap more and holes close, the liquid swells.
    /// Lower: the liquid shrinks and holes open.
    #[reflect(@SettingRange::new(0.1, 10.0).unit("radii").logarithmic())]
    pub radius_scale: f32,

    /// Number of neighbours, as `spray_threshold` counts them, up to which a splat is the unshifted sphere
    /// of radius r.
    ///
    /// Unit: particles. Range: any up to `full_neighbors`. Default: 7, as `spray_threshold`, so that a
    /// particle's two splats are alike while it turns from bulk to spray.
    /// Higher: sparse regions stay spheres. Lower: they stretch.
    #[reflect(@SettingRange::new(0.0, 64.0).unit("particles").open())]
    pub sphere_neighbors: u32,

    /// Number of neighbours, likewise, from which a splat is fully anisotropic.
    ///
    /// Unit: particles. Range: any from `sphere_neighbors`. Default: 13 (`N_ε` = 25 in the paper,
    /// for a wider R). Shape, shift and scale blend smoothly in between.
    /// Higher: a longer blend. Lower: a shorter blend, with visible pops if it is short.
    #[reflect(@SettingRange::new(0.0, 64.0).unit("particles").open())]
    pub full_neighbors: u32,

    /// Whether particles too deep inside to be seen are classified as interior.
    ///
    /// Default: true: they cost no eigen-solve. False: they are bulk.
    pub skip_interior: bool,
}

impl Default for SurfaceKernel {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl SurfaceKernel {
    /// The default.
    pub const DEFAULT: Self = Self {
        neighbor_radius: 4.0,
        spray_threshold: 7,
        anisotropic: true,
        center_shift: 0.9,
        surface_offset: 1.15,
        max_ratio: 4.0,
        radius_scale: 1.24,
        sphere_neighbors: 7,
        full_neighbors: 13,
        skip_interior: true,
    };

    /// As in the thesis: the surface sinks, and hidden interior particles are drawn as well.
    pub const THESIS: Self = Self {
        surface_offset: 0.0,
        skip_interior: false,
        ..Self::DEFAULT
    };

    /// The method before anisotropic kernels: spheres of one class, all of them drawn (thesis 3).
    pub const EARLIER: Self = Self {
        spray_threshold: 0,
        anisotropic: false,
        skip_interior: false,
        ..Self::DEFAULT
    };

    /// For smoke and fire: every particle is a ball of its radius, all of one class.
    ///
    /// Choose a radius of at least the spacing, so that balls overlap, and a correspondingly
    /// thinner medium.
    pub const PUFFS: Self = Self {
        neighbor_radius: 1.0,
        ..Self::EARLIER
    };
}

impl Settings for SurfaceKernel {
    fn mend(&mut self) -> Result<(), SettingError> {
        let [sphere, full] = [self.sphere_neighbors, self.full_neighbors];
        if sphere <= full {
            return Ok(());
        }
        self.sphere_neighbors = full;
        let most = format!("at most `full_neighbors`, {full}");
        let name = "SurfaceKernel::sphere_neighbors";
        Err(SettingError::new(name, sphere, most))
    }
}
