// Billboards that nothing touches: quads straight from their records, O09 section 6 (pass RU). Host:
// src/render/billboards.rs.
//
// Deviations from the paper: a clump takes its colour from the ground under it; light is computed per
// vertex, with normals that fan out, so that neighbours do not show as flat cards of different brightness;
// a quad seen from its edge fades; so does one far away, billboard by billboard.
#import "shared/billboard.wgsl"
#import "shared/noise.wgsl"
#import "shared/plant.wgsl"
#import "shared/plant_light.wgsl"
#import "shared/wind.wgsl"

struct BillboardLook {
    map_m: vec2f, // extent of the base-colour map
    cover: f32, // share of the sky that billboards hide at the ground
    reach_m: f32,
    samples: u32, // per pixel; 1 means that coverage is drawn by lot
    spare_a: u32,
    spare_b: vec2u,
    tints: array<vec4f, MAX_CLUMPS>,
}

// Where the anchor of a tile in view is.
struct BillboardTile {
    anchor_from_eye: vec3f,
    spare: u32,
    anchor: vec2u,
    spare_b: vec2u,
}

@group(3) @binding(0) var<uniform> billboard_look: BillboardLook;
@group(3) @binding(1) var<storage, read> billboards: array<BillboardRecord>;
@group(3) @binding(2) var<storage, read> billboard_tiles: array<BillboardTile>;
@group(3) @binding(3) var base_colour: texture_2d<f32>;
@group(3) @binding(4) var base_sampler: sampler;
@group(3) @binding(5) var clumps: texture_2d_array<f32>;
@group(3) @binding(6) var clump_sampler: sampler;

struct BillboardPoint {
    @builtin(position) clip: vec4f,
    @location(0) radiance: vec3f,
    @location(1) uv: vec2f,
    @location(2) @interpolate(flat) layer: u32,
    @location(3) @interpolate(flat) opacity: f32,
}

// Bend of the upper edge along x and z.
fn billboard_bend(anchor: vec2u, billboard: Billboard) -> vec2f {
    var tile: TileRecord;
    tile.anchor = anchor;
    var plant: Plant;
    plant.root = billboard.root;
    plant.flexibility = billboard.flexibility;
    plant.flutter_turns = billboard.flutter_turns;
    return wind_bend(tile, plant);
}

// Unit vector from the lower edge to the upper one, in the wind.
fn billboard_lean(billboard: Billboard, bend: vec2f) -> vec3f {
    return unit_or(billboard.up + vec3f(bend.x, 0.0, bend.y) * WIND_SHARE, billboard.up);
}

// Colour of the ground under a clump, varied by patch and by clump as that of blades is.
fn clump_rgb(tile: BillboardTile, billboard: Billboard, lot: f32) -> vec3f {
    let place = vec2f(tile.anchor * ANCHOR_CELLS) * field.cell_m + billboard.root.xz;
    let uv = place / billboard_look.map_m;
    let ground = textureSampleLevel(base_colour, base_sampler, uv, 0.0).rgb;
    let patches = value_noise(place * 0.9 + 3.0);
    let rgb = ground * billboard_look.tints[billboard.kind].rgb * (0.84 + 0.24 * lot + 0.22 * patches);
    let grey = dot(rgb, vec3f(0.3, 0.6, 0.1));
    return mix(rgb, grey * vec3f(1.55, 1.2, 0.5), 0.2 * patches + 0.15 * fract(lot * 7.0));
}

// Share of a billboard that is drawn: by its distance, and by how far it turns its edge to the eye.
fn clump_opacity(distance: f32, facing: f32, lot: f32) -> f32 {
    let reach = billboard_look.reach_m;
    let kept = 1.0 - smoothstep(0.6 * reach, reach, distance);
    return smoothstep(0.8 * lot, 0.8 * lot + 0.2, kept) * smoothstep(0.04, 0.22, facing);
}

@vertex
fn billboard_vertex(
    @builtin(vertex_index) corner: u32,
    @builtin(instance_index) instance: u32,
) -> BillboardPoint {
    let billboard = open_billboard(billboards[instance]);
    let tile = billboard_tiles[billboard.tile];
    let lean = billboard_lean(billboard, billboard_bend(tile.anchor, billboard));
    let across = vec3f(billboard.across.x, 0.0, billboard.across.y);
    let right = select(0.0, 1.0, corner == 1u || corner == 4u || corner == 5u);
    let up = select(0.0, 1.0, corner == 2u || corner == 3u || corner == 5u);
    let root = tile.anchor_from_eye + billboard.root;
    let position = root + across * ((right - 0.5) * billboard.width_m)
        + lean * (up * billboard.height_m);

    // A number of the billboard's own, free of its phase's first digits.
    let lot = fract(billboard.flutter_turns * 61.0);
    let middle = root + lean * (0.5 * billboard.height_m);
    let distance = max(length(middle), 1e-6);
    let level = unit_or(cross(across, lean), UP);
    let facing = abs(dot(level, middle)) / distance;
    let opacity = clump_opacity(distance, facing, lot);

    let towards = select(level, -level, dot(level, middle) > 0.0);
    let fan = across * ((right - 0.5) * 1.1);
    let normal = normalize(towards * 0.55 + fan + UP * (0.5 + 0.5 * up));
    let light = light_between(billboard_look.cover, 1.0 - up, position);
    let rgb = clump_rgb(tile, billboard, lot) * mix(0.85, 1.2, up);
    let radiance = leaf_radiance(rgb, normal, light, position);

    // Every other one shows its picture mirrored. Row 0 of a picture is its top.
    let is_mirrored = fract(billboard.flutter_turns * 17.0) < 0.5;
    let uv = vec2f(select(right, 1.0 - right, is_mirrored), 1.0 - up);
    let clip = frame.clip_from_eye * vec4f(position, 1.0);
    return BillboardPoint(
        select(clip, vec4f(0.0, 0.0, -1.0, 1.0), opacity <= 0.0),
        through_air(radiance, position),
        uv,
        billboard.texture,
        opacity,
    );
}

@fragment
fn billboard_fragment(in: BillboardPoint) -> @location(0) vec4f {
    let texel = textureSample(clumps, clump_sampler, in.uv, in.layer);
    let size = vec2f(textureDimensions(clumps));
    let texels_per_px = max(length(dpdx(in.uv) * size), length(dpdy(in.uv) * size));
    // Where a texel is wider than a pixel, edges are drawn as sharp as a pixel.
    let sharp = saturate((texel.a - 0.5) / max(fwidth(texel.a), 0.1) + 0.5);
    let cover = mix(sharp, texel.a, smoothstep(0.4, 1.0, texels_per_px)) * in.opacity;
    if billboard_look.samples == 1u && cover <= lattice(vec2i(in.clip.xy)) {
        discard;
    }
    return vec4f(in.radiance * texel.rgb * CLUMP_TINT_MOST, cover);
}
