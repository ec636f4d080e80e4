//! Movies, through ffmpeg: frames go to it as they are drawn, and the file gets its name when it
//! is whole.

use std::{
    ffi::OsString,
    io::{self, Read, Write},
    path::{Path, PathBuf},
    process::{Child, ChildStdin, Command, Stdio},
    thread::{self, JoinHandle},
};

use crate::{Error, Result, files::Beside};

/// What kind of movie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Container {
    /// H.264 in MP4, for every player.
    Mp4,
    /// VP9 in WebM, for the web.
    Webm,
}

impl Container {
    /// By the ending of the file; none where it is no movie.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_lowercase().as_str() {
            "mp4" => Some(Self::Mp4),
            "webm" => Some(Self::Webm),
            _ => None,
        }
    }

    /// What ffmpeg is to do. Pictures of sky show bands early: the quality is high.
    fn words(self) -> &'static [&'static str] {
        match self {
            Self::Mp4 => &[
                "-c:v",
                "libx264",
                "-preset",
                "medium",
                "-crf",
                "16",
                "-movflags",
                "+faststart",
                "-f",
                "mp4",
            ],
            Self::Webm => &["-c:v", "libvpx-vp9", "-crf", "20", "-b:v", "0", "-row-mt", "1", "-f", "webm"],
        }
    }
}

/// Players want even sizes, and to be told which colours they get: those of HD screens. What is told of the output
/// alone is lost where filters know better, so that the last of them tells it.
const COLOURS: &str = "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,format=yuv420p,\
     setparams=range=tv:colorspace=bt709:color_primaries=bt709:color_trc=bt709";

/// A movie under way.
pub struct Movie {
    path: PathBuf,
    /// What is written before it is whole; nothing once it has its name.
    beside: Option<Beside>,
    ffmpeg: Child,
    frames: Option<ChildStdin>,
    said: Option<JoinHandle<String>>,
}

impl Movie {
    /// Begins a movie of `size` pixels.
    ///
    /// # Errors
    /// [`Error::Argument`] where there is no ffmpeg: the sentence says what to do.
    pub fn begin(path: &Path, container: Container, [width, height]: [u32; 2], fps: f64) -> Result<Self> {
        let beside = Beside::new(path)?;
        // A name with a colon is no protocol.
        let mut output = OsString::from("file:");
        output.push(beside.path());
        let mut command = Command::new("ffmpeg");
        command
            .args(["-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24"])
            .args(["-video_size", &format!("{width}x{height}"), "-framerate", &rate(fps), "-i", "-"])
            .args([
                "-vf",
                COLOURS,
                "-colorspace",
                "bt709",
                "-color_primaries",
                "bt709",
                "-color_trc",
                "bt709",
            ])
            .args(container.words())
            .arg(&output)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let mut ffmpeg = command.spawn().map_err(|reason| no_ffmpeg(path, &reason))?;
        let said = ffmpeg.stderr.take().map(|mut pipe| {
            thread::spawn(move || {
                let mut text = String::new();
                // What can't be read is nothing to tell.
                let _ = pipe.read_to_string(&mut text);
                text
            })
        });
        Ok(Self { path: path.to_owned(), beside: Some(beside), frames: ffmpeg.stdin.take(), ffmpeg, said })
    }

    /// Adds a frame, RGB of 8 bits.
    ///
    /// # Errors
    /// [`Error::Format`] where ffmpeg gave up, with what it said.
    pub fn add(&mut self, rgb: &[u8]) -> Result<()> {
        match self.frames.as_mut().map(|pipe| pipe.write_all(rgb)) {
            Some(Ok(())) => Ok(()),
            _ => Err(self.failed()),
        }
    }

    /// Ends the movie and gives it its name.
    ///
    /// # Errors
    /// [`Error::Format`] where ffmpeg failed, [`Error::File`] where the name can't be given.
    pub fn finish(mut self) -> Result<()> {
        drop(self.frames.take());
        if !self.ffmpeg.wait().is_ok_and(|status| status.success()) {
            return Err(self.failed());
        }
        self.beside.take().map_or(Ok(()), Beside::keep)
    }

    fn failed(&mut self) -> Error {
        drop(self.frames.take());
        let _ = self.ffmpeg.wait();
        let said = self.said.take().and_then(|thread| thread.join().ok()).unwrap_or_default();
        let reason = said.lines().next().filter(|line| !line.is_empty()).unwrap_or("it said nothing");
        Error::Format {
            path: self.path.clone(),
            problem: format!(
                "could not be made, ffmpeg failed: {reason}. Write pictures, such as frame.####.png, and make \
                 the movie of them in another way"
            ),
        }
    }
}

impl Drop for Movie {
    /// A movie that was not finished leaves nothing behind.
    fn drop(&mut self) {
        drop(self.frames.take());
        let _ = self.ffmpeg.kill();
        let _ = self.ffmpeg.wait();
    }
}

/// Frames per second as ffmpeg takes them: those of television are fractions of 1001.
fn rate(fps: f64) -> String {
    let whole = (fps * 1.001).round();
    if (fps - whole / 1.001).abs() < 1e-3 && fps.fract() > 1e-3 {
        return format!("{}/1001", whole * 1000.0);
    }
    fps.to_string()
}

fn no_ffmpeg(path: &Path, reason: &io::Error) -> Error {
    if reason.kind() != io::ErrorKind::NotFound {
        return Error::Argument(format!("ffmpeg, which makes movies, does not start: {reason}"));
    }
    Error::Argument(format!(
        "`{}` needs ffmpeg, and there is none on the PATH: install it (on Debian and Ubuntu `apt-get install \
         ffmpeg`, on macOS `brew install ffmpeg`), or write pictures, such as frame.####.png",
        path.display()
    ))
}

#[cfg(test)]
mod tests {
    use super::rate;

    #[test]
    fn rates_of_television_are_told_exactly() {
        assert_eq!(rate(24.0), "24");
        assert_eq!(rate(23.976), "24000/1001");
        assert_eq!(rate(29.97), "30000/1001");
        assert_eq!(rate(59.94), "60000/1001");
        assert_eq!(rate(12.5), "12.5");
        assert_eq!(rate(25.0), "25");
    }
}
