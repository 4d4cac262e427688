//! Planning of the passes that a surface needs in a view this frame.

use bevy::prelude::*;

use crate::{
    material::{FluidMaterial, Thickness},
    medium::Medium,
    settings::{Antialiasing, ScreenSpaceFluid, Smoothing},
};

/// The properties of a surface in a view that are known before anything is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanInput {
    /// Whether the surface's bounding box touches the view's frustum.
    pub in_view: bool,
    /// Whether the near plane cuts the bounding box, so that rays may start inside.
    pub near_plane_cuts: bool,
    /// Particles of the bulk near its surface.
    pub bulk: u32,
    /// Particles of the bulk that no surface passes through.
    pub interior: u32,
    /// Particles of the spray.
    pub spray: u32,
    /// Radius of the largest particles. Unit: m, in the world.
    pub radius: f32,
    /// The surface's material.
    pub material: FluidMaterial,
    /// Whether to leave out work that the material makes unnecessary.
    pub shortcuts: bool,
    /// Whether the opaque scene's depth is known, from the camera's `DepthPrepass`.
    pub scene_depth: bool,
    /// The camera's settings.
    pub settings: ScreenSpaceFluid,
}

/// The work to be done for a surface in a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Whether the bulk's layers are drawn.
    pub bulk: bool,
    /// Whether the spray's layers are drawn.
    pub spray: bool,
    /// Whether interior particles are drawn too. They are hidden unless rays start among them.
    pub interior: bool,
    /// Whether the near plane may cut splats, which are then intersected in view space.
    pub cut: bool,
    /// How the bulk is smoothed.
    pub smoothing: Smoothing,
    /// Maximum number of interfaces that a ray crosses.
    pub interfaces: u32,
    /// Whether light passes without refraction and reflection.
    pub index_one: bool,
    /// Whether path lengths are accumulated over the particles.
    pub accumulated: bool,
    /// Whether the surface is opaque, so that it needs no back and no search.
    pub opaque: bool,
    /// The terms of the medium that are not zero.
    pub terms: MediumTerms,
    /// How edges and details are antialiased.
    pub antialiasing: Antialiasing,
}

impl Plan {
    /// Whether the layers' backs are drawn.
    pub fn backs(&self) -> bool {
        !self.opaque && !self.accumulated
    }

    /// Whether the bulk's normals are read, and not written by smoothing.
    pub(crate) fn normals_from_depth(&self) -> bool {
        self.bulk && !self.index_one && !self.smoothing.yields_normals()
    }
}

/// The terms of a medium that are not zero; the others are compiled out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct MediumTerms {
    /// Extinction: light is absorbed or scattered away.
    pub extinction: bool,
    /// Scattering: light from the scene is in-scattered.
    pub scattering: bool,
    /// Emission: the medium itself emits light.
    pub emission: bool,
}

impl MediumTerms {
    const ALL: Self = Self {
        extinction: true,
        scattering: true,
        emission: true,
    };

    fn of(medium: &Medium) -> Self {
        let some = |v: Vec3| v.max_element() > 0.0;
        Self {
            extinction: some(medium.extinction()),
            scattering: some(medium.scattered()),
            emission: some(medium.emission.to_vec3()),
        }
    }

    /// Whether the medium adds in-scattered light or emission.
    pub fn source(&self) -> bool {
        self.scattering || self.emission
    }
}

/// Largest transmission over half a particle radius of a medium that counts as opaque.
const OPAQUE: f32 = 1e-3;

fn is_opaque(medium: &Medium, radius: f32) -> bool {
    medium.transmitted(0.5 * radius).max_element() <= OPAQUE
}

/// The plan for a surface in a view; `None` if there is nothing to draw.
pub fn plan(input: &PlanInput) -> Option<Plan> {
    let interior = input.interior > 0 && input.near_plane_cuts;
    let bulk = input.bulk > 0 || interior;
    let spray = input.spray > 0;
    if !input.in_view || !(bulk || spray) {
        return None;
    }
    let material = &input.material;
    let unbent = (material.refractive_index - 1.0).abs() < 1e-6;
    let accumulated = unbent && material.thickness != Thickness::Layers;
    let index_one = accumulated || unbent && input.shortcuts;
    // Soft rims are thin wherever they are.
    let opaque = input.shortcuts && !accumulated && is_opaque(&material.medium, input.radius);
    // Without the scene's depth no bent ray finds what it meets.
    let budget = if input.scene_depth {
        input.settings.refractions.count()
    } else {
        0
    };
    Some(Plan {
        bulk,
        spray,
        interior,
        cut: input.near_plane_cuts,
        // Accumulated thickness has no surface to smooth.
        smoothing: if bulk && !accumulated {
            input.settings.smoothing
        } else {
            Smoothing::None
        },
        // One class has only one front and one back, but total internal reflection may need the
        // rest.
        interfaces: match () {
            () if index_one => 0,
            () if opaque => budget.min(1),
            () => budget,
        },
        index_one,
        accumulated,
        opaque,
        terms: if input.shortcuts {
            MediumTerms::of(&material.medium)
        } else {
            MediumTerms::ALL
        },
        antialiasing: match input.settings.antialiasing {
            // Soft rims have no edge.
            _ if accumulated => Antialiasing::None,
            // Rays that go straight on do not part.
            Antialiasing::Full { .. } if index_one => Antialiasing::Edges,
            wanted => wanted,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const POOL: PlanInput = PlanInput {
        in_view: true,
        near_plane_cuts: false,
        bulk: 100,
        interior: 50,
        spray: 3,
        radius: 0.05,
        material: FluidMaterial::WATER,
        shortcuts: true,
        scene_depth: true,
        settings: ScreenSpaceFluid::DEFAULT,
    };

    #[test]
    fn everything_is_there() {
        let plan = plan(&POOL).unwrap();
        assert!(plan.bulk && plan.spray && !plan.interior && !plan.index_one);
        assert_eq!(plan.interfaces, 4);
        assert_eq!(plan.smoothing, POOL.settings.smoothing);
    }

    #[test]
    fn nothing_in_view_or_nothing_at_all_is_no_plan() {
        let out = PlanInput {
            in_view: false,
            ..POOL
        };
        let empty = PlanInput {
            bulk: 0,
            spray: 0,
            interior: 0,
            ..POOL
        };
        assert_eq!((plan(&out), plan(&empty)), (None, None));
    }

    #[test]
    fn without_spray_no_spray_layers_but_the_whole_budget() {
        let plan = plan(&PlanInput { spray: 0, ..POOL }).unwrap();
        assert!(plan.bulk && !plan.spray);
        assert_eq!(plan.interfaces, 4);
    }

    #[test]
    fn without_bulk_no_smoothing() {
        let only_spray = PlanInput {
            bulk: 0,
            interior: 0,
            ..POOL
        };
        let plan = plan(&only_spray).unwrap();
        assert!(!plan.bulk && plan.spray);
        assert_eq!(plan.smoothing, Smoothing::None);
    }

    #[test]
    fn without_the_scenes_depth_nothing_is_bent() {
        let blind = plan(&PlanInput {
            scene_depth: false,
            ..POOL
        });
        assert_eq!(blind.unwrap().interfaces, 0);
    }

    #[test]
    fn index_one_means_no_interfaces() {
        let mut input = POOL;
        input.material.refractive_index = 1.0;
        let unbent = plan(&input).unwrap();
        assert!(unbent.index_one && unbent.backs() && !unbent.accumulated);
        assert_eq!(unbent.interfaces, 0);
        input.shortcuts = false;
        let traced = plan(&input).unwrap();
        assert!(!traced.index_one);
        assert_eq!(traced.interfaces, 4);
    }

    #[test]
    fn accumulated_thickness_needs_neither_backs_nor_smoothing() {
        let mut input = POOL;
        input.material = FluidMaterial::SMOKE;
        let smoke = plan(&input).unwrap();
        assert!(smoke.index_one && smoke.accumulated && !smoke.backs());
        assert_eq!(smoke.smoothing, Smoothing::None);
        input.material.refractive_index = 1.1;
        let bent = plan(&input).unwrap();
        assert!(!bent.accumulated && bent.backs());
        assert_eq!(bent.smoothing, POOL.settings.smoothing);
    }

    #[test]
    fn an_opaque_medium_has_no_back_and_nothing_to_search_for() {
        let mut input = POOL;
        input.material = FluidMaterial::MILK;
        let milk = plan(&input).unwrap();
        assert!(milk.opaque && !milk.backs());
        assert_eq!(milk.interfaces, 1);
        // A tenth of a millimetre of milk is a transparent film.
        input.radius = 1e-4;
        assert!(!plan(&input).unwrap().opaque);
        // One channel that passes is enough.
        input.radius = 0.05;
        input.material.medium = Medium {
            absorption_density: 1e6,
            absorption_color: LinearRgba::RED,
            ..Medium::CLEAR
        };
        assert!(!plan(&input).unwrap().opaque);
    }

    #[test]
    fn a_medium_has_the_terms_that_are_not_zero() {
        let terms = |material| plan(&PlanInput { material, ..POOL }).unwrap().terms;
        let none = MediumTerms::default();
        assert_eq!(terms(FluidMaterial::CLEAR_WATER), none);
        let extinction = MediumTerms {
            extinction: true,
            ..none
        };
        assert_eq!(terms(FluidMaterial::WATER), extinction);
        let scattering = MediumTerms {
            scattering: true,
            ..extinction
        };
        assert_eq!(terms(FluidMaterial::SMOKE), scattering);
        let emission = MediumTerms {
            emission: true,
            ..extinction
        };
        assert_eq!(terms(FluidMaterial::FIRE), emission);
        // Black matter only absorbs.
        let soot = Medium {
            scattering_density: 1.0,
            scattering_color: LinearRgba::BLACK,
            ..Medium::CLEAR
        };
        let soot = FluidMaterial {
            medium: soot,
            ..FluidMaterial::WATER
        };
        assert_eq!(terms(soot), extinction);
    }

    #[test]
    fn interiors_are_drawn_only_for_rays_that_start_among_them() {
        let input = PlanInput {
            near_plane_cuts: true,
            ..POOL
        };
        assert!(plan(&input).unwrap().interior && plan(&input).unwrap().cut);
        assert!(!plan(&POOL).unwrap().cut);
    }
}
