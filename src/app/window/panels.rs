//! What the panels show, and what is wished for in them.

use egui::{Align2, Color32, RichText};

use super::camera::CameraMode;
use super::keys::{BINDINGS, Command, HELD};
use super::play::Play;
use super::toast::Toasts;
use crate::gpu::AdapterReport;
use crate::render::TileTone;

/// Width of the panel, in points.
const PANEL_POINTS: f32 = 236.0;
/// Height of the window that the help leaves free, in points.
const HELP_MARGIN: f32 = 60.0;
/// Sample of a colour in the legend, in points.
const SWATCH: egui::Vec2 = egui::vec2(11.0, 11.0);
const WARNING: Color32 = Color32::from_rgb(255, 196, 92);
const WRONG: Color32 = Color32::from_rgb(255, 120, 104);

/// What a click in a panel asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wish {
    Do(Command),
    Scene(usize),
    /// Factor of the number of plants drawn.
    Density(f32),
    /// Another reference colour for a kind of plant: hue in degrees, saturation, value.
    Colour {
        kind: usize,
        hsv: [f32; 3],
    },
}

/// What the panels tell of the frame.
pub struct Facts<'a> {
    pub play: &'a Play,
    pub adapter: &'a AdapterReport,
    /// Smoothed time between frames, in milliseconds.
    pub frame_ms: f64,
    pub camera: &'a CameraMode,
    pub speed_m_per_s: f64,
    /// Sides of the scene's picture over those of the window.
    pub scale: f64,
}

/// Which panels are open.
#[derive(Clone, Copy, Debug)]
pub struct Shown {
    pub panels: bool,
    pub help: bool,
}

/// Builds all panels and gives what was wished for.
pub fn show(ui: &mut egui::Ui, facts: &Facts<'_>, shown: Shown, toasts: &mut Toasts) -> Vec<Wish> {
    let mut wishes = Vec::new();
    if shown.panels {
        let frame = egui::Frame::side_top_panel(ui.style()).fill(Color32::from_black_alpha(205));
        egui::Panel::left("panel")
            .resizable(false)
            .exact_size(PANEL_POINTS)
            .frame(frame)
            .show(ui, |ui| {
                egui::ScrollArea::vertical()
                    .auto_shrink(false)
                    .show(ui, |ui| side_panel(ui, facts, &mut wishes));
            });
        banner(ui, facts);
        if facts.play.overlay {
            legend(ui, facts);
        }
        if let Some(share) = facts.play.stage.pending_light() {
            light_bar(ui, share);
        }
    }
    if shown.help {
        help(ui);
    }
    messages(ui, shown, toasts);
    wishes
}

fn side_panel(ui: &mut egui::Ui, facts: &Facts<'_>, wishes: &mut Vec<Wish>) {
    let play = facts.play;
    ui.horizontal(|ui| {
        let pause = if play.paused { "go on" } else { "pause" };
        for (text, command) in [
            (pause, Command::Pause),
            ("step", Command::Step),
            ("restart", Command::Restart),
        ] {
            if ui.button(text).clicked() {
                wishes.push(Wish::Do(command));
            }
        }
    });
    ui.horizontal(|ui| {
        for (text, on, command) in [
            (
                "tiles",
                play.overlay && play.stage.resting_boxes,
                Command::TileOverlay,
            ),
            (
                "awake",
                play.overlay && !play.stage.resting_boxes,
                Command::AwakeTiles,
            ),
            ("help", false, Command::Help),
        ] {
            if ui.selectable_label(on, text).clicked() {
                wishes.push(Wish::Do(command));
            }
        }
        ui.weak("F1 keys, Tab hides");
    });
    ui.separator();
    scene_list(ui, play, wishes);
    ui.separator();
    measures(ui, facts);
    ui.separator();
    super::plant_panel::show(ui, play, wishes);
}

fn scene_list(ui: &mut egui::Ui, play: &Play, wishes: &mut Vec<Wish>) {
    for (line, entry) in play.scenes.entries.iter().enumerate() {
        let is_current = line == play.scenes.current;
        let name = match &entry.description {
            Ok(_) => RichText::new(&entry.name),
            Err(_) => RichText::new(&entry.name).color(WRONG),
        };
        let words = entry.description.as_ref().unwrap_or_else(|error| error);
        let label = ui.selectable_label(is_current, name).on_hover_text(words);
        if label.clicked() {
            wishes.push(Wish::Scene(line));
        }
        if is_current {
            ui.small(words);
        }
    }
}

fn measures(ui: &mut egui::Ui, facts: &Facts<'_>) {
    let play = facts.play;
    let meadow = play.stage.meadow();
    let tiles = play.tile_counts();
    let drawn = play.stage.blade_counts();
    let plants = u64::from(meadow.field.grid.plants_per_tile());
    let awake = u64::from(tiles.colliding + tiles.recovering);
    egui::Grid::new("measures")
        .num_columns(2)
        .spacing([8.0, 1.0])
        .show(ui, |ui| {
            let mut row = |name: &str, value: String| {
                ui.small(name);
                ui.add(egui::Label::new(RichText::new(value).small().monospace()).wrap());
                ui.end_row();
            };
            row("time", format!("{:.2} s", meadow.time_s()));
            row("frame", frame_time(facts.frame_ms));
            for (pass, ms) in play.pass_ms() {
                row(&format!("  {pass}"), format!("{ms:.2} ms"));
            }
            if play.stage.discarded_s() > 0.0 {
                let text = format!("{:.1} s, too slow", play.stage.discarded_s());
                row("left out", text);
            }
            row("tiles", format!("{}", meadow.field.grid.tile_count()));
            row("  resting", format!("{}", tiles.resting));
            row("  colliding", format!("{}", tiles.colliding));
            row("  recovering", format!("{}", tiles.recovering));
            row("plants moved", format!("{}", awake * plants));
            row("blades drawn", format!("{}", drawn.blades));
            row("triangles", format!("{}", drawn.triangles));
            if let Some(drawn) = play.stage.billboard_counts() {
                row("billboards", format!("{}", drawn.billboards));
                row("  refined", format!("{}", drawn.refined));
                let tiles = format!("{}, {} behind hills", drawn.tiles, drawn.hidden_tiles);
                row("  tiles", tiles);
                row(
                    "  on device",
                    bytes(play.stage.billboard_bytes().unwrap_or(0)),
                );
            }
            row("grass state", bytes(meadow.state_bytes()));
            let bodies = meadow.bodies.info();
            let awake = bodies.filter(|body| body.awake).count();
            let all = meadow.bodies.info().count();
            row("bodies", format!("{all}, {awake} awake"));
            if let Some(selected) = &play.selected {
                row("selected", selected.clone());
            }
            row("camera", camera(facts));
            row("engine", play.stage.engine().name().to_owned());
            row("adapter", facts.adapter.name.clone());
            row("driver", facts.adapter.driver.clone());
        });
    limits(ui, facts);
}

/// Limits that were reached, so that nothing is capped in silence.
fn limits(ui: &mut egui::Ui, facts: &Facts<'_>) {
    let meadow = facts.play.stage.meadow();
    let counters = &meadow.counters;
    for (count, what) in [
        (counters.capped_sweeps, "sub-steps with too few sweeps"),
        (counters.refused_tiles, "tiles refused for want of state"),
        (meadow.bodies.quarantined().len() as u64, "bodies taken out"),
    ] {
        if count > 0 {
            ui.colored_label(WARNING, format!("{count} {what}"));
        }
    }
}

fn camera(facts: &Facts<'_>) -> String {
    match facts.camera {
        CameraMode::Orbit => "orbit".to_owned(),
        CameraMode::Fly => format!("fly, {:.1} m/s", facts.speed_m_per_s),
        CameraMode::Scene(place) => {
            let cameras = &facts.play.stage.meadow().scene.cameras;
            let name = cameras.get(*place).map_or("whole", |c| c.name.as_str());
            format!("scene's '{name}'")
        }
    }
}

/// Says that a software adapter is at work, and what that costs.
fn banner(ui: &egui::Ui, facts: &Facts<'_>) {
    if !facts.adapter.is_software {
        return;
    }
    let share = 100.0 * facts.scale;
    area(ui, "banner", Align2::RIGHT_TOP, [-8.0, 8.0], |ui| {
        ui.colored_label(WARNING, "software adapter: slow")
            .on_hover_text("No graphics card was found; the processor draws.");
        ui.small(format!("fewer blades, picture at {share:.0}%"));
    });
}

fn legend(ui: &egui::Ui, facts: &Facts<'_>) {
    let counts = facts.play.tile_counts();
    let colour = |tone: TileTone| {
        let [r, g, b] = tone.srgb();
        Color32::from_rgb(r, g, b)
    };
    area(ui, "legend", Align2::RIGHT_BOTTOM, [-8.0, -8.0], |ui| {
        for (colour, count, state) in [
            (colour(TileTone::Resting), counts.resting, "resting"),
            (colour(TileTone::Colliding), counts.colliding, "colliding"),
            (
                colour(TileTone::Recovering),
                counts.recovering,
                "recovering",
            ),
        ] {
            ui.horizontal(|ui| {
                let (square, _) = ui.allocate_exact_size(SWATCH, egui::Sense::hover());
                ui.painter().rect_filled(square, 2.0, colour);
                ui.label(format!("{count} {state}"));
            });
        }
    });
}

fn help(ui: &egui::Ui) {
    area(ui, "help", Align2::CENTER_CENTER, [0.0, 0.0], |ui| {
        let rows = ui.ctx().content_rect().height() - HELP_MARGIN;
        egui::ScrollArea::vertical()
            .max_height(rows)
            .show(ui, |ui| {
                egui::Grid::new("keys").spacing([16.0, 2.0]).show(ui, |ui| {
                    let bound = BINDINGS.iter().map(|b| (b.key, b.help));
                    for (key, text) in bound.chain(HELD.iter().copied()) {
                        ui.strong(key);
                        ui.label(text);
                        ui.end_row();
                    }
                });
            });
    });
}

/// How far light volumes are.
fn light_bar(ui: &egui::Ui, share: f64) {
    area(ui, "light", Align2::CENTER_TOP, [0.0, 8.0], |ui| {
        let bar = egui::ProgressBar::new(share as f32).text("light volumes");
        ui.add(bar.desired_width(PANEL_POINTS));
    });
}

/// News belong to the panels; errors are shown in any case.
fn messages(ui: &egui::Ui, shown: Shown, toasts: &mut Toasts) {
    let current: Vec<_> = toasts
        .current()
        .filter(|toast| shown.panels || toast.is_error)
        .collect();
    if current.is_empty() {
        return;
    }
    area(ui, "toasts", Align2::CENTER_BOTTOM, [0.0, -8.0], |ui| {
        for toast in current {
            let colour = if toast.is_error {
                WRONG
            } else {
                Color32::WHITE
            };
            ui.colored_label(colour, &toast.text);
        }
    });
}

/// A box over the picture.
fn area(
    ui: &egui::Ui,
    name: &'static str,
    align: Align2,
    offset: [f32; 2],
    contents: impl FnOnce(&mut egui::Ui),
) {
    egui::Area::new(egui::Id::unique(name))
        .anchor(align, offset)
        .default_size(ui.ctx().content_rect().size())
        .show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style())
                .fill(Color32::from_black_alpha(205))
                .show(ui, contents);
        });
}

fn frame_time(ms: f64) -> String {
    let per_s = 1e3 / ms.max(1e-3);
    let digits = if per_s < 10.0 { 1 } else { 0 };
    format!("{ms:.0} ms, {per_s:.digits$}/s")
}

fn bytes(count: u64) -> String {
    const MIB: u64 = 1 << 20;
    match count {
        0..1024 => format!("{count} B"),
        1024..MIB => format!("{:.1} KiB", count as f64 / 1024.0),
        _ => format!("{:.1} MiB", count as f64 / MIB as f64),
    }
}
