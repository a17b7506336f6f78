// Boxes around tiles, as edges of even width and faintly filled sides. Host: src/render/overlay.rs.
#import "shared/frame.wgsl"

struct OverlayBox {
    low_from_eye: vec3f,
    edge_px: f32,
    high_from_eye: vec3f,
    fill: f32, // opacity of the sides
    rgb: vec3f,
    pad: f32,
}

@group(3) @binding(0) var<storage, read> boxes: array<OverlayBox>;

struct OverlayPoint {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) rgba: vec4f,
}

fn box_corner(box: OverlayBox, corner: u32) -> vec3f {
    let high = vec3<bool>((corner & 1u) != 0u, (corner & 2u) != 0u, (corner & 4u) != 0u);
    return select(box.low_from_eye, box.high_from_eye, high);
}

// Edge 0..11 runs along axis edge / 4; its other two coordinates are the bits of edge % 4.
fn edge_corners(edge: u32) -> vec2u {
    let axis = edge / 4u;
    let a = edge & 1u;
    let b = (edge >> 1u) & 1u;
    var first = 0u;
    switch axis {
        case 0u: { first = (a << 1u) | (b << 2u); }
        case 1u: { first = a | (b << 2u); }
        default: { first = a | (b << 1u); }
    }
    return vec2u(first, first | (1u << axis));
}

@vertex
fn edge_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> OverlayPoint {
    let box = boxes[instance];
    let ends = edge_corners(vertex / 6u);
    let quad = vertex % 6u;
    let at_end = quad == 2u || quad == 3u || quad == 5u;
    let side = select(-1.0, 1.0, quad == 1u || quad == 4u || quad == 5u);
    let start = box_corner(box, ends.x);
    let end = box_corner(box, ends.y);
    let middle = select(start, end, at_end);
    // Widened across the view; never thinner than 4 mm, so that near boxes look solid.
    let width_m = max(0.002, 0.5 * box.edge_px * length(middle) * frame.pixel_rad);
    let across = cross(end - start, middle);
    let position = middle + across * (side * width_m / max(length(across), 1e-9));
    return OverlayPoint(frame.clip_from_eye * vec4f(position, 1.0), vec4f(box.rgb, 0.9));
}

// The four upright sides and the top.
@vertex
fn side_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> OverlayPoint {
    let box = boxes[instance];
    let quad = vertex % 6u;
    let u = select(0u, 1u, quad == 2u || quad == 3u || quad == 5u);
    let v = select(0u, 1u, quad == 1u || quad == 4u || quad == 5u);
    var corner = 0u;
    switch vertex / 6u {
        case 0u: { corner = u | (v << 1u); }
        case 1u: { corner = u | (v << 1u) | 4u; }
        case 2u: { corner = (u << 2u) | (v << 1u); }
        case 3u: { corner = 1u | (u << 2u) | (v << 1u); }
        default: { corner = u | 2u | (v << 2u); }
    }
    let position = box_corner(box, corner);
    return OverlayPoint(frame.clip_from_eye * vec4f(position, 1.0), vec4f(box.rgb, box.fill));
}

@fragment
fn overlay_fragment(in: OverlayPoint) -> @location(0) vec4f {
    return in.rgba;
}
