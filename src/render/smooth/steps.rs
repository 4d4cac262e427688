//! The passes of a smoothing, in order, and their windows.

use crate::settings::{PlaneFitForm, Smoothing, Window};

/// What one smoothing pass computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum SmoothKernel {
    TotalLeastSquares,
    DeviceDepth,
    Rows,
    Columns,
    #[cfg(feature = "published")]
    Bilateral,
    #[cfg(feature = "published")]
    NarrowRows,
    #[cfg(feature = "published")]
    NarrowColumns,
    #[cfg(feature = "published")]
    CurvatureFlow,
}

/// A texture that smoothing reads or writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Buffer {
    /// The layers that later stages read.
    Layers,
    /// The other layers.
    Scratch,
    /// Layers and their slope along x, as bits, where exit rays will be.
    Slopes,
}

/// A smoothing pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Step {
    pub(crate) kernel: SmoothKernel,
    pub(crate) from: Buffer,
    pub(crate) to: Buffer,
    /// Whether it writes normals too.
    pub(crate) normals: bool,
    /// Whether slopes are taken from a window twice as wide, where the surface is flat.
    pub(crate) wide: bool,
    pub(crate) half_taps: u32,
}

/// The passes of a smoothing, which begin where the splats are drawn to and end in
/// [`Buffer::Layers`].
pub(crate) fn steps(smoothing: &Smoothing) -> Vec<Step> {
    let (kernels, half_taps, iterations): (&[_], _, _) = match smoothing {
        Smoothing::None => return Vec::new(),
        // It leaves the layers as they are.
        #[cfg(feature = "published")]
        Smoothing::NormalAverage(_) => return Vec::new(),
        Smoothing::PlaneFit(fit) => (
            match fit.form {
                PlaneFitForm::TotalLeastSquares => &[SmoothKernel::TotalLeastSquares],
                PlaneFitForm::DeviceDepth => &[SmoothKernel::DeviceDepth],
                PlaneFitForm::Separable => &[SmoothKernel::Rows, SmoothKernel::Columns],
            },
            fit.half_taps,
            fit.iterations,
        ),
        #[cfg(feature = "published")]
        Smoothing::Bilateral(filter) => (
            &[SmoothKernel::Bilateral],
            filter.half_taps,
            filter.iterations,
        ),
        #[cfg(feature = "published")]
        Smoothing::NarrowRange(filter) => (
            &[SmoothKernel::NarrowRows, SmoothKernel::NarrowColumns],
            filter.half_taps,
            filter.iterations,
        ),
        #[cfg(feature = "published")]
        Smoothing::CurvatureFlow(flow) => (&[SmoothKernel::CurvatureFlow], 1, flow.iterations),
    };
    let total = kernels.len() * iterations as usize;
    // From the last one back: it ends in the layers, and none reads what it writes.
    let mut to = Buffer::Layers;
    let mut steps: Vec<_> = (0..total)
        .rev()
        .map(|i| {
            let kernel = kernels[i % kernels.len()];
            let last = i + 1 == total;
            // Only once a fit has removed the bumps can it be told where the surface is flat.
            let wide = matches!(kernel, SmoothKernel::Rows | SmoothKernel::Columns)
                && iterations > 1
                && half_taps > 1
                && i + 2 >= total;
            // Rows pass on their slopes: to the last columns for the normals, to others as a texture that
            // is there anyway.
            let from = match to {
                Buffer::Layers if kernel == SmoothKernel::Columns => Buffer::Slopes,
                Buffer::Slopes | Buffer::Scratch => Buffer::Layers,
                Buffer::Layers => Buffer::Scratch,
            };
            let step = Step {
                kernel,
                from,
                to,
                normals: last && smoothing.yields_normals(),
                wide,
                half_taps,
            };
            to = from;
            step
        })
        .collect();
    steps.reverse();
    steps
}

/// Half window in radii; 0 means one pixel per tap.
pub(super) fn radii(window: Window) -> f32 {
    match window {
        Window::Radii(radii) => radii,
        Window::Pixels => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    #[cfg(feature = "published")]
    use crate::settings::Bilateral;
    use crate::settings::PlaneFit;

    #[test]
    fn steps_chain_and_end_with_normals_where_the_fit_yields_them() {
        let forms = [
            (PlaneFitForm::TotalLeastSquares, 3),
            (PlaneFitForm::DeviceDepth, 3),
            (PlaneFitForm::Separable, 6),
        ];
        for (form, count) in forms {
            let smoothing = Smoothing::PlaneFit(PlaneFit {
                form,
                iterations: 3,
                ..PlaneFit::DEFAULT
            });
            let steps = steps(&smoothing);
            assert_eq!(steps.len(), count);
            assert!(steps[count - 1].normals);
            let wide: Vec<_> = steps.iter().map(|step| step.wide).collect();
            let lines = form == PlaneFitForm::Separable;
            assert!(wide[..count - 2].iter().all(|wide| !wide));
            assert_eq!(wide[count - 2..], [lines, lines]);
            let slopes = steps.iter().filter(|step| step.to == Buffer::Slopes);
            let rows = if form == PlaneFitForm::Separable {
                3
            } else {
                0
            };
            assert_eq!(slopes.count(), rows);
            check(&smoothing, &steps);
        }
        assert!(steps(&Smoothing::None).is_empty());
        #[cfg(feature = "published")]
        {
            let smoothing = Smoothing::Bilateral(Bilateral::THESIS);
            let bilateral = steps(&smoothing);
            assert_eq!(bilateral.len(), 22);
            assert!(bilateral.iter().all(|step| !step.normals));
            check(&smoothing, &bilateral);
        }
    }

    fn check(smoothing: &Smoothing, steps: &[Step]) {
        assert!(steps.iter().all(|step| step.from != step.to));
        assert!(steps.windows(2).all(|pair| pair[0].to == pair[1].from));
        assert_eq!(steps.last().unwrap().to, Buffer::Layers);
        // Where splats are drawn to, and which textures there are, is decided by this number.
        let passes = smoothing.layer_passes();
        let first = if passes % 2 == 1 {
            Buffer::Scratch
        } else {
            Buffer::Layers
        };
        assert_eq!(steps[0].from, first);
        let scratch = |step: &Step| [step.from, step.to].contains(&Buffer::Scratch);
        assert_eq!(passes > 0, steps.iter().any(scratch));
    }
}
