//! Frames and sub-steps: the same sub-steps at every frame rate.

/// Counts the sub-steps that are due. Frames may come at any rate or raggedly; the sub-steps
/// they add up to are the same.
#[derive(Clone, Copy, Debug)]
pub struct Timeline {
    substep_s: f64,
    owed_s: f64,
    /// Longest time a frame may add, and what was thrown away because of it, in seconds.
    longest_frame_s: f64,
    pub discarded_s: f64,
}

impl Timeline {
    /// For headless runs: every sub-step of a long frame is run.
    pub fn unlimited(substep_s: f64) -> Self {
        Self::limited(substep_s, f64::INFINITY)
    }

    /// For a window: a frame adds at most `longest_frame_s`, the rest is discarded and counted.
    pub fn limited(substep_s: f64, longest_frame_s: f64) -> Self {
        Self {
            substep_s,
            owed_s: 0.0,
            longest_frame_s,
            discarded_s: 0.0,
        }
    }

    /// Sub-steps due after a frame of `frame_s`; one that is negative or not finite adds nothing.
    pub fn advance(&mut self, frame_s: f64) -> u32 {
        if !(frame_s.is_finite() && frame_s > 0.0) {
            return 0;
        }
        let taken = frame_s.min(self.longest_frame_s);
        self.discarded_s += frame_s - taken;
        self.owed_s += taken;
        // A millionth of a sub-step forgives the rounding of the sum.
        let due = (self.owed_s / self.substep_s + 1e-6).floor();
        self.owed_s -= due * self.substep_s;
        due as u32
    }

    /// Share of the next sub-step that has already passed, 0…1, for interpolated drawing.
    pub fn share(&self) -> f64 {
        (self.owed_s / self.substep_s).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rate_gives_the_same_sub_steps() {
        for hz in [15.0, 24.0, 30.0, 60.0, 90.0, 144.0, 240.0, 1000.0] {
            let mut timeline = Timeline::unlimited(1.0 / 120.0);
            let frames = (10.0 * hz) as u32;
            let total: u32 = (0..frames).map(|_| timeline.advance(1.0 / hz)).sum();
            assert_eq!(total, 1200, "{hz} Hz");
        }
    }

    #[test]
    fn bad_times_add_nothing_and_long_ones_are_counted() {
        let mut timeline = Timeline::limited(0.01, 0.25);
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(timeline.advance(bad), 0, "{bad}");
        }
        assert_eq!(timeline.advance(5.0), 25);
        assert!((timeline.discarded_s - 4.75).abs() < 1e-12);
        assert_eq!(timeline.advance(1e-9), 0);
    }
}
