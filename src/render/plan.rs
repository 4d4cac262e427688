//! Which passes a body needs in a view this frame: only what the scene has.

use crate::settings::{ScreenSpaceFluid, Smoothing};

/// What is known of a body in a view before anything is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanInput {
    /// Whether the body's bounding box touches the view's frustum.
    pub in_view: bool,
    /// Whether the near plane cuts the bounding box, so that rays may start inside.
    pub near_plane_cuts: bool,
    /// Particles of the bulk near its surface.
    pub bulk: u32,
    /// Particles of the bulk that no surface passes through.
    pub interior: u32,
    /// Particles of the spray.
    pub spray: u32,
    /// Of the body's material.
    pub refractive_index: f32,
    /// The camera's settings.
    pub settings: ScreenSpaceFluid,
}

/// What is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// The bulk's layers are drawn.
    pub bulk: bool,
    /// The spray's layers are drawn.
    pub spray: bool,
    /// Interior particles are drawn too. They are hidden unless rays start among them.
    pub interior: bool,
    /// How the bulk is smoothed.
    pub smoothing: Smoothing,
    /// How many interfaces a ray may cross.
    pub interfaces: u32,
    /// Light passes unbent and nothing is reflected.
    pub index_one: bool,
}

/// The plan for a body in a view; `None` if there is nothing to draw.
pub fn plan(input: &PlanInput) -> Option<Plan> {
    let interior = input.interior > 0 && input.near_plane_cuts;
    let bulk = input.bulk > 0 || interior;
    let spray = input.spray > 0;
    if !input.in_view || !(bulk || spray) {
        return None;
    }
    let index_one = (input.refractive_index - 1.0).abs() < 1e-6;
    Some(Plan {
        bulk,
        spray,
        interior,
        smoothing: if bulk {
            input.settings.smoothing
        } else {
            Smoothing::None
        },
        // One class has but one front and one back, but total reflection may want the rest.
        interfaces: if index_one {
            0
        } else {
            input.settings.refractions.count()
        },
        index_one,
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
        refractive_index: 1.333,
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
    fn index_one_means_no_interfaces() {
        let input = PlanInput {
            refractive_index: 1.0,
            ..POOL
        };
        let plan = plan(&input).unwrap();
        assert!(plan.index_one);
        assert_eq!(plan.interfaces, 0);
    }

    #[test]
    fn interiors_are_drawn_only_for_rays_that_start_among_them() {
        let input = PlanInput {
            near_plane_cuts: true,
            ..POOL
        };
        assert!(plan(&input).unwrap().interior);
    }
}
