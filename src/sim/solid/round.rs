//! Ways out of round features that a short segment can reach.

use super::Reach;
use crate::base::{Real, Vec3};

/// The way out of a ball, or of a cylinder in the plane of the way, of some radius: its depth and
/// normal. Where the shortest `way` is out of the segment's reach, since the segment runs nearly
/// through the middle, it leads to the nearest place of the surface that the segment's end can be at.
/// Without that the end stays inside for as long as the body holds the segment: half the radius of a
/// rod that is thinner than a segment is long.
pub(super) fn way_in_reach<R: Real>(
    p: Vec3<R>,
    way: (R, Vec3<R>),
    radius: R,
    reach: &Reach<R>,
) -> (R, Vec3<R>) {
    let (depth, normal) = way;
    let rise = (p - reach.from).dot(normal) + depth;
    if rise.abs() < reach.length || reach.length <= R::ZERO {
        return way;
    }
    let centre = p + normal * (depth - radius);
    let to_centre = centre - reach.from;
    let axis = to_centre.unit_or(normal);
    let along = to_centre.dot(axis);
    let span = along * reach.length;
    // Cosine of the angle at the lower node of the triangle of it, the middle and the end.
    let cosine = R::of(0.5) * (along * along + reach.length * reach.length - radius * radius)
        / span.max(R::of(LEAST_SPAN_M2));
    if cosine.abs() >= R::ONE {
        return way;
    }
    let aside = (normal - axis * axis.dot(normal)).unit_or(axis.across());
    let sine = (R::ONE - cosine * cosine).sqrt();
    let end = reach.from + (axis * cosine + aside * sine) * reach.length;
    let normal = (end - centre).unit_or(normal);
    ((end - p).dot(normal), normal)
}

/// Lower node and middle are not apart where the product of their distance and the segment's length is
/// less, in square metres.
pub const LEAST_SPAN_M2: f64 = 1e-12;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::vec3;
    use crate::sim::solid::{NO_FACE, Solid};

    /// A segment of 49 mm through a rod of 21 mm radius, its end 16 mm from the axis on the far side.
    fn through() -> (Solid<f64>, Vec3<f64>, Reach<f64>) {
        let rod = Solid::Capsule {
            radius: 0.021,
            half: 0.6,
        };
        let end = vec3(0.0126, 0.1, -0.0105);
        let reach = Reach {
            from: vec3(-0.0247, 0.1, 0.021),
            length: 0.0489,
            before: end,
        };
        (rod, end, reach)
    }

    #[test]
    fn the_end_can_be_where_the_way_leads() {
        let (rod, end, reach) = through();
        let shortest = rod.exit(end, NO_FACE, &Reach::anywhere(), |_| false);
        let shortest = shortest.expect("inside");
        let rise = |depth: f64, normal: Vec3<f64>| (end - reach.from).dot(normal) + depth;
        assert!(rise(shortest.depth, shortest.normal) > reach.length);
        let exit = rod.exit(end, NO_FACE, &reach, |_| false).expect("inside");
        let rise = rise(exit.depth, exit.normal);
        assert!(rise < reach.length, "{rise}");
        // The segment's end on the plane that the way leads to, the same side as before, is on the rod.
        let flat = (end - reach.from) - exit.normal * (end - reach.from).dot(exit.normal);
        let flat = flat.unit_or(Vec3::UP);
        let run = (reach.length * reach.length - rise * rise).sqrt();
        let turned = reach.from + exit.normal * rise + flat * run;
        assert!(rod.depth(turned).abs() < 1e-9, "{}", rod.depth(turned));
        assert!((turned - end).length() < 0.02);
    }

    #[test]
    fn a_way_in_reach_is_the_shortest() {
        let (rod, end, reach) = through();
        let long = Reach {
            length: 0.06,
            ..reach
        };
        let far = rod.exit(end, NO_FACE, &Reach::anywhere(), |_| false);
        assert_eq!(rod.exit(end, NO_FACE, &long, |_| false), far);
    }
}
