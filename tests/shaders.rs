//! Every shader is valid and agrees with its Rust structs, checked without a graphics device.
//! Each test lists all its failures at once.

#![allow(clippy::expect_used, reason = "a test says what it expects by failing")]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use naga::valid::{Capabilities, ValidationFlags, Validator};
use sward::gpu::layout::{self, StructLayout};
use sward::gpu::wgsl::{self, Assembled, WgslFile};
use sward::render;

fn libraries() -> Vec<&'static [WgslFile]> {
    vec![wgsl::SHARED, wgsl::PASSES, render::SHADERS]
}

fn layouts() -> Vec<StructLayout> {
    let mut all = layout::layouts();
    all.extend(render::layouts());
    all
}

/// Parses and validates under WebGPU's base features: no capability beyond them is allowed.
fn parse(source: &Assembled) -> Result<naga::Module, String> {
    let module = naga::front::wgsl::parse_str(&source.text)
        .map_err(|error| source.explain(&error.emit_to_string(&source.text)))?;
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|error| source.explain(&error.emit_to_string(&source.text)))?;
    Ok(module)
}

fn parse_all() -> (Vec<(&'static str, naga::Module)>, Vec<String>) {
    let libraries = libraries();
    let mut modules = Vec::new();
    let mut failures = Vec::new();
    for file in libraries.iter().flat_map(|library| library.iter()) {
        let parsed = wgsl::assemble(file, &libraries)
            .map_err(|error| error.to_string())
            .and_then(|source| parse(&source));
        match parsed {
            Ok(module) => modules.push((file.path, module)),
            Err(text) => failures.push(text),
        }
    }
    (modules, failures)
}

#[test]
fn every_shader_is_valid() {
    let (modules, failures) = parse_all();
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
    assert!(!modules.is_empty());
}

#[test]
fn every_shader_file_is_embedded() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let mut on_disk = BTreeSet::new();
    for folder in [root.clone(), root.join("billboard"), root.join("shared")] {
        for entry in fs::read_dir(&folder).expect("the shader folder") {
            let path = entry.expect("an entry").path();
            if path.is_file() {
                let inside = path.strip_prefix(&root).expect("inside").to_path_buf();
                on_disk.insert(inside.to_string_lossy().into_owned());
            }
        }
    }
    let embedded: BTreeSet<String> = libraries()
        .iter()
        .flat_map(|library| library.iter())
        .map(|file| file.path.to_owned())
        .collect();
    assert_eq!(on_disk, embedded);
}

/// A struct that a uniform or storage variable holds must be registered, and every member must
/// have the name, place and size of its Rust twin.
#[test]
fn every_struct_matches_its_rust_twin() {
    let (modules, _) = parse_all();
    let layouts = layouts();
    let mut failures = BTreeSet::new();
    let mut seen = BTreeSet::new();
    for (path, module) in &modules {
        let mut wanted = BTreeSet::new();
        for (_, variable) in module.global_variables.iter() {
            if matches!(
                variable.space,
                naga::AddressSpace::Uniform | naga::AddressSpace::Storage { .. }
            ) {
                collect_structs(module, variable.ty, &mut wanted);
            }
        }
        for handle in wanted {
            let ty = &module.types[handle];
            let name = ty.name.as_deref().unwrap_or("(no name)");
            seen.insert(name.to_owned());
            match layouts.iter().find(|layout| layout.name == name) {
                None => {
                    failures.insert(format!("{path}: struct {name} has no Rust twin"));
                }
                Some(twin) => compare(path, module, ty, twin, &mut failures),
            }
        }
    }
    for layout in &layouts {
        if !seen.contains(layout.name) {
            failures.insert(format!("no shader reads struct {}", layout.name));
        }
    }
    let failures: Vec<String> = failures.into_iter().collect();
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

fn collect_structs(
    module: &naga::Module,
    handle: naga::Handle<naga::Type>,
    into: &mut BTreeSet<naga::Handle<naga::Type>>,
) {
    match &module.types[handle].inner {
        naga::TypeInner::Struct { members, .. } => {
            into.insert(handle);
            for member in members {
                collect_structs(module, member.ty, into);
            }
        }
        naga::TypeInner::Array { base, .. } => collect_structs(module, *base, into),
        _ => {}
    }
}

fn compare(
    path: &str,
    module: &naga::Module,
    ty: &naga::Type,
    twin: &StructLayout,
    failures: &mut BTreeSet<String>,
) {
    let naga::TypeInner::Struct { members, span } = &ty.inner else {
        return;
    };
    let name = twin.name;
    if *span as usize != twin.size {
        failures.insert(format!(
            "{path}: {name} takes {span} bytes, in Rust {}",
            twin.size
        ));
    }
    let shader: Vec<(String, usize, usize)> = members
        .iter()
        .map(|member| {
            let size = module.types[member.ty].inner.size(module.to_ctx()) as usize;
            let name = member.name.clone().unwrap_or_default();
            (name, member.offset as usize, size)
        })
        .collect();
    let rust: Vec<(String, usize, usize)> = twin
        .fields
        .iter()
        .map(|field| (field.name.to_owned(), field.offset, field.size))
        .collect();
    if shader != rust {
        failures.insert(format!(
            "{path}: {name} (name, offset, size) is {shader:?}, in Rust {rust:?}"
        ));
    }
}
