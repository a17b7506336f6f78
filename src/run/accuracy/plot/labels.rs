//! Where the names of points go, so that none lies on another.

use super::axes::{Axes, Pixel};

/// Size of the letters in pixels, and what they need: fonts differ, so that it is on the safe side.
pub const LETTER_PX: i32 = 12;
const WIDTH_PX: i32 = 7;
const HEIGHT_PX: i32 = 13;
/// Half the side of a mark.
const MARK_PX: i32 = 6;
/// Distances from its point that a name may have, the nearest first.
const DISTANCES_PX: [i32; 9] = [9, 16, 26, 38, 52, 70, 90, 115, 145];
/// Directions in turn, in which names are tried.
const DIRECTIONS: [(f64, f64); 12] = [
    (1.0, 0.0),
    (0.87, -0.5),
    (0.87, 0.5),
    (0.5, -0.87),
    (0.5, 0.87),
    (0.0, -1.0),
    (0.0, 1.0),
    (-1.0, 0.0),
    (-0.87, -0.5),
    (-0.87, 0.5),
    (-0.5, -0.87),
    (-0.5, 0.87),
];

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box2 {
    pub left: i32,
    pub top: i32,
    pub right: i32,
    pub bottom: i32,
}

impl Box2 {
    /// The box of a mark.
    pub fn around((x, y): Pixel) -> Self {
        Self {
            left: x - MARK_PX,
            top: y - MARK_PX,
            right: x + MARK_PX,
            bottom: y + MARK_PX,
        }
    }

    /// The box of words whose left upper corner is at a place.
    pub fn of_words(words: &str, (left, top): Pixel) -> Self {
        Self {
            left,
            top,
            right: left + WIDTH_PX * words.chars().count() as i32,
            bottom: top + HEIGHT_PX,
        }
    }

    fn meets(&self, other: &Self) -> bool {
        let across = self.left < other.right && other.left < self.right;
        across && self.top < other.bottom && other.top < self.bottom
    }

    fn is_in(&self, axes: &Axes) -> bool {
        let across = self.left > axes.left() && self.right < axes.right();
        across && self.top > axes.top() && self.bottom < axes.bottom()
    }
}

/// A name that has found its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    pub words: String,
    pub place: Box2,
    /// The point it belongs to, and whether it is so far from it that a line has to lead there.
    pub point: Pixel,
    pub needs_line: bool,
}

impl Label {
    /// The end of its line.
    pub fn anchor(&self) -> Pixel {
        let Box2 {
            left,
            top,
            right,
            bottom,
        } = self.place;
        (
            self.point.0.clamp(left, right),
            self.point.1.clamp(top, bottom),
        )
    }
}

/// Places names beside their points, clear of each other, of the marks and of what is taken already.
/// A name for which there is no room at all is put right of its point.
pub fn place(points: &[(Pixel, String)], axes: &Axes, taken: &[Box2]) -> Vec<Label> {
    let mut taken = taken.to_vec();
    taken.extend(points.iter().map(|&(at, _)| Box2::around(at)));
    let mut labels = Vec::new();
    for (point, words) in points {
        let label = places(words, *point)
            .find(|label| label.place.is_in(axes) && !taken.iter().any(|t| t.meets(&label.place)))
            .unwrap_or_else(|| beside(words, *point, DIRECTIONS[0], DISTANCES_PX[0]));
        taken.push(label.place);
        labels.push(label);
    }
    labels
}

fn places(words: &str, point: Pixel) -> impl Iterator<Item = Label> {
    let near_first = DISTANCES_PX.into_iter();
    near_first.flat_map(move |far| DIRECTIONS.map(|to| beside(words, point, to, far)))
}

/// A name whose nearest edge is at a distance from its point in a direction.
fn beside(words: &str, point: Pixel, (x, y): (f64, f64), far_px: i32) -> Label {
    let size = Box2::of_words(words, (0, 0));
    let shift = |along: f64, length: i32| {
        let edge =
            (0.5 * (along.signum() * f64::from(along != 0.0) - 1.0) * f64::from(length)).round();
        (along * f64::from(far_px)).round() as i32 + edge as i32
    };
    let corner = (
        point.0 + shift(x, size.right),
        point.1 + shift(y, size.bottom),
    );
    Label {
        words: words.to_owned(),
        place: Box2::of_words(words, corner),
        point,
        needs_line: far_px > DISTANCES_PX[1],
    }
}

#[cfg(test)]
mod tests {
    use super::super::axes::LogAxis;
    use super::*;

    fn axes() -> Axes {
        Axes {
            x: LogAxis::around([1.0, 100.0].into_iter(), 60, 1000),
            y: LogAxis::around([1.0, 100.0].into_iter(), 700, 40),
        }
    }

    #[test]
    fn names_of_points_that_lie_together_do_not_meet() {
        let points: Vec<_> = (0..30)
            .map(|n| ((500 + n % 3, 300 + n), format!("method-{n}")))
            .collect();
        let labels = place(&points, &axes(), &[]);
        for (n, label) in labels.iter().enumerate() {
            assert!(label.place.is_in(&axes()), "{label:?}");
            for other in &labels[n + 1..] {
                assert!(!label.place.meets(&other.place), "{label:?} {other:?}");
            }
            for (point, _) in &points {
                assert!(!label.place.meets(&Box2::around(*point)), "{label:?}");
            }
        }
    }

    #[test]
    fn a_lonely_name_stands_right_of_its_point_and_left_of_it_at_the_right_edge() {
        let at = |x| place(&[((x, 300), "lonely".into())], &axes(), &[]).remove(0);
        assert!(at(500).place.left > 500 && !at(500).needs_line);
        assert!(at(990).place.right < 990);
    }
}
