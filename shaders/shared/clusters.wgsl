// Clusters of seeds: P15 section 3.4. Twin: src/field/clusters.rs, bit for bit.
#import "shared/field.wgsl"
#import "shared/philox.wgsl"

// One square of the grid over the unit square that is folded to a triangle.
struct Stratum {
    side: u32,
    // Counts along both legs; together at most `side` − 1.
    at: vec2u,
}

// Strata along the side of a cluster's grid (x), and the clusters in all smaller grids (y).
fn grid_of(cluster: u32) -> vec2u {
    var side = 1u;
    var before = 0u;
    while before + side * side <= cluster {
        before += side * side;
        side++;
    }
    return vec2u(side, before);
}

// The stratum of a triangle's cluster.
fn stratum_of(triangle: u32, cluster: u32) -> Stratum {
    let grid = grid_of(cluster);
    let side = grid.x;
    let words = philox2x32(vec2u(triangle, GRID_WORD + side), field.key, field.rounds);
    // 1 + n·h has no divisor in common with n, so the steps visit every stratum once.
    let strata = side * side;
    let step = 1u + side * (words.x % side);
    let rank = ((cluster - grid.y) * step + words.y % strata) % strata;
    let at = vec2u(rank % side, rank / side);
    let folds = at.x + at.y >= side;
    return Stratum(side, select(at, vec2u(side - 1u) - at, folds));
}

// Random words of the whole triangle, turned into words of the stratum.
fn within_stratum(stratum: Stratum, words: vec2u) -> vec2u {
    let width = 0xffffffffu / stratum.side;
    let is_cut = stratum.at.x + stratum.at.y == stratum.side - 1u;
    let own = select(words, folded(words), is_cut);
    return stratum.at * width + vec2u(multiply_high(own.x, width), multiply_high(own.y, width));
}

// P15 eq. 23-24 on words: a carry of the sum means r₁ + r₂ ≥ 1, and reflects both.
fn folded(words: vec2u) -> vec2u {
    return select(words, ~words, words.x + words.y < words.x);
}
