use super::*;
use crate::base::philox::philox2x32;
use crate::scene::{Solver, Species};
use crate::terrain::HeightGrid;

/// A map of 8 by 1 colours over 16 by 2 m.
fn map(colours: [[u8; 3]; 8]) -> Arc<ColourMap> {
    Arc::new(ColourMap {
        columns: 8,
        rows: 1,
        texel_m: 2.0,
        rgba8: colours
            .iter()
            .flat_map(|&[r, g, b]| [r, g, b, 255])
            .collect(),
    })
}

fn liking(hsv: [f32; 3]) -> Likes {
    Likes {
        hsv,
        weights: [1.0, 1.0, 1.0],
        ..Likes::default()
    }
}

fn kinds(likes: &[Likes], bare: &[Likes], map: Arc<ColourMap>) -> Kinds {
    let species = likes.iter().map(|likes| Species {
        likes: Some(likes.clone()),
        ..Species::default()
    });
    let grass = Grass {
        species: species.collect(),
        bare: bare.to_vec(),
        ..Grass::default()
    };
    let grid = FieldGrid::new(&HeightGrid::flat(17, 3, 1.0), &grass, &Solver::default());
    Kinds::new(&grass, &grid.expect("a grid"), map).expect("kinds that look at the ground")
}

/// Eq. 16 and its neighbours as they are written, in floats.
fn score(likes: &Likes, [r, g, b]: [f64; 3]) -> f64 {
    let most = r.max(g).max(b);
    let spread = most - r.min(g).min(b);
    let edge = |from: f64, to: f64| (from - to) / spread / 6.0;
    let hue = match () {
        () if spread == 0.0 => 0.0,
        () if most == r => edge(g, b).rem_euclid(1.0),
        () if most == g => 1.0 / 3.0 + edge(b, r),
        () => 2.0 / 3.0 + edge(r, g),
    };
    let saturation = if most > 0.0 { spread / most } else { 0.0 };
    let around = (hue - f64::from(likes.hsv[0]) / 360.0).abs();
    let differences = [
        around.min(1.0 - around),
        saturation - f64::from(likes.hsv[1]),
        most - f64::from(likes.hsv[2]),
    ];
    let weighted = differences.iter().zip(&likes.weights);
    let squared: f64 = weighted.map(|(d, &w)| (d * f64::from(w)).powi(2)).sum();
    squared
        .sqrt()
        .max(1.0 / 128.0)
        .powf(-f64::from(likes.exponent))
}

/// Distances are exact to 2⁻¹² (each of three differences cut off, then its product), scores with
/// them to p·1.7·2⁻¹¹/d: 0.3% for p = 4 at the distance 0.1 and more.
#[test]
fn scores_are_those_of_the_equation() {
    let likes = Likes {
        hsv: [350.0, 0.4, 0.3],
        weights: [2.0, 0.7, 0.3],
        exponent: 4.0,
        ..Likes::default()
    };
    let own = taste(&likes, 1.0);
    let mut checked = 0;
    for n in 0..4000_u32 {
        let words = philox2x32([n, 0], 5, 7);
        let rgb = [words[0] & 255, (words[0] >> 8) & 255, words[1] & 255];
        let want = score(&likes, rgb.map(|byte| f64::from(byte) / 255.0));
        if want > 1e4 {
            continue;
        }
        let log = own.score_log(hsv_of(rgb.map(|byte| byte << 8)));
        let got = (f64::from(log.expect("no threshold")) / 4096.0).exp2();
        // Hue and saturation of a dark colour hang on its rounding: V is 1/256 too large at most.
        let tolerance = 0.05;
        assert!(
            (got / want - 1.0).abs() < tolerance,
            "{rgb:?}: {got} for {want}"
        );
        checked += 1;
    }
    assert!(checked > 3000, "{checked}");
}

#[test]
fn a_kind_grows_where_its_colour_is() {
    let (green, brown) = ([40, 160, 40], [120, 80, 40]);
    let map = map([green, green, green, green, brown, brown, brown, brown]);
    let likes = [liking([120.0, 0.75, 0.63]), liking([30.0, 0.67, 0.47])];
    let kinds = kinds(&likes, &[], map);
    let share_of_brown = |texel: f64| {
        let place = [(texel * 65_536.0) as u32, 1 << 15];
        let brown = (0..2000_u32)
            .filter(|&n| kinds.choose(place, philox2x32([n, 1], 9, 7)[0]).kind == Some(1));
        brown.count() as f64 / 2000.0
    };
    // Within a byte's step of its own colour a kind's score is 10⁸ or so times the other's.
    assert_eq!(share_of_brown(1.0), 0.0);
    assert_eq!(share_of_brown(7.0), 1.0);
    // Between the middles of two texels the mixed colour decides, not a line between them.
    let shares = [3.6, 3.9, 4.0, 4.1, 4.4].map(share_of_brown);
    assert!(
        shares.is_sorted() && shares[0] < 0.05 && shares[4] > 0.95,
        "{shares:?}"
    );
}

/// z < s₁/(s₀ + s₁): the share of the second is what eq. 16 says, and s′ what eq. 18 says.
#[test]
fn the_choice_is_in_proportion_to_the_scores() {
    let colour = [100, 120, 60];
    let map = map([colour; 8]);
    let likes = [liking([110.0, 0.6, 0.6]), liking([70.0, 0.3, 0.4])];
    let kinds = kinds(&likes, &[], map);
    let scores = likes
        .clone()
        .map(|l| score(&l, colour.map(|b| f64::from(b) / 255.0)));
    let want = scores[1] / (scores[0] + scores[1]);
    assert!(want > 0.05 && want < 0.5, "a bad case: {scores:?}");
    let count = 40_000;
    let mut second = 0;
    for n in 0..count {
        let choice = kinds.choose([3 << 16, 1 << 15], philox2x32([n, 2], 3, 7)[0]);
        let share = f64::from(choice.thrives) / 65_536.0;
        let own = if choice.kind == Some(1) {
            want
        } else {
            1.0 - want
        };
        assert!(
            (share - own).abs() < 0.01,
            "{choice:?}: s' {share} for {own}"
        );
        second += u32::from(choice.kind == Some(1));
    }
    let got = f64::from(second) / f64::from(count);
    // Five standard deviations of a binomial share, and the scores' own error.
    let spread = 5.0 * (want * (1.0 - want) / f64::from(count)).sqrt() + 0.01;
    assert!((got - want).abs() < spread, "{got} for {want}");
}

#[test]
fn bare_ground_and_thresholds_leave_the_ground_bare() {
    let grey = [128, 128, 128];
    let map = map([grey; 8]);
    let place = [1 << 16, 1 << 15];
    let rock = liking([0.0, 0.0, 0.5]);
    let grass = liking([120.0, 0.8, 0.5]);
    let on_rock = kinds(std::slice::from_ref(&grass), &[rock], Arc::clone(&map));
    // Rock is within a byte of its colour, grass 0.8 away: 4·log₂(0.8·128) = 26.7 digits.
    assert_eq!(on_rock.choose(place, u32::MAX).kind, None);
    let demanding = Likes {
        threshold: 10.0,
        ..grass.clone()
    };
    // A score of at most 0.8⁻⁴ = 2.4.
    let alone = kinds(&[demanding], &[], Arc::clone(&map));
    assert_eq!(alone.choose(place, 7).kind, None);
    let undemanding = kinds(&[grass], &[], map);
    let choice = undemanding.choose(place, 7);
    assert_eq!((choice.kind, choice.thrives), (Some(0), 65_536));
}
