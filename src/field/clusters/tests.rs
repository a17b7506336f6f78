use super::*;
use crate::base::philox::unit;

/// Congruent parts of a triangle along a side; there are their square.
const PARTS: usize = 8;

/// Which of the congruent parts a place is in, given its shares along both legs.
fn part_of([u, v]: [f64; 2]) -> usize {
    let scaled = [u, v].map(|s| s * PARTS as f64);
    let cell = scaled.map(|s| (s.floor() as usize).min(PARTS - 1));
    let is_upper = scaled[0] - cell[0] as f64 + scaled[1] - cell[1] as f64 >= 1.0;
    // Row by row: row r has 2(PARTS − r) − 1 parts.
    let first = cell[1] * (2 * PARTS - cell[1]);
    (first + 2 * cell[0] + usize::from(is_upper)).min(PARTS * PARTS - 1)
}

fn place(words: [u32; 2]) -> [f64; 2] {
    words.map(|word| f64::from(unit(word)))
}

/// χ² of counts that should be equal.
fn chi_square(counts: &[u32]) -> f64 {
    let mean = counts.iter().sum::<u32>() as f64 / counts.len() as f64;
    let off = counts.iter().map(|&n| (f64::from(n) - mean).powi(2));
    off.sum::<f64>() / mean
}

/// Seeds of a triangle's clusters, as the field places them.
fn seeds(triangle: u32, clusters: u32, size: u32, rounds: u32) -> Vec<[f64; 2]> {
    let of_cluster = |cluster| {
        let stratum = stratum(triangle, cluster, 5, rounds);
        (0..size).map(move |n| {
            let words = philox2x32([triangle, cluster * size + n], 5, rounds);
            place(stratum.within(words))
        })
    };
    (0..clusters).flat_map(of_cluster).collect()
}

/// The variance of a triangle's counts in its parts over that of independent seeds, as the field places
/// clusters: every stratum of a grid once, folded as a whole.
fn own_spread(clusters: u32, size: u32) -> f64 {
    let spread = (0..400).map(|triangle| {
        let mut counts = [0; PARTS * PARTS];
        for seed in seeds(triangle, clusters, size, 7) {
            counts[part_of(seed)] += 1;
        }
        chi_square(&counts) / 63.0
    });
    spread.sum::<f64>() / 400.0
}

/// Seeds that lie alone, folded as the field does and by the square root of eq. 3, with seven rounds and with
/// the paper's three: χ² of 64 parts has the mean 63 and the deviation √126.
#[test]
fn seeds_that_lie_alone_are_uniform() {
    let square_root = |[r1, r2]: [f64; 2]| [r1.sqrt() * (1.0 - r2), r1.sqrt() * r2];
    for rounds in [7, 3] {
        let mut counts = [[0; PARTS * PARTS]; 2];
        for triangle in 0..3000 {
            for n in 0..20 {
                let words = philox2x32([triangle, n], 5, rounds);
                counts[0][part_of(place(folded(words)))] += 1;
                counts[1][part_of(square_root(place(words)))] += 1;
            }
        }
        for counts in counts {
            let chi = chi_square(&counts);
            assert!(
                chi < 63.0 + 5.0 * 126.0_f64.sqrt(),
                "{rounds} rounds: {chi}"
            );
        }
    }
}

#[test]
fn grids_are_the_pyramidal_numbers() {
    let pyramid = |n: u32| n * (n + 1) * (2 * n + 1) / 6;
    let mut cluster = 0;
    for side in 1..40 {
        for _ in 0..side * side {
            assert_eq!(grid_of(cluster), (side, pyramid(side - 1)), "{cluster}");
            cluster += 1;
        }
    }
}

/// A full grid has as many clusters in every stratum below its diagonal: two of the square's fold
/// onto it, and one onto each half stratum on the diagonal.
#[test]
fn a_grid_is_filled_evenly() {
    for triangle in 0..50 {
        for side in 1..8_u32 {
            let before: u32 = (1..side).map(|n| n * n).sum();
            let mut filled = std::collections::BTreeMap::new();
            for cluster in before..before + side * side {
                let stratum = stratum(triangle, cluster, 9, 7);
                assert_eq!(stratum.side, side);
                *filled.entry(stratum.at).or_insert(0) += 1;
            }
            for i in 0..side {
                for j in 0..side - i {
                    let want = if i + j + 1 == side { 1 } else { 2 };
                    assert_eq!(filled.get(&[i, j]), Some(&want), "{side}: {i} {j}");
                }
            }
        }
    }
}

/// Seeds are spread evenly, whatever the clusters' size: counts in 64 congruent parts over many
/// triangles. χ² of independent seeds has the mean 63 and the deviation √126; seeds of one cluster
/// go together, which multiplies both by at most the cluster's size.
#[test]
fn seeds_are_uniform() {
    for size in [1, 2, 4, 8, 16_u32] {
        for clusters in [1, 5, 14, 20] {
            let mut counts = [0; PARTS * PARTS];
            for triangle in 0..3000 {
                for seed in seeds(triangle, clusters, size, 7) {
                    counts[part_of(seed)] += 1;
                }
            }
            let chi = chi_square(&counts) / f64::from(size);
            let most = 63.0 + 5.0 * 126.0_f64.sqrt();
            assert!(chi < most, "{size} seeds, {clusters} clusters: {chi}");
        }
    }
}

/// Pairs of neighbouring triangles, and of neighbouring numbers on one, lie independently: their
/// displacements along a leg fall into 32 classes as those of independent seeds do. Three rounds
/// fail this, which is why seven are the default.
#[test]
fn neighbours_are_independent() {
    let classes = |counter: &dyn Fn(u32) -> [[u32; 2]; 2], rounds| {
        let mut counts = [0; 32];
        for n in 0..40_000 {
            let [a, b] = counter(n).map(|c| philox2x32(c, 5, rounds)[0]);
            // The difference of two even words is even, modulo 2³².
            counts[(a.wrapping_sub(b) >> 27) as usize] += 1;
        }
        chi_square(&counts)
    };
    let most = 31.0 + 5.0 * 62.0_f64.sqrt();
    let triangles = |n: u32| [[n, 3], [n + 1, 3]];
    let numbers = |n: u32| [[n / 32, n % 32], [n / 32, n % 32 + 1]];
    for counter in [&triangles as &dyn Fn(u32) -> [[u32; 2]; 2], &numbers] {
        let chi = classes(counter, 7);
        assert!(chi < most, "{chi}");
    }
    assert!(classes(&triangles, 3) > most || classes(&numbers, 3) > most);
}

/// P15's artefact: where the last grid is filled in part, eq. 3 shows its trapezoids. Measured as
/// the variance of a triangle's counts in its 64 parts over that of independent seeds, for strata
/// taken at random as the paper does.
#[test]
fn folding_spreads_clusters_better_than_the_square_root() {
    let size = 8;
    let spread = |clusters: u32, map: &dyn Fn([f64; 2]) -> [f64; 2]| {
        let mut sum = 0.0;
        for triangle in 0..400 {
            let mut counts = [0; PARTS * PARTS];
            for cluster in 0..clusters {
                let (side, _) = grid_of(cluster);
                let [i, j] = philox2x32([triangle, CLUSTER_WORD + cluster], 5, 7).map(|w| w % side);
                for n in 0..size {
                    let words = philox2x32([triangle, cluster * size + n], 5, 7);
                    let [u, v] = place(words);
                    let in_square = [(f64::from(i) + u), (f64::from(j) + v)];
                    counts[part_of(map(in_square.map(|s| s / f64::from(side))))] += 1;
                }
            }
            sum += chi_square(&counts) / 63.0;
        }
        sum / 400.0
    };
    let square_root = |[r1, r2]: [f64; 2]| [r1.sqrt() * (1.0 - r2), r1.sqrt() * r2];
    let fold = |[a, b]: [f64; 2]| {
        if a + b >= 1.0 {
            [1.0 - a, 1.0 - b]
        } else {
            [a, b]
        }
    };
    for clusters in [18, 40, 70] {
        let [root, folded] = [spread(clusters, &square_root), spread(clusters, &fold)];
        let own = own_spread(clusters, size);
        println!(
            "{clusters} clusters of {size}: eq. 3 {root:.3}, eq. 23-25 {folded:.3}, own {own:.3}"
        );
        assert!(
            own < folded && folded < root,
            "{clusters}: {own}, {folded}, {root}"
        );
    }
}
