use super::*;

fn at(taps: &SurfaceTap, weights: [f32; 4], of: impl Fn(f64) -> f64, nodes: u32) -> f64 {
    let shares = weights.into_iter().zip(taps.first..nodes);
    shares
        .map(|(weight, node)| f64::from(weight) * of(f64::from(node)))
        .sum()
}

/// Every spline meets its nodes exactly, and is the parabola through nodes that lie on one, in place and
/// slope: f32 weights of sums below 100 are good to 1e-5.
#[test]
fn splines_meet_their_nodes_and_are_exact_for_parabolas() {
    let parabola = |x: f64| 0.7 - 1.3 * x + 0.4 * x * x;
    for nodes in 3..=9 {
        for subdivision in 1..=8 {
            let taps = taps(nodes, subdivision);
            assert_eq!(taps.len() as u32, (nodes - 1) * subdivision + 1);
            for (step, tap) in taps.iter().enumerate() {
                let x = step as f64 / f64::from(subdivision);
                let place = at(tap, tap.place, parabola, nodes);
                let slope = at(tap, tap.slope, parabola, nodes);
                assert!(
                    (place - parabola(x)).abs() < 1e-5,
                    "{nodes} {subdivision} {x}"
                );
                assert!(
                    (slope - (0.8 * x - 1.3)).abs() < 1e-5,
                    "{nodes} {subdivision} {x}"
                );
                if (step as u32).is_multiple_of(subdivision) {
                    let own = (step as u32 / subdivision - tap.first) as usize;
                    let mut only = [0.0; 4];
                    only[own] = 1.0;
                    assert_eq!(tap.place, only);
                }
            }
        }
    }
}

/// Triangles cover every cell once, with the same side to the front.
#[test]
fn triangles_cover_the_grid() {
    let corners = triangles([3, 2]);
    assert_eq!(corners.len(), 3 * 2 * 6);
    let place = |corner: u32| [f64::from(corner % 4), f64::from(corner / 4)];
    let mut area = 0.0;
    for triangle in corners.chunks_exact(3) {
        let [[ax, ay], [bx, by], [cx, cy]] = [0, 1, 2].map(|n| place(triangle[n]));
        let twice = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
        assert!(twice > 0.0);
        area += 0.5 * twice;
    }
    assert_eq!(area, 6.0);
}
