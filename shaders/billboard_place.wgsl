// Where billboards stand and how they grow: O09 section 4, once per scene. Twin:
// src/field/billboards/seeds.rs; counts, ranges, sizes and pictures bit for bit.
//
// Both kernels go through the places of a tile in their order, one invocation a tile: the first counts,
// the second writes. Between them prefix sums run over the tiles of every row of ROW_TILES, then over the
// rows (shaders/sum_rows.wgsl), so that a billboard's place in the buffer is the same in every run.
#import "shared/billboard.wgsl"
#import "shared/clusters.wgsl"
#import "shared/field.wgsl"
#import "shared/ground.wgsl"
#import "shared/on_map.wgsl"
#import "shared/philox.wgsl"
#import "shared/plant.wgsl"
#import "shared/tile.wgsl"
#import "shared/trig.wgsl"

// A kind of clump. Pairs are the smallest value and the steps from it, in 1/FINE_STEPS.
struct ClumpUniform {
    height: vec2u,
    width: vec2u,
    // A billboard is of the first kind whose bound lies above its random word.
    share_below: u32,
    flexibility: u32,
    spare: vec2u,
}

struct BillboardUniform {
    // Tiles along x and z.
    tiles: vec2u,
    map_texels: vec2u,
    map_step: u32,
    // Anchors along x, whose places on the map stand before those along z.
    anchors: u32,
    // Halvings of the height samples' spacing down to a seeding cell.
    halvings: u32,
    // Billboards of every seeding triangle, and the chance of one more in 2⁻³².
    sure: u32,
    one_more: u32,
    // Places of a tile.
    places: u32,
    key: u32,
    kind_count: u32,
    // Invocations dispatched side by side.
    wide: u32,
    spare_a: u32,
    spare_b: vec2u,
    kinds: array<ClumpUniform, MAX_CLUMPS>,
}

@group(1) @binding(0) var<uniform> cover: BillboardUniform;
// Two words a texel; see src/terrain/cover_map.rs.
@group(1) @binding(1) var<storage, read> map_words: array<vec2u>;
// Places of the anchors' origins on the map along x, then along z, in units of 2⁻¹⁶ texel.
@group(1) @binding(2) var<storage, read> anchors_on_map: array<u32>;
// Billboards of each tile; then those of earlier tiles of its row; then those of all earlier tiles.
@group(1) @binding(3) var<storage, read_write> ranges: array<u32>;
// Billboards of all earlier rows.
@group(1) @binding(4) var<storage, read> rows_before: array<u32>;
@group(1) @binding(5) var<storage, read_write> records: array<BillboardRecord>;

// A tile as a blade's seeds need it.
fn tile_of(number: u32) -> TileRecord {
    var tile: TileRecord;
    tile.tile = number;
    tile.slab = NO_SLAB;
    tile.first_cell = vec2u(number % cover.tiles.x, number / cover.tiles.x) * field.tile_cells;
    tile.anchor = tile.first_cell / vec2u(ANCHOR_CELLS);
    let first = tile.anchor * ANCHOR_CELLS;
    tile.square = first >> vec2u(cover.halvings);
    let share = 1.0 / f32(1u << cover.halvings);
    tile.in_square = vec2f(first - (tile.square << vec2u(cover.halvings))) * share;
    tile.base_y = floor(heights_m[tile.square.y * field.columns + tile.square.x]);
    tile.anchor_on_map = vec2u(
        anchors_on_map[tile.anchor.x],
        anchors_on_map[cover.anchors + tile.anchor.y],
    );
    return tile;
}

struct Cover {
    // In units of 2⁻¹⁶, 0…65536.
    extent: u32,
    messiness: u32,
    // Of any length.
    direction: vec3f,
}

fn shares_of(texel: vec2u) -> vec3u {
    let word = map_words[texel.y * cover.map_texels.x + texel.x].x;
    return vec3u(word & 0xffffu, word >> 16u, 0u);
}

fn direction_of(texel: vec2u) -> vec3u {
    let word = map_words[texel.y * cover.map_texels.x + texel.x].y;
    return (vec3u(word) >> vec3u(0u, 9u, 18u)) & vec3u(0x1ffu);
}

// Twin: CoverMap::at in src/terrain/cover_map.rs.
fn cover_at(place: vec2u) -> Cover {
    let at = between_texels(place, cover.map_texels);
    let c10 = vec2u(at.high.x, at.low.y);
    let c01 = vec2u(at.low.x, at.high.y);
    let shares = mix_texels(
        at.shares,
        shares_of(at.low),
        shares_of(c10),
        shares_of(c01),
        shares_of(at.high),
    ) >> vec3u(16u);
    // White is all: 65535 becomes 65536.
    let whole = shares + (shares >> vec3u(15u));
    let mixed = mix_texels(
        at.shares,
        direction_of(at.low),
        direction_of(c10),
        direction_of(c01),
        direction_of(at.high),
    ) >> vec3u(8u);
    return Cover(whole.x, whole.y, vec3f(vec3i(mixed) - vec3i(255 << 8u)));
}

// A seed that grows.
struct Sown {
    grows: bool,
    cell: vec2u,
    in_cell: vec2u,
    // State of its small generator, past the word that the extent is compared with.
    random: u32,
    cover: Cover,
}

// The seed at a place of a tile's order.
fn sown_at(tile: TileRecord, place: u32) -> Sown {
    var none: Sown;
    let triangles = 2u * field.tile_cells * field.tile_cells;
    let index = place / triangles;
    let within = place % triangles;
    let half = within & 1u;
    let across = within >> 1u;
    let cell = tile.first_cell + vec2u(across % field.tile_cells, across / field.tile_cells);
    if cell.x >= field.cells.x || cell.y >= field.cells.y {
        return none;
    }
    let triangle = ((cell.y * field.cells.x + cell.x) << 1u) | half;
    if index >= cover.sure {
        let word = philox2x32(vec2u(triangle, BILLBOARD_COUNT_WORD), cover.key, field.rounds).x;
        if index >= cover.sure + select(0u, 1u, word < cover.one_more) {
            return none;
        }
    }
    let words = philox2x32(vec2u(triangle, BILLBOARD_WORD + index), cover.key, field.rounds);
    let inside = in_cell(cell, half, folded(words));
    let here = cover_at(place_on_map(tile.anchor_on_map, cover.map_step, cell, inside));
    var random = pcg_from_words(words);
    if (pcg_next(&random) >> 16u) >= here.extent {
        return none;
    }
    return Sown(true, cell, inside, random, here);
}

fn drawn_steps(range: vec2u, random: ptr<function, u32>) -> u32 {
    return range.x + (((range.y + 1u) * (pcg_next(random) >> 16u)) >> 16u);
}

// The nearest steps of a level part of a unit vector.
fn nearest_steps(level: vec2f) -> vec2i {
    return vec2i(floor(level * f32(UNIT_STEPS) + 0.5));
}

// Level steps of the unit vector along a map's direction, tilted to a side.
fn tilted(direction: vec3f, azimuth_turns: f32, tilt_turns: f32) -> vec2i {
    let n = unit_or(direction, UP);
    // Two unit vectors at right angles to n and each other, without a case for any n that rises.
    let a = 1.0 / (1.0 + n.y);
    let b = -(n.x * n.z * a);
    let east = vec3f(1.0 - n.x * n.x * a, -n.x, b);
    let north = vec3f(b, -n.z, 1.0 - n.z * n.z * a);
    let aside = east * cos_turns(azimuth_turns) + north * sin_turns(azimuth_turns);
    let up = n * cos_turns(tilt_turns) + aside * sin_turns(tilt_turns);
    return nearest_steps(up.xz);
}

// Level steps of the lower edge of a clump with this growth direction; `random` is −1…1.
fn edge(up: vec2i, mess: f32, random: f32) -> vec2i {
    let level = sqrt(f32(level_squared(up)));
    let lean = level * UNIT_STEP;
    let shown = (1.0 - mess) * min(1.0, FACES_FROM * lean);
    let order = max(shown, lean * lean);
    let turns = 0.25 * (1.0 - order) * random;
    var towards = vec2f(1.0, 0.0);
    if level > 0.0 {
        towards = vec2f(up) / level;
    }
    let cosine = cos_turns(turns);
    let sine = sin_turns(turns);
    // A quarter turn from the lean, then the random rest.
    return nearest_steps(vec2f(
        -towards.y * cosine - towards.x * sine,
        towards.x * cosine - towards.y * sine,
    ));
}

fn grown(tile: TileRecord, seed: Sown) -> BillboardRecord {
    var random = seed.random;
    let word = pcg_next(&random);
    var kind = 0u;
    while kind + 1u < cover.kind_count && word >= cover.kinds[kind].share_below {
        kind++;
    }
    let numbers = cover.kinds[kind];
    let variant = pcg_next(&random) >> 30u;
    let height = drawn_steps(numbers.height, &random);
    let width = drawn_steps(numbers.width, &random);
    let flutter = pcg_next(&random) >> 16u;
    let mess = f32(seed.cover.messiness) * (1.0 / 65536.0);
    let azimuth_turns = unit(pcg_next(&random));
    let tilt_turns = MOST_TILT_TURNS * mess * unit(pcg_next(&random));
    let up = tilted(seed.cover.direction, azimuth_turns, tilt_turns);
    let across = edge(up, mess, 2.0 * unit(pcg_next(&random)) - 1.0);

    let in_anchor = vec2f(seed.cell % vec2u(ANCHOR_CELLS));
    // At most 2²⁴ steps: exact.
    let xz = (in_anchor + vec2f(seed.in_cell) * (1.0 / f32(CELL_STEPS))) * field.cell_m;
    var record: BillboardRecord;
    record.root = vec3f(xz.x, ground_in_anchor(tile, xz.x, xz.y), xz.y);
    record.size = height | (width << 16u);
    record.up = signed_pair(up);
    record.across = signed_pair(across);
    record.sway = numbers.flexibility | (flutter << 16u);
    record.tile_and_texture = tile.tile | ((kind * CLUMP_VARIANTS + variant) << 24u);
    return record;
}

fn tile_number(id: vec3u) -> u32 {
    return id.y * cover.wide + id.x;
}

@compute @workgroup_size(WORKGROUP)
fn count_billboards(@builtin(global_invocation_id) id: vec3u) {
    let number = tile_number(id);
    if number >= cover.tiles.x * cover.tiles.y {
        return;
    }
    let tile = tile_of(number);
    var count = 0u;
    for (var place = 0u; place < cover.places; place++) {
        if sown_at(tile, place).grows {
            count++;
        }
    }
    ranges[number] = count;
}

@compute @workgroup_size(WORKGROUP)
fn place_billboards(@builtin(global_invocation_id) id: vec3u) {
    let number = tile_number(id);
    let tiles = cover.tiles.x * cover.tiles.y;
    if number >= tiles {
        return;
    }
    let tile = tile_of(number);
    var at = ranges[number] + rows_before[number / ROW_TILES];
    ranges[number] = at;
    for (var place = 0u; place < cover.places; place++) {
        let seed = sown_at(tile, place);
        if seed.grows {
            records[at] = grown(tile, seed);
            at++;
        }
    }
    if number + 1u == tiles {
        ranges[tiles] = at;
    }
}
