// What one sub-step asks of the passes. Twin: src/gpu/tick_data.rs.

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
    // 2a of the bend springs.
    bend: f32,
    strain_limit: f32,
}

@group(1) @binding(0) var<uniform> tick: TickUniform;
