use super::*;
use crate::scene::{ClumpLook, Season};

fn kind(look: ClumpLook, season: Season) -> ClumpKind {
    ClumpKind {
        look,
        season,
        ..ClumpKind::default()
    }
}

fn every_kind() -> Vec<ClumpKind> {
    use ClumpLook::{Broad, Fine, Flowering, Reed};
    use Season::{Autumn, Spring, Summer, Winter};
    vec![
        kind(Fine, Summer),
        kind(Broad, Spring),
        kind(Reed, Autumn),
        kind(Flowering, Winter),
    ]
}

/// A level draws at least the finest one's coverage, and with alphas lower by 1e-4, far more than what 24
/// halvings leave open, less: no other scale comes nearer from above. How far above that is depends on how
/// many texels have one alpha, since all of those cross a threshold together.
#[test]
fn levels_keep_coverage() {
    for (number, kind) in (0..).zip(every_kind()) {
        for variant in 0..CLUMP_VARIANTS {
            let finest = paint(&kind, number, variant).expect("blades with shapes");
            let levels = levels_of(finest);
            assert_eq!(levels.len(), 7);
            let wanted = drawn_coverage(&levels[0], 1.0);
            // Neither empty nor a wall; a winter's flowers have few blades.
            assert!((0.03..0.8).contains(&wanted), "{kind:?}: {wanted}");
            for level in &levels[1..] {
                let (drawn, below) = (drawn_coverage(level, 1.0), drawn_coverage(level, 0.9999));
                assert!(
                    below < wanted && wanted <= drawn,
                    "{} texels: {below} {drawn} for {wanted}",
                    level.len()
                );
            }
        }
    }
}

/// What is drawn ends before the quad does, and no texel is black: bleeding reaches all of them.
#[test]
fn pictures_have_free_borders_and_no_dark_texels() {
    for levels in pictures(&every_kind()).expect("pictures") {
        let side = CLUMP_SIDE as usize;
        let alpha = |x: usize, y: usize| levels[0][(y * side + x) * 4 + 3];
        for n in 0..side {
            assert_eq!((alpha(n, 0), alpha(0, n), alpha(side - 1, n)), (0, 0, 0));
        }
        for level in &levels {
            // A factor of 0.1 of 8 is 0.0125 of full light, the byte 30.
            assert!(level.chunks_exact(4).all(|texel| texel[1] > 30));
        }
    }
}

/// Every kind and variant is another picture, and the same again.
#[test]
fn pictures_are_repeated_and_differ() {
    let first = pictures(&every_kind()).expect("pictures");
    assert_eq!(first.len(), 4 * CLUMP_VARIANTS as usize);
    assert_eq!(first, pictures(&every_kind()).expect("pictures"));
    for (n, one) in first.iter().enumerate() {
        assert!(first[..n].iter().all(|other| other[0] != one[0]), "{n}");
    }
}

#[test]
fn too_many_layers_are_refused_with_numbers() {
    assert!(check_layers(32, 32).is_ok());
    let text = check_layers(33, 32).expect_err("too many").to_string();
    assert!(text.contains("33") && text.contains("32"), "{text}");
}
