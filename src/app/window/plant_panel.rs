//! What the panels let one change of the plants: how many are drawn, and which ground each kind likes.

use egui::Slider;

use super::panels::Wish;
use super::play::Play;
use crate::app::values::DENSITIES;

/// Sliders for the density, and for the reference colour of every kind that has one.
pub fn show(ui: &mut egui::Ui, play: &Play, wishes: &mut Vec<Wish>) {
    let mut factor = play.stage.detail.density;
    let [least, most] = DENSITIES;
    ui.small("plants drawn");
    let slider = Slider::new(&mut factor, least..=most).logarithmic(true);
    if ui.add(slider).changed() {
        wishes.push(Wish::Density(factor));
    }
    let kinds = play.stage.meadow().scene.grass.species.iter().enumerate();
    for (kind, species) in kinds {
        let Some(likes) = &species.likes else {
            continue;
        };
        ui.collapsing(format!("{} likes", species.name), |ui| {
            let mut hsv = likes.hsv;
            let rows = hsv.iter_mut().zip(["hue", "saturation", "value"]);
            let changed = rows.zip([360.0, 1.0, 1.0]).map(|((number, name), most)| {
                let slider = Slider::new(number, 0.0..=most).text(name);
                ui.add(slider).changed()
            });
            if changed.fold(false, |any, one| any | one) {
                wishes.push(Wish::Colour { kind, hsv });
            }
        });
    }
}
