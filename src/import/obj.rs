//! Corners and faces of OBJ files. All other lines, and whatever names are written in, say nothing about
//! shape; readers that take note of them refuse files for what no mesh needs.

use std::{fs, path::Path, result};

use glam::DVec3;

use super::Mesh;
use crate::{Error, Result};

/// All faces of an .obj file, as triangles.
pub(super) fn read_mesh(path: &Path) -> Result<Mesh> {
    let bytes =
        fs::read(path).map_err(|source| Error::File { action: "read", path: path.to_owned(), source })?;
    let refused = |problem: String| Error::Format { path: path.to_owned(), problem };
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err(refused("is written in UTF-16: save it as UTF-8".to_owned()));
    }
    let text = String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes));
    let lines = lines(&text);
    let in_line = |line: usize, problem: String| refused(format!("can't be read in line {line}: {problem}"));
    let mut mesh = Mesh::default();
    for (line, words) in lines.iter().filter(|(_, words)| words[0] == "v") {
        mesh.positions.push(corner(&words[1..]).map_err(|problem| in_line(*line, problem))?);
    }
    let mut before = 0;
    for (line, words) in &lines {
        if words[0] == "v" {
            before += 1;
            continue;
        }
        let number = |word| number(word, before, mesh.positions.len());
        let face: result::Result<Vec<u32>, String> = words[1..].iter().map(number).collect();
        let face = face.map_err(|problem| in_line(*line, problem))?;
        // A fan is right for faces that are not convex, too: what goes beyond them is gone round both ways.
        mesh.triangles.extend(face.windows(2).skip(1).map(|pair| [face[0], pair[0], pair[1]]));
    }
    Ok(mesh)
}

/// The words of lines that tell of a corner or a face, with the number of each line. One that ends in `\` goes on.
fn lines(text: &str) -> Vec<(usize, Vec<&str>)> {
    let end = if text.contains('\n') { '\n' } else { '\r' };
    let mut found: Vec<(usize, Vec<&str>)> = Vec::new();
    let mut goes_on = false;
    for (i, line) in text.split(end).enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        let (line, open) = line.strip_suffix('\\').map_or((line, false), |line| (line, true));
        let words = line.split_whitespace();
        match found.last_mut() {
            Some((_, list)) if goes_on => list.extend(words),
            _ => found.push((i + 1, words.collect())),
        }
        goes_on = open;
    }
    found.retain(|(_, words)| matches!(words.first(), Some(&("v" | "f"))));
    found
}

fn corner(words: &[&str]) -> result::Result<DVec3, String> {
    let numbers: Vec<f64> = words.iter().take(3).filter_map(|word| word.parse().ok()).collect();
    let three = numbers.try_into().map(|numbers: [f64; 3]| DVec3::from(numbers));
    three.map_err(|_| format!("`{}` are not three numbers: export it anew", words.join(" ")))
}

/// The number, from 0 on, of a corner of a face: `word` counts from 1 on, or back from those `before`.
fn number(word: &&str, before: usize, all: usize) -> result::Result<u32, String> {
    let told = word.split('/').next().unwrap_or_default();
    let number = match told.parse::<i64>() {
        Ok(n) if n > 0 => Some(n - 1),
        Ok(n) if n < 0 => (before as i64).checked_add(n),
        _ => None,
    };
    let found = number.and_then(|n| u32::try_from(n).ok()).filter(|n| (*n as usize) < all);
    found.ok_or_else(|| format!("there is no corner `{told}`: export it anew"))
}
