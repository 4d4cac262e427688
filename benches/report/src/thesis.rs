//! What the thesis has published (tables 5.1 to 5.4), measured on a GPU of 2013. Unit: ms.

/// A row of tables 5.1 and 5.2: the passes of a scene at 640×480 and at 1024×768.
pub(crate) struct Published {
    pub(crate) scene: &'static str,
    /// Whole, depth maps, their smoothing, normal maps, refraction.
    pub(crate) small: [f64; 5],
    pub(crate) large: [f64; 5],
}

/// What the columns of [`Published`] are, and which of our times they are beside.
pub(crate) const PASSES: [(&str, &[&str]); 5] = [
    (
        "whole",
        &[
            "time_splat",
            "time_smooth",
            "time_normals",
            "time_refract",
            "time_composite",
        ],
    ),
    ("depth maps", &["time_splat"]),
    ("smoothing", &["time_smooth"]),
    ("normal maps", &["time_normals"]),
    ("refraction", &["time_refract", "time_composite"]),
];

/// Table 5.1: the thesis's method.
pub(crate) const METHOD: [Published; 2] = [
    Published {
        scene: "wave",
        small: [4.21, 1.4, 2.16, 0.18, 0.47],
        large: [9.54, 3.06, 4.9, 0.45, 1.13],
    },
    Published {
        scene: "step",
        small: [3.87, 0.56, 2.47, 0.18, 0.66],
        large: [8.97, 1.1, 5.94, 0.45, 1.48],
    },
];

/// Table 5.2: its earlier method.
pub(crate) const EARLIER: [Published; 2] = [
    Published {
        scene: "wave",
        small: [6.26, 0.52, 5.54, 0.09, 0.11],
        large: [15.5, 1.16, 13.83, 0.23, 0.28],
    },
    Published {
        scene: "step",
        small: [6.03, 0.28, 5.54, 0.09, 0.12],
        large: [14.89, 0.53, 13.83, 0.23, 0.30],
    },
];

/// Table 5.3: smoothing by planes at 640×480, for 7², 9², 11² and 13² pixels by one to four
/// iterations.
pub(crate) const PLANES: [[f64; 4]; 4] = [
    [0.55, 1.09, 1.63, 2.15],
    [0.87, 1.71, 2.56, 3.40],
    [1.28, 2.55, 3.81, 5.08],
    [1.77, 3.51, 5.23, 6.98],
];

/// Table 5.4: the bilateral filter, for 5², 7², 9² and 11² pixels by 11, 22, 33 and 44 iterations.
pub(crate) const BILATERAL: [[f64; 4]; 4] = [
    [1.49, 2.98, 4.48, 5.96],
    [2.72, 5.43, 8.13, 10.98],
    [4.02, 8.14, 12.38, 17.29],
    [5.96, 13.01, 19.81, 26.01],
];
