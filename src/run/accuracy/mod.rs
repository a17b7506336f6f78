//! The accuracy report: how wrong every method is, and how fast.
//!
//! A point is a method on a scene. For each scene the reference engine runs once and its poses are
//! kept; every method is then compared with them frame by frame, and its error split into rounding
//! (gpu − cpu), precision (cpu in `f32` − the same in `f64`) and the method's own (in `f64` −
//! reference).

mod blades;
mod cost;
mod independent;
mod lane;
mod measure;
mod plan;
mod plot;
mod relative;
mod rod;
pub mod rods;
pub mod scenes;
mod shapes;
mod store;
mod summary;
mod table;
mod truth;

use std::io;

pub use blades::Blades;
pub use cost::{CostRow, SCENE as COST_SCENE};
pub use independent::Independent;
pub use plan::{
    Context, LeftOut, Plan, Planned, all_methods, cost_methods, has_free_bodies,
    hash_of_this_program, quick_methods, why_not_comparable,
};
pub use plot::{PlotError, error_plot, summary_plot};
pub use relative::Relative;
pub use shapes::Shapes;
pub use store::{Dropped, Row, Store, Stored};
pub use table::write_markdown;

use super::bench::Machine;
use super::report::Adapter;
use super::scenario::{Device, RunError};
use super::spring_clamp::SpringClamp;
use crate::field::blade_table::TableError;
use crate::scene::{Scene, SceneError};
use truth::Truth;

/// Name under which the distance of two references is listed.
pub const FLOOR: &str = "noise floor";

/// Frames of a reference count as so many points in the progress: two of them in `f64` at eight
/// and eleven times the sub-steps.
const TRUTH_POINTS: f64 = 6.0;

/// Methods that are timed in turns: an interrupted report loses at most so many points, and the
/// default runs once for so many.
const TOGETHER: usize = 6;

/// What a report came to.
#[derive(Clone, Debug)]
pub struct Report {
    pub machine: Machine,
    pub adapter: Option<Adapter>,
    pub scenes: Vec<SceneReport>,
    /// Cost at equal sub-steps, where the plan has its scene.
    pub cost: Vec<CostRow>,
    pub blades: Option<Blades>,
    /// Measured where the blades are.
    pub independent: Option<Independent>,
    /// The same.
    pub shapes: Option<Shapes>,
}

/// The points of a scene.
#[derive(Clone, Debug)]
pub struct SceneReport {
    pub name: String,
    pub what: String,
    /// Half the mean width of a blade, in metres: an error that can be seen.
    pub half_blade_m: f64,
    pub floor: Row,
    pub rows: Vec<Row>,
    pub left_out: Vec<LeftOut>,
    /// What the stability clamp does in the methods that have literal springs.
    pub clamps: Vec<(&'static str, SpringClamp)>,
}

impl SceneReport {
    /// The limits that one of its points misses.
    pub fn misses(&self, row: &Row) -> Vec<&'static str> {
        row.misses(&self.floor)
    }

    /// What the default costs on this machine when it is least disturbed, in milliseconds per
    /// simulated second: the least of its times beside each of the other methods.
    pub fn default_ms_per_s(&self) -> f64 {
        let times = self.rows.iter().map(|row| row.default_ms_per_s);
        times.reduce(f64::min).unwrap_or(0.0)
    }

    /// What a point costs, in milliseconds per simulated second; `None` without any work.
    pub fn ms_per_s(&self, row: &Row) -> Option<f64> {
        Some(row.times_default? * self.default_ms_per_s())
    }
}

/// Why a report ended early. What was measured is in the file.
#[derive(Debug, thiserror::Error)]
pub enum AccuracyError {
    #[error(transparent)]
    Run(#[from] RunError),
    #[error(transparent)]
    Blades(#[from] TableError),
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error("cannot write a measured point: {0}")]
    Store(#[from] io::Error),
}

/// Measures every point that the store does not have yet. `progress` gets the share done.
///
/// # Errors
///
/// A scene that cannot be laid out; a file that can no longer be written.
pub fn run(
    plan: &Plan,
    store: &mut Store,
    gpu: Option<&Device>,
    mut progress: impl FnMut(f64),
) -> Result<Report, AccuracyError> {
    let machine = Machine::now();
    let adapter = gpu.and_then(Device::gpu).map(Adapter::of);
    let points = |planned: &Planned| TRUTH_POINTS + planned.methods.len() as f64;
    let total: f64 = plan.scenes.iter().map(points).sum();
    let context = plan.context(gpu);
    let mut done = 0.0;
    let mut scenes = Vec::new();
    for planned in &plan.scenes {
        let share = |points: f64| progress((done + points) / total);
        scenes.push(run_scene(planned, store, &context, share)?);
        done += points(planned);
    }
    let timed = plan
        .scenes
        .iter()
        .find(|planned| planned.loaded.name == COST_SCENE);
    let cost = match timed {
        Some(planned) => cost::measure(&planned.loaded, &planned.methods)?,
        None => Vec::new(),
    };
    let blades = plan.blades.then(Blades::measure).transpose()?;
    let independent = plan.blades.then(Independent::measure).transpose()?;
    let shapes = plan.blades.then(Shapes::measure);
    Ok(Report {
        machine,
        adapter,
        scenes,
        cost,
        blades,
        independent,
        shapes,
    })
}

/// `progress` gets the number of points done.
fn run_scene(
    planned: &Planned,
    store: &mut Store,
    context: &Context<'_>,
    progress: impl FnMut(f64),
) -> Result<SceneReport, AccuracyError> {
    let loaded = &planned.loaded;
    let key = |name: &str| context.key(loaded, name);
    if planned.names().any(|name| store.get(&key(name)).is_none()) {
        measure_missing(planned, store, context, progress)?;
    }
    let rows = planned.methods.iter();
    let row = |name| store.get(&key(name)).cloned();
    Ok(SceneReport {
        name: loaded.name.clone(),
        what: loaded.scene.description.clone(),
        half_blade_m: half_blade_m(&loaded.scene),
        floor: row(FLOOR).unwrap_or_default(),
        rows: rows.filter_map(|method| row(method.name)).collect(),
        left_out: planned.left_out.clone(),
        clamps: planned.clamps(),
    })
}

/// Measures the points of a scene that the store does not have.
fn measure_missing(
    planned: &Planned,
    store: &mut Store,
    context: &Context<'_>,
    mut progress: impl FnMut(f64),
) -> Result<(), AccuracyError> {
    let loaded = &planned.loaded;
    let truth = Truth::record(loaded, |share| progress(TRUTH_POINTS * share))?;
    let megabytes = truth.bytes() as f64 * 1e-6;
    log::info!("{}: {megabytes:.1} MB of reference poses", loaded.name);
    let program = plan::program_name(context.program);
    let key = context.key(loaded, FLOOR);
    if store.get(&key).is_none() {
        let floor = measure::floor_row(loaded, &truth);
        let program = program.clone();
        store.add(Row {
            key,
            program,
            ..floor
        })?;
    }
    let missing = planned.methods.iter().copied();
    let missing: Vec<_> = missing
        .filter(|method| store.get(&context.key(loaded, method.name)).is_none())
        .collect();
    let mut done = TRUTH_POINTS + (planned.methods.len() - missing.len()) as f64;
    for turn in missing.chunks(TOGETHER) {
        let points = turn.len() as f64;
        let rows = measure::measure(loaded, turn, &truth, context, |share| {
            progress(done + share * points);
        })?;
        for row in rows {
            let key = context.key(loaded, &row.method);
            let program = program.clone();
            store.add(Row {
                key,
                program,
                ..row
            })?;
        }
        done += points;
    }
    Ok(())
}

fn half_blade_m(scene: &Scene) -> f64 {
    let species = &scene.grass.species;
    let widths = species.iter().flat_map(|s| s.width_m).map(f64::from);
    0.5 * widths.sum::<f64>() / (2 * species.len()).max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::plan::tests::loaded;
    use super::*;
    use crate::run::methods::method;

    /// A report of scenes that were made up.
    pub fn report_of(scenes: Vec<SceneReport>) -> Report {
        Report {
            machine: Machine::now(),
            adapter: None,
            scenes,
            cost: Vec::new(),
            blades: None,
            independent: None,
            shapes: None,
        }
    }

    #[test]
    fn what_a_store_has_is_not_measured_again() {
        let methods = [method("default"), method("analytic")].map(|m| m.expect("a name"));
        let plan = Plan {
            scenes: vec![Planned::new(loaded(), &methods)],
            ..Plan::default()
        };
        let mut store = Store::in_memory();
        run(&plan, &mut store, None, |_| {}).expect("a scene that runs");
        let as_now = Context {
            program: 0,
            quick: false,
            gpu: None,
        };
        let known = as_now.key(&loaded(), "default");
        let marked = Row {
            // No run has such strain.
            strain: 1e30,
            ..store.get(&known).expect("a measured point").clone()
        };
        store.add(marked).expect("memory");
        let strains = |plan: &Plan, store: &mut Store| -> Vec<bool> {
            let report = run(plan, store, None, |_| {}).expect("a scene that runs");
            let rows = report.scenes[0].rows.iter();
            rows.map(|row| row.strain == 1e30).collect()
        };
        assert_eq!(strains(&plan, &mut store), [true, false]);
        // A program that is another one measures all of it again.
        let rebuilt = Plan { program: 1, ..plan };
        assert_eq!(strains(&rebuilt, &mut store), [false, false]);
    }
}
