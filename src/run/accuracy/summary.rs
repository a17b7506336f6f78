//! Every method over all scenes, and which one to choose.

use std::collections::BTreeMap;

use super::{Report, Row};
use crate::run::methods::DEFAULT;

/// Share of a displayed frame that grass may cost on the processor: a quarter of real time.
pub const BUDGET_MS_PER_S: f64 = 250.0;

/// A method over the scenes that it was run on.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodSummary {
    pub method: String,
    pub family: String,
    pub scenes: usize,
    /// Mean over the scenes, in metres; `None` if it is not finite in one of them.
    pub mean_rms_m: Option<f64>,
    /// Of the worst scene.
    pub worst_rms_m: Option<f64>,
    pub worst_scene: String,
    pub mean_ms_per_s: f64,
    /// Limits missed, each with the number of scenes.
    pub misses: BTreeMap<&'static str, usize>,
    /// Root mean square over the scenes of the three parts of the error, in metres.
    pub rounding_m: Option<f64>,
    pub precision_m: Option<f64>,
    pub method_m: Option<f64>,
}

impl MethodSummary {
    fn of(rows: &[&Row]) -> Self {
        let first = rows.first().copied().cloned().unwrap_or_default();
        let errors: Option<Vec<f64>> = rows.iter().map(|row| row.rms_m).collect();
        let worst = rows.iter().max_by(|a, b| {
            let error = |row: &Row| row.rms_m.unwrap_or(f64::INFINITY);
            error(a).total_cmp(&error(b))
        });
        let mut misses = BTreeMap::new();
        for what in rows.iter().flat_map(|row| row.misses()) {
            *misses.entry(what).or_default() += 1;
        }
        Self {
            method: first.method,
            family: first.family,
            scenes: rows.len(),
            mean_rms_m: errors.as_deref().map(mean),
            worst_rms_m: worst.and_then(|row| row.rms_m),
            worst_scene: worst.map(|row| row.scene.clone()).unwrap_or_default(),
            mean_ms_per_s: mean(&rows.iter().map(|row| row.ms_per_s).collect::<Vec<_>>()),
            misses,
            rounding_m: root_mean_square(rows, |row| row.rounding_rms_m),
            precision_m: root_mean_square(rows, |row| row.precision_rms_m),
            method_m: root_mean_square(rows, |row| row.method_rms_m),
        }
    }

    /// The limits missed, in words.
    pub fn misses_in_words(&self) -> String {
        let words = |(what, scenes): (&&str, &usize)| format!("{what} in {scenes}");
        let all: Vec<String> = self.misses.iter().map(words).collect();
        all.join(", ")
    }

    /// Left of a line in the plot in every scene, with no limit missed.
    pub fn is_within(&self, rms_m: f64) -> bool {
        self.misses.is_empty() && self.worst_rms_m.is_some_and(|rms| rms <= rms_m)
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |sum, v| sum + v) / values.len().max(1) as f64
}

fn root_mean_square(rows: &[&Row], part: impl Fn(&Row) -> Option<f64>) -> Option<f64> {
    let squares: Vec<f64> = rows
        .iter()
        .filter_map(|row| part(row))
        .map(|e| e * e)
        .collect();
    (!squares.is_empty()).then(|| mean(&squares).sqrt())
}

impl Report {
    /// Every method in the order of the list, over the scenes where all were run. Scenes that
    /// were run with few methods would favour those.
    pub fn summary(&self) -> Vec<MethodSummary> {
        let most = self.scenes.iter().map(|s| s.rows.len()).max().unwrap_or(0);
        let whole: Vec<_> = self
            .scenes
            .iter()
            .filter(|s| s.rows.len() == most)
            .collect();
        let Some(first) = whole.first() else {
            return Vec::new();
        };
        let of_method = |name: &str| -> Vec<&Row> {
            let rows = whole.iter().flat_map(|scene| &scene.rows);
            rows.filter(|row| row.method == name).collect()
        };
        let names = first.rows.iter().map(|row| &row.method);
        names
            .map(|name| MethodSummary::of(&of_method(name)))
            .collect()
    }

    /// The cheapest point of each scene that misses no limit.
    pub fn cheapest_by_scene(&self) -> Vec<(&str, Option<&Row>)> {
        let mut found: Vec<(&str, Option<&Row>)> = Vec::new();
        for scene in &self.scenes {
            let fit = scene.rows.iter().filter(|row| row.misses().is_empty());
            let cheapest = fit.min_by(|a, b| a.ms_per_s.total_cmp(&b.ms_per_s));
            found.push((&scene.name, cheapest));
        }
        found
    }

    /// Half the width of a blade, the narrowest of all scenes, in metres.
    pub fn half_blade_m(&self) -> f64 {
        let halves = self.scenes.iter().map(|scene| scene.half_blade_m);
        halves.reduce(f64::min).unwrap_or(0.0)
    }

    /// The largest noise floor of the scenes, in metres.
    pub fn floor_m(&self) -> Option<f64> {
        let floors = self.scenes.iter().filter_map(|scene| scene.floor.rms_m);
        floors.reduce(f64::max)
    }
}

/// A need, and the method that serves it best.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    pub need: &'static str,
    /// `None` if no method does.
    pub method: Option<MethodSummary>,
}

/// Which method to choose for which need.
pub fn choices(summary: &[MethodSummary], half_blade_m: f64) -> Vec<Choice> {
    let cheapest = |within_m: f64| {
        let fit = summary.iter().filter(move |m| m.is_within(within_m));
        fit.min_by(|a, b| a.mean_ms_per_s.total_cmp(&b.mean_ms_per_s))
    };
    let nearest = |needs_limits: bool| {
        let fit = summary
            .iter()
            .filter(|m| m.misses.is_empty() || !needs_limits)
            .filter_map(|m| Some((m, m.mean_rms_m?)));
        let nearest = fit.min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.map(|found| found.0)
    };
    [
        ("cheapest that misses no limit", cheapest(f64::INFINITY)),
        (
            "cheapest within half a blade's width in every scene",
            cheapest(half_blade_m),
        ),
        (
            "nearest to the reference that misses no limit",
            nearest(true),
        ),
        ("nearest to the reference, limits aside", nearest(false)),
    ]
    .map(|(need, method)| Choice {
        need,
        method: method.cloned(),
    })
    .into()
}

/// What the default is, against the cheapest method that misses no limit.
pub fn verdict_on_default(summary: &[MethodSummary], half_blade_m: f64) -> String {
    let Some(default) = summary.iter().find(|m| m.method == DEFAULT) else {
        return "The default was not measured.".into();
    };
    let about = |m: &MethodSummary| {
        let rms_mm = m.worst_rms_m.unwrap_or(f64::INFINITY) * 1e3;
        format!(
            "{:.1} ms per simulated second, {rms_mm:.2} mm in its worst scene",
            m.mean_ms_per_s
        )
    };
    let line = if default.is_within(half_blade_m) {
        format!("half a blade's width ({:.1} mm)", half_blade_m * 1e3)
    } else {
        let limit_mm = super::measure::MOST_RMS_M * 1e3;
        format!(
            "the limit of {limit_mm:.0} mm, but not of half a blade's width ({:.1} mm)",
            half_blade_m * 1e3
        )
    };
    if !default.misses.is_empty() {
        return format!(
            "The default misses a limit in some of the {} scenes: {} ({}).",
            default.scenes,
            default.misses_in_words(),
            about(default)
        );
    }
    let within_m = if default.is_within(half_blade_m) {
        half_blade_m
    } else {
        f64::INFINITY
    };
    let cheaper: Vec<String> = summary
        .iter()
        .filter(|m| m.is_within(within_m) && m.mean_ms_per_s < default.mean_ms_per_s)
        .map(|m| format!("`{}` ({})", m.method, about(m)))
        .collect();
    if cheaper.is_empty() {
        format!(
            "The default ({}) is the cheapest left of {line}.",
            about(default)
        )
    } else {
        format!(
            "The default ({}) is left of {line}. These are cheaper and miss no limit in these \
             scenes either: {}.",
            about(default),
            cheaper.join("; ")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(scene: &str, method: &str, rms_m: f64, ms_per_s: f64) -> Row {
        Row {
            scene: scene.into(),
            method: method.into(),
            rms_m: Some(rms_m),
            touched_plants: 100,
            ms_per_s,
            ..Row::default()
        }
    }

    #[test]
    fn the_worst_scene_decides_and_a_missed_limit_rules_out() {
        let good = [
            row("a", DEFAULT, 0.001, 20.0),
            row("b", DEFAULT, 0.003, 40.0),
        ];
        let cheap = [row("a", "cheap", 0.001, 1.0), row("b", "cheap", 0.02, 1.0)];
        let summary: Vec<_> = [&good, &cheap]
            .map(|rows| MethodSummary::of(&rows.iter().collect::<Vec<_>>()))
            .into();
        assert_eq!(summary[0].worst_rms_m, Some(0.003));
        assert_eq!(summary[0].mean_ms_per_s, 30.0);
        assert_eq!(summary[1].misses_in_words(), "poses in 1");
        let choices = choices(&summary, 0.0035);
        let chosen = |n: usize| choices[n].method.as_ref().map(|m| m.method.as_str());
        assert_eq!([0, 1, 2, 3].map(chosen), [Some(DEFAULT); 4]);
        assert!(verdict_on_default(&summary, 0.0035).contains("is the cheapest left of half"));
    }

    #[test]
    fn what_is_cheaper_is_named() {
        let rows = [
            row("a", DEFAULT, 0.001, 20.0),
            row("a", "other", 0.001, 10.0),
        ];
        let summary: Vec<_> = rows.iter().map(|row| MethodSummary::of(&[row])).collect();
        assert!(verdict_on_default(&summary, 0.0035).contains("`other`"));
    }
}
