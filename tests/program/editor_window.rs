//! The real program in a real window, on an X server without a screen.
#![cfg(all(feature = "editor", target_os = "linux"))]

use std::{
    env, fs,
    io::{BufRead, BufReader},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    thread,
    time::Duration,
};

use nephos::scene::{Preset, Scene};

/// Looks at the program one after another that find that it has used no CPU time: a minute of them, then
/// it does nothing more. A busy machine makes it slow, but not idle.
const IDLE: u32 = 200;

fn on_path(program: &str) -> bool {
    let path = env::var_os("PATH").unwrap_or_default();
    env::split_paths(&path).any(|folder| folder.join(program).is_file())
}

/// A program that ends with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// An X server that draws into a file.
struct Screen {
    display: String,
    pixels: PathBuf,
    _server: Running,
}

impl Screen {
    fn open(folder: &Path) -> Self {
        let mut command = Command::new("Xvfb");
        command.args([
            "-displayfd",
            "1",
            "-screen",
            "0",
            "1280x720x24",
            "-nolisten",
            "tcp",
            "-noreset",
            "-fbdir",
        ]);
        let mut server =
            command.arg(folder).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("Xvfb starts");
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        Self {
            display: format!(":{}", number.trim()),
            pixels: folder.join("Xvfb_screen0"),
            _server: Running(server),
        }
    }

    /// What the screen shows: width and RGB, row by row (the X Window dump format, version 7).
    fn shot(&self) -> (usize, Vec<[u8; 3]>) {
        let dump = fs::read(&self.pixels).unwrap();
        let word = |i: usize| u32::from_be_bytes(dump[4 * i..4 * i + 4].try_into().unwrap()) as usize;
        let (header, width, height, stride, colors) = (word(0), word(4), word(5), word(12), word(19));
        assert_eq!((word(7), word(11)), (0, 32), "32 bits a pixel, blue first");
        let pixels = &dump[header + 12 * colors..];
        let row = |y: usize| pixels[y * stride..][..4 * width].chunks_exact(4).map(|p| [p[2], p[1], p[0]]);
        (width, (0..height).flat_map(row).collect())
    }

    fn xdotool(&self, arguments: &[&str]) -> bool {
        let mut command = Command::new("xdotool");
        command.env("DISPLAY", &self.display).args(arguments).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    }
}

fn start(screen: &Screen, home: &Path, scene: Option<&Path>) -> Running {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nephos"));
    if let Some(scene) = scene {
        command.arg("edit").arg(scene);
    }
    command.env_remove("WAYLAND_DISPLAY").env("DISPLAY", &screen.display).env("HOME", home);
    command
        .env("XDG_RUNTIME_DIR", home)
        .env("XDG_CONFIG_HOME", home.join("config"))
        .env("XDG_STATE_HOME", home.join("state"));
    Running(command.spawn().unwrap())
}

/// Waits until `true`, and tells in words what never came.
fn wait(what: &str, program: &mut Running, mut done: impl FnMut() -> bool) {
    let (mut idle, mut used) = (0, 0.0);
    while !done() {
        assert!(program.0.try_wait().unwrap().is_none(), "the program ended before there was {what}");
        let before = std::mem::replace(&mut used, cpu_seconds(program.0.id()));
        idle = if used > before { 0 } else { idle + 1 };
        assert!(idle < IDLE, "there never was {what}");
        thread::sleep(Duration::from_millis(300));
    }
}

/// Mean colour of a rectangle.
fn mean((width, pixels): &(usize, Vec<[u8; 3]>), [x, y, w, h]: [usize; 4]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for row in y..y + h {
        for pixel in &pixels[row * width + x..][..w] {
            sum.iter_mut().zip(pixel).for_each(|(sum, c)| *sum += f64::from(*c) / (w * h) as f64);
        }
    }
    sum
}

/// Seconds of CPU time that a process has used.
fn cpu_seconds(process: u32) -> f64 {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).unwrap();
    let fields: Vec<&str> = stat.rsplit_once(')').unwrap().1.split_whitespace().collect();
    // User and system time, in the hundredths that Linux tells everyone.
    fields[11..13].iter().map(|ticks| ticks.parse::<f64>().unwrap() / 100.0).sum()
}

/// Whether no thread of a process wants a CPU, which it may want and not get.
fn is_asleep(process: u32) -> bool {
    let threads = fs::read_dir(format!("/proc/{process}/task")).unwrap();
    threads.flatten().all(|thread| {
        // A thread that has just ended has no file any more.
        let stat = fs::read_to_string(thread.path().join("stat")).unwrap_or_default();
        stat.rsplit_once(')').is_none_or(|(_, rest)| rest.trim_start().starts_with('S'))
    })
}

#[test]
fn the_window_shows_the_cloud_rests_and_survives_a_kill() {
    if !on_path("Xvfb") {
        println!("skipped: there is no Xvfb here (Debian: apt-get install xvfb)");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let screen = Screen::open(folder.path());
    let scene = folder.path().join("sphere.json");
    Preset::Sphere.scene(1).save(&scene).unwrap();
    let mut program = start(&screen, folder.path(), Some(&scene));

    // Left the outliner, right the inspector, between them a cloud before a blue sky.
    wait("a cloud before a sky", &mut program, || {
        let shot = screen.shot();
        let panel = mean(&shot, [20, 400, 120, 100]);
        let sky = mean(&shot, [300, 130, 60, 40]);
        let cloud = mean(&shot, [570, 340, 40, 40]);
        let is_dark = panel.iter().all(|c| (20.0..60.0).contains(c));
        is_dark && sky[2] > sky[0] + 30.0 && cloud[0] > 90.0 && cloud[0] > sky[0] + 30.0
    });

    // Once the picture is final, nothing is drawn any more.
    let process = program.0.id();
    let mut used = cpu_seconds(process);
    wait("rest", &mut program, || {
        let looks = (0..20).map(|_| {
            thread::sleep(Duration::from_millis(100));
            is_asleep(process)
        });
        let asleep = looks.filter(|is_asleep| *is_asleep).count();
        let before = std::mem::replace(&mut used, cpu_seconds(process));
        // Of the two seconds, 3 %.
        used - before < 0.06 && asleep >= 18
    });

    if !on_path("xdotool") {
        println!("the rest is skipped: there is no xdotool here (Debian: apt-get install xdotool)");
        return;
    }
    assert!(screen.xdotool(&["search", "--onlyvisible", "--name", "nephos", "windowfocus", "--sync"]));
    screen.xdotool(&["key", "shift+a"]);
    let recovery = folder.path().join("state/nephos/recovery");
    let kept = || {
        let files = fs::read_dir(&recovery).into_iter().flatten().flatten().map(|file| file.path());
        files.filter(|path| path.extension().is_some_and(|e| e == "json")).count()
    };
    wait("a copy of the unsaved work", &mut program, || kept() == 1);
    // Killed, without a chance to write anything.
    drop(program);
    assert_eq!(Scene::load(&scene).unwrap(), Preset::Sphere.scene(1));

    // Alone, on a desktop, the program is the editor; it offers what was left: Restore has
    // the focus of the keyboard's first step.
    let mut program = start(&screen, folder.path(), None);
    wait("a window", &mut program, || {
        screen.xdotool(&["search", "--onlyvisible", "--name", "nephos", "windowfocus", "--sync"])
    });
    wait("the restored scene in the title", &mut program, || {
        screen.xdotool(&["key", "Tab", "space"]);
        screen.xdotool(&["search", "--onlyvisible", "--name", "sphere.json"])
    });
}
