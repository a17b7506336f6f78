//! Every method over all scenes, and which one to choose.

use std::collections::BTreeMap;

use super::relative::Relative;
use super::{Report, Row, SceneReport};
use crate::run::methods::DEFAULT;

/// Share of a displayed frame that grass may cost on the processor: a quarter of real time.
pub const BUDGET_MS_PER_S: f64 = 250.0;

/// A method over the scenes that it was run on. Errors are those of the scenes whose poses are judged.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodSummary {
    pub method: String,
    pub family: String,
    /// Mean over the scenes, in metres; `None` if it is not finite in one of them, or none is judged.
    pub mean_rms_m: Option<f64>,
    /// Of the worst scene.
    pub worst_rms_m: Option<f64>,
    pub worst_scene: String,
    /// Time over that of the default, mean over the scenes.
    pub relative: Option<Relative>,
    pub mean_ms_per_s: f64,
    /// Limits missed, each with the names of the scenes.
    pub misses: BTreeMap<&'static str, Vec<String>>,
    /// Root mean square over all scenes of the three parts of the error, in metres.
    pub rounding_m: Option<f64>,
    pub precision_m: Option<f64>,
    pub method_m: Option<f64>,
}

/// A method's point with the scene it belongs to.
type Point<'a> = (&'a SceneReport, &'a Row);

impl MethodSummary {
    fn of(points: &[Point<'_>]) -> Self {
        let first = points.first().map(|p| p.1.clone()).unwrap_or_default();
        let judged = points.iter().filter(|p| p.0.floor.judges_poses());
        let judged: Vec<&Row> = judged.map(|p| p.1).collect();
        let errors: Option<Vec<f64>> = judged.iter().map(|row| row.rms_m).collect();
        let worst = judged.iter().max_by(|a, b| {
            let error = |row: &Row| row.rms_m.unwrap_or(f64::INFINITY);
            error(a).total_cmp(&error(b))
        });
        let mut misses: BTreeMap<_, Vec<String>> = BTreeMap::new();
        for (scene, row) in points {
            for what in scene.misses(row) {
                misses.entry(what).or_default().push(scene.name.clone());
            }
        }
        let relative: Vec<Relative> = points.iter().filter_map(|p| p.1.relative()).collect();
        let times = points.iter().filter_map(|(scene, row)| scene.ms_per_s(row));
        Self {
            method: first.method,
            family: first.family,
            mean_rms_m: errors.as_deref().and_then(mean),
            worst_rms_m: worst.and_then(|row| row.rms_m),
            worst_scene: worst.map(|row| row.scene.clone()).unwrap_or_default(),
            relative: Relative::mean(&relative),
            mean_ms_per_s: mean(&times.collect::<Vec<_>>()).unwrap_or(0.0),
            misses,
            rounding_m: root_mean_square(points, |row| row.rounding_rms_m),
            precision_m: root_mean_square(points, |row| row.precision_rms_m),
            method_m: root_mean_square(points, |row| row.method_rms_m),
        }
    }

    /// The limits missed and in how many scenes.
    pub fn misses_in_words(&self) -> String {
        let words = |(what, scenes): (&&str, &Vec<String>)| format!("{what} in {}", scenes.len());
        let all: Vec<String> = self.misses.iter().map(words).collect();
        all.join(", ")
    }

    /// The limits missed and in which scenes.
    pub fn misses_by_name(&self) -> String {
        let words = |(what, scenes): (&&str, &Vec<String>)| {
            format!("{what} in {}", quoted(scenes.iter().map(String::as_str)))
        };
        let all: Vec<String> = self.misses.iter().map(words).collect();
        all.join("; ")
    }

    fn limits_missed(&self) -> usize {
        self.misses.values().map(Vec::len).sum()
    }

    /// Left of a line in the plot in every scene, with no limit missed.
    fn is_within(&self, rms_m: f64) -> bool {
        self.misses.is_empty() && self.worst_rms_m.is_some_and(|rms| rms <= rms_m)
    }
}

/// Names in back quotes, with commas between them.
pub fn quoted<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let quoted: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    quoted.join(", ")
}

fn mean(values: &[f64]) -> Option<f64> {
    let sum = values.iter().fold(0.0, |sum, v| sum + v);
    (!values.is_empty()).then(|| sum / values.len() as f64)
}

fn root_mean_square(points: &[Point<'_>], part: impl Fn(&Row) -> Option<f64>) -> Option<f64> {
    let parts = points.iter().filter_map(|p| part(p.1));
    let squares: Vec<f64> = parts.map(|e| e * e).collect();
    mean(&squares).map(f64::sqrt)
}

impl Report {
    /// The scenes where all methods were run: one that was run with few would favour those.
    pub fn whole_scenes(&self) -> Vec<&SceneReport> {
        let most = self.scenes.iter().map(|s| s.rows.len()).max().unwrap_or(0);
        let scenes = self.scenes.iter();
        scenes.filter(|s| s.rows.len() == most).collect()
    }

    /// Every method in the order of the list, over the scenes where all were run.
    pub fn summary(&self) -> Vec<MethodSummary> {
        let whole = self.whole_scenes();
        let Some(first) = whole.first() else {
            return Vec::new();
        };
        let of_method = |name: &str| -> Vec<Point<'_>> {
            let points = whole.iter().flat_map(|&scene| {
                let rows = scene.rows.iter();
                rows.map(move |row| (scene, row))
            });
            points.filter(|(_, row)| row.method == name).collect()
        };
        let names = first.rows.iter().map(|row| &row.method);
        names
            .map(|name| MethodSummary::of(&of_method(name)))
            .collect()
    }

    /// The cheapest point of each scene that misses no limit.
    pub fn cheapest_by_scene(&self) -> Vec<(&SceneReport, Option<Cheapest<'_, Row>>)> {
        let scenes = self.scenes.iter();
        scenes
            .map(|scene| {
                let fit: Vec<_> = scene
                    .rows
                    .iter()
                    .filter(|row| scene.misses(row).is_empty())
                    .filter_map(|row| Some((row, row.relative()?)))
                    .collect();
                (scene, Cheapest::of(&fit))
            })
            .collect()
    }

    /// Half the width of a blade, the narrowest of all scenes, in metres.
    pub fn half_blade_m(&self) -> f64 {
        let halves = self.scenes.iter().map(|scene| scene.half_blade_m);
        halves.reduce(f64::min).unwrap_or(0.0)
    }

    /// The largest noise floor of the scenes whose poses are judged, in metres.
    pub fn floor_m(&self) -> Option<f64> {
        let judged = self.scenes.iter().filter(|s| s.floor.judges_poses());
        let floors = judged.filter_map(|scene| scene.floor.rms_m);
        floors.reduce(f64::max)
    }
}

/// The cheapest of some methods or points, and all others that may be as cheap.
#[derive(Clone, Debug, PartialEq)]
pub struct Cheapest<'a, T> {
    pub best: &'a T,
    pub as_cheap: Vec<&'a T>,
}

impl<'a, T> Cheapest<'a, T> {
    fn of(fit: &[(&'a T, Relative)]) -> Option<Self> {
        let cheapest = fit.iter().enumerate();
        let (at, &(best, time)) =
            cheapest.min_by(|(_, a), (_, b)| a.1.median.total_cmp(&b.1.median))?;
        let others = fit.iter().enumerate().filter(|&(n, _)| n != at);
        let alike = others.filter(|(_, other)| other.1.may_be_as_cheap_as(&time));
        Some(Self {
            best,
            as_cheap: alike.map(|(_, other)| other.0).collect(),
        })
    }
}

/// A need, and the methods that serve it best; `None` if no method does.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice<'a> {
    pub need: String,
    pub found: Option<Cheapest<'a, MethodSummary>>,
}

/// Which method to choose for which need.
pub fn choices(summary: &[MethodSummary], half_blade_m: f64) -> Vec<Choice<'_>> {
    let half_blade_mm = half_blade_m * 1e3;
    let fewest = summary.iter().map(MethodSummary::limits_missed).min();
    let mut choices = vec![
        (
            "cheapest that misses no limit".to_owned(),
            cheapest(summary, |m| m.is_within(f64::INFINITY)),
        ),
        (
            format!("the same, within half a blade's width ({half_blade_mm:.1} mm) in every scene"),
            cheapest(summary, |m| m.is_within(half_blade_m)),
        ),
        (
            "nearest to the reference that misses no limit".to_owned(),
            nearest(summary, |m| m.misses.is_empty()),
        ),
        (
            "nearest to the reference, limits aside".to_owned(),
            nearest(summary, |_| true),
        ),
        (
            format!(
                "nearest to the reference in the frame budget of {BUDGET_MS_PER_S} ms per s, \
                 limits aside"
            ),
            nearest(summary, |m| m.mean_ms_per_s <= BUDGET_MS_PER_S),
        ),
    ];
    if fewest.is_some_and(|fewest| fewest > 0) {
        let need = "no method misses none; cheapest of those that miss the fewest".to_owned();
        let found = cheapest(summary, |m| Some(m.limits_missed()) == fewest);
        choices.insert(1, (need, found));
    }
    let choice = |(need, found)| Choice { need, found };
    choices.into_iter().map(choice).collect()
}

fn cheapest(
    summary: &[MethodSummary],
    fits: impl Fn(&MethodSummary) -> bool,
) -> Option<Cheapest<'_, MethodSummary>> {
    let fit = summary.iter().filter(|m| fits(m));
    let fit: Vec<_> = fit.filter_map(|m| Some((m, m.relative?))).collect();
    Cheapest::of(&fit)
}

fn nearest(
    summary: &[MethodSummary],
    fits: impl Fn(&MethodSummary) -> bool,
) -> Option<Cheapest<'_, MethodSummary>> {
    let fit = summary.iter().filter(|m| fits(m));
    let fit = fit.filter_map(|m| Some((m, m.mean_rms_m?)));
    let best = fit.min_by(|a, b| a.1.total_cmp(&b.1))?.0;
    let as_cheap = Vec::new();
    Some(Cheapest { best, as_cheap })
}

/// What the default is, against the cheapest method that misses no limit.
pub fn verdict_on_default(summary: &[MethodSummary], half_blade_m: f64) -> String {
    let Some(default) = summary.iter().find(|m| m.method == DEFAULT) else {
        return "The default was not measured, so that nothing is said of it.".into();
    };
    if !default.misses.is_empty() {
        return format!(
            "The default misses limits: {}. In the other scenes it misses none.",
            default.misses_by_name()
        );
    }
    let half_blade_mm = half_blade_m * 1e3;
    let (within_m, line) = if default.is_within(half_blade_m) {
        let line = format!("and is within half a blade's width ({half_blade_mm:.1} mm)");
        (half_blade_m, line)
    } else {
        let line = format!("but is not within half a blade's width ({half_blade_mm:.1} mm)");
        (f64::INFINITY, line)
    };
    let fit = summary.iter().filter(|m| m.is_within(within_m));
    let own = default.relative.map_or(0.0, |r| r.low);
    let cheaper = fit.filter(|m| m.relative.is_some_and(|r| r.high < own));
    let cheaper: Vec<&str> = cheaper.map(|m| m.method.as_str()).collect();
    let rest = if cheaper.is_empty() {
        "No other method that does so is cheaper by more than the times are known to.".into()
    } else {
        let names = quoted(cheaper.into_iter());
        format!("These do so too and are cheaper by more than the times are known to: {names}.")
    };
    format!("The default misses no limit {line} in every scene. {rest}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point whose time is known to a tenth.
    fn row(method: &str, rms_m: f64, times_default: f64) -> Row {
        Row {
            method: method.into(),
            rms_m: Some(rms_m),
            touched_plants: 100,
            times_default: Some(times_default),
            times_default_low: Some(0.9 * times_default),
            times_default_high: Some(1.1 * times_default),
            default_ms_per_s: 100.0,
            ..Row::default()
        }
    }

    fn scene(name: &str, floor_m: f64, rows: Vec<Row>) -> SceneReport {
        let of_scene = |row: Row| Row {
            scene: name.into(),
            ..row
        };
        SceneReport {
            name: name.into(),
            what: String::new(),
            half_blade_m: 0.0035,
            floor: row("floor", floor_m, 1.0),
            rows: rows.into_iter().map(of_scene).collect(),
            left_out: Vec::new(),
            clamps: Vec::new(),
        }
    }

    fn summary(scenes: Vec<SceneReport>) -> Vec<MethodSummary> {
        super::super::tests::report_of(scenes).summary()
    }

    #[test]
    fn the_worst_scene_decides_and_a_missed_limit_rules_out() {
        let found = summary(vec![
            scene(
                "a",
                0.0,
                vec![row(DEFAULT, 0.001, 1.0), row("cheap", 0.001, 0.1)],
            ),
            scene(
                "b",
                0.0,
                vec![row(DEFAULT, 0.003, 1.0), row("cheap", 0.02, 0.1)],
            ),
        ]);
        assert_eq!(found[0].worst_rms_m, Some(0.003));
        assert_eq!(found[1].misses_by_name(), "poses in `b`");
        let choices = choices(&found, 0.0035);
        let chosen = |n: usize| choices[n].found.as_ref().map(|f| f.best.method.as_str());
        assert_eq!([0, 1, 2, 3].map(chosen), [Some(DEFAULT); 4]);
        let verdict = verdict_on_default(&found, 0.0035);
        assert!(verdict.contains("No other method"), "{verdict}");
    }

    #[test]
    fn what_is_cheaper_than_the_noise_is_named_and_what_is_not_is_not() {
        let rows = vec![
            row(DEFAULT, 0.001, 1.0),
            row("half", 0.001, 0.5),
            row("nearly-half", 0.001, 0.55),
            row("alike", 0.001, 0.95),
        ];
        let found = summary(vec![scene("a", 0.0, rows)]);
        let verdict = verdict_on_default(&found, 0.0035);
        assert!(verdict.contains("`half`, `nearly-half`."), "{verdict}");
        let choices = choices(&found, 0.0035);
        let cheapest = choices[0].found.as_ref().expect("three methods fit");
        assert_eq!(cheapest.best.method, "half");
        let alike: Vec<_> = cheapest
            .as_cheap
            .iter()
            .map(|m| m.method.as_str())
            .collect();
        assert_eq!(alike, ["nearly-half"]);
    }

    #[test]
    fn a_scene_whose_references_differ_does_not_judge_poses_and_sides() {
        let flipped = Row {
            side_flips: 50,
            ..row(DEFAULT, 0.012, 1.0)
        };
        let torn = Row {
            strain: 0.5,
            ..row("torn", 0.012, 1.0)
        };
        let blurred = scene("blurred", 0.011, vec![flipped.clone(), torn.clone()]);
        let sharp = scene("sharp", 0.001, vec![flipped, torn]);
        let found = summary(vec![blurred, sharp]);
        assert_eq!(
            found[0].misses_by_name(),
            "poses in `sharp`; sides in `sharp`"
        );
        assert_eq!(
            found[1].misses_by_name(),
            "poses in `sharp`; strain in `blurred`, `sharp`"
        );
        assert_eq!(found[0].worst_scene, "sharp");
    }

    #[test]
    fn where_no_method_misses_none_those_that_miss_the_fewest_are_named() {
        let torn = |method: &str, rms_m| Row {
            strain: 0.5,
            ..row(method, rms_m, 1.0)
        };
        let found = summary(vec![scene(
            "a",
            0.0,
            vec![torn("b", 0.1), torn("c", 0.001)],
        )]);
        let choices = choices(&found, 0.0035);
        assert_eq!(choices[0].found, None);
        let fewest = choices[1]
            .found
            .as_ref()
            .expect("one misses a single limit");
        assert_eq!(fewest.best.method, "c");
        assert!(fewest.as_cheap.is_empty());
    }
}
