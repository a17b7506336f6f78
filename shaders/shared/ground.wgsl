// Height of the ground in an anchor's coordinates. Twins: src/field/grid.rs (ground_in_anchor),
// src/terrain/height_grid.rs (height_in_square).
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

fn height_in_square(i: u32, j: u32, u: f32, v: f32, base: f32) -> f32 {
    let low = j * field.columns + i;
    let high = low + field.columns;
    let h00 = heights_m[low] - base;
    let h10 = heights_m[low + 1u] - base;
    let h01 = heights_m[high] - base;
    let h11 = heights_m[high + 1u] - base;
    if ((i + j) & 1u) == 0u {
        if u >= v {
            return h00 + u * (h10 - h00) + v * (h11 - h10);
        }
        return h00 + v * (h01 - h00) + u * (h11 - h01);
    }
    if u + v <= 1.0 {
        return h00 + u * (h10 - h00) + v * (h01 - h00);
    }
    return h11 + (1.0 - u) * (h01 - h11) + (1.0 - v) * (h10 - h11);
}

// Height over the anchor's origin at a place in its coordinates; beyond the edge the edge's.
fn ground_in_anchor(tile: TileRecord, x: f32, z: f32) -> f32 {
    let along_x = locate_in_squares(x, tile.square.x, tile.in_square.x, field.squares.x);
    let along_z = locate_in_squares(z, tile.square.y, tile.in_square.y, field.squares.y);
    return height_in_square(
        along_x.square,
        along_z.square,
        along_x.share,
        along_z.share,
        tile.base_y,
    );
}
