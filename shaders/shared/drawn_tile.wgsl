// A tile of a frame, and how much of its plants is drawn. Host: src/render/blade_tiles.rs.
#import "shared/tile.wgsl"

struct DrawnTile {
    tile: TileRecord,
    anchor_from_eye: vec3f,
    share: f32, // of a triangle's sequence that is drawn, where the distance decides
    detail: u32, // 0 finest
    ranks: u32, // places of the tile's sequence that are looked at
    boost: f32, // factor of the counts by area: imprints stay readable
    spare: u32,
}
