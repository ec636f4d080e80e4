//! The light of all clouds: made for those in the picture, kept between frames, and dropped where
//! it would take more memory than a scene may have.

use std::collections::HashMap;

use super::{
    Quality,
    frame::{CloudFrame, Frame},
    light::{CloudLight, Inputs, LightPass},
    light_plan::{allowance, plan},
    occluders::occluders,
};

/// Where a cloud is, exactly: light that was made for it is found again by this, whichever
/// number the cloud has now.
type Place = [u64; 3];

fn place(cloud: &CloudFrame) -> Place {
    cloud.origin.to_array().map(f64::to_bits)
}

/// Light by cloud.
pub(super) struct LightStore {
    pass: LightPass,
    lights: Vec<Option<(Place, CloudLight)>>,
    /// Of clouds that are not in the picture.
    away: Vec<(Place, CloudLight)>,
    /// How many volumes were made so far.
    pub redone: u32,
}

impl LightStore {
    pub fn new(device: &wgpu::Device) -> Self {
        Self { pass: LightPass::new(device), lights: Vec::new(), away: Vec::new(), redone: 0 }
    }

    /// Light of cloud `index` of the frame that was prepared last; none where it is out of view.
    pub fn get(&self, index: usize) -> Option<&CloudLight> {
        self.lights.get(index)?.as_ref().map(|(_, light)| light)
    }

    /// Memory of all textures of light, bytes.
    pub fn bytes(&self) -> u64 {
        let kept = self.lights.iter().flatten().chain(&self.away);
        kept.map(|(_, light)| light.bytes()).sum()
    }

    /// Makes what the clouds `in_view` lack of light; `flush` may submit what is recorded so far,
    /// after each cloud for which there was something to do.
    pub fn prepare(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        frame: &Frame,
        quality: &Quality,
        in_view: &[bool],
        flush: &mut dyn FnMut(&mut wgpu::CommandEncoder),
    ) {
        let mut known: HashMap<Place, Vec<CloudLight>> = HashMap::new();
        let lights = std::mem::take(&mut self.lights).into_iter().flatten();
        for (place, light) in lights.chain(std::mem::take(&mut self.away)) {
            known.entry(place).or_default().push(light);
        }
        let details = plan(quality, &frame.clouds, in_view, &frame.camera, frame.camera_position);
        let shading = occluders(&frame.clouds, -inputs.to_sun);
        for (index, cloud) in frame.clouds.iter().enumerate() {
            let light = details[index].map(|detail| {
                let others: Vec<_> = shading[index]
                    .iter()
                    .flat_map(|&other| frame.ellipsoids_of(other as usize, cloud.origin))
                    .collect();
                let before = known.get_mut(&place(cloud)).and_then(Vec::pop);
                let made = self.redone;
                let light =
                    self.pass.prepare(encoder, inputs, cloud, &others, detail, before, &mut self.redone);
                if self.redone > made {
                    flush(encoder);
                }
                (place(cloud), light)
            });
            self.lights.push(light);
        }
        self.keep(frame, known, allowance(quality));
    }

    /// Keeps light of clouds of the frame that are out of view, as long as all of it fits.
    fn keep(&mut self, frame: &Frame, mut known: HashMap<Place, Vec<CloudLight>>, most: u64) {
        let mut total = self.bytes();
        for place in frame.clouds.iter().map(place) {
            if let Some(light) = known.get_mut(&place).and_then(Vec::pop) {
                total += light.bytes();
                if total > most {
                    return;
                }
                self.away.push((place, light));
            }
        }
    }
}
