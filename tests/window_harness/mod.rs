//! A display, a window in it, and pictures that the window writes of itself.

use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use libtest_mimic::Failed;

/// How long a window may take to open, and a picture to appear: a software adapter beside other
/// work.
const PATIENCE: Duration = Duration::from_secs(60);
const GLANCE: Duration = Duration::from_millis(30);

/// What these tests lack on this machine.
pub fn missing() -> Option<String> {
    let programs = ["Xvfb", "xdotool"];
    if let Some(program) = programs.into_iter().find(|program| !is_installed(program)) {
        return Some(format!("{program} is not installed"));
    }
    let gpu = sward::gpu::Gpu::headless();
    gpu.err().map(|error| error.to_string())
}

/// Whether a program is on the path.
pub fn is_installed(program: &str) -> bool {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&paths).any(|folder| folder.join(program).is_file())
}

/// An empty folder of a trial's own.
pub fn folder(name: &str) -> Result<PathBuf, Failed> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("window")
        .join(name);
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    Ok(folder)
}

/// Runs a program to its end, and gives its exit code and what it wrote to stderr.
pub fn run_to_end(mut command: Command) -> Result<(Option<i32>, String), Failed> {
    let output = command.stdin(Stdio::null()).output()?;
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    Ok((output.status.code(), stderr))
}

/// A child process that does not outlive its trial.
struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        // It may have ended by itself, which is as good.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A display of its own.
pub struct Server {
    _process: Process,
    display: String,
}

impl Server {
    pub fn start() -> Result<Self, Failed> {
        let mut process = Process(
            Command::new("Xvfb")
                .args(["-displayfd", "1", "-screen", "0", "1024x768x24"])
                // Else the server starts anew, deaf for a moment, whenever its last client leaves:
                // an `xdotool` that looks for a window not yet there.
                .args(["-noreset", "-nolisten", "tcp"])
                .stdout(Stdio::piped())
                .stderr(Stdio::null())
                .spawn()?,
        );
        let stdout = process.0.stdout.take().ok_or("Xvfb has no stdout")?;
        let mut number = String::new();
        BufReader::new(stdout).read_line(&mut number)?;
        Ok(Self {
            _process: process,
            display: format!(":{}", number.trim()),
        })
    }

    /// As the variable `DISPLAY` has it.
    pub fn display(&self) -> &str {
        &self.display
    }
}

/// The program's window, alone on a display.
pub struct Window {
    program: Process,
    server: Server,
    id: String,
    folder: PathBuf,
    size: [u32; 2],
    shots: usize,
}

/// A picture of the window, as the program wrote it.
pub struct Shot {
    pub size: [u32; 2],
    pub scene: String,
    pub tick: u32,
    rgb: Vec<[u8; 3]>,
}

impl Window {
    /// Starts a display and the program, and waits for its window.
    pub fn open(folder: &Path, scene: &str, size: [u32; 2]) -> Result<Self, Failed> {
        let server = Server::start()?;
        let runtime = folder.join("runtime");
        fs::create_dir_all(&runtime)?;
        let program = Command::new(env!("CARGO_BIN_EXE_sward"))
            .args(["view", scene, "--size", &format!("{}x{}", size[0], size[1])])
            .args(["--out", "shots"])
            .current_dir(folder)
            .env("DISPLAY", server.display())
            .env("XDG_RUNTIME_DIR", &runtime)
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET")
            .stdin(Stdio::null())
            .stderr(File::create(folder.join("stderr"))?)
            .spawn()?;
        let mut window = Self {
            program: Process(program),
            server,
            id: String::new(),
            folder: folder.to_owned(),
            size,
            shots: 0,
        };
        window.id = window.wait_for("its window", |window| {
            let found = window.xdotool(&["search", "--name", "^sward$"]);
            found
                .ok()
                .and_then(|ids| ids.lines().next().map(str::to_owned))
        })?;
        // There is no window manager to give it the keyboard; it can have it once it is shown.
        let id = window.id.clone();
        window.wait_for("the keyboard", |window| {
            window.xdotool(&["windowfocus", &id]).ok()?;
            let focus = window.xdotool(&["getwindowfocus"]).ok()?;
            (focus.trim() == id).then_some(())
        })?;
        Ok(window)
    }

    /// Presses keys one after the other.
    pub fn keys(&self, keys: &[&str]) -> Result<(), Failed> {
        self.xdotool(&[&["key"], keys].concat()).map(|_| ())
    }

    /// Moves the pointer to a place in the window, which stands at the screen's corner.
    pub fn point(&self, place: [u32; 2]) -> Result<(), Failed> {
        let [x, y] = place.map(|c| c.to_string());
        self.xdotool(&["mousemove", "--window", &self.id, &x, &y])
            .map(|_| ())
    }

    /// Drags with the left button from one place to another, in a few moves.
    pub fn drag(&self, from: [u32; 2], to: [u32; 2]) -> Result<(), Failed> {
        self.point(from)?;
        self.xdotool(&["mousedown", "1"])?;
        for part in 1..=4 {
            let along = |axis: usize| {
                let (from, to) = (i64::from(from[axis]), i64::from(to[axis]));
                (from + (to - from) * part / 4) as u32
            };
            self.point([along(0), along(1)])?;
        }
        self.xdotool(&["mouseup", "1"]).map(|_| ())
    }

    pub fn resize(&mut self, size: [u32; 2]) -> Result<(), Failed> {
        let [width, height] = size.map(|c| c.to_string());
        self.xdotool(&["windowsize", "--sync", &self.id, &width, &height])?;
        self.size = size;
        Ok(())
    }

    /// Asks for pictures until one has this size: the program hears of a new size a little late.
    pub fn shot_of(&mut self, size: [u32; 2]) -> Result<Shot, Failed> {
        let start = Instant::now();
        loop {
            let shot = self.shot()?;
            if shot.size == size || start.elapsed() > PATIENCE {
                return Ok(shot);
            }
        }
    }

    /// Asks for a picture and reads it.
    pub fn shot(&mut self) -> Result<Shot, Failed> {
        let folder = self.folder.join("shots");
        let before = pictures(&folder);
        self.keys(&["F12"])?;
        let path = self.wait_for("a picture", |_| {
            pictures(&folder)
                .into_iter()
                .find(|path| !before.contains(path))
        })?;
        self.shots += 1;
        // In the order they were taken, for whoever looks at them after a failure.
        let kept = self.folder.join(format!("shot-{:02}.png", self.shots));
        fs::copy(&path, kept)?;
        Shot::read(&path)
    }

    /// Closes the program by its key and checks that it ends well.
    pub fn close(mut self) -> Result<(), Failed> {
        self.keys(&["ctrl+q"])?;
        let start = Instant::now();
        let status = loop {
            if let Some(status) = self.program.0.try_wait()? {
                break status;
            }
            if start.elapsed() > PATIENCE {
                return Err("the program does not end".into());
            }
            sleep(GLANCE);
        };
        match status.code() {
            Some(0) => Ok(()),
            code => Err(format!("exit {code:?}: {}", self.stderr()).into()),
        }
    }

    fn wait_for<T>(
        &mut self,
        what: &str,
        mut look: impl FnMut(&Self) -> Option<T>,
    ) -> Result<T, Failed> {
        let start = Instant::now();
        loop {
            if let Some(found) = look(self) {
                return Ok(found);
            }
            let ended = self.program.0.try_wait()?;
            if ended.is_some() || start.elapsed() > PATIENCE {
                let state = ended.map_or("runs".to_owned(), |status| status.to_string());
                let stderr = self.stderr();
                return Err(format!("no sign of {what}; program: {state}; {stderr}").into());
            }
            sleep(GLANCE);
        }
    }

    fn stderr(&self) -> String {
        fs::read_to_string(self.folder.join("stderr")).unwrap_or_default()
    }

    fn xdotool(&self, arguments: &[&str]) -> Result<String, Failed> {
        let output = Command::new("xdotool")
            .args(arguments)
            .env("DISPLAY", self.server.display())
            .stdin(Stdio::null())
            .output()?;
        if !output.status.success() {
            let stderr = String::from_utf8_lossy(&output.stderr);
            return Err(format!("xdotool {arguments:?}: {stderr}").into());
        }
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    }
}

/// Finished pictures in a folder.
fn pictures(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let paths = entries.flatten().map(|entry| entry.path());
    paths
        .filter(|path| path.extension().is_some_and(|e| e == "png"))
        .collect()
}

impl Shot {
    fn read(path: &Path) -> Result<Self, Failed> {
        let mut reader = png::Decoder::new(BufReader::new(File::open(path)?)).read_info()?;
        let mut rgba = vec![0; reader.output_buffer_size().ok_or("a picture too large")?];
        reader.next_frame(&mut rgba)?;
        let info = reader.info();
        let text = |keyword: &str| -> Result<String, Failed> {
            let found = info.utf8_text.iter().find(|text| text.keyword == keyword);
            Ok(found.ok_or("a picture without its texts")?.get_text()?)
        };
        Ok(Self {
            size: [info.width, info.height],
            scene: text("Scene")?,
            tick: text("Tick")?.parse()?,
            rgb: rgba.chunks_exact(4).map(|c| [c[0], c[1], c[2]]).collect(),
        })
    }

    /// Texels of a colour.
    pub fn count(&self, wanted: impl Fn([u8; 3]) -> bool) -> usize {
        self.rgb.iter().filter(|&&rgb| wanted(rgb)).count()
    }

    /// Texels that are not alike in two pictures of one size.
    pub fn differing(&self, other: &Self) -> usize {
        self.differing_where(other, |_, _| true)
    }

    /// Of these, the ones within `radius` of a place.
    pub fn differing_within(&self, other: &Self, place: [u32; 2], radius: u32) -> usize {
        self.differing_where(other, |x, y| {
            let (dx, dy) = (x.abs_diff(place[0]), y.abs_diff(place[1]));
            dx * dx + dy * dy <= radius * radius
        })
    }

    /// Of these, the ones left of a column.
    pub fn differing_left_of(&self, other: &Self, column: u32) -> usize {
        self.differing_where(other, |x, _| x < column)
    }

    fn differing_where(&self, other: &Self, counts: impl Fn(u32, u32) -> bool) -> usize {
        assert_eq!(self.size, other.size, "pictures of one size");
        let pairs = self.rgb.iter().zip(&other.rgb).zip(0..);
        pairs
            .filter(|((a, b), i)| a != b && counts(i % self.size[0], i / self.size[0]))
            .count()
    }
}
