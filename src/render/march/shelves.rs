//! What the march binds of a picture: all clouds' numbers, tiles and candidates in buffers that are kept from picture
//! to picture, and one group for all clouds, at whose offsets each has its own.

use wgpu::{BindGroup, BindGroupLayout, TextureView};

use super::{
    CloudUniform, View,
    tiles::{Cover, Tile},
};
use crate::gpu::{self, Shelf};

/// What one call of the march in a picture binds: there are as many as lights and layers of it.
pub(super) struct Shelves {
    camera: Shelf,
    clouds: Shelf,
    tiles: Shelf,
    candidates: Shelf,
    /// The groups with all that is in them: one for all clouds, but for those that others shade by a map.
    own: Vec<(Bound, BindGroup)>,
    /// The group of the vertex stage, likewise.
    vertices: Option<([TextureView; 2], BindGroup)>,
}

/// What the march's own group is made of.
#[derive(Clone, PartialEq)]
struct Bound {
    buffers: [wgpu::Buffer; 6],
    textures: [TextureView; 3],
    /// The map that shades a cloud, where one does.
    shade: Option<(wgpu::Buffer, TextureView)>,
}

/// Layouts of groups.
pub(super) struct Layouts {
    /// Of a cloud that no map shades, and of one that a map shades, where there are such clouds.
    pub own: [Option<BindGroupLayout>; 2],
    pub of_vertices: BindGroupLayout,
}

/// Groups for a cloud.
#[derive(Clone)]
pub(super) struct Groups {
    pub own: BindGroup,
    pub vertices: BindGroup,
}

impl Default for Shelves {
    fn default() -> Self {
        Self {
            camera: Shelf::new("camera"),
            clouds: Shelf::of_places("clouds"),
            tiles: Shelf::new("tiles"),
            candidates: Shelf::new("candidates"),
            own: Vec::new(),
            vertices: None,
        }
    }
}

impl Shelves {
    /// Fills them for clouds with these numbers and covers, in order; tells each one's first tile.
    pub fn fill(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        shared: &View<'_>,
        clouds: &[CloudUniform],
        covers: &[&Cover],
    ) -> (Vec<u32>, [wgpu::Buffer; 4]) {
        let (mut tiles, mut candidates, mut firsts) = (Vec::new(), Vec::<u32>::new(), Vec::new());
        for cover in covers {
            firsts.push(tiles.len() as u32);
            let offset = candidates.len() as u32;
            let moved =
                |tile: &Tile| Tile { first: tile.first + offset, others: tile.others + offset, ..*tile };
            tiles.extend(cover.tiles.iter().map(moved));
            candidates.extend_from_slice(&cover.candidates);
        }
        let camera = shared.frame.camera.jittered(shared.settings.quality.jitter);
        let buffers = [
            self.camera.fill(device, queue, &[camera]).clone(),
            self.clouds.fill(device, queue, clouds).clone(),
            self.tiles.fill(device, queue, &tiles).clone(),
            self.candidates.fill(device, queue, &candidates).clone(),
        ];
        (firsts, buffers)
    }

    /// The groups of these buffers for each of the clouds `seen`, made anew only where something in them is another one
    /// than before.
    pub fn groups(
        &mut self,
        device: &wgpu::Device,
        shared: &View<'_>,
        layouts: &Layouts,
        [camera, clouds, tiles, candidates]: [wgpu::Buffer; 4],
        seen: &[usize],
        (no_depth, visibilities, linear): (&TextureView, &wgpu::Buffer, &wgpu::Sampler),
    ) -> Vec<Groups> {
        let sky = shared.sky;
        let mut before = std::mem::take(&mut self.own);
        let mut own_of = |number: usize| {
            let shade = shared.shade(number);
            if let Some((_, group)) = self.own.iter().find(|(bound, _)| bound.shade == shade) {
                return group.clone();
            }
            let [camera, clouds, tiles, candidates] =
                [&camera, &clouds, &tiles, &candidates].map(wgpu::Buffer::clone);
            let bound = Bound {
                buffers: [camera, clouds, tiles, candidates, sky.atmosphere().clone(), visibilities.clone()],
                textures: [
                    sky.aerial().clone(),
                    shared.depth.map_or(no_depth, |depth| depth.view).clone(),
                    shared.shadows.air().clone(),
                ],
                shade,
            };
            let known = before.iter().position(|(known, _)| *known == bound);
            let own = known.map(|place| before.swap_remove(place)).unwrap_or_else(|| {
                let layout = layouts.own[usize::from(bound.shade.is_some())].as_ref();
                let layout = layout.expect("there is one for each of the clouds that are seen");
                let group = own_group(device, shared, layout, &bound, linear);
                (bound, group)
            });
            self.own.push(own.clone());
            own.1
        };
        let own: Vec<_> = seen.iter().map(|&number| own_of(number)).collect();
        let lights = [sky.transmittance(), sky.sky_light()].map(TextureView::clone);
        let known = self.vertices.take().filter(|(known, _)| *known == lights);
        let vertices = known.unwrap_or_else(|| {
            let resources = lights.each_ref().map(|view| Some(wgpu::BindingResource::TextureView(view)));
            let group = gpu::bind_group(device, "lights of the march", &layouts.of_vertices, &resources);
            (lights, group)
        });
        let vertices = &self.vertices.insert(vertices).1;
        own.into_iter().map(|own| Groups { own, vertices: vertices.clone() }).collect()
    }
}

/// Group 0.
fn own_group(
    device: &wgpu::Device,
    shared: &View<'_>,
    layout: &BindGroupLayout,
    Bound { buffers: [camera, clouds, tiles, candidates, air, visibilities], textures, shade }: &Bound,
    linear: &wgpu::Sampler,
) -> BindGroup {
    let [aerial, depth, shadow] = textures;
    let texture = |view| Some(wgpu::BindingResource::TextureView(view));
    let resources = [
        Some(camera.as_entire_binding()),
        Some(gpu::one_of::<CloudUniform>(clouds)),
        Some(tiles.as_entire_binding()),
        Some(candidates.as_entire_binding()),
        Some(air.as_entire_binding()),
        Some(shared.counters.buffer().as_entire_binding()),
        Some(wgpu::BindingResource::Sampler(linear)),
        texture(aerial),
        texture(depth),
        texture(shadow),
        shade.as_ref().map(|(map, _)| map.as_entire_binding()),
        shade.as_ref().and_then(|(_, lit)| texture(lit)),
        Some(visibilities.as_entire_binding()),
    ];
    gpu::bind_group(device, "march", layout, &resources)
}
