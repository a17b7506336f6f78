//! Laws of tiles: a billboard does not notice which others there are, and a resting body leaves it still.

use super::contacts::{Ball, calm};
use super::*;

/// Sub-steps of a tile with a ball that rolls slowly among its billboards and comes to rest.
fn among<R: Real>(
    boards: &[Billboard],
    settings: &Settings<R>,
    sub_steps: u32,
    mut see: impl FnMut(u32, &Slab<R>, &Responded),
) -> Slab<R> {
    let (ground, wind, weave) = (ground(), calm(), weave(4, 4));
    let ball = Ball::new(Tested::Closed);
    let grown: Solid<R> = ball.part().solid.grown_by(0.001);
    let mut slab: Slab<R> = Slab::new(boards.len(), weave.grid.movable());
    let (mut poses, mut found) = (Poses::new(&weave), Vec::new());
    for now in 1..=sub_steps {
        let at = |n: u32| vec3(0.01 * f64::from(n.min(40)) - 0.2, 0.15, 0.05);
        let contact = ball.contact(at(now - 1), at(now));
        let touches = [Touch::new(0, &contact, ball.part(), &grown)];
        let tile = Tile {
            weave: &weave,
            billboards: boards,
            anchor: &ANCHOR,
            ground: &ground,
            ground_top_m: R::of(1e-6),
            touches: &touches,
            wind: &wind,
            wind_before: &wind,
            now,
            fading: Fading {
                step_over_t: R::of(1.0 / 240.0),
                recovery: Recovery::Lengths,
                planted: Planted::NONE,
            },
        };
        tile.touched(&slab, &mut poses, &mut found);
        let mut batch = Batch::new(&weave);
        let done = tile.respond(&mut found, &mut slab, (&mut batch, &mut poses), settings);
        see(now, &slab, &done);
    }
    slab
}

fn scattered(count: usize) -> Vec<Billboard> {
    let board = |n: usize| {
        let azimuth = 3.0 * chance(n, 11);
        Billboard {
            root_in_anchor: [0.4 * chance(n, 12) as f32, 0.0, 0.4 * chance(n, 13) as f32],
            across: [azimuth.cos() as f32, azimuth.sin() as f32],
            ..billboard(
                0.4 + 0.1 * chance(n, 14) as f32,
                0.5 + 0.2 * chance(n, 15) as f32,
            )
        }
    };
    (0..count).map(board).collect()
}

type Bits = (u32, Vec<[u32; 3]>, Vec<u32>);

fn bits(slab: &Slab<f32>, place: usize) -> Bits {
    let of = place * 12..(place + 1) * 12;
    let offsets = slab.offsets[of.clone()].iter();
    (
        slab.touched_at[place],
        offsets.map(|v| v.to_f32().map(f32::to_bits)).collect(),
        slab.faces[of].to_vec(),
    )
}

#[test]
fn a_billboard_does_not_notice_its_neighbours() {
    let settings = Settings::<f32>::new(&Solver::default());
    let boards = scattered(21);
    let together = among(&boards, &settings, 60, |_, _, _| ());
    let reversed: Vec<Billboard> = boards.iter().rev().copied().collect();
    let backwards = among(&reversed, &settings, 60, |_, _, _| ());
    let mut touched = 0;
    for place in 0..boards.len() {
        let alone = among(&boards[place..=place], &settings, 60, |_, _, _| ());
        assert_eq!(bits(&together, place), bits(&alone, 0), "{place}");
        assert_eq!(
            bits(&together, place),
            bits(&backwards, 20 - place),
            "{place}"
        );
        touched += u32::from(together.touched_at[place] > 0);
    }
    assert!(touched > 8, "{touched}");
}

/// A ball that lies still for 10 s: from 1 s on no node moves by more than 1e-5 m in a frame, and the
/// strain is within the limit.
#[test]
fn a_resting_ball_leaves_them_still() {
    let settings = Settings::<f32>::new(&Solver::default());
    let boards = scattered(21);
    let mut last: Option<Slab<f32>> = None;
    let mut most_m: f32 = 0.0;
    among(&boards, &settings, 1200, |now, slab, _| {
        if let Some(last) = last.as_ref().filter(|_| now > 160) {
            for place in (0..21).filter(|&p| slab.touched_at[p] == now) {
                for n in place * 12..(place + 1) * 12 {
                    most_m = most_m.max((slab.offsets[n] - last.offsets[n]).length());
                }
            }
        }
        last = Some(slab.clone());
    });
    println!("{most_m:e} m in a sub-step");
    // Two sub-steps of 1/120 s to a frame.
    assert!(most_m <= 0.5e-5, "{most_m}");
}

/// The printed springs stay finite behind their bound and say that it was taken.
#[test]
fn the_printed_springs_say_that_they_are_bounded() {
    let settings = Settings::<f32> {
        literal: true,
        ..Settings::new(&Solver::default())
    };
    let (mut clamped, mut strain) = (false, 0.0_f64);
    let slab = among(&scattered(21), &settings, 60, |_, _, done| {
        clamped |= done.clamped;
        strain = strain.max(done.strain);
    });
    println!("printed springs: strain up to {strain:.2}");
    assert!(clamped && slab.offsets.iter().all(|v| v.is_finite()));
}

/// A ball rolls across a clump: its top ends up leaning the way the ball went, at its full width.
#[test]
fn a_clump_lies_down_along_the_motion() {
    let settings = Settings::<f32>::new(&Solver::default());
    for azimuth in [1.2_f64, 1.57, 1.9] {
        let board = Billboard {
            root_in_anchor: [0.0, 0.0, 0.05],
            across: [azimuth.cos() as f32, azimuth.sin() as f32],
            ..billboard(0.4, 0.5)
        };
        let slab = among(&[board], &settings, 40, |_, _, _| ());
        let top = &slab.offsets[8..];
        assert!(
            top.iter().all(|offset| offset.x > 0.2),
            "{azimuth}: {top:?}"
        );
        let width = (top[3] - top[0] + vec3(board.across[0], 0.0, board.across[1]) * 0.4).length();
        println!("across {azimuth}: width {:.2}", width / 0.4);
        assert!(width > 0.9 * 0.4, "{azimuth}: {width} m");
    }
}
