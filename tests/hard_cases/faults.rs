//! Every mistake that is planted must turn a case red that is green without it, under the case's own
//! limits: a case that cannot fail proves nothing.

use std::time::Instant;

use libtest_mimic::{Failed, Trial};
use sward::run::Device;
use sward::scene::Collider;
use sward::scene::method::{Recovery, Sampling};
use sward::sim::fault::Fault;

use super::rig::{Mistake, Setting, ensure};
use super::{CASES, Told, tell};

/// A mistake, the case it turns red, and a word of what that case then says.
struct Planting {
    what: &'static str,
    mistake: Mistake,
    case: &'static str,
    collider: Collider,
    says: &'static str,
}

const PLANTINGS: &[Planting] = &[
    Planting {
        what: "weight_instead_of_ratio",
        mistake: Mistake::Method(|method| method.recovery = Recovery::Literal),
        case: "release",
        collider: Collider::Analytic,
        says: "of the offset is left",
    },
    Planting {
        what: "no_sub_step",
        mistake: Mistake::Method(|method| method.sweep_share = 1e6),
        case: "rod",
        collider: Collider::Auto,
        says: "gone through",
    },
    Planting {
        what: "no_sub_step",
        mistake: Mistake::Method(|method| method.sweep_share = 1e6),
        case: "plate",
        collider: Collider::Auto,
        says: "gone through",
    },
    // A flat or round part is read as well from the nearest texel, since each keeps its plane; in the
    // inner corners of a fork that texel belongs to another face.
    Planting {
        what: "nearest_sampling",
        mistake: Mistake::Method(|method| method.sampling = Sampling::Nearest),
        case: "hollow",
        collider: Collider::Cube,
        says: "beyond it",
    },
    Planting {
        what: "springs_last",
        mistake: Mistake::Planted(Fault::SpringsLast),
        case: "stiff_springs",
        collider: Collider::Analytic,
        says: "strain",
    },
    // At the default's κΔt = 1/40 the root takes at most 1/42 of its spring's extension in a sub-step,
    // which for a blade folded by less than a right angle is 2 − √2 of a segment at most: a strain of
    // 1.4%, below every limit. At 1 /s in sub-steps of 1/15 s it takes 1/17.
    Planting {
        what: "wrong_root_weight",
        mistake: Mistake::Planted(Fault::RootWeight),
        case: "stiff_springs",
        collider: Collider::Analytic,
        says: "strain",
    },
    Planting {
        what: "timer_per_tile",
        mistake: Mistake::Planted(Fault::TimerPerTile),
        case: "sharded",
        collider: Collider::Analytic,
        says: "plants differ",
    },
    Planting {
        what: "world_coordinates_in_f32",
        mistake: Mistake::Planted(Fault::WorldCoordinatesInF32),
        case: "far_away",
        collider: Collider::Analytic,
        says: "off by",
    },
];

/// One trial per planting, on the cpu engine, which has the mistakes.
pub fn trials(told: &Told) -> Vec<Trial> {
    let trial = |planting: &'static Planting| {
        let title = format!("fault::{}::{}", planting.what, planting.case);
        let (name, told) = (title.clone(), told.clone());
        Trial::test(name, move || turns_red(planting, &title, &told))
    };
    PLANTINGS.iter().map(trial).collect()
}

fn turns_red(planting: &Planting, title: &str, told: &Told) -> Result<(), Failed> {
    let started = Instant::now();
    let case = CASES.iter().find(|case| case.name == planting.case);
    let case = case.ok_or_else(|| format!("there is no case {}", planting.case))?;
    ensure(case.colliders.contains(&planting.collider), || {
        "the case is not run with this collider".into()
    })?;
    let setting = Setting {
        device: &Device::Processor,
        collider: planting.collider,
        mistake: Some(planting.mistake),
    };
    let red = match (case.check)(&setting) {
        Ok(measured) => return Err(format!("the case stays green: {measured}").into()),
        Err(error) => error.message().unwrap_or_default().to_owned(),
    };
    ensure(red.contains(planting.says), || {
        format!("the case fails for another reason: {red}")
    })?;
    tell(told, title, &format!("turns red: {red}"), started);
    Ok(())
}
