// A tile of a frame, and how much of its plants is drawn. Host: src/render/blade_tiles.rs.
#import "shared/tile.wgsl"

struct DrawnTile {
    tile: TileRecord,
    anchor_from_eye: vec3f,
    blades: f32, // how many of the tile's sequence are drawn; the last of them are still growing
    widen: f32, // what the drawn blades' width makes up for those left out
    detail: u32, // 0 finest
    spare: vec2u,
}

// Share of its size at which the plant or companion of a rank is drawn: those at the end of the
// prefix, and those at the end of sight, are small, so that nothing pops.
fn grown_share(drawn: DrawnTile, rank: u32, distance_m: f32, reach_m: f32) -> f32 {
    let youngest = saturate((drawn.blades - f32(rank)) / max(0.2 * drawn.blades, 1.0));
    return youngest * (1.0 - smoothstep(0.75, 1.0, distance_m / reach_m));
}
