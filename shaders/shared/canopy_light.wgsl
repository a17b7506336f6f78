// Light on grass whose blades are too small to be drawn: the mean of what blades would show.
#import "shared/plant_light.wgsl"

// Three numbers are fitted to pictures of the same place drawn with every blade, under suns from 6 to 50
// degrees (tests/pictures/canopy.rs): light is within 9%. How deep in the plants it meets the blades that
// are seen from afar, as `sun_past_plants` and `sky_past_plants` count it.
const CANOPY_DEPTH = 0.24;
// How far the normals of blades lean upwards, of two kinds of parts: stems, and tips that are bent.
const CANOPY_LEANS = vec2f(0.4, 1.1);
// Share of a blade, curved across, that the eye sees even edge-on.
const CANOPY_CURVED = 0.3;
// Blades turn to all sides alike: normals of a half turn and their opposites, in so many steps.
const CANOPY_TURNS = 6u;
const HALF_TURN = 3.14159265;

// Radiance of grass of this colour. `up` is the ground's normal with its bumps, along which blades
// stand on the whole; a blade's share is as wide as it shows itself to the eye.
fn canopy_radiance(
    rgb: vec3f,
    up: vec3f,
    position: vec3f,
    sun_reaches: f32,
) -> vec3f {
    let light = PlantLight(
        sky_past_plants(CANOPY_DEPTH),
        sun_past_plants(CANOPY_DEPTH) * sun_reaches,
        sky_light_at(position),
    );
    let to_eye = -normalize(position);
    var sum = vec3f(0.0);
    var seen = 0.0;
    for (var turn = 0u; turn < CANOPY_TURNS; turn++) {
        let angle = (f32(turn) + 0.5) * (HALF_TURN / f32(CANOPY_TURNS));
        let level = vec3f(cos(angle), 0.0, sin(angle));
        for (var side = 0u; side < 2u; side++) {
            let lean = select(CANOPY_LEANS.x, CANOPY_LEANS.y, (turn & 1u) == 1u);
            let normal = normalize(select(level, -level, side == 1u) + up * lean);
            let share = abs(dot(normal, to_eye)) + CANOPY_CURVED;
            sum += leaf_radiance(rgb, normal, light, position) * share;
            seen += share;
        }
    }
    return sum / max(seen, 1e-6);
}
