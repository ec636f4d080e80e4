//! What a frame's file says of itself, so that it need not be drawn again.

use std::{hash::Hasher, path::Path};

use siphasher::sip128::{Hasher128, SipHasher13};

use super::super::picture::PictureOptions;
use crate::{
    export::{Header, Notes},
    scene::{Cloud, Scene},
};

/// Name of the note in a frame's file.
const NOTE: &str = "nephos.frame";

/// A moment as text, and what is in the files of its meshes and volumes: those may have changed under their names.
pub fn identity(moment: &Scene) -> String {
    let files = moment.clouds.iter().filter_map(Cloud::fingerprint);
    files.fold(moment.to_json(), |text, file| text + &format!("{file:016x}"))
}

/// Fingerprint of a moment and of how it is drawn: 128 bits, in hexadecimal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stamp(String);

impl Stamp {
    /// Of the moment, to the last bit of its numbers, of everything about the picture that
    /// changes it, of what it shows and is exposed by `beside` the moment, and of this version of the program.
    pub fn new(moment: &Scene, picture: &PictureOptions, beside: &str) -> Self {
        let mut hasher = SipHasher13::new();
        // Names change no picture, nor does what draws it.
        let nameless = Scene { name: String::new(), ..moment.clone() };
        let mut options = picture.clone();
        options.adapter = None;
        options.fill_in();
        for text in [env!("CARGO_PKG_VERSION"), &identity(&nameless), &format!("{options:?}"), beside] {
            hasher.write(text.as_bytes());
            hasher.write_u8(0xff);
        }
        Self(format!("{:032x}", hasher.finish128().as_u128()))
    }

    /// Whether `file` is a picture of it, whole to its last pixel.
    pub fn is_on(&self, file: &Path) -> bool {
        file.exists() && Notes::of_whole_file(file).is_ok_and(|notes| notes.get(NOTE) == Some(&self.0))
    }

    /// The note for a file that tells `header`, too.
    pub fn notes(&self, header: Header) -> Notes {
        Notes { texts: vec![(NOTE.to_owned(), self.0.clone())], header }
    }
}
