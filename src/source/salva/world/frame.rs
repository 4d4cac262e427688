//! A finished state, as it is handed to the main world.

use bevy::prelude::*;

use super::Id;

/// Where everything is at a moment. Its buffers are filled again.
#[derive(Default)]
pub(crate) struct Frame {
    /// Simulated seconds since the world was made.
    pub(crate) time: f64,
    /// How many commands the world had applied.
    pub(crate) applied: u64,
    pub(crate) liquids: Vec<LiquidFrame>,
    pub(crate) bodies: Vec<(Id, Isometry3d)>,
    /// Loads of the liquid on solids: force (N) and torque (N m), means over the job.
    pub(crate) loads: Vec<(Id, Vec3, Vec3)>,
}

/// One fluid of a frame.
#[derive(Default)]
pub(crate) struct LiquidFrame {
    pub(crate) id: Id,
    /// Ascending names of the particles.
    pub(crate) ids: Vec<u32>,
    /// World space, m.
    pub(crate) positions: Vec<Vec3>,
    /// World space, m/s.
    pub(crate) velocities: Vec<Vec3>,
}

impl LiquidFrame {
    fn carry(&mut self, way: &Isometry3d) {
        for position in &mut self.positions {
            *position = *way * *position;
        }
        for velocity in &mut self.velocities {
            *velocity = way.rotation * *velocity;
        }
    }
}

impl Frame {
    pub(crate) fn liquid(&self, id: Id) -> Option<&LiquidFrame> {
        self.liquids.iter().find(|liquid| liquid.id == id)
    }

    /// The world is shifted.
    pub(crate) fn shift(&mut self, by: Vec3) {
        let way = Isometry3d::from_translation(by);
        for liquid in &mut self.liquids {
            liquid.carry(&way);
        }
        for (_, at) in &mut self.bodies {
            at.translation += way.translation;
        }
    }

    /// A fluid's particles are moved.
    pub(crate) fn carry(&mut self, id: Id, way: &Isometry3d) {
        if let Some(liquid) = self.liquids.iter_mut().find(|liquid| liquid.id == id) {
            liquid.carry(way);
        }
    }

    pub(crate) fn body(&self, id: Id) -> Option<Isometry3d> {
        let found = self.bodies.iter().find(|(other, _)| *other == id);
        found.map(|(_, at)| *at)
    }
}

/// Interpolated positions and velocities of the particles of `to`, a `share` of the way from `from`
/// to it. New ones are as they are in `to`; those that have gone are left out.
pub(crate) fn blend<'a>(
    from: Option<&'a LiquidFrame>,
    to: &'a LiquidFrame,
    share: f32,
) -> impl Iterator<Item = (Vec3, Vec3)> + 'a {
    let mut next = 0;
    let ends = to.positions.iter().zip(&to.velocities);
    to.ids
        .iter()
        .zip(ends)
        .map(move |(id, (&place, &velocity))| {
            let start = from.and_then(|from| {
                while from.ids.get(next).is_some_and(|before| before < id) {
                    next += 1;
                }
                from.ids.get(next).filter(|before| *before == id)?;
                Some((*from.positions.get(next)?, *from.velocities.get(next)?))
            });
            start.map_or((place, velocity), |(from, before)| {
                (from.lerp(place, share), before.lerp(velocity, share))
            })
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(ids: &[u32], x: f32) -> LiquidFrame {
        LiquidFrame {
            id: 0,
            ids: ids.to_vec(),
            positions: ids.iter().map(|&id| vec3(x, id as f32, 0.0)).collect(),
            velocities: vec![Vec3::X * x; ids.len()],
        }
    }

    #[test]
    fn particles_are_matched_by_name() {
        let (from, to) = (frame(&[1, 2, 5, 6], 0.0), frame(&[2, 6, 7, 9], 4.0));
        let blended: Vec<_> = blend(Some(&from), &to, 0.25).collect();
        let expected = [(1.0, 2.0), (1.0, 6.0), (4.0, 7.0), (4.0, 9.0)];
        assert_eq!(
            blended,
            expected.map(|(x, y)| (vec3(x, y, 0.0), Vec3::X * x))
        );
        let alone: Vec<_> = blend(None, &to, 0.25).map(|(place, _)| place).collect();
        assert_eq!(alone, to.positions);
    }
}
