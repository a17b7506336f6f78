// Coats: the plants on bodies. Hosts: src/render/coat_place.rs, src/render/coat.rs.

// A drawn body with a coat. Pairs are the smallest value and the span above it.
struct CoatBody {
    turn: vec4f, // quaternion x, y, z, w: world_from_body
    place_from_eye: vec3f,
    // Triangles of the bodies before it.
    first_number: u32,
    height_m: vec2f,
    width_m: vec2f,
    // From the surface's normal.
    lean_turns: vec2f,
    key: u32,
    form: u32, // 0 leaf, 1 blade
    rgb: vec3f,
    // Share of the sky that the coat hides at the surface.
    cover: f32,
    // Of the coat's triangles, in the buffer of all.
    first_triangle: u32,
    spare_a: u32,
    spare_b: vec2u,
}

// A plant of this frame.
struct PlacedPlant {
    root_from_eye: vec3f,
    height_m: f32,
    direction: vec3f, // unit vector, at the root
    width_m: f32, // makes up for plants that are left out
    normal: vec3f, // of the surface
    shade: u32, // random bytes
    body: u32,
    triangle: u32, // of the coat's
    index: u32, // in the triangle's sequence
    tone: f32, // of its part of the coat, 0 to 1
}
