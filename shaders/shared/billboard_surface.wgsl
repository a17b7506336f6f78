// What is drawn of a billboard: a point of its quad in the wind, or of the smooth surface through the
// nodes of its refined form. Host and twin of the surface: src/render/billboard_surface.rs.
#import "shared/billboard_quad.wgsl"

// Weights of up to four nodes along a row or a column, from node `first` on, for one drawn vertex: of its
// place, and of its change per segment between nodes.
struct SurfaceTap {
    place: vec4f,
    slope: vec4f,
    first: u32,
    spare_a: u32,
    spare_b: vec2u,
}

// Nodes of refined billboards in their anchors: a row per node, the lowest row of a billboard first, from
// left to right; w is 0 in all rows of one that stands in the wind as if nothing had touched it.
@group(3) @binding(7) var<storage, read> billboard_nodes: array<vec4f>;
// Those of the drawn columns, then those of the drawn rows.
@group(3) @binding(8) var<storage, read> surface_taps: array<SurfaceTap>;

// In the anchor's coordinates.
struct SurfacePoint {
    place: vec3f,
    // How far it is from where the wind alone would have it, 0 to 1.
    pressed: f32,
    // Unit vectors along the surface, to the right and up, and across it.
    along: vec3f,
    normal: vec3f,
    // A place in the plane through the point; the same for all points of a quad.
    in_plane: vec3f,
    is_quad: bool,
    // Lower left and right, upper left and right.
    corners: array<vec3f, 4>,
}

// The point of a quad at shares of its width and height.
fn quad_point(quad: WindQuad, at: vec2f) -> SurfacePoint {
    let corners = array<vec3f, 4>(
        quad_place(quad, vec2f(0.0, 0.0)),
        quad_place(quad, vec2f(1.0, 0.0)),
        quad_place(quad, vec2f(0.0, 1.0)),
        quad_place(quad, vec2f(1.0, 1.0)),
    );
    let normal = unit_or(cross(quad.across, quad.lean), UP);
    return SurfacePoint(quad_place(quad, at), 0.0, quad.across, normal, corners[0], true, corners);
}

// The point of the refined form whose nodes begin at row `first`, at a drawn column and row.
fn refined_point(
    quad: WindQuad,
    first: u32,
    nodes: vec2u,
    columns: SurfaceTap,
    rows: SurfaceTap,
    at: vec2f,
) -> SurfacePoint {
    var place = vec3f(0.0);
    var right = vec3f(0.0);
    var up = vec3f(0.0);
    for (var r = 0u; r < min(nodes.y, 4u); r++) {
        let row = first + (rows.first + r) * nodes.x + columns.first;
        var row_place = vec3f(0.0);
        var row_slope = vec3f(0.0);
        for (var c = 0u; c < min(nodes.x, 4u); c++) {
            let node = billboard_nodes[row + c].xyz;
            row_place += columns.place[c] * node;
            row_slope += columns.slope[c] * node;
        }
        place += rows.place[r] * row_place;
        right += rows.place[r] * row_slope;
        up += rows.slope[r] * row_place;
    }
    let last = first + (nodes.y - 1u) * nodes.x;
    let corners = array<vec3f, 4>(
        billboard_nodes[first].xyz,
        billboard_nodes[first + nodes.x - 1u].xyz,
        billboard_nodes[last].xyz,
        billboard_nodes[last + nodes.x - 1u].xyz,
    );
    let moved = distance(place, quad_place(quad, at)) / max(quad.height_m, 1e-6);
    let flat = unit_or(cross(quad.across, quad.lean), UP);
    return SurfacePoint(
        place,
        smoothstep(0.04, 0.35, moved),
        unit_or(right, quad.across),
        unit_or(cross(right, up), flat),
        place,
        false,
        corners,
    );
}
