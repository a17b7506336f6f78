//! A billboard in 32 bytes, as devices keep it. WGSL twin: `shaders/shared/billboard.wgsl`.
//!
//! Every engine opens the same words, so sizes, phases and pictures are equal bit for bit, and directions
//! to the rounding of a square root.

use super::Billboard;

/// Pictures of each kind of clump.
pub const CLUMP_VARIANTS: u32 = 4;
/// Steps of a metre, and of a flexibility of 1.
pub const FINE_STEPS: u32 = 4096;
/// Steps of a component of a unit vector from 0 to 1.
pub const UNIT_STEPS: i32 = 32_767;
/// One of them.
pub const UNIT_STEP: f32 = 1.0 / UNIT_STEPS as f32;
/// Steps of a turn.
pub const AZIMUTH_STEPS: u32 = 1 << 16;

/// A billboard and its tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackedBillboard {
    pub root_in_anchor: [f32; 3],
    /// Height in the lower half, width in the upper, in 1/4096 m.
    pub size: u32,
    /// x and z of the growth direction, signed, in [`UNIT_STEPS`]; y, which is not below 0, follows.
    pub up: u32,
    /// x and z of the lower edge's direction, signed, in about [`UNIT_STEPS`].
    pub across: u32,
    /// Flexibility in 1/4096 in the lower half, phase of the trembling in 2⁻¹⁶ turns in the upper.
    pub sway: u32,
    /// The tile in the lower 24 bits, the texture in the upper 8.
    pub tile_and_texture: u32,
}

/// Two numbers of 16 bits as one word, the first in the lower half.
pub(super) fn pair(low: u32, high: u32) -> u32 {
    low | (high << 16)
}

/// Two signed numbers of 16 bits as one word.
pub(super) fn signed_pair([low, high]: [i32; 2]) -> u32 {
    pair(low as u32 & 0xffff, high as u32 & 0xffff)
}

fn opened_pair(word: u32) -> [i32; 2] {
    [word as i16, (word >> 16) as i16].map(i32::from)
}

/// The squared length of a level vector in steps.
pub(super) fn level_squared([x, z]: [i32; 2]) -> u32 {
    (x * x + z * z) as u32
}

impl PackedBillboard {
    pub fn tile(&self) -> u32 {
        self.tile_and_texture & 0x00ff_ffff
    }

    pub fn texture(&self) -> u32 {
        self.tile_and_texture >> 24
    }

    /// The billboard in floats.
    pub fn open(&self) -> Billboard {
        let share = |n: u32| n as f32 * (1.0 / FINE_STEPS as f32);
        let up = opened_pair(self.up);
        let across = opened_pair(self.across);
        let per_step = 1.0 / (level_squared(across) as f32).sqrt();
        Billboard {
            root_in_anchor: self.root_in_anchor,
            across: across.map(|steps| steps as f32 * per_step),
            up: [up[0] as f32 * UNIT_STEP, rise(up), up[1] as f32 * UNIT_STEP],
            height_m: share(self.size & 0xffff),
            width_m: share(self.size >> 16),
            flexibility: share(self.sway & 0xffff),
            flutter_turns: (self.sway >> 16) as f32 * (1.0 / AZIMUTH_STEPS as f32),
            texture: self.texture(),
            kind: self.texture() / CLUMP_VARIANTS,
        }
    }
}

/// y of a unit vector with these level steps, whose y is not below 0.
fn rise(level: [i32; 2]) -> f32 {
    let whole = (UNIT_STEPS * UNIT_STEPS) as u32;
    let left = whole.saturating_sub(level_squared(level));
    (left as f32).sqrt() * UNIT_STEP
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_hold_what_they_are_given() {
        let packed = PackedBillboard {
            root_in_anchor: [1.0, -2.0, 0.5],
            size: pair(2048, 4096 * 10),
            up: signed_pair([-UNIT_STEPS / 2, 3]),
            across: signed_pair([0, -UNIT_STEPS]),
            sway: pair(6144, 1 << 15),
            tile_and_texture: (30 << 24) | 0x00fe_dcba,
        };
        let open = packed.open();
        assert_eq!((open.height_m, open.width_m), (0.5, 10.0));
        assert_eq!((open.flexibility, open.flutter_turns), (1.5, 0.5));
        assert_eq!(open.across, [0.0, -1.0]);
        assert_eq!((open.texture, open.kind, packed.tile()), (30, 7, 0xfe_dcba));
        let length = open.up.map(|c| f64::from(c).powi(2)).iter().sum::<f64>();
        // Three roundings of 2⁻²⁴ each.
        assert!((length - 1.0).abs() < 4e-7, "{length}");
        assert!((open.up[0] + 0.5).abs() < 1e-4 && open.up[1] > 0.86);
        assert_eq!(rise([UNIT_STEPS, 200]), 0.0);
    }
}
