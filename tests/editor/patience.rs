//! Waiting for the editor by what it does, never by the clock: a busy machine makes it slow, not wrong.

use std::{thread, time::Duration};

use eframe::egui::ViewportId;
use egui_kittest::Harness;

/// Frames one after another that ask for no other soon: then nothing more will come.
const IDLE: u32 = 500;
/// The editor waits at most two seconds for the hand to rest before it goes on.
const SOON: Duration = Duration::from_secs(5);
/// Far more frames than anything here takes: those are hundreds, and some ten thousand where the view draws a final picture
/// on a busy machine meanwhile.
const MOST: u32 = 200_000;

/// Steps until `done`; gives up where nothing is under way any more, `is_busy` with threads of its own
/// neither, and where there is no end to it.
pub fn wait<S>(
    window: &mut Harness<'_, S>,
    what: &str,
    is_busy: impl Fn(&mut S) -> bool,
    mut done: impl FnMut(&mut S) -> bool,
) {
    let mut idle = 0;
    for _ in 0..MOST {
        if done(window.state_mut()) {
            return;
        }
        window.step();
        let asked = window.output().viewport_output[&ViewportId::ROOT].repaint_delay;
        idle = if asked < SOON || is_busy(window.state_mut()) { 0 } else { idle + 1 };
        assert!(idle < IDLE, "{what} never comes, and nothing is under way any more");
        // The editor waits for the hand to rest in real time, which takes no more frames than this lets pass.
        thread::sleep(Duration::from_millis(1));
    }
    panic!("{what} does not come in {MOST} frames");
}

/// What is seen. Kittest gives up where the device has more to do than ten seconds of it: its work is
/// waited for, and then it is asked again.
pub fn picture<S>(window: &mut Harness<'_, S>, device: &wgpu::Device) -> image::RgbaImage {
    const TRIES: u32 = 20;
    for _ in 1..TRIES {
        device.poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
        if let Ok(picture) = window.render() {
            return picture;
        }
    }
    window.render().expect("the picture is drawn")
}

/// Writes what is seen, for people.
pub fn shoot<S>(window: &mut Harness<'_, S>, device: &wgpu::Device, name: &str) {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    picture(window, device).save(folder.join(format!("{name}.png"))).expect("the folder can be written");
}
