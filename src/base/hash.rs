//! A 64-bit hash of words, for comparing the bits of two runs.

/// Takes in words one after the other.
///
/// Each step, an exclusive or, a product with an odd number and a shifted exclusive or, can be
/// undone: two streams that differ in one word never meet. No protection against forgery.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Hash64(u64);

impl Default for Hash64 {
    fn default() -> Self {
        // The digits of pi after the point.
        Self(0x243f_6a88_85a3_08d3)
    }
}

impl Hash64 {
    pub fn word(&mut self, word: u64) {
        // 2^64 over the golden ratio, made odd.
        self.0 = (self.0 ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 ^= self.0 >> 32;
    }

    /// Takes in bytes and their number.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.word(bytes.len() as u64);
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.word(u64::from_le_bytes(word));
        }
    }

    /// The hash so far, mixed so that sums of several hashes are good hashes too.
    pub fn value(self) -> u64 {
        // The finaliser of Steele, Lea and Flood's SplitMix64.
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_words(words: &[u64]) -> u64 {
        let mut hash = Hash64::default();
        words.iter().for_each(|&word| hash.word(word));
        hash.value()
    }

    #[test]
    fn order_length_and_every_bit_count() {
        let all = [
            of_words(&[]),
            of_words(&[0]),
            of_words(&[0, 0]),
            of_words(&[1, 2]),
            of_words(&[2, 1]),
        ];
        for (i, a) in all.iter().enumerate() {
            assert!(all[i + 1..].iter().all(|b| a != b), "{all:x?}");
        }
        for bit in 0..64 {
            assert_ne!(of_words(&[1 << bit, 7]), of_words(&[0, 7]), "bit {bit}");
        }
    }

    #[test]
    fn bytes_are_told_from_padded_ones() {
        let of_bytes = |bytes: &[u8]| {
            let mut hash = Hash64::default();
            hash.bytes(bytes);
            hash.value()
        };
        assert_ne!(of_bytes(b"ball"), of_bytes(b"ball\0"));
        assert_ne!(of_bytes(b"ball one, two"), of_bytes(b"ball one, twp"));
    }
}
