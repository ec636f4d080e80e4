//! Colours where nothing is seen. Files with straight alpha are filtered colour by colour: whatever stands under
//! alpha 0 comes into the rims of clouds, and black makes them dark. So it is the colour of the nearest cloud.

use super::Picture;

/// Opacities below this become 0 in 8 bits.
const LEAST: f32 = 0.5 / 255.0;

/// The same picture of straight alpha, with the colours of the nearest pixels that are seen where none is.
#[must_use]
pub fn bled(picture: &Picture) -> Picture {
    let mut bled = picture.clone();
    let seen: Vec<bool> = picture.pixels.iter().map(|pixel| pixel[3] >= LEAST).collect();
    bleed(&mut bled.pixels, picture.width, &seen);
    bled
}

/// The same of rows of RGBA bytes.
pub(super) fn bled_bytes(rgba: &[u8], width: usize) -> Vec<u8> {
    let mut pixels = rgba.as_chunks::<4>().0.to_vec();
    let seen: Vec<bool> = pixels.iter().map(|pixel| pixel[3] > 0).collect();
    bleed(&mut pixels, width, &seen);
    pixels.into_flattened()
}

fn bleed<T: Copy>(pixels: &mut [[T; 4]], width: usize, seen: &[bool]) {
    for (i, source) in nearest(seen, width).into_iter().enumerate() {
        if let Some(source) = source.filter(|_| !seen[i]) {
            let [r, g, b, _] = pixels[source];
            (pixels[i][0], pixels[i][1], pixels[i][2]) = (r, g, b);
        }
    }
}

/// For each pixel the nearest one that is seen, itself if it is; nothing where none is. It is found from neighbour
/// to neighbour, so that it may now and then be the second nearest by a hair.
fn nearest(seen: &[bool], width: usize) -> Vec<Option<usize>> {
    let mut nearest: Vec<_> = seen.iter().enumerate().map(|(i, seen)| seen.then_some(i)).collect();
    let height = seen.len().checked_div(width).unwrap_or(0);
    let mut ring: Vec<usize> = (0..seen.len()).filter(|&i| seen[i]).collect();
    while !ring.is_empty() {
        let mut next = Vec::new();
        for i in ring {
            let Some(source) = nearest[i] else { continue };
            for neighbour in neighbours(i, width, height) {
                let distance = |from: usize| {
                    let across = (from % width).abs_diff(neighbour % width);
                    let down = (from / width).abs_diff(neighbour / width);
                    across * across + down * down
                };
                match nearest[neighbour] {
                    None => next.push(neighbour),
                    Some(own) if distance(source) < distance(own) => {}
                    Some(_) => continue,
                }
                nearest[neighbour] = Some(source);
            }
        }
        ring = next;
    }
    nearest
}

/// The eight around a pixel, fewer at the rim.
fn neighbours(i: usize, width: usize, height: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (i % width, i / width);
    let around = |n: usize, size: usize| n.saturating_sub(1)..(n + 2).min(size);
    around(y, height).flat_map(move |y| around(x, width).map(move |x| y * width + x)).filter(move |&n| n != i)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_from_the_nearest_pixel_and_alpha_stays() {
        let size = (17, 11);
        let seen = |i: usize| [3 + 2 * 17, 15 + 9 * 17, 8 + 5 * 17].contains(&i);
        let pixel = |i: usize| if seen(i) { [i as f32, 1.0, 2.0, 0.25] } else { [0.0, 0.0, 0.0, 0.0] };
        let picture =
            Picture { width: size.0, height: size.1, pixels: (0..size.0 * size.1).map(pixel).collect() };
        let distance = |a: usize, b: usize| {
            let (x, y) = ((a % 17).abs_diff(b % 17), (a / 17).abs_diff(b / 17));
            ((x * x + y * y) as f64).sqrt()
        };
        for (i, found) in bled(&picture).pixels.iter().enumerate() {
            let least = (0..187).filter(|&j| seen(j)).map(|j| distance(i, j)).fold(f64::INFINITY, f64::min);
            assert!(distance(i, found[0] as usize) < least + 0.5, "{i}: {found:?}");
            assert_eq!((found[1], found[3]), (1.0, picture.pixels[i][3]));
        }
        let empty = Picture { pixels: vec![[0.0; 4]; 6], width: 3, height: 2 };
        assert_eq!(bled(&empty).pixels, empty.pixels);
        assert_eq!(bled_bytes(&[7, 8, 9, 1, 0, 0, 0, 0], 2), [7, 8, 9, 1, 7, 8, 9, 0]);
    }
}
