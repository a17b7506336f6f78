//! Options of `sward run` that make no sense together, told before anything is run.

use super::Arguments;
use crate::app::Failure;
use crate::gpu::knows_method;
use crate::run::methods::{METHODS, NamedMethod};
use crate::run::{Device, EngineChoice, RunOptions};
use crate::scene::Solver;

/// A recording is verified with the cpu engine, whose bodies take other steps than the reference's.
pub(super) fn what_cannot_be_recorded(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.record.is_some() && arguments.engine.choice()? == EngineChoice::Reference {
        let text = "--record with --engine reference: a recording is replayed and verified on the cpu \
                    engine, which takes other sub-steps; record with --engine cpu or gpu";
        return Err(Failure::Usage(text.into()));
    }
    Ok(())
}

/// Options that would change nothing beside another one.
pub(super) fn what_would_be_ignored(
    arguments: &Arguments,
    options: &RunOptions,
) -> Result<(), Failure> {
    let engine = arguments.engine.choice()?;
    if let (Some(method), Some(substep_s)) = (options.method, arguments.substep)
        && method.has_own_substep()
    {
        let method = method.name;
        return Err(Failure::Usage(format!(
            "--method {method} has a sub-step of its own, so that --substep {substep_s} would change \
             nothing: leave one of them out"
        )));
    }
    if engine != EngineChoice::Reference {
        return Ok(());
    }
    if let Some(method) = options.method.filter(|m| m.is_lost_on_reference()) {
        return Err(Failure::Usage(format!(
            "--method {} would change nothing with --engine reference, which has exact shapes, sweeps \
             and rounds of its own: leave one of them out; `--engine cpu --method {} --against \
             reference` compares the two",
            method.name, method.name
        )));
    }
    if options.against_reference {
        let text = "--against reference with --engine reference compares it with itself: take --engine \
                    cpu or gpu, or leave one of them out";
        return Err(Failure::Usage(text.into()));
    }
    Ok(())
}

pub(super) fn unknown_to_gpu(
    device: &Device,
    method: Option<&'static NamedMethod>,
) -> Result<(), Failure> {
    let known = |method: &NamedMethod| {
        let mut solver = Solver::default();
        method.apply(&mut solver);
        knows_method(&solver.method)
    };
    match method {
        Some(method) if device.gpu().is_some() && !known(method) => {
            let names = METHODS.iter().filter(|m| known(m)).map(|m| m.name);
            let names: Vec<&str> = names.collect();
            Err(Failure::Missing(format!(
                "--method {}: the gpu engine does not have it; take --engine cpu, or one of {}",
                method.name,
                names.join(", ")
            )))
        }
        _ => Ok(()),
    }
}
