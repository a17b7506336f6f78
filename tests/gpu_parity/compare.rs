//! Differences between two runs of the same maths, with the unit they are in.

use libtest_mimic::Failed;

/// Largest and root mean square difference, and where the largest was.
#[derive(Clone, Debug)]
pub struct Difference {
    what: &'static str,
    unit: &'static str,
    count: u64,
    max: f64,
    worst: String,
    squares: f64,
}

impl Difference {
    pub fn new(what: &'static str, unit: &'static str) -> Self {
        Self {
            what,
            unit,
            count: 0,
            max: 0.0,
            worst: String::new(),
            squares: 0.0,
        }
    }

    pub fn add(&mut self, difference: f64, place: impl FnOnce() -> String) {
        self.count += 1;
        self.squares += difference * difference;
        if difference > self.max || !difference.is_finite() {
            self.max = difference;
            self.worst = place();
        }
    }

    pub fn rms(&self) -> f64 {
        (self.squares / self.count.max(1) as f64).sqrt()
    }

    /// Prints the difference, and fails if there was nothing to compare or the limit is passed.
    pub fn check(&self, limit: f64) -> Result<(), Failed> {
        let text = format!(
            "{}: max {:.2e} {unit} (limit {limit:.2e}), rms {:.2e} {unit} over {}, worst at {}",
            self.what,
            self.max,
            self.rms(),
            self.count,
            self.worst,
            unit = self.unit,
        );
        println!("{text}");
        if self.count > 0 && self.max <= limit {
            Ok(())
        } else {
            Err(text.into())
        }
    }
}

/// Steps between two floats of the same sign; 0 for equal ones.
pub fn ulps(a: f32, b: f32) -> u32 {
    let ordered = |x: f32| {
        let bits = x.to_bits() as i32;
        if bits < 0 {
            i64::from(i32::MIN) - i64::from(bits)
        } else {
            i64::from(bits)
        }
    };
    u32::try_from((ordered(a) - ordered(b)).abs()).unwrap_or(u32::MAX)
}

/// Distance of two points.
pub fn distance(a: [f32; 3], b: [f32; 3]) -> f64 {
    let square = |n: usize| (f64::from(a[n]) - f64::from(b[n])).powi(2);
    (square(0) + square(1) + square(2)).sqrt()
}

/// Fails with a text unless a condition holds.
pub fn ensure(holds: bool, text: impl FnOnce() -> String) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(text().into()) }
}
