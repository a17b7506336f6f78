// One tile as the passes and the renderers see it. Twin: src/gpu/field_data.rs.

struct TileRecord {
    // Rank of the tile, and its slab; NO_SLAB for a resting tile.
    tile: u32,
    slab: u32,
    // Counts of the anchor that the tile lies in, along x and z.
    anchor: vec2u,
    // Square of height samples in which the anchor's origin lies, and where in it.
    square: vec2u,
    in_square: vec2f,
    // First seeding cell of the tile.
    first_cell: vec2u,
    // Height of the anchor's origin: a whole number of metres.
    base_y: f32,
    // TILE_RESTING, TILE_COLLIDING or TILE_RECOVERING.
    state: u32,
    // The tile's run of contacts.
    first_contact: u32,
    end_contact: u32,
    // Place of the anchor's origin on the base map, in units of 2⁻¹⁶ texel.
    anchor_on_map: vec2u,
}
