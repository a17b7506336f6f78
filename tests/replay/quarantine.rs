//! A body whose numbers break is taken out; everything else goes on as if it had been removed.

use sward::base::Real;
use sward::run::{Device, Input, Outcome, RunOptions, run_scene};
use sward::scene::{Action, parse_scene};
use sward::sim::measure::{self, Standing};

const PAIR: &str = r#"(
    duration_s: 1.0,
    terrain: (ground: Flat(size_m: (8, 4))),
    bodies: [
        (name: "ball", shape: Ball(radius_m: 0.15), position_m: (-2.0, 0.15, 0.0),
         motion: Thrown(velocity_m_per_s: (1.5, 0.0, 0.0))),
        (name: "doomed", shape: Box(size_m: (0.4, 0.4, 0.4)), position_m: (2.0, 0.2, 0.0)),
    ],
)"#;
const TICK: u32 = 57;

fn run(text: &str, action: Option<Action>) -> Outcome {
    let loaded = parse_scene("pair", text, &[]).expect("a valid scene");
    let inputs = action.map(|action| Input { tick: TICK, action });
    let options = RunOptions {
        inputs: inputs.into_iter().collect(),
        ..RunOptions::default()
    };
    run_scene(&loaded, &options, &Device::Processor, |_| {}).expect("the run goes on")
}

fn poisons() -> Vec<Action> {
    let body = || "doomed".to_owned();
    vec![
        Action::Teleport {
            body: body(),
            position_m: [f64::NAN, 0.0, 0.0],
            velocity_m_per_s: [0.0; 3],
        },
        Action::Throw {
            body: body(),
            velocity_m_per_s: [f32::INFINITY, 0.0, 0.0],
            spin_deg_per_s: [0.0; 3],
        },
        Action::Throw {
            body: body(),
            velocity_m_per_s: [0.0; 3],
            spin_deg_per_s: [0.0, f32::NAN, 0.0],
        },
        Action::Impulse {
            body: body(),
            impulse_kg_m_per_s: [f32::NEG_INFINITY, 0.0, 0.0],
        },
    ]
}

#[test]
fn a_poisoned_body_is_named_and_leaves_like_a_removed_one() {
    let remove = Action::Remove {
        body: "doomed".into(),
    };
    let removed = run(PAIR, Some(remove));
    assert!(removed.meadow.bodies.quarantined().is_empty());
    for poison in poisons() {
        let poisoned = run(PAIR, Some(poison.clone()));
        assert_eq!(
            poisoned.meadow.bodies.quarantined(),
            ["doomed"],
            "{poison:?}"
        );
        assert_eq!(poisoned.watch.not_finite, 0, "{poison:?}");
        // All ticks, all bodies, all plants, bit for bit.
        assert_eq!(
            poisoned.engine.state_hash(),
            removed.engine.state_hash(),
            "{poison:?}"
        );
    }
}

/// The plants near the ball's track, which the other body does not touch.
fn track<R: Real>(outcome: &Outcome, of: impl Fn(&Outcome) -> Vec<Standing<R>>) -> Vec<Vec<u64>> {
    let bits = |plant: &Standing<R>| {
        let nodes = plant.nodes.iter().flat_map(|node| node.to_f64());
        nodes.map(f64::to_bits).collect()
    };
    of(outcome).iter().map(bits).collect()
}

#[test]
fn other_plants_are_those_of_a_run_without_the_body() {
    let near = |outcome: &Outcome| {
        let sward::run::Engine::Cpu(grass) = &outcome.engine else {
            panic!("the processor runs the cpu engine");
        };
        measure::near(&outcome.meadow, grass, [-1.2, 0.0], 0.8)
    };
    let start = PAIR.find("        (name: \"doomed\"").expect("the body");
    let end = PAIR.find("    ],").expect("the list's end");
    let alone = run(&[&PAIR[..start], &PAIR[end..]].concat(), None);
    let expected = track::<f32>(&alone, near);
    assert!(alone.watch.max_offset_m > 0.1 && expected.len() > 100);
    for poison in poisons() {
        let poisoned = run(PAIR, Some(poison.clone()));
        assert_eq!(track::<f32>(&poisoned, near), expected, "{poison:?}");
    }
}
