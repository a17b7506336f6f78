// A plant from its seed. Twin: src/field/plant.rs; words agree bit for bit.
#import "shared/field.wgsl"
#import "shared/ground.wgsl"
#import "shared/philox.wgsl"
#import "shared/tile.wgsl"
#import "shared/trig.wgsl"

// One plant, in its anchor's coordinates.
struct Plant {
    root: vec3f,
    // False where nothing grows; then the rest means nothing.
    grows: bool,
    // Cosine and sine of the azimuth it leans to, from +x towards +z.
    azimuth: vec2f,
    height_m: f32,
    width_m: f32,
    // Places in the blade table, 0…1.
    stiffness: f32,
    lean: f32,
    flexibility: f32,
    species: u32,
    flutter_turns: f32,
    // A free word for its colour.
    shade: u32,
}

fn plants_on(triangle: u32) -> u32 {
    let word = philox2x32(vec2u(triangle, 0xffffffffu), field.key, field.rounds).x;
    return field.sure_plants + select(0u, 1u, word < field.one_more);
}

fn along_leg(at_end: bool, word: u32) -> f32 {
    let r = unit(word);
    return select(r, 1.0 - r, at_end);
}

// Place in a seeding cell, 0…1: P15 eq. 23-25 on the words.
fn root_in_cell(cell: vec2u, half: u32, words: vec2u) -> vec2f {
    var ab = words;
    // A carry of the sum means r₁ + r₂ ≥ 1.
    if ab.x + ab.y < ab.x {
        ab = ~ab;
    }
    let even = ((cell.x + cell.y) & 1u) == 0u;
    let second = half == 1u;
    return vec2f(along_leg(even != second, ab.x), along_leg(second, ab.y));
}

fn draw_between(range: vec2f, random: ptr<function, u32>) -> f32 {
    return range.x + range.y * unit(pcg_next(random));
}

fn species_of(choice: u32) -> u32 {
    for (var kind = 0u; kind < field.species_count; kind++) {
        if choice < field.species[kind].share_below {
            return kind;
        }
    }
    return field.species_count - 1u;
}

// The plant at a place of a tile's order.
fn plant_at(tile: TileRecord, place: u32) -> Plant {
    var plant: Plant;
    let triangles = 2u * field.tile_cells * field.tile_cells;
    let index = place / triangles;
    let within = place % triangles;
    let half = within & 1u;
    let across = within >> 1u;
    let cell = tile.first_cell + vec2u(across % field.tile_cells, across / field.tile_cells);
    if cell.x >= field.cells.x || cell.y >= field.cells.y {
        return plant;
    }
    let triangle = ((cell.y * field.cells.x + cell.x) << 1u) | half;
    if index >= field.sure_plants {
        if index >= plants_on(triangle) {
            return plant;
        }
    }
    let words = philox2x32(vec2u(triangle, index), field.key, field.rounds);
    let place_in_cell = root_in_cell(cell, half, words);
    let in_anchor = vec2f(cell % vec2u(ANCHOR_CELLS));
    let xz = (in_anchor + place_in_cell) * field.cell_m;
    plant.root = vec3f(xz.x, ground_in_anchor(tile, xz.x, xz.y), xz.y);
    plant.grows = true;

    var random = pcg_from_words(words);
    plant.species = species_of(pcg_next(&random));
    plant.height_m = draw_between(field.species[plant.species].height_m, &random);
    plant.width_m = draw_between(field.species[plant.species].width_m, &random);
    plant.stiffness = draw_between(field.species[plant.species].stiffness, &random);
    plant.lean = draw_between(field.species[plant.species].lean, &random);
    let turns = unit(pcg_next(&random));
    plant.azimuth = vec2f(cos_turns(turns), sin_turns(turns));
    plant.flexibility = field.species[plant.species].flexibility;
    plant.flutter_turns = unit(pcg_next(&random));
    plant.shade = pcg_next(&random);
    return plant;
}
