//! Scenes with billboards: maps that cannot be used, and the scene of the paper's measurements.

#![allow(clippy::expect_used, reason = "a test says what it expects by failing")]

use sward::scene::assets::Embedded;
use sward::scene::builtin::ASSETS;
use sward::scene::parse_scene_with;
use sward::sim::Meadow;

/// A PNG of 8-bit texels.
fn png(colour: png::ColorType, [columns, rows]: [u32; 2], texels: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, columns, rows);
    encoder.set_color(colour);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().expect("a valid header");
    let written = writer.write_image_data(texels);
    written.expect("as many bytes as the header says");
    drop(writer);
    bytes
}

#[test]
fn maps_of_billboards_that_cannot_be_used() {
    use png::ColorType::{Grayscale, Rgb};
    let rising = [128, 255, 128];
    let files = [
        ("small.png", png(Grayscale, [4, 4], &[200; 16])),
        ("large.png", png(Grayscale, [8, 8], &[200; 64])),
        ("wide.png", png(Grayscale, [8, 4], &[200; 32])),
        ("up.png", png(Rgb, [4, 4], &rising.repeat(16))),
        (
            "zero.png",
            png(
                Rgb,
                [4, 4],
                &[rising.repeat(6), [127; 3].repeat(10)].concat(),
            ),
        ),
        (
            "down.png",
            png(
                Rgb,
                [4, 4],
                &[rising.repeat(15), vec![128, 0, 128]].concat(),
            ),
        ),
        ("broken.png", b"no picture".to_vec()),
    ];
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, b)| (*name, &b[..])).collect();
    let error = |keys: &str| {
        let source = format!("(billboards: ({keys}))");
        parse_scene_with("maps", &source, &Embedded(&files))
            .map(|_| ())
            .err()
    };
    for good in [
        "extent: \"small.png\", direction: \"up.png\", messiness: Map(\"small.png\")",
        "extent: \"large.png\", direction: \"up.png\", resample: true",
    ] {
        assert!(error(good).is_none(), "{good}: {:?}", error(good));
    }
    for (keys, place, key, words) in [
        (
            "extent: \"large.png\", direction: \"up.png\"",
            "1:47",
            "direction",
            &[
                "`up.png` has 4 by 4",
                "`large.png` of billboards.extent has 8 by 8",
                "resample: true",
            ][..],
        ),
        (
            "extent: \"wide.png\"",
            "1:23",
            "extent",
            &["8 by 4 texels", "16 by 16 squares", "8 rows"],
        ),
        (
            "direction: \"zero.png\"",
            "1:26",
            "direction",
            &["`zero.png`", "length 0.007 in texel (2, 1)", "limit of 0.1"],
        ),
        (
            "direction: \"down.png\"",
            "1:26",
            "direction",
            &["rises by -1.000 in texel (3, 3)"],
        ),
        (
            "direction: \"small.png\"",
            "1:26",
            "direction",
            &["8-bit Grayscale", "8-bit RGB PNG"],
        ),
        (
            "messiness: Map(\"up.png\")",
            "1:26",
            "messiness",
            &["8-bit Rgb", "16-bit grey PNG"],
        ),
        ("extent: \"broken.png\"", "1:23", "extent", &["damaged"]),
    ] {
        let text = error(keys).map(|e| e.to_string()).unwrap_or_default();
        let head = format!("maps:{place}: billboards.{key}: ");
        let says_all = words.iter().all(|word| text.contains(word));
        assert!(text.starts_with(&head) && says_all, "{keys}\n{text}");
    }
}

/// O09 section 7: 60,000 of them.
#[test]
fn the_papers_scene_has_its_billboards() {
    let source = include_str!("../scenes/meadow_60k.ron");
    let loaded = parse_scene_with("meadow_60k", source, &ASSETS).expect("a valid scene");
    let meadow = Meadow::new(loaded.scene, &loaded.assets).expect("within budget");
    let billboards = meadow.field.billboards.expect("the scene has some");
    let count = billboards.all.len();
    println!(
        "{count} billboards on {} tiles, at most {} on one",
        meadow.field.grid.tile_count(),
        billboards.most_in_tile()
    );
    assert!((59_400..=60_600).contains(&count), "{count}");
    assert!(meadow.field.seeds.species.is_empty());
}
