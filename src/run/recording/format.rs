//! The text of a recording, and everything that may be wrong with one.

use serde::{Deserialize, Serialize};

use crate::scene::assets::AssetSource;
use crate::scene::{
    Event, LoadedScene, Problem, SceneError, limits, parse_scene_with, parse_value, validate,
    value_to_ron,
};

use super::super::methods::{self, METHODS};
use super::{FORMAT, Hashed, Input, MOST_TICKS, Recording};

/// Digits of a tick.
const DIGITS: usize = 8;
const TICKS_PER_LINE: usize = 32;

/// The keys of the file, in their order.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: u32,
    sward: String,
    scene: String,
    hashed: Hashed,
    hz: f64,
    #[serde(default)]
    substep_s: Option<f64>,
    #[serde(default)]
    seed: Option<u32>,
    #[serde(default)]
    method: Option<String>,
    #[serde(default)]
    assets: Vec<Asset>,
    #[serde(default)]
    inputs: Vec<Input>,
    ticks: u32,
    hashes: Vec<String>,
    source: String,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Asset {
    file: String,
    hash: String,
}

/// What files of every format have in common.
#[derive(Deserialize)]
struct Head {
    #[serde(default)]
    format: Option<u32>,
}

pub(super) fn write(recording: &Recording) -> Result<String, ron::Error> {
    let Recording {
        sward,
        scene,
        source,
        assets,
        hz,
        substep_s,
        seed,
        method,
        hashed,
        inputs,
        hashes,
    } = recording;
    let line = |ticks: &[u32]| ticks.iter().map(|hash| format!("{hash:08x}")).collect();
    value_to_ron(&File {
        format: FORMAT,
        sward: sward.clone(),
        scene: scene.clone(),
        hashed: *hashed,
        hz: *hz,
        substep_s: *substep_s,
        seed: *seed,
        method: method.clone(),
        assets: (assets.iter())
            .map(|(file, hash)| Asset {
                file: file.clone(),
                hash: format!("{hash:016x}"),
            })
            .collect(),
        inputs: inputs.clone(),
        ticks: hashes.len() as u32,
        hashes: hashes.chunks(TICKS_PER_LINE).map(line).collect(),
        source: source.clone(),
    })
}

/// Reads a recording and its scene from the text of `file`.
pub(super) fn parse(
    file: &str,
    text: &str,
    assets: &dyn AssetSource,
) -> Result<(Recording, LoadedScene), SceneError> {
    let wrong = |key: &str, what: String| SceneError::at_key(file, text, key, what);
    // A file of another format would otherwise be told to have unknown keys.
    let Head { format } = parse_value(file, text)?;
    let Some(format) = format else {
        let what = "it has no `format` and is no recording; if it is a scene, `sward run` runs it, and \
                    records it with --record";
        let problem = Problem::Unreadable(std::io::Error::other(what));
        return Err(SceneError::whole(file, problem));
    };
    if format != FORMAT {
        let what = format!("is {format}; this sward reads recordings of format {FORMAT}");
        return Err(wrong("format", what));
    }
    let read: File = parse_value(file, text)?;
    numbers(&read).map_err(|(key, what)| wrong(key, what))?;
    let hashes = hashes(&read).map_err(|(key, what)| wrong(&key, what))?;
    let loaded = parse_scene_with(&read.scene, &read.source, assets).map_err(|mut error| {
        error.file = format!("{file}: source: {}", error.file);
        error
    })?;
    same_assets(&read, &loaded).map_err(|(key, what)| wrong(&key, what))?;
    inputs(&read, &loaded).map_err(|(key, what)| wrong(&key, what))?;
    let recording = Recording {
        sward: read.sward,
        scene: read.scene,
        source: read.source,
        assets: loaded.assets.file_hashes.clone(),
        hz: read.hz,
        substep_s: read.substep_s,
        seed: read.seed,
        method: read.method,
        hashed: read.hashed,
        inputs: read.inputs,
        hashes,
    };
    Ok((recording, loaded))
}

/// Numbers that stand alone, before anything is made of them.
fn numbers(read: &File) -> Result<(), (&'static str, String)> {
    let within = |limit: limits::Range, value: f64| (limit.min..=limit.max).contains(&value);
    if !(1.0..=10_000.0).contains(&read.hz) {
        let what = format!(
            "is {}; write a number of frames per second from 1 to 10000",
            read.hz
        );
        return Err(("hz", what));
    }
    if let Some(substep_s) = read.substep_s
        && !within(limits::SUBSTEP, substep_s)
    {
        let what = format!("is {substep_s}; write None or {}", limits::SUBSTEP);
        return Err(("substep_s", what));
    }
    if let Some(method) = &read.method
        && methods::method(method).is_none()
    {
        let names: Vec<&str> = METHODS.iter().map(|method| method.name).collect();
        let what = format!("is \"{method}\"; methods are {}", names.join(", "));
        return Err(("method", what));
    }
    if read.ticks > MOST_TICKS {
        let what = format!("is {}; a recording holds at most {MOST_TICKS}", read.ticks);
        return Err(("ticks", what));
    }
    if read.inputs.len() > limits::EVENTS {
        let what = format!(
            "holds {}; at most {} are read",
            read.inputs.len(),
            limits::EVENTS
        );
        return Err(("inputs", what));
    }
    Ok(())
}

type Wrong = (String, String);

fn hashes(read: &File) -> Result<Vec<u32>, Wrong> {
    let mut hashes = Vec::with_capacity(read.hashes.iter().map(|l| l.len() / DIGITS).sum());
    for (number, line) in read.hashes.iter().enumerate() {
        for digits in line.as_bytes().chunks(DIGITS) {
            let digits = std::str::from_utf8(digits).unwrap_or("");
            let is_hash = digits.len() == DIGITS && digits.bytes().all(|b| b.is_ascii_hexdigit());
            let hash = u32::from_str_radix(digits, 16).ok().filter(|_| is_hash);
            hashes.push(hash.ok_or_else(|| {
                let what = format!("has \"{digits}\" in it; write 8 hexadecimal digits per tick");
                (format!("hashes[{number}]"), what)
            })?);
        }
    }
    if hashes.len() != read.ticks as usize {
        let what = format!("hold {} ticks, but `ticks` is {}", hashes.len(), read.ticks);
        return Err(("hashes".to_owned(), what));
    }
    Ok(hashes)
}

/// Whether the scene has read the same files with the same bytes.
fn same_assets(read: &File, loaded: &LoadedScene) -> Result<(), Wrong> {
    let found = &loaded.assets.file_hashes;
    for (number, asset) in read.assets.iter().enumerate() {
        let Some(hash) = found.get(&asset.file) else {
            let what = format!("names `{}`, which the scene does not read", asset.file);
            return Err((format!("assets[{number}].file"), what));
        };
        let hash = format!("{hash:016x}");
        if hash != asset.hash {
            let what = format!(
                "`{}` has changed since: its hash was {} and is {hash}; name the folder of the \
                 recorded file with --assets",
                asset.file, asset.hash
            );
            return Err((format!("assets[{number}].hash"), what));
        }
    }
    match found
        .keys()
        .find(|&file| !read.assets.iter().any(|asset| asset.file == *file))
    {
        Some(file) => {
            let what = format!("lack `{file}`, which the scene reads; add it with its hash");
            Err(("assets".to_owned(), what))
        }
        None => Ok(()),
    }
}

/// Checks inputs as the events of a script are checked, behind the scene's own events.
fn inputs(read: &File, loaded: &LoadedScene) -> Result<(), Wrong> {
    let mut before = 0;
    for (number, input) in read.inputs.iter().enumerate() {
        if input.tick < before || input.tick > read.ticks {
            let what = format!(
                "is {}; ticks of inputs rise from one to the next, up to `ticks`, {}",
                input.tick, read.ticks
            );
            return Err((format!("inputs[{number}].tick"), what));
        }
        before = input.tick;
    }
    let mut scene = loaded.scene.clone();
    let scripted = scene.script.len();
    let substep_s = read.substep_s.unwrap_or(scene.solver.substep_s);
    scene.duration_s = scene.duration_s.max(f64::from(read.ticks) * substep_s);
    scene.script.extend(read.inputs.iter().map(|input| Event {
        at_s: f64::from(input.tick) * substep_s,
        action: input.action.clone(),
    }));
    let Err(invalid) = validate(&scene) else {
        return Ok(());
    };
    // An input may well have spoilt what the script meant to do: then so it was in that run.
    let after = invalid.key.strip_prefix("script[");
    let number = after.and_then(|rest| rest.split(']').next()?.parse::<usize>().ok());
    match number.and_then(|number| number.checked_sub(scripted)) {
        Some(number) => {
            let rest = invalid
                .key
                .find(']')
                .map_or("", |end| &invalid.key[end + 1..]);
            Err((format!("inputs[{number}]{rest}"), invalid.what))
        }
        None => Ok(()),
    }
}
