// The list of touched plants: TOUCHED_HEADER words (their count, the most rounds any plant took, the
// turn of the pass, how often loops were cut short), then two words per plant.
// Host: src/gpu/grass_buffers.rs.
@group(1) @binding(4) var<storage, read_write> touched: array<atomic<u32>>;

// A plant to respond: rank of its tile's record, place in the tile, sweeps it needs (0 if
// it is merely held).
struct Touched {
    tile: u32,
    place: u32,
    sweeps: u32,
}

// The turn of the pass, from 0.
fn turn() -> u32 {
    return atomicLoad(&touched[2]);
}

// Counts an invocation whose loops the driver has ended early: see src/gpu/turns.rs. Once its limit is
// reached every loop ends after its first round, a loop of two rounds too.
fn tell_if_cut_short(segments: u32) {
    var rounds = 0u;
    // No compiler knows that these are two.
    for (var j = 0u; j <= min(segments, 1u); j++) {
        rounds++;
    }
    if rounds < 2u {
        atomicAdd(&touched[3], 1u);
    }
}

fn add_touched(plant: Touched) {
    let at = TOUCHED_HEADER + 2u * atomicAdd(&touched[0], 1u);
    atomicStore(&touched[at], (plant.tile << 16u) | plant.place);
    atomicStore(&touched[at + 1u], plant.sweeps);
}

fn touched_at(index: u32) -> Touched {
    let at = TOUCHED_HEADER + 2u * index;
    let word = atomicLoad(&touched[at]);
    return Touched(word >> 16u, word & 0xffffu, atomicLoad(&touched[at + 1u]));
}
