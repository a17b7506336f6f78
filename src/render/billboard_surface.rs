//! The drawn surface of a refined billboard: a smooth one through its simulated nodes.
//!
//! O09 section 8 names two ways to a better look of coarse grids, one of which is to assemble "the displayed
//! primitives … by a higher order interpolation during rendering". Here: Catmull-Rom splines along rows and
//! columns, whose slope at a node is half the way between its neighbours, and at either end that of the
//! parabola through the three nodes there; a surface through every node, exact for parabolas, whose error
//! falls with the cube of the distance of nodes (straight segments: with the square). One drawn segment per
//! segment between nodes gives straight segments; slopes, and so light, come from the splines even then.
//!
//! The nodes at the ground stay on their line, and a plane stays a plane: what is back in the wind is the
//! quad. Twin: `shaders/shared/billboard_surface.wgsl`.

use crate::gpu_struct;

/// Nodes that a drawn vertex depends on along a row or a column, at most.
const TAPS: usize = 4;

gpu_struct! {
    /// Weights of up to four nodes for one drawn vertex: of its place, and of its change per segment.
    pub(super) struct SurfaceTap {
        pub(super) place: [f32; 4],
        pub(super) slope: [f32; 4],
        pub(super) first: u32,
        spare_a: u32,
        spare_b: [u32; 2],
    }
}

/// Drawn vertices along a row or column of `nodes` nodes, 3 or more, each segment cut into `subdivision`.
pub(super) fn taps(nodes: u32, subdivision: u32) -> Vec<SurfaceTap> {
    let last_cell = nodes - 2;
    (0..=(nodes - 1) * subdivision)
        .map(|step| {
            let cell = (step / subdivision).min(last_cell);
            let along = f64::from(step - cell * subdivision) / f64::from(subdivision);
            tap(nodes as usize, cell as usize, along)
        })
        .collect()
}

/// The weights at a share of the way through a cell.
fn tap(nodes: usize, cell: usize, t: f64) -> SurfaceTap {
    // Hermite's basis and its derivative: weights of both ends and of the slopes there.
    let place = [
        (1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t),
        t * t * (3.0 - 2.0 * t),
        t * (1.0 - t) * (1.0 - t),
        t * t * (t - 1.0),
    ];
    let slope = [
        6.0 * t * (t - 1.0),
        6.0 * t * (1.0 - t),
        (1.0 - t) * (1.0 - 3.0 * t),
        t * (3.0 * t - 2.0),
    ];
    let first = cell.saturating_sub(1).min(nodes.saturating_sub(TAPS));
    let on_nodes = |[start, end, leaving, arriving]: [f64; 4]| {
        let mut weights = [0.0; TAPS];
        let mut add = |node: usize, weight: f64| weights[node - first] += weight;
        add(cell, start);
        add(cell + 1, end);
        for (at, share) in [(cell, leaving), (cell + 1, arriving)] {
            for (node, weight) in slope_at(nodes, at) {
                add(node, share * weight);
            }
        }
        weights.map(|weight| weight as f32)
    };
    SurfaceTap {
        place: on_nodes(place),
        slope: on_nodes(slope),
        first: first as u32,
        spare_a: 0,
        spare_b: [0; 2],
    }
}

/// The slope at a node as weights of nodes, per segment.
fn slope_at(nodes: usize, at: usize) -> [(usize, f64); 3] {
    if at == 0 {
        [(0, -1.5), (1, 2.0), (2, -0.5)]
    } else if at == nodes - 1 {
        [(at, 1.5), (at - 1, -2.0), (at - 2, 0.5)]
    } else {
        [(at - 1, -0.5), (at, 0.0), (at + 1, 0.5)]
    }
}

/// Corners of the triangles of a drawn surface of so many segments across and up, as indices of vertices row
/// by row from the ground. Cells are cut as the quad is, from the lower right to the upper left.
pub(super) fn triangles([across, up]: [u32; 2]) -> Vec<u32> {
    let row = across + 1;
    let mut corners = Vec::with_capacity(6 * (across * up) as usize);
    for cell in 0..across * up {
        let low = (cell / across) * row + cell % across;
        let high = low + row;
        corners.extend([low, low + 1, high, high, low + 1, high + 1]);
    }
    corners
}

#[cfg(test)]
mod measure;
#[cfg(test)]
mod tests;
