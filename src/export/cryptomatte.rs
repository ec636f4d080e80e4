//! Clouds by their names, as Cryptomatte has them (Psyop, specification 1.2.0; Friedman and Jones 2015): each pixel has
//! a list of numbers that stand for names, and the share of the pixel that each hides, the largest first.

use std::collections::BTreeMap;

use exr::{meta::attribute::AttributeValue, prelude as openexr};

use super::{exr::Attributes, layers::Layered};
use crate::{Result, gpu::Gpu};

/// What the layers are called.
const LAYER: &str = "CryptoCloud";
/// Clouds of a pixel that are told: two to a layer.
const RANKS: usize = 6;

/// What one cloud hides in a part of the picture.
pub(super) struct Share {
    /// Its number in the moment.
    pub cloud: usize,
    /// Left, top, width, pixels.
    corner: [usize; 2],
    width: usize,
    /// Share of the pixel, and that times the distance, m.
    weights: Vec<[f32; 2]>,
}

impl Share {
    /// Column, row, share of the pixel that this cloud hides, and its distance there, m; of those where it does.
    pub fn pixels(&self) -> impl Iterator<Item = (usize, usize, f32, f32)> {
        let there = self.weights.iter().enumerate().filter(|(_, [weight, _])| *weight > 0.0);
        there.map(|(i, &[weight, distance])| {
            let [x, y] = [self.corner[0] + i % self.width, self.corner[1] + i / self.width];
            (x, y, weight, distance / weight)
        })
    }
}

/// What each cloud hides of a picture: its opacity behind all that stand before it, as pictures put one over the other.
///
/// # Errors
/// [`crate::Error::Gpu`] when the device fails.
pub(super) fn shares(gpu: &Gpu, of: Layered<'_>) -> Result<Vec<Share>> {
    let [width, height] = of.frame.size().map(|n| n as usize);
    let rays_of_pixel = (of.reduce * of.reduce) as f32;
    let mut through = vec![1.0f32; width * height];
    let mut shares = Vec::new();
    // Near ones first.
    for matte in of.layers.mattes.iter().rev() {
        let [left, top, right, bottom] = matte.area().map(|n| n as usize);
        let [low, high] =
            [[left, top].map(|n| n / of.reduce), [right, bottom].map(|n| n.div_ceil(of.reduce))];
        let columns = high[0] - low[0];
        let mut weights = vec![[0.0f32; 2]; columns * (high[1] - low[1])];
        for (i, pixel) in matte.read(gpu)?.into_iter().enumerate() {
            let (x, y) = (left + i % (right - left), top + i / (right - left));
            let behind = &mut through[y * width + x];
            let weight = &mut weights[(y / of.reduce - low[1]) * columns + x / of.reduce - low[0]];
            weight[0] += *behind * pixel.alpha / rays_of_pixel;
            weight[1] += *behind * pixel.distance / rays_of_pixel;
            *behind *= 1.0 - pixel.alpha;
        }
        shares.push(Share { cloud: matte.cloud, corner: low, width: columns, weights });
    }
    Ok(shares)
}

/// The channels: numbers and shares of the clouds that hide most of each pixel.
///
/// # Errors
/// [`crate::Error::Gpu`] when the device fails.
pub(super) fn ranks(gpu: &Gpu, of: Layered<'_>) -> Result<Vec<(String, Vec<f32>)>> {
    let [width, height] = of.frame.size().map(|n| n as usize / of.reduce);
    let mut pixels: Vec<Vec<(f32, f32)>> = vec![Vec::new(); width * height];
    for share in shares(gpu, of)? {
        let id = number(hash(of.names.get(share.cloud).map_or("", String::as_str)));
        for (x, y, weight, _) in share.pixels() {
            let list = &mut pixels[y * width + x];
            // Clouds of one name are one.
            match list.iter_mut().find(|(known, _)| known.to_bits() == id.to_bits()) {
                Some((_, sum)) => *sum += weight,
                None => list.push((id, weight)),
            }
        }
    }
    for list in &mut pixels {
        list.sort_by(|a, b| b.1.total_cmp(&a.1));
    }
    let channel = |rank: usize, of: fn(&(f32, f32)) -> f32| {
        pixels.iter().map(|list| list.get(rank).map_or(0.0, of)).collect::<Vec<f32>>()
    };
    let both = |rank: usize| {
        let layer = format!("{LAYER}{:02}", rank / 2);
        let [id, share] = [["R", "G"], ["B", "A"]][rank % 2];
        [
            (format!("{layer}.{id}"), channel(rank, |own| own.0)),
            (format!("{layer}.{share}"), channel(rank, |own| own.1)),
        ]
    };
    Ok((0..RANKS).flat_map(both).collect())
}

/// What the header tells: how numbers stand for names, and which names there are.
pub(super) fn attributes(names: &[String]) -> Attributes {
    let manifest: BTreeMap<&str, String> =
        names.iter().map(|name| (name.as_str(), format!("{:08x}", number(hash(name)).to_bits()))).collect();
    let key = format!("{:08x}", hash(LAYER));
    let manifest = serde_json::to_string(&manifest).expect("names and numbers are text");
    let entries = [
        ("name", LAYER.to_owned()),
        ("hash", "MurmurHash3_32".to_owned()),
        ("conversion", "uint32_to_float32".to_owned()),
        ("manifest", manifest),
    ];
    let attribute = |(name, value): (&str, String)| {
        let text = openexr::Text::from_slice_unchecked(value.as_bytes());
        (
            openexr::Text::from(format!("cryptomatte/{}/{name}", &key[..7]).as_str()),
            AttributeValue::Text(text),
        )
    };
    entries.into_iter().map(attribute).collect()
}

/// The number whose bits are those of a hash, none of which is infinite, no number or denormal.
fn number(hash: u32) -> f32 {
    let exponent = hash >> 23 & 255;
    f32::from_bits(if exponent == 0 || exponent == 255 { hash ^ 1 << 23 } else { hash })
}

/// `MurmurHash3_x86_32` (Appleby 2011) of a name, with seed 0.
fn hash(name: &str) -> u32 {
    let mixed = |word: u32| word.wrapping_mul(0xcc9e_2d51).rotate_left(15).wrapping_mul(0x1b87_3593);
    let word = |bytes: &[u8]| bytes.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte));
    let (words, rest) = name.as_bytes().as_chunks::<4>();
    let mut hash = words.iter().fold(0u32, |hash, bytes| {
        (hash ^ mixed(word(bytes))).rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64)
    });
    if !rest.is_empty() {
        hash ^= mixed(word(rest));
    }
    hash ^= name.len() as u32;
    for (shift, factor) in [(16, 0x85eb_ca6b), (13, 0xc2b2_ae35)] {
        hash = (hash ^ hash >> shift).wrapping_mul(factor);
    }
    hash ^ hash >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of Appleby's own code, as the specification and others print them.
    #[test]
    fn names_have_the_numbers_that_others_give_them() {
        for (name, expected) in [
            ("", 0),
            ("test", 0xba6b_d213),
            ("Hello, world!", 0xc036_3e43),
            ("The quick brown fox jumps over the lazy dog", 0x2e4f_f723),
        ] {
            assert_eq!(hash(name), expected, "{name}");
        }
        // The example of the specification.
        assert_eq!(format!("{:08x}", number(hash("hello")).to_bits()), "248bfa47");
    }

    #[test]
    fn numbers_of_names_are_numbers() {
        for hash in [0, 0x7f80_0000, 0xffff_ffff, 0x0040_0000, 0x8000_0000] {
            assert!(number(hash).is_normal(), "{hash:x}");
        }
    }
}
