//! What is measured in every sub-step, or in every frame, as rows of a CSV table.

use std::io::{self, Write};

use crate::gpu::GpuError;
use crate::sim::Meadow;
use crate::sim::measure::Snapshot;

use super::engine::Engine;
use super::scenario::Frame;

/// Passes whose times have a column each.
const PASSES: [&str; 3] = ["depth_cubes", "collide", "relax"];

/// Writes a row per sub-step or frame. A cell is empty where the engine does not tell.
pub struct Trace<W> {
    out: W,
    /// Milliseconds spent in each of [`PASSES`] up to the last row.
    spent_ms: [f64; PASSES.len()],
    /// What went wrong first; nothing is written after it.
    failed: Option<io::Error>,
}

impl<W: Write> Trace<W> {
    /// Starts a table.
    pub fn new(mut out: W) -> Self {
        let head = writeln!(
            out,
            "scenario,time_s,tick,tiles_active,state_bytes,pushed_plants,pushed_nodes,\
             max_penetration_m,pinched,over_push_m,max_length_strain,max_offset_m,rounds,\
             depth_cubes_ms,collide_ms,relax_ms,state_hash"
        );
        Self {
            out,
            spent_ms: Default::default(),
            failed: head.err(),
        }
    }

    /// Adds the row of a sub-step, which is measured for it.
    ///
    /// # Errors
    ///
    /// The engine's.
    pub fn tick(
        &mut self,
        scenario: &str,
        meadow: &Meadow,
        engine: &mut Engine,
    ) -> Result<(), GpuError> {
        let measured = engine.snapshot(meadow)?;
        self.row(scenario, meadow, engine, &measured);
        Ok(())
    }

    /// Adds the row of a frame, which is measured in any case.
    pub fn frame(&mut self, scenario: &str, frame: &Frame<'_>) {
        self.row(scenario, frame.meadow, frame.engine, frame.snapshot);
    }

    fn row(&mut self, scenario: &str, meadow: &Meadow, engine: &Engine, measured: &Snapshot) {
        if self.failed.is_some() {
            return;
        }
        let deepest = measured.depths_m.iter().copied().fold(0.0, f64::max);
        let response = engine.response();
        let [cubes_ms, collide_ms, relax_ms] = self.pass_ms(engine);
        let row = writeln!(
            self.out,
            "{},{:.6},{},{},{},{},{},{deepest:e},{},{:e},{:e},{:e},{},{cubes_ms},{collide_ms},\
             {relax_ms},{}",
            quoted(scenario),
            meadow.time_s(),
            meadow.ticks,
            meadow.tiles.len(),
            meadow.state_bytes(),
            cell(response.map(|(pushed, _)| pushed)),
            measured.pushed_nodes,
            measured.pinched,
            measured.over_push_m,
            measured.max_strain,
            measured.max_offset_m,
            cell(response.map(|(_, rounds)| rounds)),
            cell(engine.state_hash().map(|hash| format!("{hash:016x}"))),
        );
        self.failed = row.err();
    }

    /// Time of each pass since the last row.
    fn pass_ms(&mut self, engine: &Engine) -> [String; PASSES.len()] {
        let spent = engine.pass_ms();
        std::array::from_fn(|n| {
            let total = spent.iter().find(|(pass, _)| *pass == PASSES[n]);
            cell(total.map(|&(_, total_ms)| {
                // Another scenario of the same table starts from nothing again.
                let before_ms = std::mem::replace(&mut self.spent_ms[n], total_ms);
                let since_ms = if total_ms < before_ms {
                    total_ms
                } else {
                    total_ms - before_ms
                };
                format!("{since_ms:.4}")
            }))
        })
    }

    /// Ends the table.
    ///
    /// # Errors
    ///
    /// The first error of the writer.
    pub fn finish(mut self) -> io::Result<()> {
        match self.failed {
            Some(error) => Err(error),
            None => self.out.flush(),
        }
    }
}

fn cell(value: Option<impl ToString>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// A CSV field (RFC 4180).
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_that_need_it_are_quoted() {
        assert_eq!(quoted("ball"), "ball");
        assert_eq!(quoted("a,\"b\""), "\"a,\"\"b\"\"\"");
    }

    #[test]
    fn the_first_error_is_kept() {
        struct Full;
        impl Write for Full {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::ErrorKind::StorageFull.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let error = Trace::new(Full).finish().expect_err("nothing fits");
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
    }
}
