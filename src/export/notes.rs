//! What a picture's file tells of itself beside its pixels.

use std::{fs::File, io::BufReader, path::Path};

use exr::{meta::attribute::AttributeValue, prelude as openexr};

use super::Header;
use crate::{Error, Result};

/// What a file tells beside its pixels.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Notes {
    /// Names and texts, ASCII: text chunks of PNG files, attributes of EXR files.
    pub texts: Vec<(String, String)>,
    /// What EXR files say of the picture.
    pub header: Header,
}

impl Notes {
    /// The text called `name`.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.texts.iter().find(|(own, _)| own == name).map(|(_, text)| text.as_str())
    }

    /// Reads those of a PNG or EXR file, and all of its pixels: who has the notes knows that the
    /// file is whole.
    ///
    /// # Errors
    /// [`Error::Format`] where the file can't be read to its end.
    pub fn of_whole_file(path: &Path) -> Result<Self> {
        let is_exr = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr"));
        let read = if is_exr { of_exr(path) } else { of_png(path) };
        read.map_err(|problem| Error::Format {
            path: path.to_owned(),
            problem: format!("can't be read as a whole picture: {problem}"),
        })
    }

    pub(super) fn attributes(&self) -> super::exr::Attributes {
        let text = |text: &String| openexr::Text::new_or_none(text).map(AttributeValue::Text);
        self.texts.iter().filter_map(|(name, value)| Some((name.as_str().into(), text(value)?))).collect()
    }
}

fn of_exr(path: &Path) -> std::result::Result<Notes, String> {
    let image = openexr::read_first_flat_layer_from_file(path).map_err(|error| error.to_string())?;
    let attributes = image.layer_data.attributes.other;
    let text = |value: AttributeValue| match value {
        AttributeValue::Text(text) => Some(text.to_string()),
        _ => None,
    };
    let texts = attributes.into_iter().filter_map(|(name, value)| Some((name.to_string(), text(value)?)));
    Ok(Notes { texts: texts.collect(), header: Header::default() })
}

fn of_png(path: &Path) -> std::result::Result<Notes, String> {
    let file = File::open(path).map_err(|error| error.to_string())?;
    let mut reader =
        png::Decoder::new(BufReader::new(file)).read_info().map_err(|error| error.to_string())?;
    while reader.next_row().map_err(|error| error.to_string())?.is_some() {}
    reader.finish().map_err(|error| error.to_string())?;
    let texts = &reader.info().uncompressed_latin1_text;
    let texts = texts.iter().map(|chunk| (chunk.keyword.clone(), chunk.text.clone())).collect();
    Ok(Notes { texts, header: Header::default() })
}

#[cfg(test)]
mod tests {
    use super::super::{Picture, write_beauty_noted, write_png_noted};
    use super::*;

    #[test]
    fn notes_come_back_from_whole_files_alone() {
        let folder = tempfile::tempdir().unwrap();
        let notes = Notes {
            texts: vec![("nephos.frame".to_owned(), "0123abc".to_owned())],
            header: Header::default(),
        };
        let [png, exr] = ["a.png", "a.exr"].map(|name| folder.path().join(name));
        write_png_noted(&png, [7, 5], &[9; 140], false, &notes).unwrap();
        write_beauty_noted(&exr, &Picture { width: 7, height: 5, pixels: vec![[0.5; 4]; 35] }, &notes)
            .unwrap();
        for path in [png, exr] {
            assert_eq!(Notes::of_whole_file(&path).unwrap().get("nephos.frame"), Some("0123abc"));
            let bytes = std::fs::read(&path).unwrap();
            for length in [0, 1, 20, bytes.len() / 2, bytes.len() - 13, bytes.len() - 1] {
                std::fs::write(&path, &bytes[..length]).unwrap();
                assert!(Notes::of_whole_file(&path).is_err(), "{} cut to {length}", path.display());
            }
            std::fs::remove_file(&path).unwrap();
            assert!(Notes::of_whole_file(&path).is_err());
        }
    }
}
