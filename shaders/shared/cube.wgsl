// Sampling a depth cube. Twin: src/sim/depth_cube.rs.
#import "shared/field.wgsl"
#import "shared/solid.wgsl"
#import "shared/texel.wgsl"

// Six faces of resolution² texels per cube: flags and depth, and the packed normal.
@group(1) @binding(5) var<storage, read> texels: array<vec2u>;

// A surface point on a face, and how far below it the point is.
struct CubeSample {
    // False outside the face's silhouette; then the rest means nothing.
    hit: bool,
    hidden: bool,
    // Depth of the point behind the planes of the texels around it.
    behind: f32,
    normal: vec3f,
}

// A face's surface over a point: distances to the tangent planes of the texels that were hit, mixed
// by bilinear weights.
fn cube_sample(solid: SolidRecord, p: vec3f, face: u32) -> CubeSample {
    var sample: CubeSample;
    let a = face >> 1u;
    let columns_along = (a + 1u) % 3u;
    let rows_along = (a + 2u) % 3u;
    let size = solid.high - solid.low;
    let inside = (p - solid.low) / size * f32(solid.resolution) - 0.5;
    let at = vec2f(inside[columns_along], inside[rows_along]);
    let whole = floor(at);
    let share = at - whole;
    let texel_m = size / f32(solid.resolution);
    let below = select(p[a] - solid.low[a], solid.high[a] - p[a], (face & 1u) == 0u);
    let last = i32(solid.resolution) - 1;
    let first = solid.first_texel + face * solid.resolution * solid.resolution;
    var weight = 0.0;
    var hidden = 0.0;
    var distance = 0.0;
    var normal = vec3f(0.0);
    for (var corner = 0u; corner < 4u; corner++) {
        let step = vec2u(corner & 1u, corner >> 1u);
        let w = select(1.0 - share.x, share.x, step.x == 1u)
            * select(1.0 - share.y, share.y, step.y == 1u);
        let texel = vec2u(clamp(vec2i(whole) + vec2i(step), vec2i(0), vec2i(last)));
        let word = texels[first + texel.y * solid.resolution + texel.x];
        if (word.x & HIT) == 0u {
            continue;
        }
        weight += w;
        let n = unpack_normal(word.y);
        let off_centre = at - vec2f(texel);
        let sideways = n[columns_along] * (off_centre.x * texel_m[columns_along])
            + n[rows_along] * (off_centre.y * texel_m[rows_along]);
        distance += w * ((below - unpack_depth(word.x) * size[a]) * abs(n[a]) - sideways);
        normal += n * w;
        if (word.x & HIDDEN) != 0u {
            hidden += w;
        }
    }
    if weight < LEAST_WEIGHT {
        return sample;
    }
    sample.hit = true;
    sample.hidden = hidden > HIDDEN_SHARE * weight;
    sample.behind = distance / weight;
    sample.normal = unit_or(normal, face_normal(face));
    return sample;
}

fn within_bounds(solid: SolidRecord, p: vec3f) -> bool {
    return all(p > solid.low) && all(p < solid.high);
}

// True where a point is farther behind all six faces than `depth_m`.
fn cube_is_deeper(solid: SolidRecord, p: vec3f, depth_m: f32) -> bool {
    if !within_bounds(solid, p) {
        return false;
    }
    for (var face = 0u; face < 6u; face++) {
        let sample = cube_sample(solid, p, face);
        if !sample.hit || sample.behind <= depth_m {
            return false;
        }
    }
    return true;
}

// The way out for a point inside. No way leads through a hidden surface while another is open.
fn cube_exit(solid: SolidRecord, p: vec3f, kept: u32, reach: Reach) -> Exit {
    if !within_bounds(solid, p) {
        return outside();
    }
    var choice = no_choice();
    for (var face = 0u; face < 6u; face++) {
        let sample = cube_sample(solid, p, face);
        if !sample.hit || sample.behind <= 0.0 {
            return outside();
        }
        let exit = Exit(sample.behind, sample.normal, face);
        offer(&choice, p, kept, reach, exit, sample.hidden);
    }
    return nearer(solid, p, take(choice));
}

// The way out to the surface where `exit` ends, if that is shorter.
fn nearer(solid: SolidRecord, p: vec3f, exit: Exit) -> Exit {
    let way = exit.normal * exit.depth;
    let sample = cube_sample(solid, p + way, exit.face);
    let depth = sample.behind + dot(sample.normal, way);
    if !sample.hit || sample.hidden || depth <= 0.0 || depth >= exit.depth {
        return exit;
    }
    return Exit(depth, sample.normal, exit.face);
}
