// A turn and a place. Twin: src/base/pose.rs.

// Takes a point of the inner space to the outer one: unit quaternion x, y, z, w, then a place.
struct Pose {
    turn: vec4f,
    place: vec3f,
}

// In this form because drivers may pull the factor 2 out of the sum, and Mesa does: another form would
// push plants one rounding aside of where the processor does.
fn rotate(turn: vec4f, p: vec3f) -> vec3f {
    let aside = cross(turn.xyz, p);
    return p + (aside * turn.w + cross(turn.xyz, aside)) * 2.0;
}

fn inverse_point(pose: Pose, p: vec3f) -> vec3f {
    return rotate(vec4f(-pose.turn.xyz, pose.turn.w), p - pose.place);
}

// The pose at a share of the way, its turn along the shorter one.
fn lerp_poses(from_pose: Pose, to_pose: Pose, share: f32) -> Pose {
    let same_side = dot(from_pose.turn, to_pose.turn) >= 0.0;
    let mixed = from_pose.turn * (1.0 - share) + to_pose.turn * select(-share, share, same_side);
    let length = sqrt(dot(mixed, mixed));
    var turn = from_pose.turn;
    if length > 1e-12 {
        turn = mixed * (1.0 / length);
    }
    return Pose(turn, from_pose.place * (1.0 - share) + to_pose.place * share);
}
