// The wind at one instant. Twin: src/field/wind.rs.
#import "shared/philox.wgsl"
#import "shared/plant.wgsl"
#import "shared/tile.wgsl"
#import "shared/trig.wgsl"

// One sine of a gust.
struct WaveUniform {
    // Phase at the field's corner, and what is added per anchor along x and z, in 2⁻³² turns.
    per_anchor: vec2u,
    // Turns per metre along x and z.
    per_metre: vec2f,
    phase: u32,
    share: f32,
    spare: vec2u,
}

struct WindUniform {
    // Unit vector along x and z.
    direction: vec2f,
    strength: f32,
    gust: f32,
    flutter: f32,
    flutter_phase: u32,
    spare: vec2u,
    waves: array<WaveUniform, WAVES>,
}

@group(0) @binding(3) var<uniform> wind: WindUniform;

// Bend of a plant's tip along x and z by the wind of now.
fn wind_bend(tile: TileRecord, plant: Plant) -> vec2f {
    return wind_bend_by(wind, tile, plant);
}

// Bend of a plant's tip by the wind of some instant.
fn wind_bend_by(then: WindUniform, tile: TileRecord, plant: Plant) -> vec2f {
    var waves = then.waves;
    var gust = 0.0;
    for (var n = 0u; n < WAVES; n++) {
        let phase = waves[n].phase
            + tile.anchor.x * waves[n].per_anchor.x
            + tile.anchor.y * waves[n].per_anchor.y;
        let per_metre = waves[n].per_metre;
        let turns = unit(phase) + (plant.root.x * per_metre.x + plant.root.z * per_metre.y);
        gust += waves[n].share * sin_turns(turns);
    }
    let along = then.strength + then.gust * gust;
    let across = then.flutter * sin_turns(unit(then.flutter_phase) + plant.flutter_turns);
    let d = then.direction;
    return vec2f(d.x * along - d.y * across, d.y * along + d.x * across) * plant.flexibility;
}
