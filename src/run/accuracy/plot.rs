//! Work-precision plots: error on x, time on y, both logarithmic, a curve per family of methods.

use std::collections::BTreeMap;

use plotters::coord::Shift;
use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;

use super::summary::{BUDGET_MS_PER_S, MethodSummary};
use super::{Report, SceneReport};

/// Pixels of a plot, and of the part at its right in which curves are named.
const SIZE: (u32, u32) = (1200, 760);
const LEGEND_WIDTH: u32 = 170;
/// Errors below this are drawn at it: a logarithm needs a number above 0.
const LEAST_MM: f64 = 1e-4;
const LEAST_MS: f64 = 1e-2;

/// Why a plot could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("a plot cannot be drawn: {0}")]
pub struct PlotError(String);

/// A method as a point.
#[derive(Clone, Debug)]
struct Point {
    method: String,
    family: String,
    error_mm: f64,
    /// The error in the worst scene, where there are several.
    worst_mm: Option<f64>,
    ms_per_s: f64,
    failed: bool,
}

/// Lines of a plot, in millimetres.
struct Lines {
    half_blade_mm: f64,
    floor_mm: Option<f64>,
}

/// The plot of a scene, as SVG.
///
/// # Errors
///
/// What the plotting crate refuses.
pub fn error_plot(scene: &SceneReport) -> Result<String, PlotError> {
    let point = |row: &super::Row| {
        Some(Point {
            method: row.method.clone(),
            family: row.family.clone(),
            error_mm: row.rms_m? * 1e3,
            worst_mm: None,
            ms_per_s: row.ms_per_s,
            failed: !row.misses().is_empty(),
        })
    };
    let points: Vec<Point> = scene.rows.iter().filter_map(point).collect();
    let lines = Lines {
        half_blade_mm: scene.half_blade_m * 1e3,
        floor_mm: scene.floor.rms_m.map(|m| m * 1e3),
    };
    draw(&format!("{}: {}", scene.name, scene.what), &points, &lines)
}

/// The plot over all scenes: the mean error, and a thin line to that of the worst scene.
///
/// # Errors
///
/// What the plotting crate refuses.
pub fn summary_plot(report: &Report) -> Result<String, PlotError> {
    let point = |m: &MethodSummary| {
        Some(Point {
            method: m.method.clone(),
            family: m.family.clone(),
            error_mm: m.mean_rms_m? * 1e3,
            worst_mm: m.worst_rms_m.map(|worst| worst * 1e3),
            ms_per_s: m.mean_ms_per_s,
            failed: !m.misses.is_empty(),
        })
    };
    let points: Vec<Point> = report.summary().iter().filter_map(point).collect();
    let lines = Lines {
        half_blade_mm: report.half_blade_m() * 1e3,
        floor_mm: report.floor_m().map(|m| m * 1e3),
    };
    let title = "Mean over the scenes; thin lines lead to the worst scene (hollow)";
    draw(title, &points, &lines)
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;

fn draw(title: &str, points: &[Point], lines: &Lines) -> Result<String, PlotError> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        drawn(&area, title, points, lines).map_err(|error| PlotError(error.to_string()))?;
        area.present()
            .map_err(|error| PlotError(error.to_string()))?;
    }
    Ok(svg)
}

type DrawResult = Result<(), DrawingAreaErrorKind<std::io::Error>>;

fn drawn(area: &Area<'_>, title: &str, points: &[Point], lines: &Lines) -> DrawResult {
    area.fill(&WHITE)?;
    let (left_area, right_area) = area.split_horizontally(SIZE.0 - LEGEND_WIDTH);
    let errors = points.iter().flat_map(|p| [Some(p.error_mm), p.worst_mm]);
    let marks = [Some(lines.half_blade_mm), lines.floor_mm];
    let (left, right) = span(errors.chain(marks).flatten(), LEAST_MM);
    let times = points.iter().map(|p| p.ms_per_s);
    let (low, high) = span(times.chain([BUDGET_MS_PER_S]), LEAST_MS);
    let mut chart = ChartBuilder::on(&left_area)
        .caption(title, ("sans-serif", 20))
        .margin(12)
        .x_label_area_size(48)
        .y_label_area_size(64)
        .build_cartesian_2d((left..right).log_scale(), (low..high).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("pose error to the reference, RMS, mm")
        .y_desc("collide and relax, ms per simulated second")
        .x_label_formatter(&|x| short(*x))
        .y_label_formatter(&|y| short(*y))
        .label_style(("sans-serif", 14))
        .draw()?;
    let vertical = |x: f64| vec![(x.max(LEAST_MM), low), (x.max(LEAST_MM), high)];
    let level = vec![(left, BUDGET_MS_PER_S), (right, BUDGET_MS_PER_S)];
    let mut legend = vec![
        ("½ blade width".to_owned(), RED.to_rgba()),
        ("frame budget".to_owned(), BLUE.to_rgba()),
    ];
    dashed(&mut chart, vertical(lines.half_blade_mm), RED.to_rgba())?;
    dashed(&mut chart, level, BLUE.to_rgba())?;
    if let Some(floor_mm) = lines.floor_mm {
        dashed(&mut chart, vertical(floor_mm), BLACK.mix(0.5))?;
        legend.push(("noise floor".to_owned(), BLACK.mix(0.5)));
    }
    for (number, (family, curve)) in families(points).into_iter().enumerate() {
        let colour = Palette99::pick(number).to_rgba();
        draw_family(&mut chart, &curve, colour)?;
        legend.push((family, colour));
    }
    draw_legend(&right_area, &legend)
}

fn draw_legend(area: &Area<'_>, entries: &[(String, RGBAColor)]) -> DrawResult {
    let words = |text: &str, y: i32| {
        Text::new(text.to_owned(), (24, y - 7), ("sans-serif", 14).into_font())
    };
    let mut y = 60;
    for (name, colour) in entries {
        let sample = PathElement::new([(0, y), (18, y)], colour.stroke_width(2));
        area.draw(&sample)?;
        area.draw(&words(name, y))?;
        y += 22;
    }
    y += 12;
    area.draw(&Circle::new((9, y), 4, BLACK.filled()))?;
    area.draw(&words("meets every limit", y))?;
    area.draw(&Cross::new((9, y + 22), 5, BLACK.stroke_width(2)))?;
    area.draw(&words("misses a limit", y + 22))
}

/// The points of each family, in the order of its knob, which is that of the list of methods.
fn families(points: &[Point]) -> BTreeMap<String, Vec<&Point>> {
    let mut families: BTreeMap<String, Vec<&Point>> = BTreeMap::new();
    for point in points {
        families
            .entry(point.family.clone())
            .or_default()
            .push(point);
    }
    families
}

fn dashed(chart: &mut Chart<'_, '_>, points: Vec<(f64, f64)>, colour: RGBAColor) -> DrawResult {
    let series = DashedLineSeries::new(points, 6, 4, colour.stroke_width(1));
    chart.draw_series(series)?;
    Ok(())
}

fn draw_family(chart: &mut Chart<'_, '_>, points: &[&Point], colour: RGBAColor) -> DrawResult {
    let place = |p: &Point| (p.error_mm.max(LEAST_MM), p.ms_per_s.max(LEAST_MS));
    let curve = points.iter().map(|p| place(p));
    chart.draw_series(LineSeries::new(curve, colour.stroke_width(2)))?;
    for point in points {
        let (x, y) = place(point);
        if let Some(worst_mm) = point.worst_mm {
            let worst = (worst_mm.max(LEAST_MM), y);
            let thin = colour.mix(0.4);
            chart.draw_series(LineSeries::new([(x, y), worst], thin))?;
            chart.draw_series([Circle::new(worst, 3, colour)])?;
        }
        if point.failed {
            chart.draw_series([Cross::new((x, y), 5, colour.stroke_width(2))])?;
        } else {
            chart.draw_series([Circle::new((x, y), 4, colour.filled())])?;
        }
        let label = ("sans-serif", 12).into_font().color(&BLACK.mix(0.7));
        let above = EmptyElement::at((x, y)) + Text::new(point.method.clone(), (5, -12), label);
        chart.draw_series([above])?;
    }
    Ok(())
}

/// The least and the largest of these numbers with some room around them.
fn span(values: impl Iterator<Item = f64>, least: f64) -> (f64, f64) {
    let clamped = values.map(|v| v.max(least));
    let (low, high) = clamped.fold((f64::INFINITY, 0.0_f64), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    if low > high {
        return (least, 1.0);
    }
    (low / 1.5, high * 2.0)
}

fn short(value: f64) -> String {
    if value >= 0.01 {
        format!("{value}")
    } else {
        format!("{value:.0e}")
    }
}

#[cfg(test)]
mod tests {
    use super::super::{FLOOR, Row};
    use super::*;
    use crate::run::methods::METHODS;

    /// A scene with every method, of which every third misses a limit.
    fn scene() -> SceneReport {
        let rows = METHODS.iter().zip(1_u8..).map(|(method, n)| Row {
            scene: "made up".into(),
            method: method.name.into(),
            family: method.family.into(),
            rms_m: Some(1e-4 * f64::from(n)),
            ms_per_s: 200.0 / f64::from(n),
            strain: if n % 3 == 0 { 0.5 } else { 0.0 },
            touched_plants: 10,
            ..Row::default()
        });
        SceneReport {
            name: "made up".into(),
            what: "nothing".into(),
            half_blade_m: 0.0035,
            floor: Row {
                method: FLOOR.into(),
                rms_m: Some(1e-5),
                ..Row::default()
            },
            rows: rows.collect(),
            left_out: Vec::new(),
        }
    }

    #[test]
    fn a_plot_names_every_family_every_line_and_every_method() {
        let svg = error_plot(&scene()).expect("a plot");
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        let texts = METHODS.iter().flat_map(|m| [m.name, m.family]);
        for text in texts.chain(["½ blade width", "frame budget", "noise floor"]) {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn a_plot_without_points_and_one_with_zeros_can_be_drawn() {
        let mut scene = scene();
        for row in &mut scene.rows {
            row.rms_m = Some(0.0);
            row.ms_per_s = 0.0;
        }
        assert!(error_plot(&scene).is_ok());
        scene.rows.clear();
        assert!(error_plot(&scene).is_ok());
    }
}
