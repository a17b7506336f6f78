//! `sward render`.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::outputs::ResultFile;
use super::scene_file;
use crate::app::Failure;
use crate::app::device::EngineArguments;
use crate::app::light_up::light_up;
use crate::app::progress::Progress;
use crate::app::values::{count, density, number, whole};
use crate::gpu::Gpu;
use crate::render::{Animation, Count, Picture, PictureTarget, Submission, Sun, View, scene_view};
use crate::run::{Exit, Stage};
use crate::scene::{Camera, limits};

/// Draw pictures of a scene without a window
#[derive(Args, Debug)]
pub struct Arguments {
    /// Scene file, or name of one of the program's own scenes
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Simulated time of the first picture
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = number)]
    at: f64,
    /// Draw N pictures, as FILE_0000.png and so on or as one animation where FILE ends in .apng
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1,
        allow_negative_numbers = true,
        value_parser = |text: &str| whole(text, 1, MOST_FRAMES)
    )]
    frames: u32,
    /// Pictures per simulated second, of a sequence
    #[arg(
        long,
        value_name = "N",
        default_value_t = 30,
        requires = "frames",
        allow_negative_numbers = true,
        value_parser = |text: &str| whole(text, 1, MOST_HZ.into()).map(|hz| hz as u16)
    )]
    hz: u16,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    size: [u32; 2],
    /// One of the scene's cameras; by default the first
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// Look from a place of your own, in metres of the scene, in place of a camera
    #[arg(
        long,
        value_name = "X,Y,Z",
        allow_hyphen_values = true,
        requires = "target",
        conflicts_with = "camera",
        value_parser = place
    )]
    eye: Option<[f64; 3]>,
    /// The place that `--eye` looks at
    #[arg(
        long,
        value_name = "X,Y,Z",
        allow_hyphen_values = true,
        requires = "eye",
        value_parser = place
    )]
    target: Option<[f64; 3]>,
    /// Show which tiles are awake
    #[arg(long)]
    overlay: bool,
    /// Show tiles that collide in red and those that recover in green, and no others, as O09's figure 8
    #[arg(long, conflicts_with = "overlay")]
    awake_tiles: bool,
    /// The sun's height over the horizon in degrees, 2 to 90, and after a comma where it stands, from +x
    /// towards +z
    #[arg(
        long,
        value_name = "HEIGHT[,AZIMUTH]",
        allow_hyphen_values = true,
        value_parser = sun
    )]
    sun: Option<Sun>,
    /// How plants are submitted: by the exact counts of triangles, or by the 32 bins of P15
    #[arg(long, value_enum, default_value = "exact")]
    submission: SubmissionName,
    /// Draw this many times as many plants, 0.1 to 4; above 1 blades get more companions, other plants
    /// stay as many
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = density)]
    density: f32,
    /// What decides how many plants are drawn: distance, or P15's projected (eq. 1) or world (eq. 2) area of a
    /// seeding triangle, with plants per pixel after a comma
    #[arg(long, value_name = "RULE[,PER_PX]", default_value = "distance", value_parser = count)]
    count: Count,
    /// Leave the shadows of plants on the ground out
    #[arg(long)]
    no_plant_shadows: bool,
    #[command(flatten)]
    engine: EngineArguments,
    /// Another folder in which assets are looked up; may be repeated
    #[arg(long, value_name = "DIR")]
    assets: Vec<PathBuf>,
    /// The picture: a name that ends in .png, or in .apng for an animation
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SubmissionName {
    Exact,
    Bins,
}

/// Longest side of a picture, in pixels.
const MOST_PIXELS: u32 = 8192;
/// Most pictures of a sequence: their names count to 9999.
const MOST_FRAMES: u32 = 10_000;
/// Most pictures per second.
const MOST_HZ: u16 = 1000;

/// Draws the pictures and prints the names of the files.
pub fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    check(arguments)?;
    let choice = arguments.engine.choice()?;
    let animated = is_animation(&arguments.out)?;
    scene_file::check_folders(&arguments.assets)?;
    let loaded = scene_file::load(&arguments.scene, &arguments.assets)?;
    let gpu = Gpu::headless()?;
    let target = PictureTarget::new(&gpu, arguments.size)?;
    let mut stage = Stage::new(&gpu, &loaded, choice, PictureTarget::FORMAT, arguments.size)?;
    stage.camera(arguments.camera.as_deref())?;
    stage.sun = arguments.sun.unwrap_or(stage.sun);
    stage.detail.density = arguments.density;
    stage.detail.count = arguments.count;
    stage.resting_boxes = !arguments.awake_tiles;
    stage.detail.shadows &= !arguments.no_plant_shadows;
    stage.detail.submission = match arguments.submission {
        SubmissionName::Exact => Submission::Exact,
        SubmissionName::Bins => Submission::Bins,
    };
    // A place that cannot be written to is told before time is spent on pictures.
    let first = match arguments.frames {
        frames if frames > 1 && !animated => numbered(&arguments.out, 0),
        _ => arguments.out.clone(),
    };
    ResultFile::create(&first)?;
    light_up(&gpu, &mut stage)?;
    let mut shoot = Shoot {
        arguments,
        gpu: &gpu,
        target,
        stage: &mut stage,
        progress: Progress::new(&loaded.name),
    };
    let files = if animated {
        vec![shoot.animation()?]
    } else {
        shoot.pictures()?
    };
    drop(shoot);
    for file in files {
        writeln!(out, "{}", file.display())?;
    }
    Ok(Exit::Ok)
}

fn check(arguments: &Arguments) -> Result<(), Failure> {
    let usage = |text| Err(Failure::Usage(text));
    let at = &arguments.at;
    if !(0.0..=limits::DURATION.max).contains(at) {
        return usage(format!(
            "--at {at}: give 0 to {} seconds",
            limits::DURATION.max
        ));
    }
    Ok(())
}

/// Parses a size such as `1280x720`.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(width, height)| {
        let size: [u32; 2] = [width.parse().ok()?, height.parse().ok()?];
        let fits = |side: &u32| (1..=MOST_PIXELS).contains(side);
        size.iter().all(fits).then_some(size)
    });
    sides.ok_or_else(|| format!("give WIDTHxHEIGHT, each 1 to {MOST_PIXELS}, such as 1280x720"))
}

/// Parses a place of the sun such as `12` or `12,90`.
fn sun(text: &str) -> Result<Sun, String> {
    let mut numbers = text.splitn(2, ',').map(str::parse::<f32>);
    let told = match (numbers.next(), numbers.next()) {
        (Some(Ok(height)), None) => Some((height, Sun::default().azimuth_deg)),
        (Some(Ok(height)), Some(Ok(azimuth))) => Some((height, azimuth)),
        _ => None,
    };
    let fits = |&(height, azimuth): &(f32, f32)| {
        (2.0..=90.0).contains(&height) && (-360.0..=360.0).contains(&azimuth)
    };
    let (elevation_deg, azimuth_deg) = told.filter(fits).ok_or(
        "give a height of 2 to 90 degrees, or that and an azimuth of -360 to 360, such as 12,90",
    )?;
    Ok(Sun {
        elevation_deg,
        azimuth_deg,
    })
}

/// Parses a place such as `0,1.7,-3`.
fn place(text: &str) -> Result<[f64; 3], String> {
    let limits::Range { min, max, .. } = limits::PLACE;
    let numbers: Option<Vec<f64>> = (text.split(','))
        .map(|number| number.trim().parse().ok())
        .map(|number| number.filter(|number| (min..=max).contains(number)))
        .collect();
    numbers
        .and_then(|numbers| numbers.try_into().ok())
        .ok_or_else(|| format!("give three numbers of {min} to {max} metres, such as 0,1.7,-3"))
}

/// Whether a file name asks for an animation.
fn is_animation(file: &Path) -> Result<bool, Failure> {
    match file.extension().and_then(|ending| ending.to_str()) {
        Some("png") => Ok(false),
        Some("apng") => Ok(true),
        _ => Err(Failure::Usage(format!(
            "--out {}: give a name that ends in .png or .apng",
            file.display()
        ))),
    }
}

/// A stage that is photographed.
struct Shoot<'a> {
    arguments: &'a Arguments,
    gpu: &'a Gpu,
    target: PictureTarget,
    stage: &'a mut Stage,
    progress: Progress,
}

impl Shoot<'_> {
    /// One file per picture.
    fn pictures(&mut self) -> Result<Vec<PathBuf>, Failure> {
        let Arguments { frames, out, .. } = self.arguments;
        let mut files = Vec::new();
        for frame in 0..*frames {
            let file = match frames {
                1 => out.clone(),
                _ => numbered(out, frame),
            };
            let picture = self.picture(frame)?;
            let png = with_texts(&self.texts(), |texts| picture.to_png(texts))?;
            std::fs::write(&file, png).map_err(|error| Failure::file(&file, error))?;
            files.push(file);
        }
        Ok(files)
    }

    /// All pictures in one file.
    fn animation(&mut self) -> Result<PathBuf, Failure> {
        let Arguments {
            frames,
            hz,
            size,
            out,
            ..
        } = self.arguments;
        let first = self.picture(0)?;
        let file = File::create(out).map_err(|error| Failure::file(out, error))?;
        let mut animation = with_texts(&self.texts(), |texts| {
            Animation::new(BufWriter::new(file), *size, *frames, *hz, texts)
        })?;
        animation.add(&first)?;
        for frame in 1..*frames {
            animation.add(&self.picture(frame)?)?;
        }
        animation.finish()?;
        Ok(out.clone())
    }

    /// Simulates up to a frame and draws it.
    fn picture(&mut self, frame: u32) -> Result<Picture, Failure> {
        let Arguments { at, frames, hz, .. } = self.arguments;
        let time_s = at + f64::from(frame) / f64::from(*hz);
        let last_s = at + f64::from(*frames) / f64::from(*hz);
        let substep_s = self.stage.meadow().scene.solver.substep_s;
        // A millionth of a sub-step forgives the rounding of the division.
        let ticks = (time_s / substep_s + 1e-6) as u32;
        while self.stage.meadow().ticks < ticks {
            self.stage.tick()?;
            self.progress.set(self.stage.meadow().time_s() / last_s);
        }
        self.stage.engine().check()?;
        let view = self.view()?;
        let overlay = self.arguments.overlay || self.arguments.awake_tiles;
        (self.stage).draw(self.gpu, &view, &self.target.view, overlay)?;
        Ok(self.target.read(self.gpu)?)
    }

    /// From where this moment is looked at.
    fn view(&self) -> Result<View, Failure> {
        let Arguments {
            camera,
            eye,
            target,
            ..
        } = self.arguments;
        let (Some(eye_m), Some(target_m)) = (*eye, *target) else {
            return Ok(self.stage.camera(camera.as_deref())?);
        };
        let free = Camera::at("eye", eye_m, target_m);
        Ok(scene_view(self.stage.meadow(), Some(&free)))
    }

    /// What a file says of its first picture.
    fn texts(&self) -> [(&'static str, String); 8] {
        let (meadow, stage) = (self.stage.meadow(), &self.stage);
        [
            ("Software", "sward".to_owned()),
            ("Version", env!("CARGO_PKG_VERSION").to_owned()),
            ("Scene", stage.loaded().name.clone()),
            ("Time", format!("{:.6} s", meadow.time_s())),
            ("Tick", meadow.ticks.to_string()),
            ("Seed", meadow.scene.grass.seed.to_string()),
            ("Engine", stage.engine().name().to_owned()),
            ("Adapter", self.gpu.adapter.name.clone()),
        ]
    }
}

/// Lends texts as the encoders take them.
fn with_texts<T>(texts: &[(&'static str, String)], encode: impl FnOnce(&[(&str, &str)]) -> T) -> T {
    let lent: Vec<(&str, &str)> = texts
        .iter()
        .map(|(key, text)| (*key, text.as_str()))
        .collect();
    encode(&lent)
}

/// `FILE_0000.png` from `FILE.png`.
fn numbered(file: &Path, frame: u32) -> PathBuf {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    file.with_file_name(format!("{stem}_{frame:04}.png"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_numbers_within_limits() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        for wrong in ["", "640", "0x1", "8193x1", "640x", "axb", "-1x5", "1x2x3"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_sun_is_a_height_and_perhaps_an_azimuth() {
        let told = sun("12,-90").map(|sun| [sun.elevation_deg, sun.azimuth_deg]);
        assert_eq!(told, Ok([12.0, -90.0]));
        assert_eq!(sun("5").map(|sun| sun.elevation_deg), Ok(5.0));
        for wrong in ["", "1", "91", "NaN", "10,", "10,400", "10,20,30"] {
            assert!(sun(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn places_are_three_numbers_within_limits() {
        assert_eq!(place("0,1.7,-3"), Ok([0.0, 1.7, -3.0]));
        for wrong in ["", "1,2", "1,2,3,4", "a,b,c", "NaN,0,0", "1e300,0,0"] {
            assert!(place(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn files_of_a_sequence_are_numbered() {
        let file = numbered(Path::new("a/b.c.png"), 7);
        assert_eq!(file, Path::new("a/b.c_0007.png"));
    }
}
