//! Being put elsewhere.

use bevy::prelude::*;

use super::{Id, command::Command, frame::Frame};

/// A way that a job in flight does not know.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Relocation {
    World(Vec3),
    Fluid(Id, Isometry3d),
}

impl Relocation {
    pub(crate) fn command(self) -> Command {
        match self {
            Self::World(by) => Command::Shift(by),
            Self::Fluid(id, way) => Command::Carry(id, way),
        }
    }

    pub(crate) fn apply(self, frame: &mut Frame) {
        match self {
            Self::World(by) => frame.shift(by),
            Self::Fluid(id, way) => frame.carry(id, &way),
        }
    }
}
