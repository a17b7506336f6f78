// A turn and a place. Twin: src/base/pose.rs.

// Takes a point of the inner space to the outer one: unit quaternion x, y, z, w, then a place.
struct Pose {
    turn: vec4f,
    place: vec3f,
}

fn rotate(turn: vec4f, p: vec3f) -> vec3f {
    let t = cross(turn.xyz, p) * 2.0;
    return p + t * turn.w + cross(turn.xyz, t);
}

fn inverse_point(pose: Pose, p: vec3f) -> vec3f {
    return rotate(vec4f(-pose.turn.xyz, pose.turn.w), p - pose.place);
}
