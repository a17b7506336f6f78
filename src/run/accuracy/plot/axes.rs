//! Two logarithmic axes in pixels.

use plotters::prelude::*;
use plotters::style::FontTransform;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::{Area, DrawResult};

/// A place in a picture: pixels from its left and from its top.
pub type Pixel = (i32, i32);

const GRID: RGBColor = RGBColor(225, 225, 225);
const FONT: &str = "sans-serif";

/// An axis from a pixel to another, logarithmic in its values.
#[derive(Clone, Copy, Debug)]
pub struct LogAxis {
    low: f64,
    high: f64,
    first_px: i32,
    last_px: i32,
}

impl LogAxis {
    /// An axis that has room for some values above 0 and, at either end, for what is written at
    /// them.
    pub fn around(values: impl Iterator<Item = f64>, first_px: i32, last_px: i32) -> Self {
        let extremes = values.fold(None, |found: Option<(f64, f64)>, v| {
            let (low, high) = found.unwrap_or((v, v));
            Some((low.min(v), high.max(v)))
        });
        let (low, high) = extremes.unwrap_or((0.1, 10.0));
        Self {
            low: low / 1.4,
            high: high * 1.8,
            first_px,
            last_px,
        }
    }

    /// The pixel of a value; one beyond an end is at that end.
    pub fn pixel(&self, value: f64) -> i32 {
        let share = (value / self.low).ln() / (self.high / self.low).ln();
        let along = share.clamp(0.0, 1.0) * f64::from(self.last_px - self.first_px);
        self.first_px + along.round() as i32
    }

    /// 1, 2 and 5 times the powers of ten on the axis.
    pub fn ticks(&self) -> Vec<f64> {
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let all = decades.flat_map(|power| [1.0, 2.0, 5.0].map(|n| n * 10_f64.powi(power)));
        let on_axis = all.filter(|tick| (self.low..=self.high).contains(tick));
        on_axis.collect()
    }
}

/// Both axes, x to the right and y upwards.
#[derive(Clone, Copy, Debug)]
pub struct Axes {
    pub x: LogAxis,
    pub y: LogAxis,
}

impl Axes {
    pub fn pixel(&self, x: f64, y: f64) -> Pixel {
        (self.x.pixel(x), self.y.pixel(y))
    }

    pub fn left(&self) -> i32 {
        self.x.first_px
    }

    pub fn right(&self) -> i32 {
        self.x.last_px
    }

    pub fn bottom(&self) -> i32 {
        self.y.first_px
    }

    pub fn top(&self) -> i32 {
        self.y.last_px
    }

    /// Draws grid, frame, numbers and what the axes are.
    pub fn draw(&self, area: &Area<'_>, x_is: &str, y_is: &str) -> DrawResult {
        let (left, right) = (self.left(), self.right());
        let (bottom, top) = (self.bottom(), self.top());
        for tick in self.x.ticks() {
            let x = self.x.pixel(tick);
            area.draw(&PathElement::new([(x, bottom), (x, top)], GRID))?;
            area.draw(&text(
                &short(tick),
                (x, bottom + 6),
                14,
                HPos::Center,
                VPos::Top,
            ))?;
        }
        for tick in self.y.ticks() {
            let y = self.y.pixel(tick);
            area.draw(&PathElement::new([(left, y), (right, y)], GRID))?;
            area.draw(&text(
                &short(tick),
                (left - 6, y),
                14,
                HPos::Right,
                VPos::Center,
            ))?;
        }
        area.draw(&Rectangle::new([(left, top), (right, bottom)], BLACK))?;
        let middle = ((left + right) / 2, (top + bottom) / 2);
        area.draw(&text(
            x_is,
            (middle.0, bottom + 30),
            15,
            HPos::Center,
            VPos::Top,
        ))?;
        let turned = (FONT, 15).into_font().transform(FontTransform::Rotate270);
        let turned = turned
            .color(&BLACK)
            .pos(Pos::new(HPos::Center, VPos::Center));
        area.draw(&Text::new(y_is.to_owned(), (14, middle.1), turned))
    }
}

/// A text at a pixel.
pub fn text(
    words: &str,
    at: Pixel,
    size: i32,
    across: HPos,
    down: VPos,
) -> Text<'static, Pixel, String> {
    let style = (FONT, size).into_font().color(&BLACK);
    Text::new(words.to_owned(), at, style.pos(Pos::new(across, down)))
}

fn short(value: f64) -> String {
    if (0.01..1e6).contains(&value) {
        // A power of ten is not exact: its rounding must not be printed.
        format!("{}", (value * 100.0).round() / 100.0)
    } else {
        format!("{value:.0e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_ratios_are_equally_long_and_ticks_lie_on_the_axis() {
        let axis = LogAxis::around([1.0, 100.0].into_iter(), 50, 950);
        let [one, ten, hundred] = [1.0, 10.0, 100.0].map(|v| axis.pixel(v));
        assert!(
            ((ten - one) - (hundred - ten)).abs() <= 1,
            "{one} {ten} {hundred}"
        );
        assert!(one > 50 && hundred < 950, "room for labels");
        assert_eq!(axis.ticks(), [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]);
    }

    #[test]
    fn an_axis_of_one_value_and_of_none_can_be_drawn() {
        for values in [vec![], vec![3.0], vec![3.0, 3.0]] {
            let axis = LogAxis::around(values.into_iter(), 0, 100);
            assert!((0..=100).contains(&axis.pixel(3.0)));
            assert!(!axis.ticks().is_empty() || axis.pixel(3.0) > 0);
        }
    }

    #[test]
    fn numbers_at_ticks_are_short() {
        let short: Vec<String> = [1e-4, 0.02, 0.5, 2.0, 5000.0].map(short).into();
        assert_eq!(short, ["1e-4", "0.02", "0.5", "2", "5000"]);
    }
}
