//! The quad in the wind. WGSL twin: `shaders/billboards.wgsl`.

use crate::base::{Real, Vec3, vec3};

use super::Billboard;

/// Share of the wind's bend that the straight sides of a quad take: the mean of s(2 − s), so that its upper
/// edge moves as far as the tip of a blade of the same flexibility.
pub const WIND_SHARE: f64 = 2.0 / 3.0;

impl Billboard {
    /// Lower left and right, upper left and right vertex in its anchor, its top bent by `bend` along x and
    /// z. Sides keep their length (O09 section 5).
    pub fn vertices<R: Real>(&self, bend: [R; 2]) -> [Vec3<R>; 4] {
        let up = Vec3::of_f32(self.up);
        let share = R::of(WIND_SHARE);
        let lean = (up + vec3(bend[0] * share, R::ZERO, bend[1] * share)).unit_or(up);
        let [cos, sin] = self.across.map(R::of_f32);
        let half = vec3(cos, R::ZERO, sin) * (R::of(0.5) * R::of_f32(self.width_m));
        let root = Vec3::of_f32(self.root_in_anchor);
        let side = lean * R::of_f32(self.height_m);
        [
            root - half,
            root + half,
            root - half + side,
            root + half + side,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_keep_their_length() {
        let billboard = Billboard {
            root_in_anchor: [0.3, 0.1, 1.2],
            across: [0.6, 0.8],
            up: [0.0, 1.0, 0.0],
            height_m: 0.4,
            width_m: 0.5,
            flexibility: 1.0,
            flutter_turns: 0.0,
            texture: 0,
            kind: 0,
        };
        for bend in [[0.0, 0.0], [0.3, -0.2], [2.0, 1.0]] {
            let [left, right, upper_left, upper_right] = billboard.vertices::<f64>(bend);
            // Sizes are f32 and every sum rounds once at most.
            for (low, high) in [(left, upper_left), (right, upper_right)] {
                assert!(((high - low).length() - f64::from(0.4_f32)).abs() < 1e-12);
            }
            assert!(((right - left).length() - 0.5).abs() < 1e-7);
        }
    }
}
