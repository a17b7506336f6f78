// A tile of a frame, and how much of its plants is drawn. Host: src/render/blade_tiles.rs.
#import "shared/tile.wgsl"

struct DrawnTile {
    tile: TileRecord,
    anchor_from_eye: vec3f,
    bound: f32, // of every triangle's count; the count itself where the distance decides
    detail: u32, // 0 finest
    most_places: u32, // of the tile's plants in the list of places
    morph: f32, // how far its plants are on their way to the next coarser detail, 0 to 1
    spare: u32,
}
