//! From components to commands for the simulation.

mod fluids;
mod solids;

pub(crate) use self::{
    fluids::{FluidEntry, gather_fluids},
    solids::{SolidEntry, gather_solids, start_anew},
};
