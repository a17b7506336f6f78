//! The report in Markdown.

use std::io::{self, Write};

use super::cost::LITERAL;
use super::measure::{MOST_FLIPS, MOST_RMS_M, MOST_STRAIN};
use super::summary::{
    BUDGET_MS_PER_S, Cheapest, MethodSummary, choices, quoted, verdict_on_default,
};
use super::{CostRow, FLOOR, Relative, Report, Row, SceneReport};
use crate::run::methods::{DEFAULT, method};

mod words;
use words::{mm, mm_of_limit, ms, share, small_mm, times};

/// A default sub-step may cost this many times a literal one.
const MOST_TIMES_LITERAL: f64 = 4.0;

/// Writes the whole report; `plots` tells that they lie beside it.
///
/// # Errors
///
/// The writer's.
pub fn write_markdown(report: &Report, plots: bool, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "# Accuracy and cost of the methods\n")?;
    write_machine(report, out)?;
    write_how_to_read(out)?;
    let summary = report.summary();
    write_choice(report, &summary, out)?;
    write_summary(report, &summary, plots, out)?;
    write_split(report, &summary, out)?;
    write_cost(report, out)?;
    if let Some(independent) = &report.independent {
        independent.write(out)?;
    }
    if let Some(blades) = &report.blades {
        blades.write(out)?;
    }
    if let Some(shapes) = &report.shapes {
        shapes.write(out)?;
    }
    for scene in &report.scenes {
        write_scene(scene, plots, out)?;
    }
    Ok(())
}

fn write_machine(report: &Report, out: &mut impl Write) -> io::Result<()> {
    let machine = &report.machine;
    let cpu = machine.cpu.as_deref().unwrap_or("an unknown processor");
    let threads = machine.threads;
    let version = env!("CARGO_PKG_VERSION");
    write!(out, "sward {version}, {cpu}, {threads} threads")?;
    if let Some(load) = machine.load_average {
        write!(out, ", load average {load:.1} at the start")?;
    }
    match &report.adapter {
        Some(adapter) => writeln!(
            out,
            "; rounding on {} ({}).\n",
            adapter.name, adapter.driver
        ),
        None => writeln!(
            out,
            "; without a graphics adapter, so rounding is not measured.\n"
        ),
    }
}

fn write_how_to_read(out: &mut impl Write) -> io::Result<()> {
    let (rms_mm, flips, strain) = (MOST_RMS_M * 1e3, MOST_FLIPS * 100.0, MOST_STRAIN * 100.0);
    writeln!(
        out,
        "## How to read it\n\n\
         - **A method** is a setting of `solver` by name; `sward report accuracy --list` says what \
         each is, and `sward run SCENE --method NAME` runs it.\n\
         - **Times** are those of collide and relax on the cpu engine while a body is near grass. A \
         method and the default run in turns, frame by frame; *times the default* is the median of \
         their ratio, and the range behind it what that is known to (the notch of a box plot). \
         Methods whose ranges overlap count as equally cheap. Milliseconds per simulated second \
         are that ratio times what the default took when it was least disturbed; the frame budget \
         is {BUDGET_MS_PER_S}, a quarter of real time.\n\
         - **RMS** and **95%** are distances of nodes from the reference engine's, at 30 frames per \
         second, over touched plants on the same side of the bodies; *other side* counts the rest. \
         Blades of other numbers of segments are compared at equal arc length. L is a blade's \
         length, and *imprint* the overlap of the plants that lean more than 30°.\n\
         - **Limits**: poses {rms_mm} mm RMS; sides {flips}% of the touched plants; strain {strain}%; \
         penetration, by the true shape, one texel of a depth cube or 1 mm of a closed form; every \
         value finite.\n\
         - **The {FLOOR}** is the distance of two references that differ in sub-steps (8 and 11 per \
         step of the bodies), sweeps (1/20 and 1/33 of the half thickness) and in how a body of \
         several parts is tested; they share the motion of the bodies, the order of the constraints \
         and the closed forms of simple shapes. Where it is above the limit of poses, the scene \
         judges neither poses nor sides.\n"
    )
}

fn write_choice(
    report: &Report,
    summary: &[MethodSummary],
    out: &mut impl Write,
) -> io::Result<()> {
    let half_blade_m = report.half_blade_m();
    let blurred = names_of_blurred(&report.whole_scenes());
    let not_judged = if blurred.is_empty() {
        String::new()
    } else {
        format!(
            " Poses and sides of {blurred} are not judged: two references are farther apart there than \
             the limit."
        )
    };
    writeln!(
        out,
        "## Which to choose\n\n{}{not_judged}\n\n\
         | need | method | times the default | ms per s | worst RMS, mm | limits missed | as cheap, \
         for all that is known |\n|---|---|---|---|---|---|---|",
        verdict_on_default(summary, half_blade_m)
    )?;
    for choice in choices(summary, half_blade_m) {
        write!(out, "| {} | ", choice.need)?;
        match choice.found {
            Some(Cheapest { best, as_cheap }) => writeln!(
                out,
                "`{}` | {} | {:.0} | {} in `{}` | {} | {} |",
                best.method,
                times(best.relative),
                best.mean_ms_per_s,
                mm(best.worst_rms_m),
                best.worst_scene,
                best.misses_in_words(),
                quoted(as_cheap.iter().map(|m| m.method.as_str()))
            )?,
            None => writeln!(out, "none | | | | | |")?,
        }
    }
    let by_scene = report.cheapest_by_scene();
    // Of a single scene it would be said twice.
    for (scene, cheapest) in by_scene.into_iter().filter(|_| report.scenes.len() > 1) {
        write!(
            out,
            "| cheapest that misses no limit in `{}` | ",
            scene.name
        )?;
        match cheapest {
            Some(Cheapest { best, as_cheap }) => writeln!(
                out,
                "`{}` | {} | {} | {} | | {} |",
                best.method,
                times(best.relative()),
                ms(scene.ms_per_s(best)),
                mm_of_limit(best, &scene.floor),
                quoted(as_cheap.iter().map(|row| row.method.as_str()))
            )?,
            None => writeln!(out, "none | | | | | |")?,
        }
    }
    writeln!(out)
}

/// The scenes whose references are too far apart to judge poses and sides, in words.
fn names_of_blurred(scenes: &[&SceneReport]) -> String {
    let blurred = scenes.iter().filter(|scene| !scene.floor.judges_poses());
    quoted(blurred.map(|scene| scene.name.as_str()))
}

fn write_summary(
    report: &Report,
    summary: &[MethodSummary],
    plots: bool,
    out: &mut impl Write,
) -> io::Result<()> {
    let whole = report.whole_scenes();
    let blurred = names_of_blurred(&whole);
    let names = quoted(whole.iter().map(|scene| scene.name.as_str()));
    write!(out, "## Every method\n\nOver {names}.")?;
    if !blurred.is_empty() {
        write!(
            out,
            " Errors leave out {blurred}: two references are farther apart there than the limit."
        )?;
    }
    if plots {
        write!(out, "\n\n![Error and time of every method](all-scenes.svg)")?;
    }
    writeln!(
        out,
        "\n\n| method | what it is | times the default | ms per s | mean RMS, mm | worst RMS, mm | in \
         | limits missed |\n|---|---|---|---|---|---|---|---|"
    )?;
    for m in summary {
        let what = method(&m.method).map_or("", |method| method.what);
        // A bar would end the cell.
        let what = what.replace('|', "\\|");
        writeln!(
            out,
            "| `{}` | {what} | {} | {:.0} | {} | {} | {} | {} |",
            m.method,
            times(m.relative),
            m.mean_ms_per_s,
            mm(m.mean_rms_m),
            mm(m.worst_rms_m),
            m.worst_scene,
            m.misses_in_words()
        )?;
    }
    writeln!(out)
}

fn write_split(report: &Report, summary: &[MethodSummary], out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "## Where the error comes from\n\n\
         Root mean square over these scenes, in millimetres. Rounding is the gpu engine against the \
         cpu engine, precision the cpu engine in `f32` against `f64`, and the method's own error that \
         of `f64` against the reference. The three do not add up to the whole error: they are lengths \
         of differences that may point anywhere. The quick form splits the error of \
         few methods. An empty rounding: the passes of the device do not know the method, or there is \
         no adapter.\n\n\
         | method | rounding (gpu − cpu) | precision (f32 − f64) | method (f64 − reference) |\n\
         |---|---|---|---|"
    )?;
    for m in summary.iter().filter(|m| m.precision_m.is_some()) {
        let parts = [m.rounding_m, m.precision_m, m.method_m].map(small_mm);
        let [rounding, precision, of_method] = parts;
        writeln!(
            out,
            "| `{}` | {rounding} | {precision} | {of_method} |",
            m.method
        )?;
    }
    writeln!(out)?;
    let rows = report.scenes.iter().flat_map(|scene| &scene.rows);
    for row in rows.filter(|row| !row.rounding_refused.is_empty()) {
        let (method, scene, why) = (&row.method, &row.scene, &row.rounding_refused);
        writeln!(
            out,
            "Without the rounding of `{method}` in `{scene}`: {why}.\n"
        )?;
    }
    Ok(())
}

fn write_cost(report: &Report, out: &mut impl Write) -> io::Result<()> {
    let rows = report.cost.iter();
    let equal: Vec<&CostRow> = rows.filter(|row| row.at_equal_steps).collect();
    if !equal.iter().any(|row| row.method == LITERAL) {
        return Ok(());
    }
    let mut scenes = report.scenes.iter();
    let scene = scenes.find(|scene| scene.name == super::COST_SCENE);
    writeln!(
        out,
        "## What accuracy costs in `{}`\n\n\
         One run, the methods in turns, sub-step by sub-step. `{LITERAL}` is O09 as printed; each of \
         the others but the default has one of its parts in place of the default's, so that the \
         distance to the default's row is what that part buys.\n\n\
         | method | ms per sub-step | times `{LITERAL}` | RMS, mm | penetration max / 99.9%, mm | \
         strain | limits missed |\n|---|---|---|---|---|---|---|",
        super::COST_SCENE
    )?;
    for row in &equal {
        let of_method = |point: &&Row| point.method == row.method;
        let point = scene.and_then(|s| Some((s, s.rows.iter().find(of_method)?)));
        writeln!(
            out,
            "| `{}` | {:.3} | {} | {} |",
            row.method,
            row.ms_per_substep,
            times(row.over_literal),
            point.map_or_else(|| " | | |".into(), |(scene, point)| bought(scene, point))
        )?;
    }
    if let Some(default) = equal.iter().find(|row| row.method == DEFAULT) {
        write_times_literal(report, default, out)?;
    }
    writeln!(out)
}

fn write_times_literal(report: &Report, default: &CostRow, out: &mut impl Write) -> io::Result<()> {
    if let Some(ratio) = default.over_literal {
        let verdict = match ratio {
            Relative { high, .. } if high <= MOST_TIMES_LITERAL => "within",
            Relative { low, .. } if low > MOST_TIMES_LITERAL => "above",
            _ => "which cannot be told from",
        };
        writeln!(
            out,
            "\nA default sub-step costs {} times a literal one, {verdict} the limit of \
             {MOST_TIMES_LITERAL}.",
            times(Some(ratio))
        )?;
    }
    let Some(own) = report.cost.iter().find(|row| !row.at_equal_steps) else {
        return Ok(());
    };
    writeln!(
        out,
        "Per simulated second at their own rates: the default at {:.0} Hz {:.0} ms, `{LITERAL}` at \
         {:.0} Hz (a sub-step per displayed frame) {:.0} ms.",
        default.hz,
        default.ms_per_s(),
        own.hz,
        own.ms_per_s()
    )
}

fn bought(scene: &SceneReport, row: &Row) -> String {
    format!(
        "{} | {:.2} / {:.2} | {:.4} | {}",
        mm(row.rms_m),
        row.penetration_max_m * 1e3,
        row.penetration_p999_m * 1e3,
        row.strain,
        scene.misses(row).join(", ")
    )
}

fn write_scene(scene: &SceneReport, plots: bool, out: &mut impl Write) -> io::Result<()> {
    let name = &scene.name;
    writeln!(
        out,
        "## `{name}`: {}\n\n\
         The {FLOOR} is {} mm; {} plants touched; half a blade's width {:.1} mm.",
        scene.what,
        mm(scene.floor.rms_m),
        scene.floor.touched_plants,
        scene.half_blade_m * 1e3
    )?;
    if !scene.floor.judges_poses() {
        writeln!(
            out,
            "\n**The two references are farther apart than the limit of poses: what this scene says \
             of poses and sides is no verdict on a method.**"
        )?;
    }
    if plots {
        writeln!(out, "\n![Error and time in {name}](<{name}.svg>)")?;
    }
    writeln!(
        out,
        "\n| method | times the default | ms per s | RMS, mm | 95%, mm | RMS, L | 95%, L | imprint | \
         other side | penetration max / 99.9% / RMS, mm | of middles, mm | over-push, mm | strain | \
         limits missed |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
    )?;
    for row in &scene.rows {
        write_row(scene, row, out)?;
    }
    for (method, clamp) in &scene.clamps {
        writeln!(out, "\nSprings of `{method}`: {}.", clamp.words())?;
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

fn write_row(scene: &SceneReport, row: &Row, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "| `{}` | {} | {} | {} | {} | {} | {} | {} | {} of {} | {:.2} / {:.2} / {:.3} | {:.2} | {:.1} | \
         {:.4} | {} |",
        row.method,
        times(row.relative()),
        ms(scene.ms_per_s(row)),
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
        scene.misses(row).join(", ")
    )
}
