//! What a scene may ask for. Every limit is checked before anything is allocated, and every error
//! that comes from one prints it.

use std::fmt::{self, Display};

/// Smallest and largest allowed value, both included, with the unit they are in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    pub min: f64,
    pub max: f64,
    /// Empty for a plain number.
    pub unit: &'static str,
}

const fn range(min: f64, max: f64, unit: &'static str) -> Range {
    Range { min, max, unit }
}

impl Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let gap = if self.unit.is_empty() { "" } else { " " };
        write!(f, "{} to {}{gap}{}", self.min, self.max, self.unit)
    }
}

/// Length of a run: two days hold the 24 hours of the endurance test and the recovery after it.
pub const DURATION: Range = range(0.001, 2.0 * 86_400.0, "s");
/// Any extent of a body or a part of one. Below a millimetre a body is thinner than the skin the
/// grass keeps from it.
pub const BODY_LENGTH: Range = range(0.001, 100.0, "m");
/// A point of a convex hull, or a part of a compound, from the body's origin, along one axis.
pub const BODY_OFFSET: Range = range(-100.0, 100.0, "m");
/// A place in the world, along one axis. The grass is exact in its cells up to here.
pub const PLACE: Range = range(-500_000.0, 500_000.0, "m");
pub const ANGLE: Range = range(-36_000.0, 36_000.0, "degrees");
/// Along one axis.
pub const VELOCITY: Range = range(-1000.0, 1000.0, "m/s");
/// About one axis.
pub const SPIN: Range = range(-1_000_000.0, 1_000_000.0, "degrees/s");
/// Along one axis.
pub const IMPULSE: Range = range(-1e9, 1e9, "kg m/s");
pub const KILOGRAMS: Range = range(1e-6, 1e7, "kg");
pub const MASS_DENSITY: Range = range(0.01, 50_000.0, "kg/m3");
pub const FRICTION: Range = range(0.0, 10.0, "");
/// A part of a whole: restitution, a component of a colour, a share of plants.
pub const FRACTION: Range = range(0.0, 1.0, "");
pub const DAMPING: Range = range(0.0, 100.0, "per second");
pub const MESH_SCALE: Range = range(1e-6, 1e6, "");
pub const ENGINE_FORCE: Range = range(-1e6, 1e6, "N");
pub const BRAKE_FORCE: Range = range(0.0, 1e6, "N");
pub const STEER: Range = range(-80.0, 80.0, "degrees");
pub const FIELD_OF_VIEW: Range = range(1.0, 170.0, "degrees");
pub const MEASURED_RADIUS: Range = range(0.001, 1000.0, "m");
pub const MEASURED_OFFSET: Range = range(0.0, 1000.0, "m");
pub const LEAN: Range = range(0.0, 180.0, "degrees");

/// Extent of flat or rolling ground along one side.
pub const TERRAIN_SIDE: Range = range(0.1, 262_144.0, "m");
pub const HEIGHT_SPACING: Range = range(0.01, 1000.0, "m");
pub const HEIGHT: Range = range(0.001, 20_000.0, "m");
pub const AMPLITUDE: Range = range(0.0, 10_000.0, "m");
pub const WAVELENGTH: Range = range(0.1, 1e6, "m");
pub const OCTAVES: Range = range(1.0, 12.0, "");
/// Height samples: 64 MiB of them as 32-bit floats.
pub const HEIGHT_SAMPLES: u64 = 1 << 24;
/// Samples along one side of a height map.
pub const HEIGHT_MAP_SIDE: u32 = 16_384;
/// Tiles of a field.
pub const TILES: u64 = 1 << 24;
/// Seeding triangles: their ids are 32-bit words.
pub const SEEDING_TRIANGLES: u64 = 1 << 32;
/// Plants of one tile. Those of a field have no limit of their own: at rest none of them is stored, and each
/// is known by its triangle and its number there.
pub const PLANTS_PER_TILE: u64 = 65_536;

pub const PLANT_DENSITY: Range = range(0.0, 10_000.0, "plants/m2");
pub const SPECIES: usize = 8;
/// Plants of a coat per square metre of a body's surface.
pub const COAT_DENSITY: Range = range(0.0, 100_000.0, "plants/m2");
/// Plants of all coats of a scene: a frame's list of them is then at most 64 MiB.
pub const COAT_PLANTS: u64 = 1 << 20;
/// Triangles under all coats of a scene.
pub const COAT_TRIANGLES: u64 = 1 << 20;
pub const BILLBOARD_DENSITY: Range = range(0.0, 1000.0, "billboards/m2");
/// Billboards of a field: the list of them is then at most 128 MiB on a device.
pub const BILLBOARDS: u64 = 1 << 22;
/// Billboards of one tile.
pub const BILLBOARDS_PER_TILE: u64 = 4096;
/// Nodes along one side of a touched billboard.
pub const BILLBOARD_NODES: Range = range(3.0, 9.0, "nodes");
/// Drawn segments per segment between nodes.
pub const DRAW_SUBDIVISION: Range = range(0.0, 8.0, "segments");
/// Kinds of clumps.
pub const CLUMPS: usize = 8;
/// Height or width of a clump.
pub const CLUMP_SIZE: Range = range(0.01, 10.0, "m");
/// Texels along one side of a map of billboards.
pub const COVER_MAP_SIDE: u32 = 4096;
/// Texels of a map of billboards: all three together are then 128 MiB.
pub const COVER_MAP_TEXELS: u64 = 1 << 24;
/// Shortest vector of a direction map, of 1 for a unit vector.
pub const LEAST_DIRECTION: f64 = 0.1;
/// Seeds of a cluster.
pub const CLUSTER: Range = range(1.0, 16.0, "seeds");
/// Grounds on which nothing grows.
pub const BARE_GROUNDS: usize = 4;
/// Hue of a reference colour.
pub const HUE: Range = range(0.0, 360.0, "degrees");
/// Of one difference of colours. Weighted distances are exact to 1/4096 up to here.
pub const COLOUR_WEIGHT: Range = range(0.0, 8.0, "");
/// Weighted distances of colours up to here are all the same: two steps of a byte.
pub const LEAST_DISTANCE: f32 = 1.0 / 128.0;
pub const SCORE_EXPONENT: Range = range(0.25, 16.0, "");
pub const SCORE_THRESHOLD: Range = range(0.0, 1e30, "");
pub const PETALS: Range = range(3.0, 64.0, "");
/// Texels along one side of a base map.
pub const BASE_MAP_SIDE: u32 = 8192;
/// Texels of a base map: 64 MiB of them.
pub const BASE_MAP_TEXELS: u64 = 1 << 24;
pub const SHARE: Range = range(0.0, 1e6, "");
pub const PLANT_HEIGHT: Range = range(0.001, 10.0, "m");
pub const PLANT_WIDTH: Range = range(0.0001, 1.0, "m");
/// k′, the range over which the blade-shape solver is tested.
pub const STIFFNESS: Range = range(1e-6, 1e6, "");
pub const ROOT_LEAN: Range = range(0.0, 90.0, "degrees");
/// Of the directions that phototropic plants lean to, on either side of the light.
pub const AZIMUTH_SPREAD: Range = range(0.0, 180.0, "degrees");
pub const FLEXIBILITY: Range = range(0.0, 10.0, "");
pub const TINT: Range = range(0.0, 10.0, "");
pub const WIND_BEND: Range = range(0.0, 10.0, "");
pub const GUST_LENGTH: Range = range(0.1, 10_000.0, "m");
pub const GUST_SPEED: Range = range(0.0, 200.0, "m/s");

/// Distance of the columns of light volumes.
pub const LIGHT_CELL: Range = range(0.05, 1000.0, "m");
pub const LIGHT_HEIGHT: Range = range(0.1, 1000.0, "m");
/// The textures have four layers for each; a device may allow fewer than that makes.
pub const LIGHT_SLICES: Range = range(2.0, 512.0, "slices");
pub const LIGHT_RAYS: Range = range(16.0, 4096.0, "rays");
/// Columns of light volumes along one side.
pub const LIGHT_COLUMNS: u64 = 2048;
/// Cells of light volumes: the textures of them are then 25 MiB.
pub const LIGHT_CELLS: u64 = 1 << 20;
/// Rays of all cells of light volumes: a bit is kept of each, 64 MiB of them.
pub const LIGHT_ALL_RAYS: u64 = 1 << 29;

pub const SUBSTEP: Range = range(1e-4, 1.0 / 15.0, "s");
pub const RECOVERY: Range = range(0.01, 60.0, "s");
pub const SEGMENTS: Range = range(1.0, 16.0, "");
pub const CUBE_RESOLUTION: Range = range(8.0, 256.0, "texels");
pub const SKIN: Range = range(0.0, 0.05, "m");
pub const SPRING_RATE: Range = range(0.0, 10_000.0, "per second");
pub const ROUNDS: Range = range(1.0, 32.0, "");
pub const STRAIN_LIMIT: Range = range(1e-4, 1.0, "");
pub const GRASS_STEPS: Range = range(1.0, 1024.0, "");
pub const SWEEP_SHARE: Range = range(0.001, 1e6, "");
pub const SWEEPS: Range = range(1.0, 1024.0, "");
pub const TILE_SIDE: Range = range(0.05, 64.0, "m");
/// Entries along one axis of the blade table. 512 × 512 of 16 segments are 32 MiB, and are solved in
/// some seconds.
pub const BLADE_TABLE: Range = range(2.0, 512.0, "entries");
pub const SEEDING_CELL: Range = range(0.05, 16.0, "m");

/// Bodies present from the start and spawned by the script, together.
pub const BODIES: usize = 4096;
/// Characters of a name.
pub const NAME_CHARACTERS: usize = 64;
pub const EVENTS: usize = 100_000;
pub const WAYPOINTS: usize = 10_000;
pub const CAMERAS: usize = 256;
pub const EXPECTATIONS: usize = 1024;
/// Fewest and most points of a convex hull.
pub const HULL_POINTS: [usize; 2] = [4, 256];
/// Pieces of a compound.
pub const COMPOUND_PARTS: usize = 32;
/// Convex parts of a mesh.
pub const MESH_PARTS: Range = range(1.0, 64.0, "");

/// Bytes of a scene file.
pub const SCENE_BYTES: u64 = 1 << 20;
/// Bytes of one asset file, and of the buffers one glTF file names.
pub const ASSET_BYTES: u64 = 64 << 20;
/// Different asset files of a scene.
pub const ASSET_FILES: usize = 64;
pub const MESH_TRIANGLES: u64 = 200_000;
pub const MESH_VERTICES: u64 = 3 * MESH_TRIANGLES;
/// JSON objects of a glTF file: each becomes a structure of up to a kilobyte.
pub const GLTF_OBJECTS: u64 = 65_536;
/// Depth of a glTF file's tree of nodes.
pub const GLTF_DEPTH: usize = 64;
/// How deep brackets may nest in a scene file.
pub const SCENE_DEPTH: usize = 48;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_prints_its_unit() {
        assert_eq!(RECOVERY.to_string(), "0.01 to 60 s");
        assert_eq!(FRACTION.to_string(), "0 to 1");
    }
}
