//! The media of clouds on the device: what shaders bind for each, made once a shape.

use std::collections::HashMap;

use wgpu::{BindGroup, BindGroupLayout, TextureView};

use crate::{
    frame::{
        Shared,
        medium::{ELLIPSOIDS, Medium, bind_ellipsoids, upload_noise},
    },
    gpu::{Role, Shader, view},
};

/// Media that were in one of the last pictures.
pub(super) struct Media {
    device: wgpu::Device,
    queue: wgpu::Queue,
    layout: BindGroupLayout,
    kept: HashMap<u64, Vec<Kept>>,
    /// Noise volumes by seed, the latest first.
    noise: Vec<(u32, TextureView)>,
    picture: u64,
    /// How many noise volumes were made so far.
    pub noises: u32,
}

struct Kept {
    medium: Shared<Medium>,
    group: BindGroup,
    /// The last picture that it was in.
    picture: u64,
}

/// Noise volumes that are kept.
const MOST_NOISES: usize = 4;

impl Media {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        // Any shader that has the role declares its group.
        let layout = Shader::new(device, "sky_volume", &[ELLIPSOIDS]).groups.swap_remove(1);
        let (device, queue) = (device.clone(), queue.clone());
        Self { device, queue, layout, kept: HashMap::new(), noise: Vec::new(), picture: 0, noises: 0 }
    }

    /// The module that fills the role of the medium.
    pub fn role(&self, _: &Medium) -> Role<'static> {
        ELLIPSOIDS
    }

    /// Begins a picture: forgets what the last two had not.
    pub fn begin(&mut self) {
        self.picture += 1;
        let oldest = self.picture.saturating_sub(2);
        self.kept.retain(|_, list| {
            list.retain(|kept| kept.picture >= oldest);
            !list.is_empty()
        });
    }

    /// What shaders bind for `medium` as group 1.
    pub fn group(&mut self, medium: &Shared<Medium>) -> &BindGroup {
        let picture = self.picture;
        let known = self.kept.get(&medium.fingerprint);
        let place = known.and_then(|list| list.iter().position(|kept| kept.medium == *medium));
        let place = place.unwrap_or_else(|| {
            let noise = self.noise_volume(medium.seed);
            let species = [medium.species.uniform()];
            let group = bind_ellipsoids(
                &self.device,
                &self.layout,
                &medium.ellipsoids,
                &species,
                &medium.noise,
                &noise,
            );
            let list = self.kept.entry(medium.fingerprint).or_default();
            list.push(Kept { medium: medium.clone(), group, picture });
            list.len() - 1
        });
        let list = self.kept.entry(medium.fingerprint).or_default();
        list[place].picture = picture;
        &list[place].group
    }

    fn noise_volume(&mut self, seed: u32) -> TextureView {
        let known = self.noise.iter().position(|(known, _)| *known == seed);
        let place = known.unwrap_or_else(|| {
            self.noises += 1;
            self.noise.truncate(MOST_NOISES - 1);
            self.noise.insert(0, (seed, view(&upload_noise(&self.device, &self.queue, seed))));
            0
        });
        self.noise[place].1.clone()
    }
}
