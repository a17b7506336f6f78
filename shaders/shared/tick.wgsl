// What one sub-step asks of the passes. Twin: src/gpu/tick_data.rs.

#import "shared/wind.wgsl"

struct TickUniform {
    // Tick at the end of the sub-step.
    now: u32,
    // Active tiles; the colliding ones come first.
    tiles: u32,
    colliding: u32,
    fewest_rounds: u32,
    most_rounds: u32,
    // Δt/T of the recovery.
    step_over_t: f32,
    // κΔt of the bend springs over the whole sub-step.
    bend: f32,
    strain_limit: f32,
    // Most sweeps in a turn of either pass.
    collide_sweeps: u32,
    relax_sweeps: u32,
    // A point this deep in a part with its skin is in the part.
    cover_m: f32,
    spare: u32,
    // The wind at the start of the sub-step.
    wind_before: WindUniform,
}

@group(1) @binding(0) var<uniform> tick: TickUniform;
