//! The report in Markdown.

use std::io::{self, Write};

use super::cost::LITERAL;
use super::measure::MOST_RMS_M;
use super::summary::{MethodSummary, choices, verdict_on_default};
use super::{CostRow, FLOOR, Report, Row, SceneReport};
use crate::run::methods::{DEFAULT, method};

/// A default sub-step may cost this many times a literal one.
const MOST_TIMES_LITERAL: f64 = 4.0;

/// Writes the whole report.
///
/// # Errors
///
/// The writer's.
pub fn write_markdown(report: &Report, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "# Accuracy and cost of the methods\n")?;
    write_machine(report, out)?;
    let summary = report.summary();
    write_choice(report, &summary, out)?;
    write_summary(&summary, out)?;
    write_split(&summary, out)?;
    write_cost(report, out)?;
    if let Some(blades) = &report.blades {
        blades.write(out)?;
    }
    for scene in &report.scenes {
        write_scene(scene, out)?;
    }
    Ok(())
}

fn write_machine(report: &Report, out: &mut impl Write) -> io::Result<()> {
    let machine = &report.machine;
    let cpu = machine.cpu.as_deref().unwrap_or("an unknown processor");
    write!(
        out,
        "sward {}, {cpu}, {} threads",
        env!("CARGO_PKG_VERSION"),
        machine.threads
    )?;
    if let Some(load) = machine.load_average {
        write!(out, ", load average {load:.1} at the start")?;
    }
    match &report.adapter {
        Some(adapter) => write!(out, "; rounding on {} ({})", adapter.name, adapter.driver)?,
        None => write!(out, "; no graphics adapter, so rounding is not measured")?,
    }
    writeln!(
        out,
        ".\n\nTimes are those of collide and relax on the cpu engine: the median sub-step in which a \
         body is near grass, times the sub-steps of a simulated second. Errors are distances of \
         nodes from the reference engine at 30 frames per second, over touched plants on the same \
         side of the bodies; blades of other numbers of segments are compared at equal arc length. \
         The {FLOOR} is the distance of two references that differ in sub-steps (8 and 11 per step \
         of the bodies), sweeps (1/20 and 1/33 of the half thickness) and in how a body of several \
         parts is tested; they share the motion of the bodies, the order of the constraints and the \
         closed forms of simple shapes.\n"
    )
}

fn write_choice(
    report: &Report,
    summary: &[MethodSummary],
    out: &mut impl Write,
) -> io::Result<()> {
    let half_blade_m = report.half_blade_m();
    writeln!(out, "## Which to choose\n")?;
    writeln!(out, "{}\n", verdict_on_default(summary, half_blade_m))?;
    writeln!(
        out,
        "| need | method | ms per s | RMS in the worst scene, mm |\n|---|---|---|---|"
    )?;
    for choice in choices(summary, half_blade_m) {
        match &choice.method {
            Some(m) => writeln!(
                out,
                "| {} | `{}` | {:.1} | {} |",
                choice.need,
                m.method,
                m.mean_ms_per_s,
                mm(m.worst_rms_m)
            )?,
            None => writeln!(out, "| {} | none | | |", choice.need)?,
        }
    }
    for (scene, cheapest) in report.cheapest_by_scene() {
        write!(out, "| cheapest that misses no limit in `{scene}` | ")?;
        match cheapest {
            Some(row) => writeln!(
                out,
                "`{}` | {:.1} | {} there |",
                row.method,
                row.ms_per_s,
                mm(row.rms_m)
            )?,
            None => writeln!(out, "none | | |")?,
        }
    }
    writeln!(out)
}

fn write_summary(summary: &[MethodSummary], out: &mut impl Write) -> io::Result<()> {
    let scenes = summary.first().map_or(0, |m| m.scenes);
    writeln!(
        out,
        "## Every method over {scenes} scenes\n\n\
         | method | what it is | ms per s | mean RMS, mm | worst RMS, mm | in | limits missed |\n\
         |---|---|---|---|---|---|---|"
    )?;
    for m in summary {
        let what = method(&m.method).map_or("", |method| method.what);
        // A bar would end the cell.
        let what = what.replace('|', "\\|");
        writeln!(
            out,
            "| `{}` | {what} | {:.1} | {} | {} | {} | {} |",
            m.method,
            m.mean_ms_per_s,
            mm(m.mean_rms_m),
            mm(m.worst_rms_m),
            m.worst_scene,
            m.misses_in_words()
        )?;
    }
    writeln!(out)
}

fn write_split(summary: &[MethodSummary], out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "## Where the error comes from\n\n\
         Root mean square over these scenes. An empty rounding: the passes of the device do not \
         know the method, or there is no adapter.\n\n\
         | method | rounding (gpu − cpu), mm | precision (f32 − f64), mm | \
         method (f64 − reference), mm |\n|---|---|---|---|"
    )?;
    for m in summary {
        let parts = [m.rounding_m, m.precision_m, m.method_m].map(small_mm);
        let [rounding, precision, of_method] = parts;
        writeln!(
            out,
            "| `{}` | {rounding} | {precision} | {of_method} |",
            m.method
        )?;
    }
    writeln!(out)
}

fn write_cost(report: &Report, out: &mut impl Write) -> io::Result<()> {
    let equal: Vec<&CostRow> = report
        .cost
        .iter()
        .filter(|row| row.at_equal_steps)
        .collect();
    let literal = equal.iter().find(|row| row.method == LITERAL);
    let Some(literal) = literal else {
        return Ok(());
    };
    let scene = report
        .scenes
        .iter()
        .find(|scene| scene.name == super::COST_SCENE);
    writeln!(
        out,
        "## What accuracy costs in `{}`\n\n\
         One run, the methods in turns, sub-step by sub-step. `{LITERAL}` is O09 as printed; each of \
         the others but the default has one of its parts in place of the default's, so that the \
         distance to the default's row is what that part buys.\n\n\
         | method | ms per sub-step | over `{LITERAL}` | RMS, mm | penetration max / 99.9%, mm | \
         strain | limits missed |\n|---|---|---|---|---|---|---|",
        super::COST_SCENE
    )?;
    for row in &equal {
        let point = scene.and_then(|s| s.rows.iter().find(|point| point.method == row.method));
        writeln!(
            out,
            "| `{}` | {:.3} | {:.2} | {} |",
            row.method,
            row.ms_per_substep,
            row.ms_per_substep / literal.ms_per_substep,
            point.map_or_else(|| " | | |".into(), bought)
        )?;
    }
    if let Some(default) = equal.iter().find(|row| row.method == DEFAULT) {
        let times = default.ms_per_substep / literal.ms_per_substep;
        let verdict = if times <= MOST_TIMES_LITERAL {
            "within"
        } else {
            "above"
        };
        writeln!(
            out,
            "\nA default sub-step costs {times:.2} times a literal one, {verdict} the limit of \
             {MOST_TIMES_LITERAL}."
        )?;
        let own = report.cost.iter().find(|row| !row.at_equal_steps);
        if let Some(own) = own {
            writeln!(
                out,
                "Per simulated second at their own rates: the default at {:.0} Hz {:.1} ms, \
                 `{LITERAL}` at {:.0} Hz (a sub-step per displayed frame) {:.1} ms.",
                default.hz,
                default.ms_per_s(),
                own.hz,
                own.ms_per_s()
            )?;
        }
    }
    writeln!(out)
}

fn bought(row: &Row) -> String {
    format!(
        "{} | {:.2} / {:.2} | {:.4} | {}",
        mm(row.rms_m),
        row.penetration_max_m * 1e3,
        row.penetration_p999_m * 1e3,
        row.strain,
        row.misses().join(", ")
    )
}

fn write_scene(scene: &SceneReport, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "## `{}`: {}\n\n\
         Noise floor {} mm; {} plants touched; half a blade's width {:.1} mm. Penetration by true \
         shape.\n\n\
         | method | ms per s | RMS, mm | 95%, mm | RMS, L | 95%, L | imprint IoU | other side | \
         penetration max / 99.9% / RMS, mm | middles, mm | over-push, mm | strain | limits missed |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|",
        scene.name,
        scene.what,
        mm(scene.floor.rms_m),
        scene.floor.touched_plants,
        scene.half_blade_m * 1e3
    )?;
    for row in &scene.rows {
        writeln!(
            out,
            "| `{}` | {:.1} | {} | {} | {} | {} | {} | {} of {} | {:.2} / {:.2} / {:.3} | {:.2} | \
             {:.1} | {:.4} | {} |",
            row.method,
            row.ms_per_s,
            mm(row.rms_m),
            mm(row.p95_m),
            share(row.rms_lengths),
            share(row.p95_lengths),
            share(row.imprint_iou),
            row.side_flips,
            row.touched_plants,
            row.penetration_max_m * 1e3,
            row.penetration_p999_m * 1e3,
            row.penetration_rms_m * 1e3,
            row.penetration_middle_m * 1e3,
            row.over_push_m * 1e3,
            row.strain,
            row.misses().join(", ")
        )?;
    }
    if scene.floor.rms_m.is_some_and(|floor| floor > MOST_RMS_M) {
        writeln!(
            out,
            "\nThe two references are farther apart than the limit of poses: what this scene says of \
             poses and sides is no verdict on a method."
        )?;
    }
    for out_of in &scene.left_out {
        writeln!(
            out,
            "\nLeft out: `{}`, since {}.",
            out_of.method, out_of.why
        )?;
    }
    writeln!(out)
}

fn mm(metres: Option<f64>) -> String {
    metres.map_or_else(|| "not finite".into(), |m| format!("{:.2}", m * 1e3))
}

/// A length that may be as small as rounding; empty where it was not measured.
fn small_mm(metres: Option<f64>) -> String {
    metres.map_or_else(String::new, |m| format!("{:.1e}", m * 1e3))
}

fn share(value: Option<f64>) -> String {
    value.map_or_else(|| "–".into(), |v| format!("{v:.3}"))
}
