//! How far particles have come since the frame before, in the main world.

use bevy::{core_pipeline::prepass::MotionVectorPrepass, prelude::*};

use crate::{
    settings::ScreenSpaceFluid,
    source::particles::{FluidParticles, ShapedFluid},
};

/// The displacements of a fluid's particles; it has them while a camera asks for motion vectors.
#[derive(Component, Default)]
pub(crate) struct Displacements {
    /// Of each particle, in the particles' space. Unit: m; the fourth number is unused. Empty: no
    /// particle has moved, as far as is known.
    pub(super) values: Vec<[f32; 4]>,
    /// The particles when they were shaped last, and which shaping that was.
    positions: Vec<Vec3>,
    ids: Vec<u32>,
    generation: u64,
    /// (id, index) in the order of the ids, unless the particles are in that order.
    sorted: Vec<(u32, u32)>,
}

impl Displacements {
    /// Measures from where the same ids were. Particles that are new, or have no ids, come from where
    /// their velocities say; those without velocities from where they are.
    fn measure(&mut self, particles: &FluidParticles, seconds: f32) {
        let FluidParticles { positions, .. } = particles;
        let velocities = particles.whole_velocities();
        let by_velocity = |i: usize| velocities.get(i).map_or(Vec3::ZERO, |v| *v * seconds);
        let ids = particles.whole_ids();
        let finds = !ids.is_empty() && !self.ids.is_empty();
        if !finds && velocities.is_empty() {
            return;
        }
        self.sort();
        let mut next = 0;
        for (i, &position) in positions.iter().enumerate() {
            let found = if finds { self.find(ids[i], next) } else { None };
            let displacement = found.map_or_else(
                || by_velocity(i),
                |before| {
                    next = before + 1;
                    position - self.positions[before]
                },
            );
            self.values.push(displacement.extend(0.0).to_array());
        }
    }

    fn sort(&mut self) {
        self.sorted.clear();
        if !self.ids.is_sorted() {
            self.sorted.extend(self.ids.iter().copied().zip(0..));
            self.sorted.sort_unstable();
        }
    }

    /// Where an id was, if it was there; probably at `guess`.
    fn find(&self, id: u32, guess: usize) -> Option<usize> {
        if self.ids.get(guess) == Some(&id) {
            return Some(guess);
        }
        if self.sorted.is_empty() {
            return self.ids.binary_search(&id).ok();
        }
        let found = self.sorted.binary_search_by_key(&id, |(id, _)| *id).ok()?;
        Some(self.sorted[found].1 as usize)
    }

    fn remember(&mut self, particles: &FluidParticles, generation: u64) {
        self.generation = generation;
        self.positions.clone_from(&particles.positions);
        self.ids.clear();
        self.ids.extend_from_slice(particles.whole_ids());
    }
}

/// Measures the displacements of all fluids that have been shaped in this frame.
pub(super) fn measure_displacements(
    cameras: Query<&Camera, (With<ScreenSpaceFluid>, With<MotionVectorPrepass>)>,
    mut fluids: Query<(
        Entity,
        &FluidParticles,
        &ShapedFluid,
        Option<&mut Displacements>,
    )>,
    time: Option<Res<Time>>,
    mut commands: Commands,
) {
    let is_asked = cameras.iter().any(|camera| camera.is_active);
    let seconds = time.map_or(0.0, |time| time.delta_secs());
    for (entity, particles, shaped, displacements) in &mut fluids {
        let is_known = is_asked && !shaped.is_stale();
        let generation = shaped.generation();
        match displacements {
            Some(mut displacements) if is_known => {
                displacements.values.clear();
                if displacements.generation != generation {
                    displacements.measure(particles, seconds);
                    displacements.remember(particles, generation);
                }
            }
            None if is_known => {
                let mut displacements = Displacements::default();
                displacements.remember(particles, generation);
                commands.entity(entity).try_insert(displacements);
            }
            // What was in this frame is not known in the next one.
            Some(_) => {
                commands.entity(entity).try_remove::<Displacements>();
            }
            None => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fluid(ids: &[u32], at: f32) -> FluidParticles {
        FluidParticles {
            ids: ids.to_vec(),
            // Each id has a place of its own.
            ..FluidParticles::new(
                ids.iter().map(|&id| vec3(id as f32, at, 0.0)).collect(),
                0.1,
            )
        }
    }

    fn measured(before: &FluidParticles, now: &FluidParticles) -> Vec<Vec3> {
        let mut displacements = Displacements::default();
        displacements.remember(before, 0);
        displacements.measure(now, 0.5);
        let values = displacements.values.iter();
        values.map(|&[x, y, z, _]| vec3(x, y, z)).collect()
    }

    #[test]
    fn particles_are_found_by_their_ids_wherever_they_were() {
        let orders: [(&[u32], &[u32]); 4] = [
            (&[1, 2, 3, 4], &[1, 2, 3, 4]),
            (&[1, 2, 3, 4, 5], &[2, 4, 5]),
            (&[7, 3, 9, 1], &[9, 1, 3, 7]),
            (&[4, 2, 6], &[6, 4]),
        ];
        for (before, now) in orders {
            let found = measured(&fluid(before, 0.0), &fluid(now, 0.25));
            assert_eq!(found, vec![vec3(0.0, 0.25, 0.0); now.len()], "{before:?}");
        }
    }

    #[test]
    fn what_is_not_found_has_moved_by_its_velocity() {
        let mut now = fluid(&[1, 8], 1.0);
        assert_eq!(measured(&fluid(&[1], 0.0), &now), [Vec3::Y, Vec3::ZERO]);
        now.velocities = vec![Vec3::X, Vec3::Z];
        assert_eq!(measured(&fluid(&[1], 0.0), &now), [Vec3::Y, 0.5 * Vec3::Z]);
        now.ids.clear();
        let both = [0.5 * Vec3::X, 0.5 * Vec3::Z];
        assert_eq!(measured(&fluid(&[1], 0.0), &now), both);
        // A column of another length is ignored.
        now.velocities.pop();
        assert!(measured(&fluid(&[1], 0.0), &now).is_empty());
    }
}
