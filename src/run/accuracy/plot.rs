//! Work-precision plots: error on x, time on y, both logarithmic, a curve per family of methods.

use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::measure::MOST_RMS_M;
use super::summary::{BUDGET_MS_PER_S, MethodSummary};
use super::{Relative, Report, SceneReport};

mod axes;
mod labels;
mod legend;

use axes::{Axes, LogAxis, Pixel, text};
use labels::{Box2, LETTER_PX};
use legend::{Style, draw_legend};

/// Pixels of a plot, and of what lies around its axes: left, right with the names of the curves, top
/// and bottom.
const SIZE: (u32, u32) = (1280, 800);
const MARGINS: [i32; 4] = [76, 180, 44, 60];
/// Letters of a title that fit above the axes.
const TITLE_LETTERS: usize = 110;
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
    /// The range that the time is known to.
    ms_range: [f64; 2],
    failed: bool,
}

/// What a plot shows besides its points.
struct About {
    title: String,
    half_blade_mm: f64,
    floor_mm: Option<f64>,
    /// Methods that have no finite error or no time, and so no place.
    missing: Vec<String>,
}

/// Families of methods that differ in more than a knob: no line joins their points.
const NO_KNOB: [&str; 3] = ["default", "literal", "recovery"];

/// The plot of a scene, as SVG.
///
/// # Errors
///
/// What the plotting crate refuses.
pub fn error_plot(scene: &SceneReport) -> Result<String, PlotError> {
    let point = |row: &super::Row| {
        let ms_per_s = scene.ms_per_s(row)?;
        Some(Point {
            method: row.method.clone(),
            family: row.family.clone(),
            error_mm: row.rms_m? * 1e3,
            worst_mm: None,
            ms_per_s,
            ms_range: range_ms(row.relative(), ms_per_s),
            failed: !scene.misses(row).is_empty(),
        })
    };
    let points: Vec<Point> = scene.rows.iter().filter_map(point).collect();
    let names = scene.rows.iter().map(|row| row.method.as_str());
    let about = About {
        title: format!("{}: {}", scene.name, scene.what),
        half_blade_mm: scene.half_blade_m * 1e3,
        floor_mm: scene.floor.rms_m.map(|m| m * 1e3),
        missing: missing(names, &points),
    };
    draw(&points, &about)
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
            ms_range: range_ms(m.relative, m.mean_ms_per_s),
            failed: !m.misses.is_empty(),
        })
    };
    let summary = report.summary();
    let points: Vec<Point> = summary.iter().filter_map(point).collect();
    let about = About {
        title: "Mean error over the scenes; thin lines lead to the worst scene (hollow)".into(),
        half_blade_mm: report.half_blade_m() * 1e3,
        floor_mm: report.floor_m().map(|m| m * 1e3),
        missing: missing(summary.iter().map(|m| m.method.as_str()), &points),
    };
    draw(&points, &about)
}

fn range_ms(relative: Option<Relative>, ms_per_s: f64) -> [f64; 2] {
    match relative {
        Some(Relative { median, low, high }) if median > 0.0 => {
            [low, high].map(|times| ms_per_s * times / median)
        }
        _ => [ms_per_s; 2],
    }
}

fn missing<'a>(names: impl Iterator<Item = &'a str>, points: &[Point]) -> Vec<String> {
    let absent = names.filter(|name| !points.iter().any(|point| point.method == *name));
    absent.map(str::to_owned).collect()
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type DrawResult = Result<(), DrawingAreaErrorKind<std::io::Error>>;

fn draw(points: &[Point], about: &About) -> Result<String, PlotError> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        let failed = |error: DrawingAreaErrorKind<_>| PlotError(error.to_string());
        drawn(&area, points, about).map_err(failed)?;
        area.present().map_err(failed)?;
    }
    Ok(svg)
}

fn drawn(area: &Area<'_>, points: &[Point], about: &About) -> DrawResult {
    area.fill(&WHITE)?;
    let axes = axes_of(points, about);
    let title: String = about.title.chars().take(TITLE_LETTERS).collect();
    let cut = if title.len() < about.title.len() {
        "…"
    } else {
        ""
    };
    let middle = ((axes.left() + axes.right()) / 2, 12);
    area.draw(&text(
        &format!("{title}{cut}"),
        middle,
        18,
        HPos::Center,
        VPos::Top,
    ))?;
    axes.draw(
        area,
        "pose error to the reference, RMS, mm",
        "collide and relax on the cpu, ms per simulated second",
    )?;
    let mut taken = guides(area, &axes, about)?;
    let mut legend = Vec::new();
    for (number, (family, curve)) in families(points).into_iter().enumerate() {
        let style = Style::of(number);
        draw_family(area, &axes, &curve, style)?;
        legend.push((family, style));
    }
    let worst = points
        .iter()
        .filter_map(|p| Some((p.worst_mm?, p.ms_per_s)));
    taken.extend(worst.map(|(x, y)| Box2::around(pixel(&axes, x, y))));
    let named = points
        .iter()
        .map(|p| (pixel(&axes, p.error_mm, p.ms_per_s), p.method.clone()));
    let named: Vec<(Pixel, String)> = named.collect();
    for label in labels::place(&named, &axes, &taken) {
        if label.needs_line {
            let line = [label.point, label.anchor()];
            area.draw(&PathElement::new(line, BLACK.mix(0.35)))?;
        }
        let corner = (label.place.left, label.place.top);
        area.draw(&text(
            &label.words,
            corner,
            LETTER_PX,
            HPos::Left,
            VPos::Top,
        ))?;
    }
    draw_legend(area, &axes, &legend, &about.missing)
}

fn axes_of(points: &[Point], about: &About) -> Axes {
    let [left, right, top, bottom] = MARGINS;
    let (width, height) = (SIZE.0 as i32, SIZE.1 as i32);
    let errors = points.iter().flat_map(|p| [Some(p.error_mm), p.worst_mm]);
    let guides = [
        Some(about.half_blade_mm),
        about.floor_mm,
        Some(MOST_RMS_M * 1e3),
    ];
    let errors = errors.chain(guides).flatten().map(|mm| mm.max(LEAST_MM));
    let times = points.iter().map(|p| p.ms_per_s).chain([BUDGET_MS_PER_S]);
    Axes {
        x: LogAxis::around(errors, left, width - right),
        y: LogAxis::around(times.map(|ms| ms.max(LEAST_MS)), height - bottom, top),
    }
}

fn pixel(axes: &Axes, error_mm: f64, ms_per_s: f64) -> Pixel {
    axes.pixel(error_mm.max(LEAST_MM), ms_per_s.max(LEAST_MS))
}

/// Draws the lines of limits with their names, each at a height of its own, and tells where those
/// are.
fn guides(area: &Area<'_>, axes: &Axes, about: &About) -> Result<Vec<Box2>, DrawError> {
    let limit_mm = MOST_RMS_M * 1e3;
    let mut upright = vec![
        (about.half_blade_mm, "½ blade width"),
        (limit_mm, "limit of poses"),
    ];
    upright.extend(about.floor_mm.map(|mm| (mm, "noise floor")));
    let mut taken = Vec::new();
    for (n, (error_mm, what)) in upright.into_iter().enumerate() {
        let x = axes.x.pixel(error_mm.max(LEAST_MM));
        dashed(area, [(x, axes.bottom()), (x, axes.top())])?;
        let words = format!("{what} {error_mm:.2} mm");
        taken.push(name_guide(
            area,
            &words,
            (x + 4, axes.top() + 4 + 16 * n as i32),
        )?);
    }
    let y = axes.y.pixel(BUDGET_MS_PER_S);
    dashed(area, [(axes.left(), y), (axes.right(), y)])?;
    let words = format!("frame budget {BUDGET_MS_PER_S} ms per s");
    taken.push(name_guide(area, &words, (axes.left() + 4, y - 15))?);
    Ok(taken)
}

type DrawError = DrawingAreaErrorKind<std::io::Error>;

fn name_guide(area: &Area<'_>, words: &str, corner: Pixel) -> Result<Box2, DrawError> {
    area.draw(&text(words, corner, LETTER_PX, HPos::Left, VPos::Top))?;
    Ok(Box2::of_words(words, corner))
}

fn dashed(area: &Area<'_>, ends: [Pixel; 2]) -> DrawResult {
    let line = DashedPathElement::new(ends, 6, 4, BLACK.mix(0.6));
    area.draw(&line)
}

/// The points of each family in the order of the list of methods, which is that of its knob.
fn families(points: &[Point]) -> Vec<(String, Vec<&Point>)> {
    let mut families: Vec<(String, Vec<&Point>)> = Vec::new();
    for point in points {
        match families.iter_mut().find(|(name, _)| *name == point.family) {
            Some((_, curve)) => curve.push(point),
            None => families.push((point.family.clone(), vec![point])),
        }
    }
    families
}

fn draw_family(area: &Area<'_>, axes: &Axes, points: &[&Point], style: Style) -> DrawResult {
    let place = |p: &&Point| pixel(axes, p.error_mm, p.ms_per_s);
    let has_knob = points
        .first()
        .is_some_and(|p| !NO_KNOB.contains(&p.family.as_str()));
    if has_knob {
        let curve: Vec<Pixel> = points.iter().map(place).collect();
        area.draw(&PathElement::new(
            curve,
            style.colour.mix(0.7).stroke_width(2),
        ))?;
    }
    for point in points {
        let (x, y) = place(point);
        let [low, high] = point.ms_range.map(|ms| axes.y.pixel(ms.max(LEAST_MS)));
        area.draw(&PathElement::new([(x, low), (x, high)], style.colour))?;
        if let Some(worst_mm) = point.worst_mm {
            let worst = pixel(axes, worst_mm, point.ms_per_s);
            area.draw(&PathElement::new([(x, y), worst], style.colour.mix(0.3)))?;
            area.draw(&Circle::new(worst, 3, style.colour))?;
        }
        style.mark(area, (x, y), point.failed)?;
    }
    Ok(())
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
            times_default: Some(2.0 / f64::from(n)),
            times_default_low: Some(1.5 / f64::from(n)),
            times_default_high: Some(2.5 / f64::from(n)),
            default_ms_per_s: 100.0,
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
            clamps: Vec::new(),
        }
    }

    #[test]
    fn a_plot_names_every_family_every_line_and_every_method() {
        let svg = error_plot(&scene()).expect("a plot");
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        let texts = METHODS.iter().flat_map(|m| [m.name, m.family]);
        for text in texts.chain([
            "½ blade width",
            "limit of poses",
            "frame budget",
            "noise floor",
        ]) {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn a_plot_without_points_and_one_with_zeros_can_be_drawn() {
        let mut scene = scene();
        for row in &mut scene.rows {
            row.rms_m = Some(0.0);
            row.times_default = Some(0.0);
        }
        assert!(error_plot(&scene).is_ok());
        scene.rows.clear();
        assert!(error_plot(&scene).is_ok());
    }

    #[test]
    fn a_method_without_a_finite_error_is_named_beside_the_plot() {
        let mut scene = scene();
        scene.rows[1].rms_m = None;
        let svg = error_plot(&scene).expect("a plot");
        assert!(svg.contains("without a place"), "it would be missed");
        assert!(svg.contains(METHODS[1].name));
    }
}
