// The ground in an anchor's coordinates. Twins: src/field/grid.rs (ground_plane_in_anchor),
// src/terrain/height_grid.rs (plane_in_square).
#import "shared/field.wgsl"
#import "shared/tile.wgsl"

struct InSquare {
    square: u32,
    share: f32,
}

fn locate_in_squares(p: f32, first: u32, in_square: f32, squares: u32) -> InSquare {
    let at = p * field.squares_per_m + in_square;
    let whole = floor(at);
    let square = i32(first) + i32(whole);
    if square < 0 {
        return InSquare(0u, 0.0);
    }
    if square >= i32(squares) {
        return InSquare(squares - 1u, 1.0);
    }
    return InSquare(u32(square), at - whole);
}

// The plane of the ground's triangle under a place.
struct GroundPlane {
    // Height of the ground there over the anchor's origin.
    height: f32,
    // How steeply it rises along x and z, in metres per metre.
    slope: vec2f,
}

// Height inside a square at fractions along x and z, and by how much the triangle there rises across
// the square along both.
fn plane_in_square(i: u32, j: u32, u: f32, v: f32, base: f32) -> vec3f {
    let low = j * field.columns + i;
    let high = low + field.columns;
    let h00 = heights_m[low] - base;
    let h10 = heights_m[low + 1u] - base;
    let h01 = heights_m[high] - base;
    let h11 = heights_m[high + 1u] - base;
    let is_even = ((i + j) & 1u) == 0u;
    if !is_even && u + v > 1.0 {
        let height = h11 + (1.0 - u) * (h01 - h11) + (1.0 - v) * (h10 - h11);
        return vec3f(height, h11 - h01, h11 - h10);
    }
    let near_x = !is_even || u >= v;
    let near_z = !is_even || u < v;
    let along_x = select(h11 - h01, h10 - h00, near_x);
    let along_z = select(h11 - h10, h01 - h00, near_z);
    return vec3f(h00 + u * along_x + v * along_z, along_x, along_z);
}

// The ground under a place in the anchor's coordinates; beyond the edge the edge's.
fn ground_plane_in_anchor(tile: TileRecord, x: f32, z: f32) -> GroundPlane {
    let along_x = locate_in_squares(x, tile.square.x, tile.in_square.x, field.squares.x);
    let along_z = locate_in_squares(z, tile.square.y, tile.in_square.y, field.squares.y);
    let plane = plane_in_square(
        along_x.square,
        along_z.square,
        along_x.share,
        along_z.share,
        tile.base_y,
    );
    return GroundPlane(plane.x, plane.yz * field.squares_per_m);
}

// Height over the anchor's origin at a place in its coordinates.
fn ground_in_anchor(tile: TileRecord, x: f32, z: f32) -> f32 {
    return ground_plane_in_anchor(tile, x, z).height;
}
