//! The tables of an atmosphere and the programs that fill them.

use wgpu::{TextureFormat, TextureUsages, TextureView};

use crate::gpu::{self, ComputeProgram, TextureDesc, Timing, view};

/// Format of all tables: filterable and storable on every device.
pub(super) const FORMAT: TextureFormat = TextureFormat::Rgba16Float;
/// Sizes of the tables, texels. All are multiples of their shader's workgroup.
pub(super) const TRANSMITTANCE: [u32; 3] = [256, 64, 0];
pub(super) const MULTIPLE: [u32; 3] = [32, 32, 0];
pub(super) const GROUND_LIGHT: [u32; 3] = [64, 1, 0];
pub(super) const SKY_VIEW: [u32; 3] = [192, 128, 0];
pub(super) const SKY_LIGHT: [u32; 3] = [3, 1, 0];
pub(super) const AERIAL: [u32; 3] = [32, 32, 32];

/// One table's program and what it reads and writes.
pub(super) struct Fill {
    name: &'static str,
    program: ComputeProgram,
    group: wgpu::BindGroup,
    workgroups: [u32; 3],
}

impl Fill {
    pub fn new(
        device: &wgpu::Device,
        name: &'static str,
        resources: &[wgpu::BindingResource<'_>],
        workgroups: impl Fn(&ComputeProgram) -> [u32; 3],
    ) -> Self {
        let program = ComputeProgram::new(device, name, &[]);
        let resources: Vec<_> = resources.iter().cloned().map(Some).collect();
        let group = program.bind(device, &resources);
        let workgroups = workgroups(&program);
        Self { name, program, group, workgroups }
    }

    pub fn run(&self, encoder: &mut wgpu::CommandEncoder, timing: Option<&Timing>) {
        let stamps = timing.and_then(|timing| timing.compute(self.name));
        self.program.dispatch(encoder, &[&self.group], self.workgroups, stamps);
    }
}

/// The tables of an atmosphere, made when a scene first has one.
pub(super) struct Tables {
    pub transmittance: TextureView,
    pub multiple: TextureView,
    pub ground: TextureView,
    pub sky_view: TextureView,
    pub aerial: TextureView,
    pub fill_atmosphere: [Fill; 3],
    pub fill_sky_view: Fill,
    pub fill_sky_light: Fill,
    pub fill_aerial: Fill,
}

impl Tables {
    /// What tables of the sky are made of: transmittance, multiple scattering and ground light.
    pub fn air(&self) -> [&TextureView; 3] {
        [&self.transmittance, &self.multiple, &self.ground]
    }

    pub fn new(
        device: &wgpu::Device,
        sky: &wgpu::Buffer,
        camera: &wgpu::Buffer,
        sampler: &wgpu::Sampler,
        sky_light: &TextureView,
    ) -> Self {
        let uniforms = [sky, camera];
        use wgpu::BindingResource::{Sampler, TextureView as View};
        let table = |label, size| view(&table(device, label, size));
        let transmittance = table("transmittance", TRANSMITTANCE);
        let multiple = table("multiple scattering", MULTIPLE);
        let ground = table("ground light", GROUND_LIGHT);
        let sky_view = table("sky view", SKY_VIEW);
        let aerial = table("aerial", AERIAL);
        let (sky, camera) = (sky.as_entire_binding(), camera.as_entire_binding());
        let (sky, camera, linear) = (|| sky.clone(), || camera.clone(), || Sampler(sampler));
        let (t, m, g) = (|| View(&transmittance), || View(&multiple), || View(&ground));
        // A thread a texel; those of a column of the air before the camera are one thread's.
        let over = |[x, y, _]: [u32; 3]| move |program: &ComputeProgram| program.groups_over([x, y, 1]);
        let fill_transmittance = Fill::new(device, "transmittance", &[sky(), t()], over(TRANSMITTANCE));
        let fill_multiple =
            Fill::new(device, "multiple_scattering", &[sky(), t(), linear(), m()], over(MULTIPLE));
        let fill_ground =
            Fill::new(device, "ground_light", &[sky(), t(), m(), linear(), g()], over(GROUND_LIGHT));
        let fill_sky_light = Fill::new(
            device,
            "sky_light",
            &[sky(), t(), m(), g(), linear(), View(sky_light)],
            // A workgroup a texel.
            |_| [SKY_LIGHT[0], 1, 1],
        );
        let fill_aerial =
            Fill::new(device, "aerial", &[sky(), camera(), t(), m(), linear(), View(&aerial)], over(AERIAL));
        Self {
            fill_atmosphere: [fill_transmittance, fill_multiple, fill_ground],
            fill_sky_view: fill_sky_view(
                device,
                uniforms,
                [&transmittance, &multiple, &ground],
                sampler,
                &sky_view,
            ),
            fill_sky_light,
            fill_aerial,
            transmittance,
            multiple,
            ground,
            sky_view,
            aerial,
        }
    }
}

/// The program of a table of what is seen from the height of a camera: the sky's uniform and the camera's, and of the air
/// transmittance, multiple scattering and ground light.
pub(super) fn fill_sky_view(
    device: &wgpu::Device,
    [sky, camera]: [&wgpu::Buffer; 2],
    air: [&TextureView; 3],
    sampler: &wgpu::Sampler,
    table: &TextureView,
) -> Fill {
    use wgpu::BindingResource::{Sampler, TextureView as View};
    let [transmittance, multiple, ground] = air.map(View);
    let (sky, camera) = (sky.as_entire_binding(), camera.as_entire_binding());
    let resources = [sky, camera, transmittance, multiple, ground, Sampler(sampler), View(table)];
    Fill::new(device, "sky_view", &resources, |program| program.groups_over([SKY_VIEW[0], SKY_VIEW[1], 1]))
}

pub(super) fn table(device: &wgpu::Device, label: &str, size: [u32; 3]) -> wgpu::Texture {
    gpu::texture(
        device,
        &TextureDesc { label, size, mips: 1, format: FORMAT, usage: TextureUsages::STORAGE_BINDING },
    )
}
