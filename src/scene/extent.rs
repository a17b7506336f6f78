//! How far points spread: the check that a hull or a mesh is no line and no plane.

/// Length, width and thickness of a cloud of points: the largest distance from its first point,
/// from the line so found, and from the plane so found. Each lies between half the true extent and
/// the true extent; the thickness is 0 for points in one plane.
pub(super) fn extents(points: &[[f32; 3]]) -> [f64; 3] {
    let Some(&origin) = points.first() else {
        return [0.0; 3];
    };
    let offsets = || {
        points
            .iter()
            .map(|p| [0, 1, 2].map(|i| f64::from(p[i]) - f64::from(origin[i])))
    };
    let far = |measure: &dyn Fn([f64; 3]) -> f64| {
        offsets()
            .map(|p| (measure(p), p))
            .fold(
                (0.0, [0.0; 3]),
                |best, next| if next.0 > best.0 { next } else { best },
            )
    };
    let (length, along) = far(&norm);
    let along = along.map(|x| if length > 0.0 { x / length } else { 0.0 });
    let (width, across) = far(&|p| norm(cross(along, p)));
    let normal = cross(along, across).map(|x| if width > 0.0 { x / width } else { 0.0 });
    let (thickness, _) = far(&|p| dot(normal, p).abs());
    [length, width, thickness]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clouds_lines_and_planes() {
        assert_eq!(extents(&[]), [0.0; 3]);
        assert_eq!(extents(&[[3.0; 3]; 5]), [0.0; 3]);
        let line = [[0.0; 3], [1.0, 0.0, 0.0], [4.0, 0.0, 0.0]];
        assert_eq!(extents(&line), [4.0, 0.0, 0.0]);
        let plane = [[0.0; 3], [4.0, 0.0, 0.0], [1.0, 2.0, 0.0]];
        assert_eq!(extents(&plane), [4.0, 2.0, 0.0]);
        let solid = [[0.0; 3], [4.0, 0.0, 0.0], [1.0, 2.0, 0.0], [1.0, 1.0, -0.5]];
        assert_eq!(extents(&solid), [4.0, 2.0, 0.5]);
    }
}
