// The quad of a billboard in the wind. Twin: src/sim/billboard/shape.rs.
#import "shared/billboard.wgsl"
#import "shared/plant.wgsl"
#import "shared/wind.wgsl"

// In its anchor's coordinates.
struct WindQuad {
    root: vec3f, // middle of the lower edge
    width_m: f32,
    across: vec3f, // unit vector along the lower edge
    height_m: f32,
    lean: vec3f, // unit vector from the lower edge to the upper one
}

// Bend of the upper edge along x and z by the wind of some instant.
fn billboard_bend_by(then: WindUniform, anchor: vec2u, billboard: Billboard) -> vec2f {
    var tile: TileRecord;
    tile.anchor = anchor;
    var plant: Plant;
    plant.root = billboard.root;
    plant.flexibility = billboard.flexibility;
    plant.flutter_turns = billboard.flutter_turns;
    return wind_bend_by(then, tile, plant);
}

// The quad in the wind of now.
fn wind_quad(anchor: vec2u, billboard: Billboard) -> WindQuad {
    return bent_quad(billboard, billboard_bend_by(wind, anchor, billboard));
}

// The quad whose top the wind bends by `bend` along x and z.
fn bent_quad(billboard: Billboard, bend: vec2f) -> WindQuad {
    let lean = billboard.up + vec3f(bend.x, 0.0, bend.y) * WIND_SHARE;
    return WindQuad(
        billboard.root,
        billboard.width_m,
        vec3f(billboard.across.x, 0.0, billboard.across.y),
        billboard.height_m,
        unit_or(lean, billboard.up),
    );
}

// The place at shares of the width from the left and of the height.
fn quad_place(quad: WindQuad, at: vec2f) -> vec3f {
    return quad.root + quad.across * ((at.x - 0.5) * quad.width_m)
        + quad.lean * (at.y * quad.height_m);
}
