// How many plants of a triangle are drawn: P15 eq. 1 and 2, of the ground's seeding triangles and of a
// coat's alike. Twin: src/field/count.rs.

struct CountUniform {
    right: vec3f,
    pixel_rad: f32,
    up: vec3f,
    per_px: f32,
    forward: vec3f,
    // COUNT_BY_DISTANCE, COUNT_BY_PROJECTED_AREA or COUNT_BY_WORLD_AREA.
    rule: u32,
    // Ceiling: the plants of a triangle and their companions.
    most: f32,
    // 1 if plants and segments come and go at once.
    is_plain: u32,
    spare_a: vec2f,
    // The place from which distances decide.
    judge_from_eye: vec3f,
    spare_b: f32,
}

// Place on the picture in pixels, and depth.
fn on_picture(corner: vec3f, view: CountUniform) -> vec3f {
    let depth = dot(corner, view.forward);
    let px = 1.0 / (max(depth, 1e-6) * view.pixel_rad);
    return vec3f(dot(corner, view.right) * px, dot(corner, view.up) * px, depth);
}

fn count_by_projected_area(corners: array<vec3f, 3>, view: CountUniform) -> f32 {
    let a = on_picture(corners[0], view);
    let b = on_picture(corners[1], view) - a;
    let c = on_picture(corners[2], view) - a;
    let nearest = a.z + min(min(b.z, c.z), 0.0);
    if nearest < NEAR_M {
        return view.most;
    }
    return min(view.per_px * 0.5 * abs(b.x * c.y - b.y * c.x), view.most);
}

fn count_by_world_area(corners: array<vec3f, 3>, view: CountUniform) -> f32 {
    let across = cross(corners[1] - corners[0], corners[2] - corners[0]);
    let upwards = select(across, -across, across.y < 0.0);
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    let away = max(dot(middle, middle), NEAR_M * NEAR_M);
    let facing = max(-dot(upwards, middle), 0.0) / sqrt(away);
    let area_px = 0.5 * facing / (away * view.pixel_rad * view.pixel_rad);
    return min(view.per_px * area_px, view.most);
}

// Places of a triangle of this count: the plants of smaller indices are shown, more or less.
fn places_of(count: f32, rounding: f32) -> u32 {
    return u32(max(ceil(count + rounding) - 1.0, 0.0));
}

// How much of plant `index` of a triangle is drawn, 0 to 1: `end` is its count, rounded.
fn shown_share(end: f32, ramp: f32, index: u32) -> f32 {
    return saturate((end - (f32(index) + 1.0)) / ramp);
}

// Plants over which the shares of a prefix's last ones fall to nothing.
fn ramp_of(count: f32) -> f32 {
    return max(0.2 * count, 1.0);
}
