//! A picture's values between its texels, mixed in integers: the same bits on every machine and device.

/// The four texels around a place of a picture.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct BetweenTexels {
    /// Where they lie in the picture's rows: low and high x at the low z, then at the high z.
    pub texels: [usize; 4],
    /// How far the place lies from the low ones to the high ones along x and z, in units of 2⁻⁸.
    pub shares: [u32; 2],
}

impl BetweenTexels {
    /// Around a place in units of 2⁻¹⁶ texel, of a picture of so many columns and rows. Beyond the
    /// outer texels' middles the edge's values go on.
    pub fn at(place: [u32; 2], size: [u32; 2]) -> Self {
        // A texel's value lies in its middle.
        let at = place.map(|p| p.max(1 << 15) - (1 << 15));
        let low = [0, 1].map(|a| (at[a] >> 16).min(size[a] - 1));
        let high = [0, 1].map(|a| (low[a] + 1).min(size[a] - 1));
        let texel = |x: u32, z: u32| z as usize * size[0] as usize + x as usize;
        Self {
            texels: [
                texel(low[0], low[1]),
                texel(high[0], low[1]),
                texel(low[0], high[1]),
                texel(high[0], high[1]),
            ],
            shares: at.map(|p| (p >> 8) & 255),
        }
    }

    /// The mixed value in units of 2⁻¹⁶ of a texel's, of values below 2¹⁶.
    pub fn mix(&self, value: impl Fn(usize) -> u32) -> u32 {
        let [u, v] = self.shares;
        let corners = self.texels.map(value);
        let near = corners[0] * (256 - u) + corners[1] * u;
        let far = corners[2] * (256 - u) + corners[3] * u;
        near * (256 - v) + far * v
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_mixed_along_lines() {
        let values = [0_u32, 1000, 65_535, 65_535];
        let at = |x: f64, z: f64| {
            let place = [x, z].map(|p| (p * 65_536.0) as u32);
            let between = BetweenTexels::at(place, [2, 2]);
            f64::from(between.mix(|texel| values[texel])) / 65_536.0
        };
        assert_eq!(at(0.5, 0.5), 0.0);
        assert_eq!(at(1.0, 0.0), 500.0);
        assert_eq!(at(0.75, 0.2), 250.0);
        assert_eq!(at(2.0, 1.0), 0.5 * (1000.0 + 65_535.0));
        assert_eq!(at(9.0, 9.0), 65_535.0);
    }
}
