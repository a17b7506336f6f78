//! The ground, drawn more or less finely.

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::gpu::Gpu;
use sward::render::{TerrainDetail, View};

use super::{ALL, Shown, Stage, WHOLE, difference, hold};

/// A field large enough to be drawn through its bintree: in full, within a pixel, and within many.
pub fn a_coarser_ground_looks_like_the_full_one(gpu: &Gpu) -> Result<(), Failed> {
    let scene = "(terrain: (ground: Rolling(size_m: (600, 600), spacing_m: 5, amplitude_m: 30, \
        wavelength_m: 200, octaves: 5, seed: 3)), grass: (species: []))";
    let mut stage = Stage::new(gpu, scene, 0)?;
    let far = Shown {
        view: View::look_at(Vec3::new(0.0, 90.0, 330.0), Vec3::ZERO, 45.0),
        bodies: false,
        blades: false,
        active: false,
        ..ALL
    };
    let mut shoot = |error_px: f32| -> Result<_, Failed> {
        stage.renderer.terrain_detail = TerrainDetail {
            error_px,
            budget: 40_000,
        };
        let picture = stage.shoot(gpu, far)?;
        let mesh = stage.renderer.ground_mesh().ok_or("no mesh was drawn")?;
        Ok((picture, mesh))
    };
    let (full, all) = shoot(0.0)?;
    let (fine, few) = shoot(1.0)?;
    let (coarse, fewer) = shoot(30.0)?;
    hold(
        all.worst_px == 0.0 && few.triangles < all.triangles / 2,
        format!("{all:?}, {few:?}"),
    )?;
    hold(fewer.triangles < few.triangles, format!("{fewer:?}"))?;
    // Nothing moves by more than a pixel: less changes than if everything moved down by one.
    let mut lower = full.clone();
    let row = 4 * lower.width as usize;
    lower
        .rgba8
        .copy_within(..row * (lower.height as usize - 1), row);
    let moved = difference(&full, &lower, WHOLE);
    let (near, off) = (
        difference(&full, &fine, WHOLE),
        difference(&full, &coarse, WHOLE),
    );
    hold(
        near < moved && near < 0.5 * off,
        format!("within a pixel {near} steps, moved by one {moved}, within thirty {off}"),
    )
}
