// Goes on to the next turn of a pass whose sweeps do not fit one dispatch. Host: src/gpu/turns.rs.
#import "shared/touched.wgsl"

@compute @workgroup_size(1)
fn next_turn() {
    atomicAdd(&touched[2], 1u);
}
