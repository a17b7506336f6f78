// Billboards, O09 section 6: those that nothing touches as quads straight from their records (pass RU),
// those of tiles that are awake from the nodes of their refined forms (pass RA). Host:
// src/render/billboards.rs.
//
// Deviations from the paper: a clump takes its colour from the ground under it; light is computed per
// vertex, with normals that fan out, so that neighbours do not show as flat cards of different brightness;
// a quad seen from its edge fades; so does one far away, billboard by billboard. A vertex of a refined form
// is lit by mixing the light of the quad's corners, each turned as the surface is there: a form that is
// back in the wind has the quad's light, and the change between the two shows nothing.
#import "shared/billboard_surface.wgsl"
#import "shared/noise.wgsl"
#import "shared/plant_light.wgsl"

struct BillboardLook {
    map_m: vec2f, // extent of the base-colour map
    cover: f32, // share of the sky that billboards hide at the ground
    reach_m: f32,
    samples: u32, // per pixel; 1 means that coverage is drawn by lot
    spare: u32,
    nodes: vec2u, // columns and rows of a refined form
    steps: vec2u, // segments across and up that are drawn of one
    spare_b: vec2u,
    tints: array<vec4f, MAX_CLUMPS>,
}

// A tile in view.
struct BillboardTile {
    anchor_from_eye: vec3f,
    first: u32, // its first billboard
    anchor: vec2u,
    nodes_at: u32, // where the nodes of its billboards begin, in rows
    spare: u32,
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
    @location(3) opacity: f32,
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

// Share of a billboard that is drawn at a distance.
fn kept_share(distance: f32, lot: f32) -> f32 {
    let reach = billboard_look.reach_m;
    let kept = 1.0 - smoothstep(0.6 * reach, reach, distance);
    return smoothstep(0.8 * lot, 0.8 * lot + 0.2, kept);
}

// How much of each corner's light a point of the quad gets, drawn as two triangles.
fn corner_shares(at: vec2f) -> vec4f {
    if at.x + at.y <= 1.0 {
        return vec4f(1.0 - at.x - at.y, at.x, at.y, 0.0);
    }
    return vec4f(0.0, 1.0 - at.y, 1.0 - at.x, at.x + at.y - 1.0);
}

// What the parts of a billboard have in common.
struct Shaded {
    billboard: Billboard,
    anchor_from_eye: vec3f,
    rgb: vec3f,
}

// Light of a quad's corner, turned as the surface is at a point.
fn corner_radiance(shaded: Shaded, point: SurfacePoint, corner: u32) -> vec3f {
    let right = f32(corner & 1u);
    let up = f32(corner >> 1u);
    let from_eye = shaded.anchor_from_eye + point.place;
    let towards = select(point.normal, -point.normal, dot(point.normal, from_eye) > 0.0);
    let fan = point.along * ((right - 0.5) * 1.1);
    let normal = normalize(towards * 0.55 + fan + UP * (0.5 + 0.5 * up));
    // Where clumps are pressed their neighbours are too, and shade them less.
    let risen = saturate((point.place.y - shaded.billboard.root.y) / shaded.billboard.height_m);
    let open = max(mix(up, risen, point.pressed), 0.7 * point.pressed);
    var corners = point.corners;
    let position = shaded.anchor_from_eye + corners[corner];
    let light = light_between(billboard_look.cover, 1.0 - open, position);
    // A clump that is turned over shows undersides, which are paler and duller.
    let pale = mix(shaded.rgb, vec3f(dot(shaded.rgb, vec3f(0.3, 0.6, 0.1))), 0.2) * 1.25;
    let rgb = mix(shaded.rgb, pale, 0.6 * point.pressed) * mix(0.85, 1.2, up);
    return through_air(leaf_radiance(rgb, normal, light, position), position);
}

// Where a place in a tile's anchor is in the picture.
fn clip_of(tile: BillboardTile, place: vec3f) -> vec4f {
    return frame.clip_from_eye * vec4f(tile.anchor_from_eye + place, 1.0);
}

fn billboard_point(billboard: Billboard, point: SurfacePoint, at: vec2f) -> BillboardPoint {
    let tile = billboard_tiles[billboard.tile];
    // A number of the billboard's own, free of its phase's first digits.
    let lot = fract(billboard.flutter_turns * 61.0);
    let corners = point.corners;
    let middle = tile.anchor_from_eye
        + 0.25 * ((corners[0] + corners[1]) + (corners[2] + corners[3]));
    let distance = max(length(middle), 1e-6);
    let facing = abs(dot(point.normal, tile.anchor_from_eye + point.in_plane)) / distance;
    let kept = kept_share(distance, lot);
    // What is bent turns some part of itself to the eye.
    let opacity = kept * max(smoothstep(0.04, 0.22, facing), point.pressed);

    let shaded = Shaded(billboard, tile.anchor_from_eye, clump_rgb(tile, billboard, lot));
    var shares = corner_shares(at);
    var radiance = vec3f(0.0);
    for (var corner = 0u; corner < 4u; corner++) {
        if shares[corner] > 0.0 {
            radiance += shares[corner] * corner_radiance(shaded, point, corner);
        }
    }

    // Every other one shows its picture mirrored. Row 0 of a picture is its top.
    let is_mirrored = fract(billboard.flutter_turns * 17.0) < 0.5;
    let uv = vec2f(select(at.x, 1.0 - at.x, is_mirrored), 1.0 - at.y);
    let clip = clip_of(tile, point.place);
    return BillboardPoint(
        select(clip, vec4f(0.0, 0.0, -1.0, 1.0), kept <= 0.0 || (point.is_quad && opacity <= 0.0)),
        radiance,
        uv,
        billboard.texture,
        opacity,
    );
}

// RU: two triangles.
@vertex
fn quad_vertex(
    @builtin(vertex_index) corner: u32,
    @builtin(instance_index) instance: u32,
) -> BillboardPoint {
    let billboard = open_billboard(billboards[instance]);
    let quad = wind_quad(billboard_tiles[billboard.tile].anchor, billboard);
    let right = select(0.0, 1.0, corner == 1u || corner == 4u || corner == 5u);
    let up = select(0.0, 1.0, corner == 2u || corner == 3u || corner == 5u);
    let at = vec2f(right, up);
    return billboard_point(billboard, quad_point(quad, at), at);
}

// RA: a grid of vertices, row by row from the ground.
@vertex
fn refined_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> BillboardPoint {
    let billboard = open_billboard(billboards[instance]);
    let tile = billboard_tiles[billboard.tile];
    let quad = wind_quad(tile.anchor, billboard);
    let steps = billboard_look.steps;
    let step = vec2u(vertex % (steps.x + 1u), vertex / (steps.x + 1u));
    let at = vec2f(step) / vec2f(steps);
    let nodes = billboard_look.nodes;
    let first = tile.nodes_at + (instance - tile.first) * nodes.x * nodes.y;
    if billboard_nodes[first].w == 0.0 {
        // The grid's first cell is the whole quad, in the same two triangles; the others have no area.
        let corner = vec2f(min(step, vec2u(1u)));
        if any(step > vec2u(1u)) {
            var point: BillboardPoint;
            point.clip = clip_of(tile, quad_place(quad, corner));
            return point;
        }
        return billboard_point(billboard, quad_point(quad, corner), corner);
    }
    let columns = surface_taps[step.x];
    let rows = surface_taps[steps.x + 1u + step.y];
    let point = refined_point(quad, first, nodes, columns, rows, at);
    return billboard_point(billboard, point, at);
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
