// Shadows of plants on the ground: P15 section 3.6. A plant is drawn a second time, each of its points
// moved along the light onto the plane of the seeding triangle under its root, flat black, and as a
// screen door: some of a pixel's samples. They cover ground only as far as its triangle's plane is the
// ground. Deviations: they end at twice the distance up to which plants are drawn in full; they fade
// where the sun is so low that they would be many times as long as the plant, and in the shadow of a
// body; a closed canopy has none, since it hides the ground and dims it already (src/render/plants.rs).
#import "shared/drawn_plant.wgsl"
#import "shared/frame.wgsl"
#import "shared/ground.wgsl"
#import "shared/shadow.wgsl"

struct ShadowPoint {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) opacity: f32,
}

// Share of the ground's light that a shadow takes: the sun's, not the sky's.
const SHADOW_OPACITY = 0.55;
// Sines of the sun's height over the ground between which shadows fade in: 4 and 14 degrees.
const FADES_IN = vec2f(0.07, 0.24);
// How far a shadow lies over its plane, in metres, and towards the eye, as a share of the distance, so
// that the ground does not come through.
const SHADOW_LIFT_M = 0.003;
const SHADOW_NEARER = 0.002;

// The shadow of a plant's point that is drawn at `clip`.
fn planar_shadow(drawn: DrawnPlant, clip: vec4f) -> ShadowPoint {
    let point = frame.eye_from_clip * clip;
    let from_root = point.xyz / point.w - drawn.root_from_eye;
    let root = drawn.plant.root;
    let slope = ground_plane_in_anchor(drawn.tile.tile, root.x, root.z).slope;
    let normal = normalize(vec3f(-slope.x, 1.0, -slope.y));
    let facing = dot(normal, frame.sun_direction);
    let away = max(dot(from_root, normal), 0.0) / max(facing, FADES_IN.x);
    let fallen = drawn.root_from_eye + from_root - frame.sun_direction * away;
    let lifted = (fallen + normal * SHADOW_LIFT_M) * (1.0 - SHADOW_NEARER);

    let distance = length(drawn.root_from_eye);
    let near = 1.0 - smoothstep(1.1, 1.9, distance / frame.blade_full_m);
    let sun = smoothstep(FADES_IN.x, FADES_IN.y, facing)
        * sun_reaches_cheaply(drawn.root_from_eye + normal * 0.02);
    // Coverage has few steps: a lot per plant makes up for what lies between.
    let lot = (shade_byte(drawn.plant, 1u) - 0.5) / f32(plant_look.samples);
    let opacity = select(0.0, SHADOW_OPACITY * near * sun + lot, near * sun > 0.01);
    return ShadowPoint(frame.clip_from_eye * vec4f(lifted, 1.0), opacity);
}

@fragment
fn shadow_fragment(in: ShadowPoint) -> @location(0) vec4f {
    // Without multisampling the door has whole pixels.
    let is_open = plant_look.samples == 1u && in.opacity < lattice(vec2i(in.clip.xy));
    if is_open || in.opacity <= 0.0 {
        discard;
    }
    return vec4f(0.0, 0.0, 0.0, saturate(in.opacity));
}
