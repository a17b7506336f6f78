// Arguments of an indirect draw, and where its instances begin in the list that they are taken from.
// Hosts: src/render/sort_plants.rs, src/render/plants.rs.

struct DrawArgs {
    vertices: u32,
    instances: u32,
    first_vertex: u32,
    first_instance: u32,
    start: u32,
}
