// Stones: octahedra with corners moved about, flat shaded (P15 section 4: diamond-shaped gravel).
// Host: src/render/gravel.rs.
//
// A stone that bodies shove has a centre line like a plant that bends, and is moved, whole, by as much
// as the tip of that is off, level. It comes to lie on the ground there, tilted the way it was pushed.
#import "shared/drawn_plant.wgsl"
#import "shared/planar_shadow.wgsl"
#import "shared/plant_light.wgsl"

struct StonePoint {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(perspective, centroid) radiance: vec3f,
    @location(1) on_stone: vec3f,
    @location(2) @interpolate(flat) opacity: f32,
}

// Corner of a stone on one of its half axes (0, 1: along x; 2, 3: up; 4, 5: along z), in its half
// lengths.
fn stone_corner(shade: u32, half_axis: u32) -> vec3f {
    var random = shade ^ ((half_axis + 1u) * PHILOX_WEYL);
    let skew = vec3f(unit(pcg_next(&random)), unit(pcg_next(&random)), unit(pcg_next(&random))) - 0.5;
    var corner = skew * 0.7;
    corner[half_axis >> 1u] = select(1.0, -1.0, (half_axis & 1u) == 1u)
        * (0.75 + 0.5 * unit(pcg_next(&random)));
    return corner;
}

// Sine of the angle by which a stone is rocked that was shoved by its own length: what lies in the
// ground holds back its lower part.
const ROCKED = 0.3;

// How far bodies have moved a stone.
struct Shove {
    away: vec3f, // from where it grew, in metres; up by as much as the ground rises
    tilt: vec2f, // sine of the angle it is rocked by, to the side it was pushed to, x and z
}

fn shove_of(drawn: DrawnPlant) -> Shove {
    let unmoved = Shove(vec3f(0.0), vec2f(0.0));
    let tile = drawn.tile.tile;
    let plant = drawn.plant;
    if tile.slab == NO_SLAB || !responds(plant) {
        return unmoved;
    }
    let tip = active_nodes[plant_row(tile.slab, drawn.place) + field.segments].xyz;
    let free = wind_pose_at(plant, wind_bend(tile, plant), field.segments).place;
    let share = (tip - free) / max(plant.height_m, 1e-6);
    if length(share) < UNMOVED {
        return unmoved;
    }
    let level = (tip - free).xz;
    let place = plant.root.xz + level;
    let rise = ground_in_anchor(tile, place.x, place.y) - plant.root.y;
    return Shove(vec3f(level.x, rise, level.y), ROCKED * share.xz);
}

// The plant as if it had grown where it was shoved to.
fn shoved(drawn: DrawnPlant, shove: Shove) -> DrawnPlant {
    var there = drawn;
    there.plant.root += shove.away;
    there.root_from_eye += shove.away;
    return there;
}

// Turns a vector as what is upright is turned by a tilt.
fn rocked(v: vec3f, tilt: vec2f) -> vec3f {
    let cosine = sqrt(max(1.0 - dot(tilt, tilt), 0.0));
    // Times the sine.
    let axis = cross(UP, vec3f(tilt.x, 0.0, tilt.y));
    return v * cosine + cross(axis, v) + axis * (dot(axis, v) / (1.0 + cosine));
}

@vertex
fn stone_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> StonePoint {
    let drawn = drawn_plant(vertex, instance);
    return stone_point(drawn, shove_of(drawn), vertex % BUCKET_VERTICES);
}

@vertex
fn shadow_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> ShadowPoint {
    let drawn = drawn_plant(vertex, instance);
    let shove = shove_of(drawn);
    let point = stone_point(drawn, shove, vertex % BUCKET_VERTICES);
    return planar_shadow(shoved(drawn, shove), point.clip);
}

// Its colour is that of the ground where it grew, wherever it lies.
fn stone_point(drawn: DrawnPlant, shove: Shove, corner: u32) -> StonePoint {
    let face = corner / 3u;
    let plant = drawn.plant;
    // A face has one corner on each axis.
    let x = stone_corner(plant.shade, face & 1u);
    let y = stone_corner(plant.shade, 2u + ((face >> 1u) & 1u));
    let z = stone_corner(plant.shade, 4u + (face >> 2u));
    let half_m = vec3f(0.5 * plant.height_m, 0.5 * plant.width_m, 0.4 * plant.height_m)
        * (drawn.grown * sqrt(drawn.widen));
    let outward = cross((y - x) * half_m, (z - x) * half_m);
    let own_normal = normalize(select(outward, -outward, dot(outward, x + y + z) < 0.0));
    var local = x;
    if corner % 3u == 1u {
        local = y;
    } else if corner % 3u == 2u {
        local = z;
    }

    let root_from_eye = shoved(drawn, shove).root_from_eye;
    let distance = length(root_from_eye);
    let widened = max(LEAST_HALF_PX * distance * frame.pixel_rad / max(half_m.x, 1e-6), 1.0);
    let turn = plant.azimuth;
    // A third of the stone is in the ground.
    let shaped = local * half_m * widened + vec3f(0.0, 0.35 * half_m.y, 0.0);
    let position = root_from_eye + rocked(turned_level(shaped, turn), shove.tilt);
    let normal = rocked(turned_level(own_normal, turn), shove.tilt);
    let ground = ground_rgb(drawn) * field.species[plant.species].tint_rgb;
    let warmth = 0.9 + 0.2 * shade_byte(plant, 1u);
    let surface = ground * (0.75 + 0.65 * shade_byte(plant, 0u)) * vec3f(warmth, 1.0, 2.0 - warmth);
    // Low parts see less of the sky, past other stones.
    let low = saturate(0.7 - 0.5 * shaped.y / max(half_m.y * widened, 1e-6));
    let light = light_between(local_cover(drawn), low, position);
    let radiance = through_air(dull_radiance(surface, normal, light), position);
    let clip = frame.clip_from_eye * vec4f(position, 1.0);
    return StonePoint(clip, radiance, local * 3.0, 1.33 / (widened * widened));
}

@fragment
fn stone_fragment(in: StonePoint) -> @location(0) vec4f {
    if is_left_out(in.opacity, in.clip.xy) {
        discard;
    }
    let width = fwidth(in.on_stone);
    let detail = 1.0 - smoothstep(0.3, 1.0, max(max(width.x, width.y), width.z));
    let grain = value_noise(in.on_stone.xz * 2.3 + in.on_stone.y * 1.7) - 0.5;
    return vec4f(in.radiance * (1.0 + detail * 0.45 * grain), saturate(in.opacity));
}
