// What ground and bodies do to one node: push it, or turn the segment below it, which keeps its length.
// Twin: src/sim/relax/ground.rs.
#import "shared/field.wgsl"
#import "shared/ground.wgsl"
#import "shared/tile.wgsl"

// The segment below a node that is moved.
struct Laid {
    // Its lower node.
    start: vec3f,
    length: f32,
    // Unit vector along it at rest.
    rest: vec3f,
}

// Where a node is put; where it was if `moved` is false.
struct Put {
    node: vec3f,
    moved: bool,
}

fn plane_below(tile: TileRecord, node: vec3f) -> GroundPlane {
    return ground_plane_in_anchor(tile, node.x, node.z);
}

fn ground_below(tile: TileRecord, node: vec3f) -> f32 {
    return ground_in_anchor(tile, node.x, node.z);
}

// True for a node that a body presses onto the ground: its way out leads below it, and into it
// rather than along.
fn is_pressed(tile: TileRecord, out: vec3f, normal: vec3f) -> bool {
    let plane = plane_below(tile, out);
    let into = dot(plane.slope, normal.xz) - normal.y;
    return into > STICKS * sqrt(1.0 + dot(plane.slope, plane.slope)) && out.y < plane.height;
}

fn is_on_ground(tile: TileRecord, node: vec3f) -> bool {
    return node.y - ground_below(tile, node) <= ON_GROUND_M;
}

// The upper node turned about the lower one until it is on the ground, if it is below.
fn lay_on_ground(tile: TileRecord, laid: Laid, node: vec3f) -> vec3f {
    let plane = plane_below(tile, node);
    if node.y < plane.height {
        return turned_to(laid, node, plane);
    }
    return node;
}

// The upper node turned about the lower one, up or down, until it is on the plane of the ground below
// it, as far as the segment's length allows.
fn turned_to(laid: Laid, node: vec3f, plane: GroundPlane) -> vec3f {
    let sideways = unit_or(vec3f(laid.rest.x, 0.0, laid.rest.z), vec3f(1.0, 0.0, 0.0));
    let segment = node - laid.start;
    let aside = vec3f(segment.x, 0.0, segment.z);
    let flat = unit_or(aside, sideways);
    // Along `flat` the plane is `start + slope·run` above the lower node, and the upper one is where
    // run² + rise² is the square of the length.
    let slope = dot(plane.slope, flat.xz);
    let square = 1.0 + slope * slope;
    let reach = laid.length * sqrt(square);
    let start = clamp(plane.height - slope * dot(aside, flat) - laid.start.y, -reach, reach);
    let left = sqrt(max(reach * reach - start * start, 0.0));
    let run = (left - start * slope) / square;
    return laid.start + flat * run + UP * (start + slope * run);
}

// The upper node turned about the lower one until it is out of a part along the way `n` by `depth`, where
// the segment's length allows that, or of the way between the part and the ground.
fn turned_out(tile: TileRecord, laid: Laid, node: vec3f, n: vec3f, depth: f32) -> Put {
    let segment = node - laid.start;
    let along = dot(segment, n);
    let rise = along + depth;
    let run = laid.length * laid.length - rise * rise;
    if run <= 0.0 {
        if is_on_ground(tile, laid.start) && !is_on_ground(tile, node) {
            return Put(turned_to(laid, node, plane_below(tile, node)), true);
        }
        return Put(node, false);
    }
    let sideways = unit_or(laid.rest - n * dot(laid.rest, n), across(n));
    let flat = unit_or(segment - n * along, sideways);
    let out = laid.start + n * rise + flat * sqrt(run);
    if !is_pressed(tile, out, n) {
        return Put(out, true);
    }
    if is_on_ground(tile, node) {
        return Put(node, false);
    }
    return Put(turned_to(laid, node, plane_below(tile, node)), true);
}

// A node pushed out of a part along the way `n` by `depth`, and aside by `aside`; or straight down where
// the part presses it onto the ground.
fn pushed_out(tile: TileRecord, node: vec3f, n: vec3f, depth: f32, aside: vec3f) -> Put {
    let out = node + n * depth;
    if !is_pressed(tile, out, n) {
        return Put(out + aside, true);
    }
    if is_on_ground(tile, node) {
        return Put(node, false);
    }
    return Put(vec3f(node.x, ground_below(tile, node), node.z), true);
}
