//! How long each pass of a sub-step takes.

use std::collections::BTreeMap;

use crate::base::statistics::median;

/// Milliseconds per sub-step and pass, over a run.
#[derive(Clone, Debug, Default)]
pub struct PassTimes {
    /// By pass: the running total after the last sub-step, and each sub-step's share of it.
    passes: BTreeMap<&'static str, (f64, Vec<f64>)>,
}

impl PassTimes {
    /// Takes in the running totals after a sub-step.
    pub fn tick(&mut self, total_ms: &[(&'static str, f64)]) {
        for &(pass, total) in total_ms {
            let (last, each) = self.passes.entry(pass).or_default();
            each.push(total - *last);
            *last = total;
        }
    }

    /// The median of each pass. The first sub-step, which draws and allocates, is left out where
    /// there are others.
    pub fn median_ms(&self) -> BTreeMap<String, f64> {
        let passes = self.passes.iter().filter_map(|(&pass, (_, each))| {
            let first = usize::from(each.len() > 1);
            Some((pass.to_owned(), median(&each[first..])?))
        });
        passes.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_of_steps_from_running_totals() {
        let mut times = PassTimes::default();
        for total in [100.0, 101.0, 103.0, 113.0] {
            times.tick(&[("collide", total)]);
        }
        assert_eq!(times.median_ms(), BTreeMap::from([("collide".into(), 2.0)]));
        assert!(PassTimes::default().median_ms().is_empty());
    }
}
