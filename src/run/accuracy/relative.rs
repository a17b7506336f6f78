//! What a method's time is worth beside the default's: both run in the same frames, so that a
//! machine that gets slower meanwhile does not favour one of them.

use serde::{Deserialize, Serialize};

use crate::base::statistics::quantile;

/// Half the length of a notch over the interquartile range, times the root of the number of values:
/// two medians whose notches do not meet differ at about the 95% level (McGill, Tukey and Larsen,
/// *Variations of Box Plots*, The American Statistician 32, 1978).
const NOTCH: f64 = 1.57;
/// Fewer frames than these have no quartiles worth the name; their extremes stand for the notch.
const FEW_FRAMES: usize = 8;

/// Time of a method over that of the default.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Relative {
    /// Median over the frames in which both were at work.
    pub median: f64,
    /// What the median may be but for chance.
    pub low: f64,
    pub high: f64,
}

impl Relative {
    /// Compares frame by frame; `None` where no frame has work for both.
    pub fn of(method_ms: &[Option<f64>], default_ms: &[Option<f64>]) -> Option<Self> {
        let both = method_ms.iter().zip(default_ms);
        let ratios: Vec<f64> = both
            .filter_map(|(&method, &default)| Some((method?, default?)))
            .filter(|&(_, default)| default > 0.0)
            .map(|(method, default)| method / default)
            .collect();
        let at = |q| quantile(&ratios, q);
        let median = at(0.5)?;
        let [low, high] = if ratios.len() < FEW_FRAMES {
            [at(0.0)?, at(1.0)?]
        } else {
            let reach = NOTCH * (at(0.75)? - at(0.25)?) / (ratios.len() as f64).sqrt();
            [(median - reach).max(0.0), median + reach]
        };
        Some(Self { median, low, high })
    }

    /// The mean of several scenes, whose errors are independent of each other.
    pub fn mean(of_scenes: &[Self]) -> Option<Self> {
        if of_scenes.is_empty() {
            return None;
        }
        let count = of_scenes.len() as f64;
        let mean = of_scenes.iter().fold(0.0, |sum, r| sum + r.median) / count;
        let reach = |to: fn(&Self) -> f64| {
            let squares = of_scenes.iter().map(|r| (to(r) - r.median).powi(2));
            squares.fold(0.0, |sum, s| sum + s).sqrt() / count
        };
        Some(Self {
            median: mean,
            low: (mean - reach(|r| r.low)).max(0.0),
            high: mean + reach(|r| r.high),
        })
    }

    /// Whether this one may be as cheap as another, for all that was measured.
    pub fn may_be_as_cheap_as(&self, other: &Self) -> bool {
        self.low <= other.high
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(pairs: &[(f64, f64)]) -> Relative {
        let (method, default): (Vec<_>, Vec<_>) =
            pairs.iter().map(|&(m, d)| (Some(m), Some(d))).unzip();
        Relative::of(&method, &default).expect("frames with work")
    }

    #[test]
    fn a_machine_that_gets_slower_changes_nothing() {
        let quiet: Vec<_> = (1..=30)
            .map(|n| (f64::from(n), 2.0 * f64::from(n)))
            .collect();
        let mut busy = quiet.clone();
        for pair in &mut busy[10..] {
            *pair = (pair.0 * 3.0, pair.1 * 3.0);
        }
        assert_eq!(of(&quiet), of(&busy));
        assert_eq!(of(&quiet).median, 0.5);
    }

    #[test]
    fn a_few_frames_in_which_something_else_ran_do_not_count() {
        let mut frames = vec![(1.0, 2.0); 30];
        frames[3].0 = 90.0;
        frames[20].1 = 50.0;
        let found = of(&frames);
        assert_eq!((found.median, found.low, found.high), (0.5, 0.5, 0.5));
    }

    #[test]
    fn methods_of_one_cost_are_told_from_dearer_ones() {
        // Noise of up to a fifth, the same in both.
        let noisy = |by: f64| -> Vec<(f64, f64)> {
            let frames = (0..40).map(|n| 1.0 + 0.05 * f64::from(n % 5));
            frames.map(|noise| (by * noise, 1.0)).collect()
        };
        let [same, alike, dear] = [1.0, 1.02, 1.5].map(|by| of(&noisy(by)));
        assert!(alike.may_be_as_cheap_as(&same) && same.may_be_as_cheap_as(&alike));
        assert!(same.may_be_as_cheap_as(&dear) && !dear.may_be_as_cheap_as(&same));
    }

    #[test]
    fn frames_without_work_are_left_out_and_nothing_has_no_ratio() {
        let half = Relative::of(&[None, Some(1.0)], &[Some(5.0), Some(2.0)]);
        assert_eq!(half.map(|r| r.median), Some(0.5));
        assert_eq!(Relative::of(&[None, Some(1.0)], &[Some(5.0), None]), None);
        assert_eq!(Relative::mean(&[]), None);
    }

    #[test]
    fn the_mean_of_scenes_is_surer_than_each() {
        let scene = Relative {
            median: 2.0,
            low: 1.0,
            high: 3.0,
        };
        let mean = Relative::mean(&[scene; 4]).expect("four scenes");
        assert_eq!((mean.median, mean.low, mean.high), (2.0, 1.5, 2.5));
    }
}
