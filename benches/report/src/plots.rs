//! The fronts as pictures: one for each scene and error, methods as series.

use std::path::Path;

use image::{ImageBuffer, Rgb};
use plotters::{
    coord::{
        CoordTranslate, Shift,
        ranged1d::{DefaultFormatting, Ranged},
    },
    prelude::*,
    style::{
        FontStyle, register_font,
        text_anchor::{HPos, Pos, VPos},
    },
};

use crate::{
    ReportError, Table,
    front::{Point, TRADES, Trade, points},
};

const SIZE: (u32, u32) = (1120, 640);
/// What names the methods stands beside the plot, where it covers no point.
const LEGEND_WIDTH: u32 = 200;
/// Colours that also differ in lightness, for print and for those who see few colours.
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(70, 70, 70),
];

/// How the points of a method look: colours are few, so every round of them has its own shape.
#[derive(Clone, Copy)]
struct Marker {
    shape: usize,
    color: RGBColor,
}

impl Marker {
    fn of(method: usize) -> Self {
        Self {
            shape: method / COLORS.len(),
            color: COLORS[method % COLORS.len()],
        }
    }

    fn draw<DB: DrawingBackend, CT: CoordTranslate>(
        self,
        area: &DrawingArea<DB, CT>,
        at: CT::From,
    ) -> Result<(), DrawingAreaErrorKind<DB::ErrorType>>
    where
        CT::From: Clone,
    {
        match self.shape {
            0 => area.draw(&Circle::new(at, 5, self.color.filled())),
            1 => area.draw(&TriangleMarker::new(at, 7, self.color.filled())),
            _ => area.draw(&Cross::new(at, 5, self.color.stroke_width(2))),
        }
    }
}

/// Draws every front that the table has, as SVG and PNG.
pub(crate) fn draw(table: &Table, folder: &Path) -> Result<(), ReportError> {
    // Fails only where the font is none.
    let _ = register_font(
        "sans-serif",
        FontStyle::Normal,
        epaint_default_fonts::UBUNTU_LIGHT,
    );
    for scene in table.scenes() {
        for trade in &TRADES {
            let points = points(table, scene, trade);
            if points.len() < 2 {
                continue;
            }
            let stem = folder.join(format!("{scene}_{}", trade.error));
            let failed = |reason: String| ReportError::Plot {
                path: stem.clone(),
                reason,
            };
            let svg = stem.with_extension("svg");
            let area = SVGBackend::new(&svg, SIZE).into_drawing_area();
            draw_front(&area, scene, trade, &points).map_err(failed)?;
            drop(area);
            let mut pixels = vec![0; (SIZE.0 * SIZE.1 * 3) as usize];
            let area = BitMapBackend::with_buffer(&mut pixels, SIZE).into_drawing_area();
            draw_front(&area, scene, trade, &points).map_err(failed)?;
            drop(area);
            let png = stem.with_extension("png");
            ImageBuffer::<Rgb<u8>, _>::from_raw(SIZE.0, SIZE.1, pixels)
                .ok_or_else(|| failed("too few pixels".into()))?
                .save(&png)
                .map_err(|error| failed(error.to_string()))?;
        }
    }
    Ok(())
}

/// From a little below the least to a little above the greatest.
fn range(values: impl Iterator<Item = f64> + Clone) -> std::ops::Range<f64> {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(0.0, f64::max);
    low / 1.3..high * 1.5
}

/// A logarithmic axis with labels at round numbers, the more of them the shorter it is.
fn decades(
    range: std::ops::Range<f64>,
) -> impl Ranged<ValueType = f64, FormatOption = DefaultFormatting> {
    let digits: &[f64] = if range.end < 8.0 * range.start {
        &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]
    } else {
        &[1.0, 2.0, 5.0]
    };
    let first = range.start.log10().floor() as i32;
    let last = range.end.log10().ceil() as i32;
    let labels = (first..=last)
        .flat_map(|power| digits.iter().map(move |digit| digit * 10_f64.powi(power)))
        .filter(|label| range.contains(label))
        .collect::<Vec<_>>();
    range.log_scale().with_key_points(labels)
}

fn draw_front<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    scene: &str,
    trade: &Trade,
    points: &[Point],
) -> Result<(), String> {
    let text = |error: DrawingAreaErrorKind<DB::ErrorType>| error.to_string();
    area.fill(&WHITE).map_err(text)?;
    let (area, legend) = area.split_horizontally(SIZE.0 - LEGEND_WIDTH);
    let caption = format!("{scene}: {} against time", trade.title);
    let mut chart = ChartBuilder::on(&area)
        .caption(caption, ("sans-serif", 24))
        .margin(16)
        .x_label_area_size(46)
        .y_label_area_size(70)
        .build_cartesian_2d(
            decades(range(points.iter().map(|p| p.time))),
            decades(range(points.iter().map(|p| p.error))),
        )
        .map_err(text)?;
    chart
        .configure_mesh()
        .x_desc(format!("GPU ms a frame ({})", trade.time))
        .y_desc(trade.unit)
        .light_line_style(RGBColor(240, 240, 240))
        .label_style(("sans-serif", 15))
        .axis_desc_style(("sans-serif", 17))
        .draw()
        .map_err(text)?;
    let front = points.iter().filter(|p| p.on_front);
    chart
        .draw_series(LineSeries::new(
            front.clone().map(|p| (p.time, p.error)),
            RGBColor(170, 170, 170).stroke_width(2),
        ))
        .map_err(text)?;
    let mut methods: Vec<&str> = points.iter().map(|p| p.method.as_str()).collect();
    methods.sort_unstable();
    methods.dedup();
    for (i, method) in methods.iter().enumerate() {
        let marker = Marker::of(i);
        for point in points.iter().filter(|p| p.method == *method) {
            marker
                .draw(chart.plotting_area(), (point.time, point.error))
                .map_err(text)?;
        }
        let y = 70 + 22 * i as i32;
        marker.draw(&legend, (8, y)).map_err(text)?;
        let name = Text::new(*method, (20, y - 9), ("sans-serif", 15));
        legend.draw(&name).map_err(text)?;
    }
    let anchor = Pos::new(HPos::Left, VPos::Bottom);
    let style = TextStyle::from(("sans-serif", 13).into_font()).pos(anchor);
    // By turns above and below, so that near ones can be told apart.
    let sides = [(7, -5), (7, 16)].into_iter().cycle();
    chart
        .draw_series(front.zip(sides).map(|(p, side)| {
            let label = if p.parameters.is_empty() {
                p.method.clone()
            } else {
                p.parameters.clone()
            };
            EmptyElement::at((p.time, p.error)) + Text::new(label, side, style.clone())
        }))
        .map_err(text)?;
    area.present().map_err(text)
}
