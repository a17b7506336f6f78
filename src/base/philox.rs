//! Philox-2x32: a random function of a counter and a key (Salmon et al. 2011).
//!
//! P15 section 2.2 uses three rounds. With consecutive triangle ids as counters three rounds leave
//! neighbours correlated, so seven are the default and three the `paper` variant. The WGSL twin is
//! `shaders/shared/philox.wgsl`; both agree bit for bit.

const MULTIPLIER: u32 = 0xD256_D193;
const WEYL: u32 = 0x9E37_79B9;

/// Two random words for a counter of two words and a key.
pub fn philox2x32(counter: [u32; 2], key: u32, rounds: u32) -> [u32; 2] {
    let [mut c0, mut c1] = counter;
    let mut k = key;
    for _ in 0..rounds {
        let product = u64::from(MULTIPLIER) * u64::from(c0);
        c0 = (product >> 32) as u32 ^ k ^ c1;
        c1 = product as u32;
        k = k.wrapping_add(WEYL);
    }
    [c0, c1]
}

/// A small generator for a plant's remaining parameters: PCG with a 32-bit state
/// (RXS-M-XS output, O'Neill 2014).
#[derive(Clone, Copy, Debug)]
pub struct Pcg(u32);

impl Pcg {
    /// Starts from the two words a plant got from Philox.
    pub fn from_words(words: [u32; 2]) -> Self {
        Self(words[0] ^ words[1].wrapping_mul(WEYL))
    }

    pub fn next_word(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((self.0 >> ((self.0 >> 28) + 4)) ^ self.0).wrapping_mul(277_803_737);
        (word >> 22) ^ word
    }
}

/// A word as a fraction in [0, 1): its upper 24 bits, exact in `f32`.
pub fn unit(word: u32) -> f32 {
    (word >> 8) as f32 * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_answers() {
        assert_eq!(philox2x32([0, 0], 0, 10), [0xff1d_ae59, 0x6cd1_0df2]);
        assert_eq!(
            philox2x32([0x243f_6a88, 0x85a3_08d3], 0x1319_8a2e, 10),
            [0xdd7c_e038, 0xf62a_4c12]
        );
        assert_eq!(philox2x32([0, 0], 0, 7), [0x257a_3673, 0xcd26_be2a]);
        assert_eq!(philox2x32([0, 0], 0, 3), [0xbd91_d970, 0xca60_ee3b]);
    }

    #[test]
    fn unit_stays_below_one() {
        assert_eq!(unit(0), 0.0);
        assert!(unit(u32::MAX) < 1.0);
    }
}
