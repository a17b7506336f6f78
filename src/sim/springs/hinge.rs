//! Bend springs of a blade with exact lengths.
//!
//! A bend spring joins nodes j and j + 2, and with segments of fixed length its length depends on
//! the angle at node j + 1 alone. Turning everything above that node as one changes no other bend
//! spring and no segment, so that each spring can take its share of its extension by itself: after a
//! sweep every extension is 1 − 2a of what it was, and the energy falls at any step. This is O09
//! eq. 7 with responsibilities 0 below the hinge and 1 above it.

use crate::base::{Real, Vec3};

/// Turns every hinge of a centre line, root to tip, so that the extension of its bend spring loses
/// the share `share` = 2a. `rest` holds the same nodes at rest. In place, nothing is allocated.
pub fn turn<R: Real>(rest: &[Vec3<R>], nodes: &mut [Vec3<R>], share: R) {
    let two = R::of(2.0);
    for j in 0..nodes.len().min(rest.len()).saturating_sub(2) {
        let rest = (rest[j + 2] - rest[j]).length();
        let (below, above) = (nodes[j + 1] - nodes[j], nodes[j + 2] - nodes[j + 1]);
        let (b, a) = (below.length(), above.length());
        let chord = (nodes[j + 2] - nodes[j]).length();
        let wanted = (chord - share * (chord - rest)).clamp((b - a).abs(), b + a);
        let product = two * b * a;
        if product <= R::ZERO {
            continue;
        }
        let cos = ((wanted * wanted - b * b - a * a) / product).clamp(-R::ONE, R::ONE);
        let along = below.unit_or(Vec3::UP);
        let from = above.unit_or(along);
        let sideways = (from - along * from.dot(along)).unit_or(along.across());
        let to = along * cos + sideways * (R::ONE - cos * cos).max(R::ZERO).sqrt();
        turn_above(&mut nodes[j + 1..], from, to);
    }
}

/// Turns the nodes after the first about it, by the shortest turn from one unit vector to another.
fn turn_above<R: Real>(nodes: &mut [Vec3<R>], from: Vec3<R>, to: Vec3<R>) {
    let two = R::of(2.0);
    let sum = from + to;
    let squared = sum.length_squared();
    // Opposite directions have no shortest turn; a share below 1 never asks for one.
    if squared < R::of(1e-12) {
        return;
    }
    if let Some((&mut hinge, above)) = nodes.split_first_mut() {
        for node in above {
            let x = *node - hinge;
            let turned = x - sum * (two * x.dot(sum) / squared) + to * (two * x.dot(from));
            *node = hinge + turned;
        }
    }
}
