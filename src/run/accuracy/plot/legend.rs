//! How families of methods look, and what their marks mean.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::{Axes, Pixel, text};
use super::{Area, DrawError, DrawResult};

/// Colours that are told apart on white, also by most who see few colours.
const COLOURS: [RGBColor; 12] = [
    RGBColor(0, 0, 0),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 140, 100),
    RGBColor(170, 60, 140),
    RGBColor(150, 110, 0),
    RGBColor(60, 60, 190),
    RGBColor(200, 30, 30),
    RGBColor(70, 120, 20),
    RGBColor(110, 80, 60),
    RGBColor(0, 150, 190),
    RGBColor(120, 120, 120),
];

/// How a family looks: past the last colour they come again with other marks.
#[derive(Clone, Copy, Debug)]
pub struct Style {
    pub colour: RGBColor,
    square: bool,
}

impl Style {
    pub fn of(number: usize) -> Self {
        Self {
            colour: COLOURS[number % COLOURS.len()],
            square: (number / COLOURS.len()) % 2 == 1,
        }
    }

    /// A point that meets every limit, or misses one.
    pub fn mark(self, area: &Area<'_>, (x, y): Pixel, failed: bool) -> DrawResult {
        let colour = self.colour;
        match (failed, self.square) {
            (true, false) => area.draw(&Cross::new((x, y), 5, colour.stroke_width(2))),
            (true, true) => area.draw(&TriangleMarker::new((x, y), 6, colour.stroke_width(2))),
            (false, false) => area.draw(&Circle::new((x, y), 5, colour.filled())),
            (false, true) => {
                let corners = [(x - 4, y - 4), (x + 4, y + 4)];
                area.draw(&Rectangle::new(corners, colour.filled()))
            }
        }
    }
}

/// Names the families right of the axes, what marks mean, and the methods without a place.
pub fn draw_legend(
    area: &Area<'_>,
    axes: &Axes,
    families: &[(String, Style)],
    missing: &[String],
) -> DrawResult {
    let left = axes.right() + 14;
    let mut y = axes.top() + 10;
    let mut words = |row_px: i32, words: &str| {
        let at = (left + 26, y);
        y += row_px;
        area.draw(&text(words, at, 14, HPos::Left, VPos::Center))?;
        Ok::<i32, DrawError>(at.1)
    };
    for (family, style) in families {
        let y = words(22, family)?;
        let sample = [(left, y), (left + 18, y)];
        area.draw(&PathElement::new(sample, style.colour.stroke_width(2)))?;
        style.mark(area, (left + 9, y), false)?;
    }
    words(12, "")?;
    for (failed, meaning) in [(false, "meets every limit"), (true, "misses a limit")] {
        let y = words(22, meaning)?;
        Style::of(0).mark(area, (left + 3, y), failed)?;
        Style::of(COLOURS.len()).mark(area, (left + 16, y), failed)?;
    }
    let y = words(22, "time known to")?;
    area.draw(&PathElement::new(
        [(left + 9, y - 7), (left + 9, y + 7)],
        BLACK,
    ))?;
    if !missing.is_empty() {
        words(18, "without a place:")?;
    }
    for method in missing {
        words(18, method)?;
    }
    Ok(())
}
