//! A rod on a hinge whose tip a led ball pushes: what a blade of one segment comes to, solved without
//! any of the grass's kernels.
//!
//! The tip p is on the sphere of the rod's length L about its root r, and outside the ball of radius ρ
//! (skin included) about c, which moves at velocity u. With a = (p − r)/L, n = (p − c)/ρ and κ = n·a, a
//! tip that slides on the ball without friction and however slowly moves in the plane of n and a, at
//! right angles to a, and along n as fast as the ball:
//!
//! ```text
//! ṗ = f(p) = (u·n) (n − κa) / (1 − κ²)    while u·n > 0
//! ```
//!
//! Where the ball withdraws the tip stays; once the ball is [`HOLD_M`] off, the tip goes back to its
//! place of rest w by p = r + L·unit(w − r + t³d), d its offset then and t falling from 1 to 0 within
//! the recovery time, until it meets the ball again.
//!
//! A method of steps of length h moves the tip in planes through n and a as they are at some instant of
//! a step. Both constraints hold after every step, so that it errs along the circle in which the two
//! spheres meet. Along it, f changes by λ = (u·n)(1/ρ − κ/L)/(1 − κ²) per metre, and within a step the
//! plane turns by at most h(|ṅ| + |ȧ|)/√(1 − κ²). The error is thus below the solution of
//!
//! ```text
//! ė = λe + h |f| (|ṅ| + |ȧ|)/√(1 − κ²),   |ṅ| ≤ (|f| + |u|)/ρ,   |ȧ| = |f|/L
//! ```

use crate::base::Vec3;

type V = Vec3<f64>;

/// A ball that withdraws lets a tip go once it is this far off, in metres.
const HOLD_M: f64 = 1e-3;
/// Slices of a step of the bodies, at the end of each of which is looked for contact.
const SLICES: u32 = 16;
/// What a Runge-Kutta step may err by, in metres, and how often it is halved at most.
const STEP_ERROR_M: f64 = 1e-13;
const HALVINGS: u32 = 24;
/// Bisections of a slice: its length over 2⁵⁰ is below a rounding.
const BISECTIONS: u32 = 50;

/// A ball that is led from one place to another: at s of its way's time it has gone 3s² − 2s³ of the
/// way, at the end of every step of the bodies; evenly in between.
#[derive(Clone, Copy, Debug)]
pub struct LedBall {
    /// With the skin, in metres.
    pub radius_m: f64,
    pub from_m: [f64; 3],
    pub to_m: [f64; 3],
    pub arrives_s: f64,
    pub body_step_s: f64,
}

impl LedBall {
    fn at_step(&self, step: f64) -> V {
        let s = (step * self.body_step_s / self.arrives_s).clamp(0.0, 1.0);
        let way = V::of(self.to_m) - V::of(self.from_m);
        V::of(self.from_m) + way * (s * s * (3.0 - 2.0 * s))
    }

    /// Place and velocity, `into_s` after the start of a step.
    fn at(&self, step: u32, into_s: f64) -> (V, V) {
        let [from, to] = [step, step + 1].map(|step| self.at_step(f64::from(step)));
        let velocity = (to - from) * (1.0 / self.body_step_s);
        (from + velocity * into_s, velocity)
    }
}

/// A rod at rest.
#[derive(Clone, Copy, Debug)]
pub struct Rod {
    pub root: V,
    /// From the root to the tip's place of rest.
    pub rest: V,
    pub length_m: f64,
    pub recovery_s: f64,
}

#[derive(Clone, Copy, Debug)]
enum Phase {
    /// On its way back, or at rest, where the offset is 0.
    Free {
        since_s: f64,
        offset: V,
    },
    Pushed,
    /// In its place while the ball withdraws.
    Held,
}

/// Where a tip is at a time.
#[derive(Clone, Copy, Debug)]
pub struct Tip {
    rod: Rod,
    at: V,
    phase: Phase,
    /// Whole steps of the bodies so far, and the time since.
    step: u32,
    into_s: f64,
    /// Length h of the steps of the method whose error is bounded, in seconds.
    step_s: f64,
    /// The error's bound, in metres; `None` once the tip was let go, when a step's part in its
    /// time counts too.
    bound_m: Option<f64>,
}

impl Tip {
    pub fn new(rod: Rod, step_s: f64) -> Self {
        Self {
            rod,
            at: rod.root + rod.rest,
            phase: Phase::Free {
                since_s: 0.0,
                offset: V::ZERO,
            },
            step: 0,
            into_s: 0.0,
            step_s,
            bound_m: Some(0.0),
        }
    }

    pub fn place(&self) -> V {
        self.at
    }

    /// Whether the ball has met it.
    pub fn was_met(&self) -> bool {
        !matches!(self.phase, Phase::Free { offset, .. } if offset == V::ZERO)
    }

    /// How far a method of steps of the given length may be off while the ball pushes the tip for the
    /// first time, in metres.
    pub fn bound_while_pushed_m(&self) -> Option<f64> {
        let is_pushed = matches!(self.phase, Phase::Pushed);
        self.bound_m.filter(|_| is_pushed)
    }

    /// Advances by whole steps of the bodies.
    pub fn advance(&mut self, ball: &LedBall, steps: u32) {
        for _ in 0..steps {
            for slice in 1..=SLICES {
                self.slice(
                    ball,
                    ball.body_step_s * f64::from(slice) / f64::from(SLICES),
                );
            }
            self.step += 1;
            self.into_s = 0.0;
        }
    }

    /// Advances to a time within the step, from one phase into the next as often as it takes.
    fn slice(&mut self, ball: &LedBall, end_s: f64) {
        while self.into_s < end_s {
            let whole_s = end_s - self.into_s;
            let end = self.after(ball, whole_s);
            if end.stays(ball) {
                *self = end;
                self.into_s = end_s;
                return;
            }
            let (mut low_s, mut high_s) = (0.0, whole_s);
            for _ in 0..BISECTIONS {
                let middle_s = 0.5 * (low_s + high_s);
                if self.after(ball, middle_s).stays(ball) {
                    low_s = middle_s;
                } else {
                    high_s = middle_s;
                }
            }
            *self = self.after(ball, high_s);
            self.enter_next(ball);
        }
    }

    /// Whether the phase goes on.
    fn stays(&self, ball: &LedBall) -> bool {
        match self.phase {
            Phase::Free { .. } => self.gap_m(ball) >= 0.0,
            Phase::Pushed => self.approach(ball) > 0.0,
            Phase::Held => self.gap_m(ball) < HOLD_M && !self.is_met_again(ball),
        }
    }

    fn is_met_again(&self, ball: &LedBall) -> bool {
        self.gap_m(ball) < 0.0 && self.approach(ball) > 0.0
    }

    fn enter_next(&mut self, ball: &LedBall) {
        self.phase = match self.phase {
            Phase::Free { .. } => Phase::Pushed,
            Phase::Pushed => Phase::Held,
            Phase::Held if self.is_met_again(ball) => Phase::Pushed,
            Phase::Held => {
                self.bound_m = None;
                Phase::Free {
                    since_s: self.now_s(ball),
                    offset: self.at - self.rod.root - self.rod.rest,
                }
            }
        };
    }

    fn now_s(&self, ball: &LedBall) -> f64 {
        f64::from(self.step) * ball.body_step_s + self.into_s
    }

    fn gap_m(&self, ball: &LedBall) -> f64 {
        (self.at - ball.at(self.step, self.into_s).0).length() - ball.radius_m
    }

    /// u·n, in metres per second.
    fn approach(&self, ball: &LedBall) -> f64 {
        let (middle, velocity) = ball.at(self.step, self.into_s);
        velocity.dot((self.at - middle).unit_or(V::UP))
    }

    /// The tip some seconds later, in the same phase.
    fn after(&self, ball: &LedBall, seconds: f64) -> Self {
        let mut tip = *self;
        tip.into_s += seconds;
        match self.phase {
            Phase::Held => {}
            Phase::Free { since_s, offset } => {
                let left = 1.0 - (tip.now_s(ball) - since_s) / self.rod.recovery_s;
                let towards = self.rod.rest + offset * left.max(0.0).powi(3);
                tip.at = self.rod.root + towards.unit_or(V::UP) * self.rod.length_m;
            }
            Phase::Pushed => {
                let bound_m = self.bound_m.unwrap_or(0.0);
                let end = self.pushed(ball, [self.into_s, seconds], (self.at, bound_m), HALVINGS);
                tip.at = end.0;
                tip.bound_m = self.bound_m.map(|_| end.1);
            }
        }
        tip
    }

    /// A Runge-Kutta step of the fourth order, halved until both halves come to the same.
    fn pushed(
        &self,
        ball: &LedBall,
        [start_s, seconds]: [f64; 2],
        from: State,
        halvings: u32,
    ) -> State {
        let step = |start_s, seconds, from| self.runge_kutta(ball, start_s, seconds, from);
        let half = 0.5 * seconds;
        let whole = step(start_s, seconds, from);
        let halves = step(start_s + half, half, step(start_s, half, from));
        if (whole.0 - halves.0).length() <= STEP_ERROR_M || halvings == 0 {
            return halves;
        }
        let middle = self.pushed(ball, [start_s, half], from, halvings - 1);
        self.pushed(ball, [start_s + half, half], middle, halvings - 1)
    }

    fn runge_kutta(&self, ball: &LedBall, start_s: f64, seconds: f64, from: State) -> State {
        let slope = |after_s: f64, state: State| self.slope(ball, start_s + after_s, state);
        let along = |slope: State, by: f64| (from.0 + slope.0 * by, from.1 + slope.1 * by);
        let half = 0.5 * seconds;
        let first = slope(0.0, from);
        let second = slope(half, along(first, half));
        let third = slope(half, along(second, half));
        let fourth = slope(seconds, along(third, seconds));
        let sixth = seconds / 6.0;
        (
            from.0 + (first.0 + (second.0 + third.0) * 2.0 + fourth.0) * sixth,
            from.1 + (first.1 + (second.1 + third.1) * 2.0 + fourth.1) * sixth,
        )
    }

    /// ṗ and ė.
    fn slope(&self, ball: &LedBall, into_s: f64, (at, error_m): State) -> State {
        let (middle, velocity) = ball.at(self.step, into_s);
        let along = (at - self.rod.root) * (1.0 / self.rod.length_m);
        let normal = (at - middle) * (1.0 / ball.radius_m);
        let (kappa, rising) = (normal.dot(along), velocity.dot(normal).max(0.0));
        let free = (1.0 - kappa * kappa).max(f64::MIN_POSITIVE);
        let sliding = (normal - along * kappa) * (rising / free);
        let speed = sliding.length();
        let growth = rising * (1.0 / ball.radius_m - kappa / self.rod.length_m) / free;
        let turning = (speed + velocity.length()) / ball.radius_m + speed / self.rod.length_m;
        let new_m = self.step_s * speed * turning / free.sqrt();
        (sliding, growth * error_m + new_m)
    }
}

/// Place of a tip and the bound of the error.
type State = (V, f64);
