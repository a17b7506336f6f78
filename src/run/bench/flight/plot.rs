//! The plots of P15, figures 7 to 9, as SVG.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::experiment::FlightBench;
use super::seeding::CLUSTERS;

/// Pixels of a plot.
const SIZE: (u32, u32) = (900, 480);
const FONT: &str = "sans-serif";
/// Areas from the largest to the smallest, light to dark.
const GREYS: [RGBColor; 5] = [
    RGBColor(222, 226, 214),
    RGBColor(186, 198, 168),
    RGBColor(146, 166, 118),
    RGBColor(104, 128, 74),
    RGBColor(62, 84, 40),
];

/// Why a plot could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("a plot of the flight cannot be drawn: {0}")]
pub struct FlightPlotError(String);

/// Numbers over the seconds of the flight.
struct Series {
    name: String,
    values: Vec<f64>,
}

impl Series {
    fn new(name: impl Into<String>, values: impl Iterator<Item = f64>) -> Self {
        Self {
            name: name.into(),
            values: values.collect(),
        }
    }

    fn sum(&self) -> f64 {
        self.values.iter().sum()
    }
}

/// A plot of areas, the smaller ones over the larger ones, and perhaps a dashed line with its own axis on the
/// right.
struct Plot<'a> {
    title: &'a str,
    unit: &'a str,
    areas: Vec<Series>,
    line: Option<Series>,
}

/// Figure 7: time of a frame, with plants and without.
///
/// # Errors
///
/// What the plotting crate refuses.
pub fn frame_time_plot(bench: &FlightBench) -> Result<String, FlightPlotError> {
    let seconds = &bench.seconds;
    draw(&Plot {
        title: "Time of a frame over the flight",
        unit: "ms",
        areas: vec![
            Series::new("with plants", seconds.iter().map(|s| s.frame_ms)),
            Series::new("without", seconds.iter().map(|s| s.frame_ms_without_plants)),
        ],
        line: None,
    })
}

/// Figure 8: clusters and triangles of a frame.
///
/// # Errors
///
/// What the plotting crate refuses.
pub fn load_plot(bench: &FlightBench) -> Result<String, FlightPlotError> {
    let seconds = &bench.seconds;
    draw(&Plot {
        title: "Clusters of 8 seeds in a frame, and triangles of its plants",
        unit: "clusters",
        areas: vec![
            Series::new("submitted", seconds.iter().map(|s| s.clusters)),
            Series::new("drawn", seconds.iter().map(|s| s.drawn)),
            Series::new("on bare soil", seconds.iter().map(|s| s.bare)),
        ],
        line: Some(Series::new(
            "triangles",
            seconds.iter().map(|s| s.triangles),
        )),
    })
}

/// Figure 9: time of seeding by the size of clusters.
///
/// # Errors
///
/// What the plotting crate refuses.
pub fn seeding_plot(bench: &FlightBench) -> Result<String, FlightPlotError> {
    let rows = &bench.seeding;
    let areas = CLUSTERS.iter().enumerate().map(|(size, cluster)| {
        let name = match cluster {
            1 => "seeds alone".to_owned(),
            _ => format!("clusters of {cluster}"),
        };
        Series::new(name, rows.iter().map(|row| row.ms[size]))
    });
    draw(&Plot {
        title: "Time of seeding on the device, by the size of clusters",
        unit: "ms",
        areas: areas.collect(),
        line: None,
    })
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type DrawResult = Result<(), DrawingAreaErrorKind<std::io::Error>>;

fn draw(plot: &Plot<'_>) -> Result<String, FlightPlotError> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        let failed = |error: DrawingAreaErrorKind<_>| FlightPlotError(error.to_string());
        drawn(&area, plot).map_err(failed)?;
        area.present().map_err(failed)?;
    }
    Ok(svg)
}

/// The end of an axis that holds all values.
fn end_of(series: &[&Series]) -> f64 {
    let all = series.iter().flat_map(|one| &one.values);
    1.15 * all.copied().fold(1e-3, f64::max)
}

/// A number as on an axis, with thousands and millions by their letters.
fn short(value: &f64) -> String {
    match *value {
        v if v >= 1e6 => format!("{:.1} M", v * 1e-6),
        v if v >= 1e4 => format!("{:.0} k", v * 1e-3),
        v if v >= 10.0 => format!("{v:.0}"),
        v => format!("{v:.1}"),
    }
}

fn drawn(area: &Area<'_>, plot: &Plot<'_>) -> DrawResult {
    area.fill(&WHITE)?;
    let last = plot.areas.first().map_or(0, |one| one.values.len()) as f64;
    let mut areas: Vec<&Series> = plot.areas.iter().collect();
    areas.sort_by(|a, b| b.sum().total_cmp(&a.sum()));
    let line: Vec<&Series> = plot.line.iter().collect();
    let mut chart = ChartBuilder::on(area)
        .caption(plot.title, (FONT, 18))
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(66)
        .right_y_label_area_size(if plot.line.is_some() { 66 } else { 12 })
        .build_cartesian_2d(0.0..last, 0.0..end_of(&areas))?
        .set_secondary_coord(0.0..last, 0.0..end_of(&line));
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(WHITE)
        .x_desc("second of the flight")
        .y_desc(plot.unit)
        .x_label_formatter(&|second| format!("{second:.0}"))
        .y_label_formatter(&short)
        .label_style((FONT, 13))
        .draw()?;
    let shades = GREYS.iter().skip(GREYS.len().saturating_sub(areas.len()));
    for (series, &shade) in areas.iter().zip(shades) {
        let outline = steps(&series.values);
        let closed = [(0.0, 0.0)].into_iter().chain(outline).chain([(last, 0.0)]);
        let polygon = Polygon::new(closed.collect::<Vec<_>>(), shade.filled());
        chart
            .draw_series([polygon])?
            .label(series.name.as_str())
            .legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 18, y + 5)], shade.filled()));
    }
    for series in line {
        chart
            .configure_secondary_axes()
            .y_desc(series.name.as_str())
            .y_label_formatter(&short)
            .label_style((FONT, 13))
            .draw()?;
        let path = DashedLineSeries::new(steps(&series.values), 5, 4, BLACK.stroke_width(1));
        chart
            .draw_secondary_series(path)?
            .label(series.name.as_str())
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], BLACK));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.8))
        .label_font((FONT, 13))
        .draw()
}

/// Means of seconds as steps: a level line over each.
fn steps(values: &[f64]) -> Vec<(f64, f64)> {
    let ends =
        |(second, &value): (usize, &f64)| [(second as f64, value), (second as f64 + 1.0, value)];
    values.iter().enumerate().flat_map(ends).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plot_names_all_it_shows() {
        let series = |name: &str| Series::new(name, (0..30).map(f64::from));
        let svg = draw(&Plot {
            title: "a flight",
            unit: "ms",
            areas: vec![series("first"), series("second")],
            line: Some(series("third")),
        })
        .expect("a plot");
        for text in ["a flight", "first", "second", "third", "ms"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn a_second_is_a_step() {
        assert_eq!(
            steps(&[2.0, 3.0]),
            [(0.0, 2.0), (1.0, 2.0), (1.0, 3.0), (2.0, 3.0)]
        );
    }
}
