//! The noise as the shaders read it.

use crate::common;

use common::{evaluate_bound, gpu};
use nephos::{
    frame::{NOISE_SIZE, bake_noise},
    gpu::{TextureDesc, linear_repeat, texture},
};

/// Uploads one level of the baked noise.
fn volume() -> wgpu::TextureView {
    let texture = texture(
        &gpu().device,
        &TextureDesc {
            label: "noise",
            size: [NOISE_SIZE; 3],
            mips: 1,
            format: wgpu::TextureFormat::Rg16Float,
            usage: wgpu::TextureUsages::empty(),
        },
    );
    let texels: Vec<_> = bake_noise(1).into_iter().map(|texel| texel.map(half::f16::from_f32)).collect();
    gpu().queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&texels),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * NOISE_SIZE),
            rows_per_image: Some(NOISE_SIZE),
        },
        texture.size(),
    );
    texture.create_view(&Default::default())
}

#[test]
fn lookup_gives_the_texels_of_both_scales_and_repeats() {
    let noise = bake_noise(1);
    let at = |texel: [u32; 3]| {
        let [x, y, z] = texel.map(|i| i % NOISE_SIZE);
        noise[((z * NOISE_SIZE + y) * NOISE_SIZE + x) as usize]
    };
    // Texel centres of the fine look-up, which is eight times as dense; the period is 64 m.
    let places: Vec<[u32; 3]> = (0..40).map(|i| [i * 7 % 64, i * 11 % 64, i * 13 % 64]).collect();
    let inputs: Vec<_> = places
        .iter()
        .flat_map(|p| {
            [0.0, 64.0].map(|shift| [[p[0] as f32 + 0.5 + shift, p[1] as f32 + 0.5, p[2] as f32 + 0.5, 0.0]])
        })
        .collect();
    let declarations = "
        @group(0) @binding(2) var volume: texture_3d<f32>;
        @group(0) @binding(3) var repeat: sampler;";
    let body = "
        let row = 1.0 / 64.0;
        var frame: NoiseFrame;
        frame.coarse_x = vec4f(row, 0.0, 0.0, 0.0);
        frame.coarse_y = vec4f(0.0, row, 0.0, 0.0);
        frame.coarse_z = vec4f(0.0, 0.0, row, 0.0);
        // One texel further along x: which channel and which scale went where shows.
        frame.fine_x = vec4f(row, 0.0, 0.0, row);
        frame.fine_y = frame.coarse_y;
        frame.fine_z = frame.coarse_z;
        frame.fine_weight = 0.25;
        frame.texels_per_metre = 1.0;
        return vec4f(noise_at(volume, repeat, frame, x[0].xyz, 0.0), 0.0, 0.0);";
    let (view, sampler) = (volume(), linear_repeat(&gpu().device));
    let resources = [wgpu::BindingResource::TextureView(&view), wgpu::BindingResource::Sampler(&sampler)];
    let got = evaluate_bound("noise", declarations, body, &inputs, &resources);
    for (place, got) in places.iter().zip(got.chunks_exact(2)) {
        let (coarse, fine) = (at(*place), at([place[0] + 1, place[1], place[2]]));
        for channel in 0..2 {
            let wanted = (coarse[channel] + 0.25 * fine[channel]) / 1.25;
            // Half floats hold 11 bits; filters may weigh with as few as 8.
            assert!((got[0][channel] - wanted).abs() < 8e-3, "{place:?}: {got:?} for {wanted}");
            assert!((got[0][channel] - got[1][channel]).abs() < 8e-3, "a period further is the same");
        }
    }
}
