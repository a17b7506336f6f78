use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::*;
use crate::bodies::{Bodies, Occluders};
use crate::render::Sun;
use crate::render::light::{LightGrid, TraceProgress};
use crate::scene::Scene;
use crate::terrain::height_grid;

/// A folder of a test's own that goes away with it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let own = format!("sward-light-{}-{name}", std::process::id());
        let folder = std::env::temp_dir().join(own);
        fs::create_dir_all(&folder).expect("a folder for temporary files");
        Self(folder)
    }

    fn cache(&self) -> LightCache {
        LightCache::in_folder(&self.0)
    }

    fn files(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(&self.0).expect("the folder");
        let mut files: Vec<_> = entries.map(|entry| entry.expect("a file").path()).collect();
        files.sort();
        files
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Nothing depends on it.
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// The light of a small scene with a wall at an x.
fn task(wall_x: f32, cache: LightCache) -> LightTask {
    let text = format!(
        "(terrain: (ground: Flat(size_m: (4, 4))), light: Some((cell_m: 1, slices: 3, rays: 64)), \
         bodies: [(name: \"wall\", shape: Box(size_m: (0.4, 2, 3)), position_m: ({wall_x}, 1, 0), \
         motion: Fixed)])"
    );
    let scene: Scene = ron::from_str(&text).expect("a scene");
    let settings = scene.light.expect("the key");
    let ground = height_grid(&scene.terrain, &Default::default()).expect("flat");
    let bodies = Bodies::new(&scene, &Default::default(), &ground).expect("plain bodies");
    LightTask {
        settings,
        grid: LightGrid::new(&settings, &ground),
        occluders: Arc::new(Occluders::new(&bodies).expect("a ground")),
        cache,
        daylight: Sun::default().daylight(),
        known: None,
    }
}

fn made(task: &LightTask) -> LightMade {
    task.make(&TraceProgress::default())
        .expect("nobody ends it")
}

#[test]
fn a_kept_file_gives_the_same_bytes_and_another_scene_misses_it() {
    let folder = Folder::new("kept");
    let first = made(&task(0.5, folder.cache()));
    assert_eq!(
        (first.source, first.notices.len()),
        (LightSource::Traced, 0)
    );
    let files = folder.files();
    let bytes = fs::read(&files[0]).expect("the file");

    let again = made(&task(0.5, folder.cache()));
    assert_eq!((again.source, again.notices.len()), (LightSource::Cache, 0));
    assert_eq!(again.texels, first.texels);
    assert_eq!(made(&task(0.5, LightCache::none())).texels, first.texels);
    assert_eq!(
        (folder.files(), fs::read(&files[0]).ok()),
        (files, Some(bytes))
    );

    // The sun does not hide anything: other light from the same file.
    let mut evening = task(0.5, folder.cache());
    let low = Sun {
        elevation_deg: 5.0,
        azimuth_deg: 90.0,
    };
    evening.daylight = low.daylight();
    let evening = made(&evening);
    assert_eq!(evening.source, LightSource::Cache);
    assert_ne!(evening.texels.irradiance, first.texels.irradiance);
    assert_eq!(evening.texels.openness, first.texels.openness);

    let moved = made(&task(0.75, folder.cache()));
    assert_eq!(moved.source, LightSource::Traced);
    assert_eq!(folder.files().len(), 2);
}

#[test]
fn a_broken_file_is_told_of_and_made_anew() {
    let folder = Folder::new("broken");
    let right = made(&task(0.5, folder.cache()));
    let file = folder.files().remove(0);
    let bytes = fs::read(&file).expect("the file");
    let mut flipped = bytes.clone();
    flipped[100] ^= 1;
    let mut longer = bytes.clone();
    longer.push(0);
    for wrong in [&flipped, &longer, &bytes[..50].to_vec(), &Vec::new()] {
        fs::write(&file, wrong).expect("a writable file");
        let anew = made(&task(0.5, folder.cache()));
        assert_eq!(anew.source, LightSource::Traced);
        assert_eq!(anew.texels, right.texels);
        let told = anew.notices.join("\n");
        let name = file.display().to_string();
        assert!(
            told.contains(&name) && told.contains("worked out anew"),
            "{told}"
        );
        assert_eq!(
            fs::read(&file).ok().as_ref(),
            Some(&bytes),
            "the file is right again"
        );
    }
}

#[test]
fn a_file_of_another_scene_is_not_taken() {
    let folder = Folder::new("other");
    made(&task(0.5, folder.cache()));
    let other = folder.files().remove(0);
    let own = folder.cache().file(task(0.75, folder.cache()).key());
    fs::copy(&other, own.expect("a folder")).expect("a writable folder");
    let anew = made(&task(0.75, folder.cache()));
    assert_eq!(anew.source, LightSource::Traced);
    assert!(
        anew.notices[0].contains("another scene"),
        "{:?}",
        anew.notices
    );
}

/// A folder that cannot be made, since a file has its name: for any user, unlike one without rights.
#[test]
fn a_folder_that_cannot_be_written_to_is_told_of_and_nothing_else() {
    let folder = Folder::new("unwritable");
    let file = folder.0.join("no_folder");
    fs::write(&file, "a file").expect("a writable folder");
    let cache = LightCache::in_folder(file.join("sward"));
    let without = made(&task(0.5, cache));
    assert_eq!(without.texels, made(&task(0.5, LightCache::none())).texels);
    let told = without.notices.join("\n");
    assert!(
        told.contains("not kept") && told.contains("SWARD_CACHE"),
        "{told}"
    );
    assert_eq!(fs::read(&file).ok().as_deref(), Some(&b"a file"[..]));
}

#[test]
fn a_job_tells_how_far_it_is_and_ends_when_it_is_dropped() {
    let folder = Folder::new("job");
    let job = LightJob::start(task(0.5, folder.cache()));
    while !job.is_finished() {
        assert!((0.0..=1.0).contains(&job.done_share()));
        std::thread::yield_now();
    }
    assert_eq!(job.done_share(), 1.0);
    let texels = job.finish().expect("light volumes").texels;
    assert_eq!(texels, made(&task(0.5, LightCache::none())).texels);

    let unwanted = TraceProgress::default();
    unwanted
        .is_unwanted
        .store(true, std::sync::atomic::Ordering::Relaxed);
    assert!(task(0.75, folder.cache()).make(&unwanted).is_none());
    // Nothing half done is kept.
    assert_eq!(folder.files().len(), 1);
    assert!(
        folder
            .files()
            .iter()
            .all(|file| Path::new(file).extension() == Some("bin".as_ref()))
    );
}
