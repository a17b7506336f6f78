//! What keys and buttons do.

use super::camera::CameraMode;
use super::keys::Command;
use super::session::Session;
use crate::base::Vec3;
use crate::scene::Likes;

/// Distance of the point that the camera turns about, where it looks at nothing, in metres.
const FAR_PIVOT_M: f64 = 8.0;

impl Session {
    /// Does what a key or a button means; what goes wrong is shown as a message.
    pub(super) fn obey(&mut self, command: Command) {
        match command {
            Command::Pause => self.play.paused = !self.play.paused,
            Command::Step => {
                if let Err(error) = self.play.step() {
                    self.toasts.error(error);
                }
            }
            Command::Restart => {
                if let Err(error) = self.play.restart(&self.gpu) {
                    self.toasts.error(error);
                }
            }
            Command::PreviousScene => self.choose(self.play.scenes.line(-1)),
            Command::NextScene => self.choose(self.play.scenes.line(1)),
            Command::DropBall => self.drop_ball(),
            Command::TileOverlay => self.play.toggle_overlay(true),
            Command::AwakeTiles => self.play.toggle_overlay(false),
            Command::CameraMode => self.next_camera(),
            Command::FrameAll => {
                let (middle, radius_m) = self.play.whole_ball();
                self.frame_ball(middle, radius_m);
            }
            Command::FrameBody => match self.play.body_ball() {
                Some((middle, radius_m)) => self.frame_ball(middle, radius_m),
                None => self.toasts.news("this scene has no body to look at"),
            },
            Command::Panels => self.shown.panels = !self.shown.panels,
            Command::Help => self.shown.help = !self.shown.help,
            Command::CloseHelp => self.shown.help = false,
            Command::Screenshot => self.wants_picture = true,
        }
    }

    /// Gives a kind of plant another reference colour; the meadow grows anew.
    pub(super) fn recolour(&mut self, kind: usize, hsv: [f32; 3]) {
        let species = &self.play.stage.meadow().scene.grass.species;
        let Some(likes) = species.get(kind).and_then(|kind| kind.likes.clone()) else {
            return;
        };
        let likes = Likes { hsv, ..likes };
        if let Err(error) = self.play.stage.set_likes(&self.gpu, kind, likes) {
            self.toasts.error(error);
        }
    }

    /// Goes to a line of the menu and to its first camera.
    pub(super) fn choose(&mut self, line: usize) {
        match self.play.choose(&self.gpu, line) {
            Ok(()) => self.start_camera(),
            Err(error) => self.toasts.error(error),
        }
    }

    /// Shows the scene as its first camera does, or as a whole.
    pub(super) fn start_camera(&mut self) {
        self.follow_scene_camera(0);
        self.rig.mode = if self.play.stage.meadow().scene.cameras.is_empty() {
            CameraMode::Orbit
        } else {
            CameraMode::Scene(0)
        };
    }

    /// Takes the view of one of the scene's cameras as it is now.
    pub(super) fn follow_scene_camera(&mut self, place: usize) {
        let stage = &self.play.stage;
        let name = stage.meadow().scene.cameras.get(place);
        match stage.camera(name.map(|camera| camera.name.as_str())) {
            Ok(view) => {
                let from = view.eye_in_world;
                let bodies = &stage.meadow().bodies;
                let hit = bodies.ray(from.to_f64(), view.forward.to_f64(), 100.0);
                let distance_m =
                    hit.map_or(FAR_PIVOT_M, |hit| (Vec3::of(hit.point_m) - from).length());
                self.rig.adopt(&view, distance_m);
            }
            Err(error) => self.toasts.error(error),
        }
    }

    /// Orbit, fly, then the scene's cameras in turn.
    fn next_camera(&mut self) {
        let cameras = self.play.stage.meadow().scene.cameras.len();
        self.rig.mode = match self.rig.mode {
            CameraMode::Orbit => CameraMode::Fly,
            CameraMode::Fly if cameras > 0 => CameraMode::Scene(0),
            CameraMode::Scene(place) if place + 1 < cameras => CameraMode::Scene(place + 1),
            CameraMode::Fly | CameraMode::Scene(_) => CameraMode::Orbit,
        };
    }

    fn frame_ball(&mut self, middle: Vec3<f64>, radius_m: f64) {
        self.rig.mode = CameraMode::Orbit;
        self.rig.frame(middle, radius_m);
    }

    fn drop_ball(&mut self) {
        let Some((view, ray)) = self.pointer_ray() else {
            self.toasts.news("point at a place to drop a ball there");
            return;
        };
        match self.play.drop_ball(&view, ray) {
            Ok(Some(name)) => self.toasts.news(format!("{name} falls")),
            Ok(None) => self.toasts.news("nothing to drop a ball on there"),
            Err(error) => self.toasts.error(error),
        }
    }
}
