//! The report as text for people.

use std::collections::BTreeMap;
use std::io::{self, Write};

use super::against::AgainstReference;
use super::report::{Collider, Expectation, Metrics, Report, Scenario};

/// Most bodies of a kind of collider that are named in a row.
const BODIES_NAMED: usize = 8;

/// Writes the whole report.
///
/// # Errors
///
/// The writer's.
pub fn write_table(report: &Report, out: &mut impl Write) -> io::Result<()> {
    for scenario in &report.scenarios {
        write_scenario(scenario, out)?;
    }
    write_count(report, out)
}

/// Writes how many scenarios passed, and on what.
///
/// # Errors
///
/// The writer's.
pub fn write_count(report: &Report, out: &mut impl Write) -> io::Result<()> {
    let passed = report.scenarios.iter().filter(|s| s.passed).count();
    let engine = report.engine;
    write!(
        out,
        "{passed} of {} scenarios passed, {engine} engine",
        report.scenarios.len()
    )?;
    match &report.adapter {
        Some(adapter) => writeln!(out, " on {} ({})", adapter.name, adapter.driver),
        None => writeln!(out),
    }
}

/// Writes what came of one scenario.
///
/// # Errors
///
/// The writer's.
pub fn write_scenario(scenario: &Scenario, out: &mut impl Write) -> io::Result<()> {
    if let Some(error) = &scenario.error {
        return writeln!(out, "{}: NOT RUN\n  {error}\n", scenario.name);
    }
    let verdict = if scenario.passed { "passed" } else { "FAILED" };
    writeln!(
        out,
        "{}: {verdict}, {:.2} s simulated in {:.2} s, {} sub-steps",
        scenario.name, scenario.seconds_simulated, scenario.wall_s, scenario.ticks
    )?;
    for expectation in &scenario.expectations {
        write_expectation(expectation, out)?;
    }
    write_metrics(&scenario.metrics, out)?;
    if let Some(against) = &scenario.against_reference {
        write_against(against, out)?;
    }
    for kind in colliders(&scenario.colliders) {
        writeln!(out, "  collider     {kind}")?;
    }
    if let Some(clamp) = &scenario.literal_springs {
        writeln!(out, "  springs      literal: {}", clamp.words())?;
    }
    let passes = scenario.pass_ms.iter();
    write_list(
        out,
        "median ms",
        passes.map(|(pass, ms)| format!("{pass} {ms:.3}")),
    )?;
    if let Some(hash) = &scenario.state_hash {
        writeln!(out, "  state hash   {hash}")?;
    }
    writeln!(out)
}

fn write_expectation(expectation: &Expectation, out: &mut impl Write) -> io::Result<()> {
    let verdict = match expectation.passed {
        Some(true) => "ok  ",
        Some(false) => "FAIL",
        None => "n/a ",
    };
    write!(out, "  {verdict}  ")?;
    if let Some(at) = expectation.at {
        write!(out, "at {at} s: ")?;
    }
    write!(out, "{}", expectation.what)?;
    if let Some(limit) = expectation.limit {
        write!(out, " [{}]", with_unit(limit, expectation.unit))?;
    }
    if let Some(measured) = expectation.measured {
        write!(out, ": {}", with_unit(measured, expectation.unit))?;
    }
    if let Some(reason) = &expectation.reason {
        write!(out, " ({reason})")?;
    }
    writeln!(out)
}

/// The verdict on the distance from the reference, and what it rests on.
fn write_against(against: &AgainstReference, out: &mut impl Write) -> io::Result<()> {
    let verdict = match against.within_limits {
        Some(true) => "within its limits",
        Some(false) => "OVER a limit",
        None => "no verdict",
    };
    writeln!(out, "  reference    {verdict}:")?;
    for limit in &against.limits {
        write_expectation(limit, out)?;
    }
    Ok(())
}

fn write_metrics(metrics: &Metrics, out: &mut impl Write) -> io::Result<()> {
    let mm = |m: f64| format!("{:.3} mm", m * 1e3);
    writeln!(
        out,
        "  penetration  {} at most, {} for 99.9%, {} rms; {} not pushed; {} for middles of segments; over-push {}; \
         {} pinched, {} plants buried",
        mm(metrics.max_penetration_m),
        mm(metrics.p999_penetration_m),
        mm(metrics.rms_penetration_m),
        mm(metrics.max_missed_penetration_m),
        mm(metrics.max_middle_penetration_m),
        mm(metrics.over_push_m),
        metrics.pinched_vertices,
        metrics.buried_plants
    )?;
    writeln!(
        out,
        "  shape        strain {:.2}% at most, offset {:.3} m at most{}",
        metrics.max_length_strain * 100.0,
        metrics.max_offset_m,
        metrics
            .jitter_m_per_frame
            .map_or(String::new(), |j| format!(", jitter {} a frame", mm(j)))
    )?;
    let seconds = |s: Option<f64>| s.map_or("-".into(), |s| format!("{s:.3} s"));
    let [half, tenth, hundredth] = metrics.tip_recovery_s.map(seconds);
    writeln!(
        out,
        "  recovery     half {}, tenth {}, hundredth {}; tip {half}, {tenth}, {hundredth}",
        seconds(metrics.recovery_half_s),
        seconds(metrics.recovery_tenth_s),
        seconds(metrics.recovery_hundredth_s)
    )?;
    if let (Some(rms), Some(p95), Some(flips), Some(plants)) = (
        metrics.pose_rms_m,
        metrics.pose_p95_m,
        metrics.side_flips,
        metrics.compared_plants,
    ) {
        let overlap = metrics
            .imprint_iou
            .map_or("-".into(), |o| format!("{o:.4}"));
        writeln!(
            out,
            "  reference    {} rms, {} for 95%, imprint overlap {overlap}, {flips} of {plants} plants \
             on another side",
            mm(rms),
            mm(p95)
        )?;
    }
    writeln!(
        out,
        "  peak         {} of {} tiles, {} plants, {} bytes of state",
        metrics.tiles_active_peak,
        metrics.tiles_total,
        metrics.plants_simulated_peak,
        metrics.state_bytes_peak
    )?;
    if metrics.billboards > 0 {
        writeln!(out, "  billboards   {}", metrics.billboards)?;
    }
    for (count, what) in [
        (metrics.nan_count, "values that are not finite"),
        (
            metrics.capped_sweeps,
            "sub-steps in which a body needed more sweeps than allowed",
        ),
        (
            metrics.refused_tiles,
            "tiles that could not wake for want of state",
        ),
    ] {
        if count > 0 {
            writeln!(out, "  LIMIT        {count} {what}")?;
        }
    }
    write_list(out, "quarantined", metrics.quarantined.iter().cloned())
}

/// The bodies by what they were tested by; a kind with many bodies is only counted.
fn colliders(colliders: &[Collider]) -> Vec<String> {
    let mut by_kind: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for collider in colliders {
        by_kind
            .entry(kind(collider))
            .or_default()
            .push(&collider.body);
    }
    let told = by_kind.iter().map(|(kind, bodies)| match bodies.len() {
        1..=BODIES_NAMED => format!("{kind}: {}", bodies.join(", ")),
        count => format!("{kind}: {count} bodies"),
    });
    told.collect()
}

fn kind(collider: &Collider) -> String {
    let times = |count, by: &str| match count {
        0 => None,
        1 => Some(by.to_owned()),
        n => Some(format!("{n} × {by}")),
    };
    let parts = [
        times(collider.cube_parts, "cube"),
        times(collider.analytic_parts, "analytic"),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join(" + ")
}

fn write_list(
    out: &mut impl Write,
    title: &str,
    items: impl Iterator<Item = String>,
) -> io::Result<()> {
    let items: Vec<String> = items.collect();
    if items.is_empty() {
        return Ok(());
    }
    writeln!(out, "  {title:<11}  {}", items.join(", "))
}

/// A measured value; lengths below a decimetre in millimetres.
fn with_unit(value: f64, unit: &str) -> String {
    match unit {
        "" => number(value),
        "m" if value != 0.0 && value.abs() < 0.1 => format!("{} mm", number(value * 1e3)),
        unit => format!("{} {unit}", number(value)),
    }
}

/// A number with the digits that matter: whole, or four significant ones.
fn number(value: f64) -> String {
    let size = value.abs();
    if value == value.trunc() && size < 1e15 {
        format!("{value}")
    } else if (1e-3..1e4).contains(&size) {
        let decimals = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.3e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::report::tests::sample;

    #[test]
    fn a_report_in_words() {
        let mut text = Vec::new();
        write_table(&sample(), &mut text).expect("a vector takes everything");
        let text = String::from_utf8(text).expect("text");
        assert!(text.contains("ball & roll: FAILED, 4.00 s simulated in 0.50 s, 480 sub-steps"));
        assert!(
            text.contains("FAIL  at 2 s: plants lean at least 40 ° [40 °]: 12.25 °"),
            "{text}"
        );
        assert!(
            text.contains("n/a   the state hash is 00 (only the cpu"),
            "{text}"
        );
        assert!(text.contains("collider     cube: ball"), "{text}");
        assert!(text.contains("gone: NOT RUN\n  no such <file>"), "{text}");
        assert!(
            text.ends_with("0 of 2 scenarios passed, cpu engine\n"),
            "{text}"
        );
    }

    #[test]
    fn short_lengths_are_in_millimetres() {
        assert_eq!(with_unit(0.0, "m"), "0 m");
        assert_eq!(with_unit(0.00471875, "m"), "4.719 mm");
        assert_eq!(with_unit(0.5, "m"), "0.5000 m");
        assert_eq!(with_unit(40.0, "°"), "40 °");
    }

    #[test]
    fn numbers_keep_four_digits() {
        for (value, text) in [
            (0.0, "0"),
            (40.0, "40"),
            (12.25, "12.25"),
            (0.0123, "0.01230"),
            (1.5e-5, "1.500e-5"),
            (123456.7, "1.235e5"),
        ] {
            assert_eq!(number(value), text);
        }
    }
}
