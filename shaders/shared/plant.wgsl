// A plant from its seed. Twin: src/field/plant.rs; words agree bit for bit.
#import "shared/clusters.wgsl"
#import "shared/field.wgsl"
#import "shared/ground.wgsl"
#import "shared/kinds.wgsl"
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

fn along_leg(at_end: bool, word: u32) -> u32 {
    return select(word >> 8u, CELL_STEPS - (word >> 8u), at_end);
}

// Place in a seeding cell in 2⁻²⁴ of its side, given the shares of both legs as words: P15 eq. 25.
fn in_cell(cell: vec2u, half: u32, legs: vec2u) -> vec2u {
    let even = ((cell.x + cell.y) & 1u) == 0u;
    let second = half == 1u;
    return vec2u(along_leg(even != second, legs.x), along_leg(second, legs.y));
}

fn draw_between(range: vec2f, random: ptr<function, u32>) -> f32 {
    return range.x + range.y * unit(pcg_next(random));
}

// Azimuth of a plant from its random number: evenly all around, or thinning out from the light's.
fn azimuth_turns(towards: vec2f, random: f32) -> f32 {
    if towards.y < 0.0 {
        return random;
    }
    let side = 2.0 * random - 1.0;
    let away = 1.0 - sqrt(1.0 - abs(side));
    return towards.x + towards.y * select(away, -away, side < 0.0);
}

// A kind by the shares alone.
fn by_share(word: u32) -> KindChoice {
    for (var kind = 0u; kind < field.species_count; kind++) {
        if word < field.species[kind].share_below {
            return KindChoice(kind, 65536u);
        }
    }
    return KindChoice(field.species_count - 1u, 65536u);
}

// A seed: where on its triangle a plant grows, before its kind is known.
struct Seed {
    cell: vec2u,
    // In 2⁻²⁴ of the cell's side.
    in_cell: vec2u,
    words: vec2u,
    // Where its kind is looked up, and the word that chooses it: its own, or its cluster's.
    middle: vec2u,
    word: u32,
    // False beyond the ground's edge and past a triangle's own count.
    exists: bool,
}

// The seed at a place of a tile's order.
fn seed_at(tile: TileRecord, place: u32) -> Seed {
    var seed: Seed;
    let triangles = 2u * field.tile_cells * field.tile_cells;
    let index = place / triangles;
    let within = place % triangles;
    let half = within & 1u;
    let across = within >> 1u;
    let cell = tile.first_cell + vec2u(across % field.tile_cells, across / field.tile_cells);
    if cell.x >= field.cells.x || cell.y >= field.cells.y {
        return seed;
    }
    let triangle = ((cell.y * field.cells.x + cell.x) << 1u) | half;
    if index >= field.sure_plants {
        if index >= plants_on(triangle) {
            return seed;
        }
    }
    let words = philox2x32(vec2u(triangle, index), field.key, field.rounds);
    if field.cluster > 1u {
        let cluster = index / field.cluster;
        let stratum = stratum_of(triangle, cluster);
        let of_cluster =
            philox2x32(vec2u(triangle, CLUSTER_WORD + cluster), field.key, field.rounds);
        var random = pcg_from_words(of_cluster);
        let root = in_cell(cell, half, within_stratum(stratum, words));
        let middle = in_cell(cell, half, within_stratum(stratum, of_cluster));
        return Seed(cell, root, words, middle, pcg_next(&random), true);
    }
    var random = pcg_from_words(words);
    let root = in_cell(cell, half, folded(words));
    return Seed(cell, root, words, root, pcg_next(&random), true);
}

// What grows of a seed.
fn choice_of(tile: TileRecord, seed: Seed) -> KindChoice {
    if field.taste_count == 0u {
        return by_share(seed.word);
    }
    return choose_kind(
        place_on_map(tile.anchor_on_map, field.map_step, seed.cell, seed.middle),
        seed.word,
    );
}

// The plant of a seed, of a kind that is known.
fn plant_of(tile: TileRecord, seed: Seed, choice: KindChoice) -> Plant {
    var plant: Plant;
    let in_anchor = vec2f(seed.cell % vec2u(ANCHOR_CELLS));
    // At most 2²⁴ steps: exact.
    let xz = (in_anchor + vec2f(seed.in_cell) * (1.0 / f32(CELL_STEPS))) * field.cell_m;
    plant.root = vec3f(xz.x, ground_in_anchor(tile, xz.x, xz.y), xz.y);
    plant.grows = true;

    var random = pcg_from_words(seed.words);
    // The word that chooses the kind of a seed that lies alone.
    pcg_next(&random);
    plant.species = choice.kind;
    // Eq. 18: on its own ground a plant is as large and stiff as its seed says.
    let dwindle = field.species[plant.species].dwindle;
    let vigour = 1.0 - dwindle * (1.0 - f32(choice.thrives) * (1.0 / 65536.0));
    plant.height_m = draw_between(field.species[plant.species].height_m, &random) * vigour;
    plant.width_m = draw_between(field.species[plant.species].width_m, &random);
    let stiffness = field.species[plant.species].stiffness;
    plant.stiffness = draw_between(vec2f(stiffness.x, stiffness.y * vigour), &random);
    plant.lean = draw_between(field.species[plant.species].lean, &random);
    let turns = azimuth_turns(field.species[plant.species].towards, unit(pcg_next(&random)));
    plant.azimuth = vec2f(cos_turns(turns), sin_turns(turns));
    plant.flexibility = field.species[plant.species].flexibility;
    plant.flutter_turns = unit(pcg_next(&random));
    plant.shade = pcg_next(&random);
    return plant;
}

// The plant at a place of a tile's order.
fn plant_at(tile: TileRecord, place: u32) -> Plant {
    let seed = seed_at(tile, place);
    if seed.exists {
        let choice = choice_of(tile, seed);
        if choice.kind < field.species_count {
            return plant_of(tile, seed, choice);
        }
    }
    var none: Plant;
    return none;
}

// Whether a plant is there and of a kind that bodies push aside.
fn responds(plant: Plant) -> bool {
    return plant.grows && field.species[plant.species].responds == 1u;
}
