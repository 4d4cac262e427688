//! Forces on a liquid other than pressure and gravity.

use rayon::prelude::*;
use salva3d::{
    TimestepManager,
    geometry::ParticlesContacts,
    object::{Boundary, Fluid},
    solver::NonPressureForce,
};

use super::convert::LiquidVector;

/// Viscosity within the liquid and against walls, and the drag of the air.
///
/// Monaghan's form of the Laplacian (Weiler et al. 2018, equation 5): along the line between two
/// particles, so that linear and angular momentum are kept. salva's own forces are not used: its
/// artificial viscosity resists approach only, and hands walls the sum over neighbours again for
/// each of them.
pub(crate) struct Friction {
    /// Kinematic viscosity, m²/s.
    pub(crate) viscosity: f32,
    /// The same between liquid and walls, m²/s.
    pub(crate) wall: f32,
    /// Share of the velocity lost in a second, 1/s.
    pub(crate) drag: f32,
}

/// 2 (d + 2) in three dimensions.
const DIMENSIONS: f32 = 10.0;
/// Viscosity times step over squared support at which explicit steps begin to oscillate, with
/// a margin.
const STABLE: f32 = 0.02;

impl NonPressureForce for Friction {
    fn solve(
        &mut self,
        timestep: &TimestepManager,
        support: f32,
        liquid_contacts: &ParticlesContacts,
        wall_contacts: &ParticlesContacts,
        fluid: &mut Fluid,
        walls: &[Boundary],
        densities: &[f32],
    ) {
        let rest_density = fluid.density0;
        let (positions, velocities, volumes) =
            (&fluid.positions, &fluid.velocities, &fluid.volumes);
        let most = STABLE * support * support * timestep.inv_dt();
        let [viscosity, wall] = [self.viscosity, self.wall].map(|it| DIMENSIONS * it.min(most));
        let drag = self.drag.min(timestep.inv_dt());
        let softening = 0.01 * support * support;
        let rate = |offset: LiquidVector, velocity: LiquidVector| {
            velocity.dot(&offset) / (offset.norm_squared() + softening)
        };
        fluid
            .accelerations
            .par_iter_mut()
            .enumerate()
            .for_each(|(i, acceleration)| {
                *acceleration -= velocities[i] * drag;
                if viscosity > 0.0
                    && let Ok(contacts) = liquid_contacts.particle_contacts(i).read()
                {
                    for c in contacts.iter().filter(|c| c.i_model == c.j_model) {
                        let rate = rate(
                            positions[i] - positions[c.j],
                            velocities[i] - velocities[c.j],
                        );
                        // By the mean of both densities, so that the forces on both are opposite.
                        let density = 0.5 * (densities[i] + densities[c.j]);
                        let volume = volumes[c.j] * rest_density / density;
                        *acceleration += c.gradient * (viscosity * volume * rate);
                    }
                }
                if wall > 0.0
                    && let Ok(contacts) = wall_contacts.particle_contacts(i).read()
                {
                    for c in contacts.iter() {
                        let boundary = &walls[c.j_model];
                        let rate = rate(
                            positions[i] - boundary.positions[c.j],
                            velocities[i] - boundary.velocities[c.j],
                        );
                        let volume = boundary.volumes[c.j] * rest_density / densities[i];
                        let push = c.gradient * (wall * volume * rate);
                        *acceleration += push;
                        boundary.apply_force(c.j, push * (-volumes[i] * rest_density));
                    }
                }
            });
    }
}
