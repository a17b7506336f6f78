//! Scenes and assets that are wrong: each is refused with a sentence that names file, line,
//! column, key and what would be right, and none makes the program panic or take much memory.

#![allow(clippy::expect_used, reason = "a test says what it expects by failing")]

#[path = "bad_scenes/assets.rs"]
mod assets;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use proptest::prelude::*;
use sward::scene::assets::{Embedded, read_height_map, read_mesh};
use sward::scene::{parse_scene, parse_scene_with, to_ron};

/// What is wrong with the answer to a wrong scene, if anything: its error must stand at `place`,
/// name `key`, say every one of `words`, and be one line.
fn flaw(source: &str, place: &str, key: &str, words: &[&str]) -> Option<String> {
    let text = match parse_scene("bad", source, &[]) {
        Ok(_) => "no error".to_owned(),
        Err(error) => error.to_string(),
    };
    let head = format!("bad:{place}: {key}: ");
    let says_all = words.iter().all(|word| text.contains(word));
    let right = text.starts_with(&head) && says_all && !text.contains('\n');
    (!right).then(|| format!("{source}\n  wanted {head}… {words:?}\n  got    {text}"))
}

/// A table of `scene => place key: words;`.
macro_rules! check {
    ($($source:expr => $place:literal $key:literal: $($word:literal),+;)+) => {
        let flaws: Vec<String> =
            [$(flaw($source, $place, $key, &[$($word),+])),+].into_iter().flatten().collect();
        assert!(flaws.is_empty(), "\n{}", flaws.join("\n"));
    };
}

/// A scene with one body that has these keys, on the second line.
macro_rules! body {
    ($keys:literal) => {
        concat!("(bodies: [\n(name: \"a\", ", $keys, ")])")
    };
}

#[test]
fn text_that_is_no_scene() {
    check! {
        "" => "1:1" "scene": "round brackets";
        "(duration: 3)" => "1:2" "duration": "no known key", "did you mean duration_s?", "terrain";
        "(\n grass: (\n  colour: 3))" => "3:3" "grass.colour": "no known key", "density_per_m2";
        body!("shape: Ball(radius: 3)") => "2:25" "bodies[0].shape.radius": "did you mean radius_m?";
        "(bodies: [\n (name: \"a\")])" => "2:2" "bodies[0].shape": "is missing";
        "(bodies: [(shape: Ball(radius_m: 1))])" => "1:11" "bodies[0].name": "is missing";
        "(bodies: [(shape: Ball(radius_m: 1), damping: (0, 0))])" => "1:11" "bodies[0].name": "is missing";
        body!("shape: Capsule(radius_m: 1)") => "2:20" "bodies[0].shape.length_m": "is missing";
        body!("shape: Ball()") => "2:20" "bodies[0].shape.radius_m": "is missing";
        body!("name: \"b\"") => "2:13" "bodies[0].name": "twice";
        body!("shape: Bal(radius_m: 1)") => "2:20" "bodies[0].shape": "did you mean Ball?", "Vehicle";
        "(solver: (root: triple))" => "1:17" "solver.root": "`triple`", "double, paper";
        "(duration_s: 3" => "1:15" "duration_s": "closing bracket";
        "(duration_s: 3) more" => "1:16" "scene": "more text", "one scene";
        "(duration_s 3)" => "1:13" "duration_s": "no colon";
        "(duration_s: 3 wind: ())" => "1:16" "wind": "a comma";
        "(description: \"never closed)" => "1:15" "description": "no closing double quote";
        "(duration_s: 3 /* open )" => "1:25" "scene": "closing `*/`";
        "Scenery()" => "1:1" "scene": "Scene( … )";
    }
}

#[test]
fn values_of_the_wrong_type() {
    check! {
        "(description: true)" => "1:15" "description": "is true", "double quotes";
        "(duration_s: \"long\")" => "1:14" "duration_s": "\"long\"", "a number";
        body!("shape: Ball(radius_m: \"x\")") => "2:35" "bodies[0].shape.radius_m": "\"x\"";
        body!("shape: Box(size_m: [1, 2, 3])") => "2:32" "bodies[0].shape.size_m": "(x, y, z)";
        body!("shape: Box(size_m: (1, 2))") => "2:32" "bodies[0].shape.size_m": "holds 2", "write 3";
        body!("shape: Box(size_m: (1, 2, 3, 4))") => "2:42" "bodies[0].shape.size_m": "more values";
        body!("shape: Ball(radius_m: 1), above_ground: 1") => "2:53" "bodies[0].above_ground": "true or false";
        "(bodies: (name: \"a\"))" => "1:10" "bodies": "square brackets";
        "(billboards: (messiness: 0.5))" => "1:26" "billboards.messiness": "is 0.5", "name of a choice";
        "(solver: (segments: 4.5))" => "1:21" "solver.segments": "4.5", "whole number";
        "(solver: (segments: -1))" => "1:21" "solver.segments": "-1", "whole number";
        "(solver: (segments: 5000000000))" => "1:21" "solver.segments": "5000000000";
        "(expect: [AllRest])" => "1:11" "expect[0]": "round brackets";
    }
}

#[test]
fn numbers_out_of_range() {
    check! {
        "(duration_s: NaN)" => "1:14" "duration_s": "NaN", "0.001 to 172800 s";
        "(duration_s: inf)" => "1:14" "duration_s": "infinite";
        "(duration_s: 0)" => "1:14" "duration_s": "is 0";
        "(duration_s: 200000)" => "1:14" "duration_s": "200000", "172800";
        "(wind: (strength: 1e39))" => "1:19" "wind.strength": "3.4e38", "0 to 10";
        "(solver: (substep_s: 0.1))" => "1:22" "solver.substep_s": "0.0001 to 0.0666";
        "(solver: (recovery_s: 0))" => "1:23" "solver.recovery_s": "0.01 to 60 s";
        "(solver: (segments: 17))" => "1:21" "solver.segments": "1 to 16";
        "(solver: (cube_resolution: 4))" => "1:28" "solver.cube_resolution": "8 to 256 texels";
        "(solver: (rounds: (6, 2)))" => "1:19" "solver.rounds": "(6, 2)", "smaller value first";
        "(solver: (blade_table: (128, 1)))" => "1:30" "solver.blade_table[1]": "2 to 512 entries";
        "(solver: (max_sweeps: 0))" => "1:23" "solver.max_sweeps": "1 to 1024";
        "(grass: (density_per_m2: -1))" => "1:26" "grass.density_per_m2": "is -1", "0 to 10000";
        "(grass: (species: [(height_m: (0.4, 0.2))]))" => "1:31" "grass.species[0].height_m": "(0.4, 0.2)";
        "(grass: (species: [(share: 0)]))" => "1:19" "grass.species": "positive share";
        "(grass: (species: [(name: \"\")]))" => "1:27" "grass.species[0].name": "1 to 64";
        "(grass: (species: [(form: Gravel)]))" => "1:20" "grass.species[0].response": "is Bends", "where none is given", "write Shoved", "Stays";
        "(grass: (species: [(form: Gravel, response: Bends)]))" => "1:45" "grass.species[0].response": "is Bends", "write Shoved", "Stays";
        "(grass: (species: [(form: Twig, response: Shoved)]))" => "1:43" "grass.species[0].response": "is Shoved", "only the form Gravel", "write Bends", "Stays";
        "(grass: (species: [(likes: (hsv: (361, 0, 0)))]))" => "1:35" "grass.species[0].likes.hsv[0]": "is 361", "0 to 360 degrees";
        "(grass: (species: [(likes: (hsv: (60, 1.5, 0)))]))" => "1:39" "grass.species[0].likes.hsv[1]": "is 1.5", "0 to 1";
        "(grass: (species: [(likes: (weights: (0, 0, 0)))]))" => "1:38" "grass.species[0].likes.weights": "no colour differs", "1/64 for the hue";
        "(grass: (species: [(likes: (weights: (0.0156, 0, 0)))]))" => "1:38" "grass.species[0].likes.weights": "no colour differs";
        "(grass: (species: [(likes: (weights: (0, 0.0078, 0.005)))]))" => "1:38" "grass.species[0].likes.weights": "1/128";
        "(grass: (species: [(likes: (weights: (9, 0, 0)))]))" => "1:39" "grass.species[0].likes.weights[0]": "0 to 8";
        "(grass: (species: [(likes: (exponent: 0))]))" => "1:39" "grass.species[0].likes.exponent": "0.25 to 16";
        "(grass: (species: [(likes: (dwindle: 2))]))" => "1:38" "grass.species[0].likes.dwindle": "0 to 1";
        "(grass: (species: [(likes: ()), (name: \"b\")]))" => "1:33" "grass.species[1].likes": "to all or to none";
        "(grass: (species: [(likes: (), share: 0), (likes: ())]))" => "1:39" "grass.species[0].share": "never chosen";
        "(grass: (cluster: 0))" => "1:19" "grass.cluster": "1 to 16 seeds";
        "(grass: (bare: [()]))" => "1:16" "grass.bare": "no species has `likes`";
        "(grass: (species: [(likes: ())], bare: [(), (), (), (), ()]))" => "1:40" "grass.bare": "at most 4";
        "(grass: (species: [(form: Flower(head_m: 0, petal_rgb: (1, 1, 1), centre_rgb: (1, 1, 0)))]))" => "1:42" "grass.species[0].form.head_m": "0.0001 to 1 m";
        "(grass: (species: [(form: Flower(head_m: 0.1, petals: 2, petal_rgb: (1, 1, 1), centre_rgb: (1, 1, 0)))]))" => "1:55" "grass.species[0].form.petals": "3 to 64";
        body!("shape: Ball(radius_m: 1), coat: (form: Twig)") => "2:52" "bodies[0].coat.form": "`Twig`", "Leaf, Blade";
        body!("shape: Ball(radius_m: 1), coat: (per_m2: -1)") => "2:54" "bodies[0].coat.per_m2": "is -1", "0 to 100000 plants/m2";
        body!("shape: Ball(radius_m: 1), coat: (height_m: (0.2, 0.1))") => "2:56" "bodies[0].coat.height_m": "smaller value first";
        body!("shape: Ball(radius_m: 1), coat: (width_m: (0, 0.1))") => "2:56" "bodies[0].coat.width_m[0]": "0.0001 to 1 m";
        body!("shape: Ball(radius_m: 1), coat: (rgb: (0, 0, 2))") => "2:58" "bodies[0].coat.rgb[2]": "is 2";
        body!("shape: Ball(radius_m: 1), coat: (lean_deg: (0, 91))") => "2:60" "bodies[0].coat.lean_deg[1]": "0 to 90 degrees";
        body!("shape: Ball(radius_m: 1), coat: (lean: 3)") => "2:46" "bodies[0].coat.lean": "no known key", "lean_deg";
        "(billboards: (density_per_m2: -1))" => "1:31" "billboards.density_per_m2": "is -1", "0 to 1000 billboards/m2";
        "(billboards: (nodes: (2, 4)))" => "1:23" "billboards.nodes[0]": "is 2", "3 to 9 nodes";
        "(billboards: (nodes: (4, 10)))" => "1:26" "billboards.nodes[1]": "is 10";
        "(billboards: (draw_subdivision: 9))" => "1:33" "billboards.draw_subdivision": "is 9", "0 to 8";
        "(billboards: (clumps: []))" => "1:23" "billboards.clumps": "no share above 0";
        "(billboards: (clumps: [(share: 0)]))" => "1:23" "billboards.clumps": "no share above 0";
        "(billboards: (clumps: [(), (), (), (), (), (), (), (), ()]))" => "1:23" "billboards.clumps": "9 kinds of clumps", "at most 8";
        "(billboards: (clumps: [(height_m: (1, 11))]))" => "1:39" "billboards.clumps[0].height_m[1]": "0.01 to 10 m";
        "(billboards: (clumps: [(width_m: (2, 1))]))" => "1:34" "billboards.clumps[0].width_m": "smaller value first";
        "(billboards: (clumps: [(look: Palm)]))" => "1:31" "billboards.clumps[0].look": "`Palm`", "Flowering";
        "(billboards: (clumps: [(season: Monsoon)]))" => "1:33" "billboards.clumps[0].season": "`Monsoon`", "Winter";
        "(billboards: (messiness: Even(1.5)))" => "1:26" "billboards.messiness": "is 1.5", "0 to 1";
        "(light: (cell_m: 0.04))" => "1:18" "light.cell_m": "is 0.04", "0.05 to 1000 m";
        "(light: (height_m: 0))" => "1:20" "light.height_m": "0.1 to 1000 m";
        "(light: (slices: 1))" => "1:18" "light.slices": "is 1", "2 to 512 slices";
        "(light: (rays: 15))" => "1:16" "light.rays": "is 15", "16 to 4096 rays";
        "(light: (ray: 64))" => "1:10" "light.ray": "did you mean rays?";
        "(terrain: (ground: Flat(size_m: (200, 1))), light: (cell_m: 0.05))" => "1:61" "light.cell_m": "4001 by 21 columns", "limit of 2048";
        "(terrain: (ground: Flat(size_m: (100, 100))), light: (cell_m: 0.1))" => "1:63" "light.cell_m": "6012006 cells in 6 slices", "limit of 1048576";
        "(terrain: (ground: Flat(size_m: (100, 100))), light: (cell_m: 0.25, rays: 600))" => "1:75" "light.rays": "is 600", "964806 cells", "limit of 536870912";
        "(billboards: (extent: \"none.png\"))" => "1:23" "billboards.extent": "none.png";
        "(terrain: (base_map: \"none.png\"))" => "1:22" "terrain.base_map": "none.png";
        "(terrain: (lush_rgb: (0, 2, 0)))" => "1:26" "terrain.lush_rgb[1]": "is 2", "0 to 1";
        "(terrain: (ground: Flat(size_m: (8, 0))))" => "1:37" "terrain.ground.size_m[1]": "is 0";
    }
}

#[test]
fn the_limits_themselves_are_allowed() {
    for source in [
        "(duration_s: 172800)",
        "(solver: (substep_s: 0.06666666666666667, segments: 16, cube_resolution: 256, skin_m: 0.05))",
        "(solver: (substep_s: 0.0001, recovery_s: 60, segments: 1, cube_resolution: 8, rounds: (1, 1)))",
        "(solver: (blade_table: (2, 512)))",
        "(grass: (density_per_m2: 10000, species: []))",
        "(grass: (density_per_m2: 0, species: [(height_m: (0.001, 10), lean_deg: (0, 90))]))",
        "(grass: (species: [(form: Gravel, response: Shoved), (form: Gravel, response: Stays)]))",
        "(terrain: (ground: Flat(size_m: (0.1, 0.1), spacing_m: 0.5)))",
        body!("shape: Ball(radius_m: 0.001), restitution: 1, mass: Density(50000)"),
        body!("shape: Box(size_m: (100, 0.001, 100)), position_m: (500000, -500000, 0)"),
        body!(
            "shape: Compound(parts: [(shape: ConvexHull(points_m: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]))])"
        ),
        body!("shape: Vehicle(chassis_m: (1, 1, 2), wheel_radius_m: 0.5, wheel_width_m: 0.2)"),
        "(expect: [AllRest(by_s: 4), Lean(at_s: 0, near_m: (-8, 8), within_m: 1, at_most_deg: 0)])",
    ] {
        if let Err(error) = parse_scene("limit", source, &[]) {
            panic!("{source}\n{error}");
        }
    }
}

#[test]
fn bodies_that_cannot_be() {
    check! {
        body!("shape: Ball(radius_m: -1)") => "2:35" "bodies[0].shape.radius_m": "is -1", "0.001 to 100 m";
        body!("shape: Ball(radius_m: 1e39)") => "2:35" "bodies[0].shape.radius_m": "3.4e38";
        body!("shape: Box(size_m: (1, 0, 1))") => "2:36" "bodies[0].shape.size_m[1]": "is 0";
        body!("shape: Capsule(radius_m: 1, length_m: 0)") => "2:51" "bodies[0].shape.length_m": "is 0";
        body!("shape: Ball(radius_m: 1), mass: Kilograms(0)") => "2:45" "bodies[0].mass": "is 0", "kg";
        body!("shape: Ball(radius_m: 1), position_m: (0, NaN, 0)") => "2:55" "bodies[0].position_m[1]": "NaN";
        body!("shape: ConvexHull(points_m: [(0, 0, 0), (1, 0, 0), (0, 0, 1)])") => "2:41" "bodies[0].shape.points_m": "3 points", "4 to 256";
        body!("shape: ConvexHull(points_m: [(0, 1, 0), (1, 1, 0), (0, 1, 1), (1, 1, 1)])") => "2:41" "bodies[0].shape.points_m": "one plane", "0.001 m";
        body!("shape: Compound(parts: [])") => "2:36" "bodies[0].shape.parts": "at least one part";
        body!("shape: Compound(parts: [(shape: Mesh(file: \"a.obj\"))])") => "2:45" "bodies[0].shape.parts[0].shape": "is a mesh";
        body!("motion: Fixed, shape: Vehicle(chassis_m: (1, 0.4, 2), wheel_radius_m: 0.3, wheel_width_m: 0.2)") => "2:21" "bodies[0].motion": "Free or Thrown";
        body!("shape: Vehicle(chassis_m: (1, 0.4, 2), wheel_radius_m: 0.7, wheel_width_m: 0.2)") => "2:68" "bodies[0].shape.wheel_radius_m": "is 0.7", "0.5 m";
        body!("shape: Ball(radius_m: 1), motion: Path(waypoints: [(at_s: 0, position_m: (0, 0, 0))])") => "2:63" "bodies[0].motion.waypoints": "1 way points", "needs 2";
        body!("shape: Ball(radius_m: 1), motion: Path(waypoints: [(at_s: 1, position_m: (0, 0, 0)), (at_s: 1, position_m: (1, 0, 0))])") => "2:105" "bodies[0].motion.waypoints[1].at_s": "not after the 1 before it";
        body!("shape: Ball(radius_m: 1)), (name: \"a\", shape: Ball(radius_m: 2)") => "2:47" "bodies[1].name": "\"a\"", "another body";
    }
}

#[test]
fn scripts_cameras_and_expectations() {
    check! {
        "(script: [(at_s: 9, action: SetWind())])" => "1:18" "script[0].at_s": "is 9", "0 to 4 s";
        "(script: [(at_s: 1, action: Remove(body: \"x\"))])" => "1:42" "script[0].action.body": "\"x\"", "no bodies";
        "(script: [\n(at_s: 2, action: Spawn(name: \"x\", shape: Ball(radius_m: 1))),\n(at_s: 1, action: Remove(body: \"x\"))])" => "3:32" "script[1].action.body": "before it is spawned";
        "(script: [\n(at_s: 1, action: Spawn(name: \"x\", shape: Ball(radius_m: 1))),\n(at_s: 2, action: Remove(body: \"x\")), (at_s: 3, action: Remove(body: \"x\"))])" => "3:70" "script[2].action.body": "removal at 2 s";
        "(script: [(at_s: 1, action: Spawn(name: \"x\", shape: Ball(radius_m: 0)))])" => "1:68" "script[0].action.shape.radius_m": "is 0";
        "(script: [(at_s: 1, action: Spawn((name: \"x\")))])" => "1:35" "script[0].action": "one pair of brackets";
        "(bodies: [(name: \"x\", shape: Ball(radius_m: 1))], script: [(at_s: 1, action: Drive(body: \"x\", engine_n: 1))])" => "1:90" "script[0].action.body": "no Vehicle";
        "(bodies: [(name: \"x\", shape: Ball(radius_m: 1), motion: Fixed)], script: [(at_s: 1, action: Throw(body: \"x\", velocity_m_per_s: (1, 0, 0)))])" => "1:105" "script[0].action.body": "never moves";
        "(cameras: [(name: \"c\", eye_m: (1, 1, 1), target_m: (1, 1, 1))])" => "1:52" "cameras[0].target_m": "needs a direction";
        "(cameras: [(name: \"c\", eye_m: (1, 1, 1), target_m: (0, 0, 0), follow: \"x\")])" => "1:71" "cameras[0].follow": "no body of the scene";
        "(expect: [Lean(at_s: 1, near_m: (0, 0), within_m: 1)])" => "1:11" "expect[0]": "no limit", "at_least_deg or at_most_deg";
        "(expect: [Lean(at_s: 1, near_m: (0, 0), within_m: 1, at_least_deg: 50, at_most_deg: 40)])" => "1:68" "expect[0].at_least_deg": "50", "40";
        "(expect: [Offset(at_s: 1, near_m: (0, 9), within_m: 1, at_least_m: 0.1)])" => "1:39" "expect[0].near_m[1]": "is 9", "-8 to 8 m";
        "(expect: [Imprint(body: \"x\", at_s: 1, at_least: 0.5)])" => "1:25" "expect[0].body": "\"x\"";
        "(expect: [StateHash(is: \"dull\")])" => "1:25" "expect[0].is": "hexadecimal";
    }
}

#[test]
fn counts_over_budget() {
    check! {
        "(terrain: (ground: Flat(size_m: (200000, 200000))))" => "1:20" "terrain.ground": "40000400001 height samples", "16777216";
        "(grass: (density_per_m2: 10000), solver: (tile_m: 32, seeding_cell_m: 8),\n terrain: (ground: Flat(size_m: (64, 64), spacing_m: 8)))" => "1:26" "grass.density_per_m2": "10240000 plants in a tile", "65536";
        "(solver: (tile_m: 8))" => "1:19" "solver.tile_m": "is 8 m", "0.5 m", "write 2 m";
        "(terrain: (ground: Flat(size_m: (5000, 5000), spacing_m: 2)))" => "1:20" "terrain.ground": "25000000 tiles", "16777216";
        "(billboards: (density_per_m2: 1000), solver: (tile_m: 8, seeding_cell_m: 2),\n terrain: (ground: Flat(size_m: (8, 8), spacing_m: 2)))" => "1:31" "billboards.density_per_m2": "64000 billboards in a tile", "4096";
        "(billboards: (density_per_m2: 50), terrain: (ground: Flat(size_m: (300, 300))))" => "1:31" "billboards.density_per_m2": "4500000 billboards", "4194304";
        // 24 m2 a box; then 4π m2 a ball, in the script too.
        body!("shape: Box(size_m: (2, 2, 2)), coat: (per_m2: 50000)") => "2:59" "bodies[0].coat.per_m2": "is 50000", "1200000 plants on 24.000 m2", "1048576";
        "(bodies: [(name: \"a\", shape: Ball(radius_m: 1), coat: (per_m2: 70000))],\n script: [(at_s: 1, action: Spawn(name: \"b\", shape: Ball(radius_m: 1), coat: (per_m2: 20000)))])" => "2:87" "script[0].action.coat.per_m2": "251327 plants", "makes 1130973", "1048576";
    }
    let coated = |n: usize| format!("(shape: Ball(radius_m: 0.1), name: \"b{n}\", coat: ()),");
    let many: String = (0..1000).map(coated).collect();
    let text = parse_scene("many", &format!("(bodies: [{many}])"), &[]).expect_err("too many");
    assert!(
        text.to_string()
            .contains("more than the limit of 1048576; use a coarser mesh"),
        "{text}"
    );
    let many = "(shape: Ball(radius_m: 1), name: \"b\"),".repeat(4097);
    let text = parse_scene("many", &format!("(bodies: [{many}])"), &[]).expect_err("too many");
    assert!(text.to_string().contains("4097 bodies"), "{text}");
    let deep = format!("(bodies: {}", "[".repeat(100_000));
    assert!(parse_scene("deep", &deep, &[]).is_err());
}

/// Bytes like a valid file's: the file with some bytes changed, cut or doubled.
fn mutated(valid: &'static [u8]) -> impl Strategy<Value = Vec<u8>> {
    let changes =
        prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4_u8), 0..12);
    changes.prop_map(move |changes| {
        let mut bytes = valid.to_vec();
        for (place, value, kind) in changes {
            if bytes.is_empty() {
                break;
            }
            let at = place.index(bytes.len());
            match kind {
                0 => bytes[at] = value,
                1 => bytes.insert(at, value),
                2 => bytes.truncate(at),
                _ => bytes.extend_from_within(at..),
            }
            // Doubling again and again would only test the budget for bytes.
            bytes.truncate(1 << 16);
        }
        bytes
    })
}

const CHAIR: &[u8] = include_bytes!("../scenes/assets/chair.gltf");
const MEADOW: &[u8] = include_bytes!("../scenes/meadow.ron");

/// A 3 by 2 height map, as a PNG writer makes it.
fn height_map() -> &'static [u8] {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 3, 2);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let mut writer = encoder.write_header().expect("a valid header");
    writer
        .write_image_data(&[7; 12])
        .expect("as many bytes as the header says");
    drop(writer);
    bytes.leak()
}

/// A binary glTF file without anything in it.
const EMPTY_GLB: &[u8] =
    b"glTF\x02\0\0\0\x30\0\0\0\x1c\0\0\0JSON{\"asset\":{\"version\":\"2.0\"}} ";

/// The system's allocator, which also remembers the largest block ever asked for.
struct Watched;

static LARGEST_BLOCK: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Watched {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LARGEST_BLOCK.fetch_max(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promise about `layout` is passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise about `block` and `layout` is passed on.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Watched = Watched;

/// Files below are at most 64 KiB, which a PNG may unpack 1032-fold; nothing else may grow so.
const LARGEST_ALLOWED: usize = (1 << 16) * 1032 + (1 << 20);

fn never_panics(name: &str, bytes: &[u8]) {
    let files = [(name, bytes)];
    // Errors are what most of these bytes deserve; coming back is the test.
    let _ = read_mesh(name, &Embedded(&files));
    let _ = read_height_map(name, &Embedded(&files));
    let largest = LARGEST_BLOCK.load(Ordering::Relaxed);
    assert!(largest <= LARGEST_ALLOWED, "a block of {largest} bytes");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn any_bytes_as_an_asset(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        for name in ["a.obj", "a.gltf", "a.glb", "a.png"] {
            never_panics(name, &bytes);
            let headed = [b"glTF\x02\0\0\0".as_slice(), &bytes].concat();
            never_panics(name, &headed);
        }
    }

    #[test]
    fn changed_meshes_and_height_maps(
        obj in mutated(assets::TETRAHEDRON.as_bytes()),
        gltf in mutated(CHAIR),
        glb in mutated(EMPTY_GLB),
        png in mutated(height_map()),
    ) {
        never_panics("a.obj", &obj);
        never_panics("a.gltf", &gltf);
        never_panics("a.glb", &glb);
        never_panics("a.png", &png);
    }

    #[test]
    fn changed_scenes_are_read_or_explained(bytes in mutated(MEADOW)) {
        let source = String::from_utf8_lossy(&bytes);
        let files = [("assets/chair.gltf", CHAIR)];
        match parse_scene_with("changed", &source, &Embedded(&files)) {
            Ok(loaded) => {
                let text = to_ron(&loaded.scene).expect("a scene can be written");
                let again = parse_scene_with("again", &text, &Embedded(&files));
                prop_assert_eq!(again.expect("what was valid stays valid").scene, loaded.scene);
            }
            Err(error) => {
                prop_assert!(error.line >= 1 && error.column >= 1 && !error.key.is_empty());
                let lines = source.lines().count().max(1) as u32 + 1;
                prop_assert!(error.line <= lines, "{}", error);
            }
        }
    }
}
