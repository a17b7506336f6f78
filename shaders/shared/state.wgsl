// Where a plant's state lies. Twin: src/sim/slab.rs.
//
// A slab holds, per plant, a row with the tick of the last contact (0: never) in x, and a row per
// segment: offset of its upper node from the wind pose as three floats' bits, and the word about
// the face that node was pushed out through.
#import "shared/field.wgsl"

// First row of a plant.
fn plant_row(slab: u32, place: u32) -> u32 {
    return (slab * field.plants_per_tile + place) * (field.segments + 1u);
}
