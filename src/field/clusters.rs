//! Clusters of seeds with hierarchical stratification: P15 section 3.4, eq. 19-22.
//!
//! The clusters of a triangle fill grids of 1, 4, 9, … strata, one cluster a stratum, each grid
//! before the next: any number of them covers the triangle, and none moves when there are more. All
//! seeds of a cluster lie in its stratum and are of the kind that grows at the cluster's middle.
//!
//! Deviations: the grid is found by counting up the pyramidal numbers of eq. 19 in integers, which
//! is exact where eq. 21 and 22 are not; a grid's strata are taken in a random order, each once,
//! instead of at random; strata are folded onto the triangle (eq. 23-24) as wholes, so that a
//! cluster stays in one place. WGSL twin: `shaders/shared/clusters.wgsl`, bit for bit.

use crate::base::philox::philox2x32;

/// Second counter word of a cluster's own random words, plus its number.
pub const CLUSTER_WORD: u32 = 1 << 31;
/// Second counter word of a grid's random order, plus the strata on its side.
pub const GRID_WORD: u32 = 3 << 30;

/// One square of the grid of `side` by `side` over the unit square that is folded to a triangle.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Stratum {
    pub side: u32,
    /// Counts of the stratum along both legs; together at most `side` − 1.
    pub at: [u32; 2],
}

/// Strata along the side of a cluster's grid, and the clusters in all smaller grids. Clusters count
/// from 0.
pub fn grid_of(cluster: u32) -> (u32, u32) {
    let (mut side, mut before) = (1, 0);
    while before + side * side <= cluster {
        before += side * side;
        side += 1;
    }
    (side, before)
}

/// The stratum of a triangle's cluster.
pub fn stratum(triangle: u32, cluster: u32, key: u32, rounds: u32) -> Stratum {
    let (side, before) = grid_of(cluster);
    let [turn, start] = philox2x32([triangle, GRID_WORD + side], key, rounds);
    // 1 + n·h has no divisor in common with n, so the steps visit every stratum once.
    let strata = side * side;
    let step = 1 + side * (turn % side);
    let rank = ((cluster - before) * step + start % strata) % strata;
    let at = [rank % side, rank / side];
    let folds = at[0] + at[1] >= side;
    Stratum {
        side,
        at: if folds { at.map(|n| side - 1 - n) } else { at },
    }
}

impl Stratum {
    /// Random words of the whole triangle, turned into words of the stratum: along both legs, their
    /// sum below 2³².
    pub fn within(&self, words: [u32; 2]) -> [u32; 2] {
        let width = u32::MAX / self.side;
        let is_cut = self.at[0] + self.at[1] == self.side - 1;
        let [a, b] = if is_cut { folded(words) } else { words };
        let at =
            |n: u32, word: u32| n * width + ((u64::from(word) * u64::from(width)) >> 32) as u32;
        [at(self.at[0], a), at(self.at[1], b)]
    }
}

/// Eq. 23-24 on words: r₁ + r₂ ≥ 1, the carry of the sum, reflects both.
pub fn folded([a, b]: [u32; 2]) -> [u32; 2] {
    match a.checked_add(b) {
        Some(_) => [a, b],
        None => [!a, !b],
    }
}

#[cfg(test)]
mod tests;
