// A billboard at rest, opened from its 32 bytes. Twin: src/field/billboards/packed.rs.

struct BillboardRecord {
    // Middle of its lower edge, in its anchor's coordinates.
    root: vec3f,
    // Height in the lower half, width in the upper, in 1/FINE_STEPS m.
    size: u32,
    // x and z of the growth direction, signed, in UNIT_STEPS.
    up: u32,
    // x and z of the lower edge's direction, signed, in about UNIT_STEPS.
    across: u32,
    // Flexibility in 1/FINE_STEPS in the lower half, phase of the trembling in 2⁻¹⁶ turns in the upper.
    sway: u32,
    // The tile in the lower 24 bits, the texture in the upper 8.
    tile_and_texture: u32,
}

struct Billboard {
    root: vec3f,
    height_m: f32,
    // Unit vector from the lower edge to the upper one.
    up: vec3f,
    width_m: f32,
    // Level unit direction of the lower edge, along x and z.
    across: vec2f,
    flexibility: f32,
    flutter_turns: f32,
    tile: u32,
    // Layer of the array of clump pictures, and the kind of clump.
    texture: u32,
    kind: u32,
}

fn signed_pair(steps: vec2i) -> u32 {
    return (u32(steps.x) & 0xffffu) | (u32(steps.y) << 16u);
}

fn opened_pair(word: u32) -> vec2i {
    return vec2i(i32(word << 16u) >> 16u, i32(word) >> 16u);
}

// The squared length of a level vector in steps.
fn level_squared(steps: vec2i) -> u32 {
    return u32(steps.x * steps.x + steps.y * steps.y);
}

// y of a unit vector with these level steps, whose y is not below 0.
fn rise(level: vec2i) -> f32 {
    let whole = u32(UNIT_STEPS * UNIT_STEPS);
    return sqrt(f32(whole - min(whole, level_squared(level)))) * UNIT_STEP;
}

fn open_billboard(record: BillboardRecord) -> Billboard {
    let up = opened_pair(record.up);
    let across = opened_pair(record.across);
    let per_step = 1.0 / sqrt(f32(level_squared(across)));
    let per_fine = 1.0 / f32(FINE_STEPS);
    let texture = record.tile_and_texture >> 24u;
    var open: Billboard;
    open.root = record.root;
    open.height_m = f32(record.size & 0xffffu) * per_fine;
    open.up = vec3f(f32(up.x) * UNIT_STEP, rise(up), f32(up.y) * UNIT_STEP);
    open.width_m = f32(record.size >> 16u) * per_fine;
    open.across = vec2f(across) * per_step;
    open.flexibility = f32(record.sway & 0xffffu) * per_fine;
    open.flutter_turns = f32(record.sway >> 16u) * (1.0 / f32(AZIMUTH_STEPS));
    open.tile = record.tile_and_texture & 0x00ffffffu;
    open.texture = texture;
    open.kind = texture / CLUMP_VARIANTS;
    return open;
}
