//! Speed against error: which methods nothing else beats in both.

use crate::{Table, methods};

/// Which time stands against which error.
#[derive(Clone, Copy)]
pub(crate) struct Trade {
    pub(crate) time: &'static str,
    pub(crate) error: &'static str,
    pub(crate) region: &'static str,
    /// For axes and headings.
    pub(crate) title: &'static str,
    pub(crate) unit: &'static str,
    /// Ways to smooth stand against each other, not whole frames that share one.
    pub(crate) smoothing: bool,
}

/// What is plotted for each scene that has it: the smoothing alone, then the whole frame.
pub(crate) const TRADES: [Trade; 7] = [
    Trade {
        time: "time_smooth_normals",
        error: "normal_p50",
        region: "interior",
        title: "normals, median error",
        unit: "degrees",
        smoothing: true,
    },
    Trade {
        time: "time_smooth_normals",
        error: "normal_p95",
        region: "interior",
        title: "normals, 95th percentile",
        unit: "degrees",
        smoothing: true,
    },
    Trade {
        time: "time_smooth_normals",
        error: "surface_roughness",
        region: "interior",
        title: "roughness",
        unit: "particle radii",
        smoothing: true,
    },
    Trade {
        time: "time_gpu",
        error: "flip",
        region: "all",
        title: "picture, FLIP",
        unit: "mean FLIP",
        smoothing: false,
    },
    Trade {
        time: "time_gpu",
        error: "picture_rmse",
        region: "all",
        title: "picture, RMSE",
        unit: "RMSE of sRGB values",
        smoothing: false,
    },
    Trade {
        time: "time_gpu",
        error: "thickness_rmse",
        region: "all",
        title: "thickness, RMSE",
        unit: "particle radii",
        smoothing: false,
    },
    Trade {
        time: "time_gpu",
        error: "aliasing_rmse",
        region: "all",
        title: "antialiasing, RMSE",
        unit: "RMSE of sRGB values",
        smoothing: false,
    },
];

/// A method's time (ms) and error.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    pub(crate) method: String,
    pub(crate) parameters: String,
    pub(crate) time: f64,
    pub(crate) error: f64,
    /// No other method is both faster and more exact.
    pub(crate) on_front: bool,
}

/// All methods of a scene by time.
pub(crate) fn points(table: &Table, scene: &str, trade: &Trade) -> Vec<Point> {
    let methods = table.methods(scene, trade.error).into_iter();
    let mut points: Vec<_> = methods
        .filter(|(method, _)| !trade.smoothing || methods::smooths(method))
        .filter_map(|(method, parameters)| {
            let value =
                |quantity, region| table.value(scene, (&method, &parameters), quantity, region);
            let time = value(trade.time, "all").filter(|time| *time > 0.0)?;
            let error = value(trade.error, trade.region).filter(|error| *error > 0.0)?;
            Some(Point {
                time,
                error,
                on_front: false,
                method,
                parameters,
            })
        })
        .collect();
    points.sort_by(|a, b| a.time.total_cmp(&b.time));
    let mut best = f64::INFINITY;
    for point in &mut points {
        point.on_front = point.error < best;
        best = best.min(point.error);
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_slower_and_worse_is_not_on_the_front() {
        let mut table = Table::default();
        for (method, time, error) in [("a", 1.0, 3.0), ("b", 2.0, 4.0), ("c", 3.0, 1.0)] {
            for (quantity, region, value) in [("time_gpu", "all", time), ("flip", "all", error)] {
                table.push(crate::Row {
                    scene: "s".into(),
                    particles: 1,
                    width: 1,
                    height: 1,
                    method: method.into(),
                    parameters: String::new(),
                    quantity: quantity.into(),
                    region: region.into(),
                    value,
                    unit: "1".into(),
                });
            }
        }
        let points = points(&table, "s", &TRADES[3]);
        let front: Vec<_> = points.iter().map(|p| (&*p.method, p.on_front)).collect();
        assert_eq!(front, [("a", true), ("b", false), ("c", true)]);
    }
}
