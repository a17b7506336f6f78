//! What every cell sees of the sky: a bit per direction. The costly part of light volumes, and the one
//! that does not depend on the sun; kept on disk as [`Visibility::to_bytes`].

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::base::{Hash64, Vec3};
use crate::bodies::Sight;

use super::directions::sky_directions;
use super::grid::LightGrid;

/// Changes whenever the same scene would be given other bits, or bytes another meaning.
const VERSION: u64 = 1;
const MAGIC: &[u8; 8] = b"swdlight";

/// What a ray from a place along a unit vector meets.
pub type SightOf<'a> = dyn Fn([f64; 3], [f64; 3]) -> Sight + Sync + 'a;

/// What every cell of a grid sees.
#[derive(Clone, Debug, PartialEq)]
pub struct Visibility {
    pub grid: LightGrid,
    pub(super) directions: Vec<Vec3<f64>>,
    /// Runs of words, one run per cell: bit n is set where nothing hides direction n.
    bits: Vec<u64>,
    /// A bit per cell: set where the cell lies in a body.
    inside: Vec<u64>,
}

/// How far the work on another thread is, and whether it is still wanted.
#[derive(Debug, Default)]
pub struct TraceProgress {
    pub cells_done: AtomicUsize,
    pub is_unwanted: AtomicBool,
}

impl TraceProgress {
    fn is_unwanted(&self) -> bool {
        self.is_unwanted.load(Ordering::Relaxed)
    }
}

impl Visibility {
    /// Traces all rays, on as many threads as the current rayon pool has; the bits do not depend on them.
    /// `None` where it is no longer wanted.
    pub fn trace(
        grid: LightGrid,
        rays: u32,
        seed: u32,
        sight: &SightOf<'_>,
        progress: &TraceProgress,
    ) -> Option<Self> {
        let directions = sky_directions(rays, seed);
        let words = words_for(directions.len());
        let along: Vec<[f64; 3]> = directions.iter().map(|d| d.to_f64()).collect();
        let mut bits = vec![0; grid.cells() * words];
        let mut is_inside = vec![false; grid.cells()];
        bits.par_chunks_mut(words)
            .zip(&mut is_inside)
            .enumerate()
            .for_each(|(cell, (bits, is_inside))| {
                if !progress.is_unwanted() {
                    *is_inside = look(grid.place(cell), &along, sight, bits);
                    progress.cells_done.fetch_add(1, Ordering::Relaxed);
                }
            });
        let mut inside = vec![0; words_for(grid.cells())];
        for (cell, _) in is_inside.iter().enumerate().filter(|(_, inside)| **inside) {
            inside[cell / 64] |= 1 << (cell % 64);
        }
        (!progress.is_unwanted()).then_some(Self {
            grid,
            directions,
            bits,
            inside,
        })
    }

    /// A name for what [`Visibility::trace`] would give, from the hash of what rays meet.
    pub fn key(grid: &LightGrid, rays: u32, seed: u32, sight_hash: u64) -> u64 {
        let mut hash = Hash64::default();
        for word in [VERSION, sight_hash, u64::from(rays), u64::from(seed)] {
            hash.word(word);
        }
        grid.hash_into(&mut hash);
        hash.value()
    }

    /// The directions that a cell sees; none where it lies in a body.
    pub(super) fn seen_from(&self, cell: usize) -> impl Iterator<Item = usize> {
        let words = words_for(self.directions.len());
        let run = &self.bits[cell * words..(cell + 1) * words];
        run.iter().enumerate().flat_map(|(place, &word)| {
            let bits = (0..64).filter(move |bit| word >> bit & 1 == 1);
            bits.map(move |bit| 64 * place + bit)
        })
    }

    pub(super) fn is_inside(&self, cell: usize) -> bool {
        self.inside[cell / 64] >> (cell % 64) & 1 == 1
    }

    /// Bytes that [`Visibility::to_bytes`] gives.
    pub fn file_bytes(grid: &LightGrid, rays: u32) -> usize {
        // A mark, the key and two counts before them; a hash after them.
        8 * (4 + lengths(grid, rays).iter().sum::<usize>() + 1)
    }

    /// The bits with their key, and a hash at the end.
    pub fn to_bytes(&self, key: u64) -> Vec<u8> {
        let counts = [key, self.bits.len() as u64, self.inside.len() as u64];
        let mut bytes = MAGIC.to_vec();
        for word in counts.iter().chain(&self.bits).chain(&self.inside) {
            bytes.extend(word.to_le_bytes());
        }
        let mut hash = Hash64::default();
        hash.bytes(&bytes);
        bytes.extend(hash.value().to_le_bytes());
        bytes
    }

    /// Reads what [`Visibility::to_bytes`] wrote for the same key.
    ///
    /// # Errors
    /// In words, what is wrong with the bytes.
    pub fn from_bytes(
        bytes: &[u8],
        key: u64,
        grid: LightGrid,
        rays: u32,
        seed: u32,
    ) -> Result<Self, String> {
        let directions = sky_directions(rays, seed);
        let lengths = lengths(&grid, rays);
        let wanted = Self::file_bytes(&grid, rays);
        if bytes.len() != wanted {
            return Err(format!("it has {} bytes in place of {wanted}", bytes.len()));
        }
        let (content, end) = bytes.split_at(wanted - 8);
        let mut hash = Hash64::default();
        hash.bytes(content);
        if end != hash.value().to_le_bytes() {
            return Err("its bytes do not have the hash at its end".to_owned());
        }
        let mut words = content.chunks_exact(8).map(|chunk| {
            let mut word = [0; 8];
            word.copy_from_slice(chunk);
            u64::from_le_bytes(word)
        });
        let head = [words.next(), words.next(), words.next(), words.next()];
        let expected = [key, lengths[0] as u64, lengths[1] as u64].map(Some);
        if !content.starts_with(MAGIC) || head[1..] != expected {
            return Err("it belongs to another scene".to_owned());
        }
        let bits = words.by_ref().take(lengths[0]).collect();
        Ok(Self {
            grid,
            directions,
            bits,
            inside: words.collect(),
        })
    }
}

/// Words of both runs of bits.
fn lengths(grid: &LightGrid, rays: u32) -> [usize; 2] {
    [
        grid.cells() * words_for(rays as usize),
        words_for(grid.cells()),
    ]
}

/// Words that hold so many bits.
fn words_for(bits: usize) -> usize {
    bits.div_ceil(64)
}

/// Sets the bits of one cell, and tells whether it lies in a body.
fn look(place: [f64; 3], along: &[[f64; 3]], sight: &SightOf<'_>, bits: &mut [u64]) -> bool {
    for (n, &direction) in along.iter().enumerate() {
        match sight(place, direction) {
            Sight::Open => bits[n / 64] |= 1 << (n % 64),
            Sight::Blocked => {}
            Sight::Inside => return true,
        }
    }
    false
}
