use super::*;

/// Entries as a scene has them that does not say.
const USUAL: [u32; 2] = [128, 64];

fn grass(stiffness: [f32; 2], lean_deg: [f32; 2]) -> Grass {
    let kind = Species {
        stiffness,
        lean_deg,
        ..Species::default()
    };
    Grass {
        species: vec![kind],
        ..Grass::default()
    }
}

#[test]
fn default_grass_within_a_thousandth_of_a_blade() {
    for root in [Root::Double, Root::Paper] {
        let table = BladeTable::new(&Grass::default(), 8, root, USUAL).expect("the default grass");
        let error = table.max_error().expect("the default grass");
        assert!(error <= 1e-3, "{root:?}: {error:e}");
    }
    // The head of this file states this figure.
    let table =
        BladeTable::new(&Grass::default(), 8, Root::Double, USUAL).expect("the default grass");
    let error = table.max_error().expect("the default grass");
    assert!((1.8e-4..2.0e-4).contains(&error), "{error:e}");
}

#[test]
fn the_error_falls_with_the_square_of_the_entries() {
    // Bilinear mixing is of second order; halved steps must divide the error by about 4.
    let error = |entries| {
        let grass = grass([100.0, 160.0], [8.0, 16.0]);
        let table = BladeTable::new(&grass, 8, Root::Double, entries).expect("valid");
        table.max_error().expect("valid")
    };
    let ratio = error([9, 5]) / error([17, 9]);
    assert!((3.0..5.0).contains(&ratio), "{ratio}");
}

#[test]
fn entries_are_the_solvers_answers() {
    let table = BladeTable::new(&Grass::default(), 5, Root::Paper, [4, 3]);
    let table = table.expect("the default grass");
    assert_eq!(table.directions.len(), 4 * 3 * 5);
    let k = stiffness_for_segments(160.0, 5);
    let shape = blade_shape::solve(5, k, Root::Paper, 16.0_f64.to_radians()).expect("valid");
    let place = table.place(1.0_f32, 1.0);
    for (j, angle) in shape.angles_rad.iter().enumerate() {
        let [x, y] = table.direction(place, j);
        // Half an ulp of a number below 1, and log₂ and 2^x in between.
        assert!((f64::from(x) - angle.sin()).abs() < 1e-7, "{j}");
        assert!((f64::from(y) - angle.cos()).abs() < 1e-7, "{j}");
    }
}

#[test]
fn kinds_share_the_table() {
    let mut grass = grass([20.0, 40.0], [0.0, 10.0]);
    grass.species.push(Species {
        stiffness: [80.0, 320.0],
        lean_deg: [5.0, 5.0],
        ..Species::default()
    });
    let table = BladeTable::new(&grass, 2, Root::Double, [16, 4]).expect("valid");
    assert_eq!(table.species[0].stiffness, [0.0, 0.25]);
    assert_eq!(table.species[1].stiffness, [0.5, 1.0]);
    assert_eq!(table.species[1].lean, [0.5, 0.5]);
}

#[test]
fn one_stiffness_one_lean() {
    let table =
        BladeTable::new(&grass([100.0; 2], [5.0; 2]), 8, Root::Double, USUAL).expect("valid");
    assert_eq!(table.species[0].stiffness, [0.0, 0.0]);
    assert!(table.max_error().expect("valid") < 1e-6);
}

#[test]
fn no_species_still_make_a_table() {
    let bare = Grass {
        species: Vec::new(),
        ..Grass::default()
    };
    let table = BladeTable::new(&bare, 8, Root::Double, [2, 2]).expect("valid");
    assert_eq!(table.directions.len(), 2 * 2 * 8);
}

#[test]
fn what_is_no_range_is_named() {
    for (stiffness, lean) in [
        ([2.0, 1.0], [0.0, 1.0]),
        ([0.0, 1.0], [0.0, 1.0]),
        ([1.0, f32::NAN], [0.0, 1.0]),
        ([1.0, 2.0], [-1.0, 1.0]),
        ([1.0, 2.0], [0.0, 91.0]),
    ] {
        let error = BladeTable::new(&grass(stiffness, lean), 8, Root::Double, USUAL);
        let text = error.expect_err("no range").to_string();
        assert!(
            text.contains("meadow grass") && text.contains("is no range"),
            "{text}"
        );
    }
}
