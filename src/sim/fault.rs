//! Mistakes that the laws must notice: what a naive method does, planted in the default one.
//!
//! Only builds with the feature `planted-faults`, which the tests have, can switch one on; in
//! others every question here is answered with no, at compile time. Mistakes that are methods of
//! their own (the printed recovery, one sweep, nearest texels) need no switch: see
//! [`Method`](crate::scene::Method).

/// A mistake.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Fault {
    /// Springs act after the last push, so that they pull nodes back into the body.
    SpringsLast,
    /// The root takes half of its bend spring's correction, as if it were not pinned.
    RootWeight,
    /// Plants recover since the last contact of any plant of their tile.
    TimerPerTile,
    /// All sweeps of a sub-step run in one dispatch, however many loops that takes.
    OneTurn,
    /// Places of bodies are rounded to `f32` in the world before they become relative to a cell.
    WorldCoordinatesInF32,
}

/// The mistake that is planted, if any.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Planted(Option<Fault>);

impl Planted {
    pub const NONE: Self = Self(None);

    #[cfg(feature = "planted-faults")]
    pub fn plant(fault: Fault) -> Self {
        Self(Some(fault))
    }

    pub fn is(self, fault: Fault) -> bool {
        cfg!(feature = "planted-faults") && self.0 == Some(fault)
    }
}
