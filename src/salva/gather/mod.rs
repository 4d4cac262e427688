//! From components to what the simulation is told.

mod fluids;
mod solids;

pub(crate) use self::{
    fluids::{FluidEntry, gather_fluids},
    solids::{SolidEntry, gather_solids, start_anew},
};
