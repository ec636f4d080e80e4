use nephos::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let text = std::fs::read_to_string(&a[1]).unwrap();
    let scene: scene::Scene = serde_json::from_str(&text).unwrap();
    let size = [a[3].parse().unwrap(), a[4].parse().unwrap()];
    let t = std::time::Instant::now();
    let gpu = pollster::block_on(gpu::Gpu::open(None)).unwrap();
    let mut r = render::Renderer::new(&gpu.device, &gpu.queue, wgpu::TextureFormat::Rgba16Float);
    r.counting = true;
    r.timing = Some(gpu::Timing::new(&gpu));
    if let Some(q) = a.get(5) {
        r.quality = render::Quality::PRESETS.iter().find(|x| x.0 == q).unwrap().1;
    }
    let frame = render::Frame::new(&scene, size).unwrap();
    let pic = r.picture("p", size, wgpu::TextureFormat::Rgba16Float);
    let out = r.picture("o", size, wgpu::TextureFormat::Rgba8Unorm);
    eprintln!("setup {:?}", t.elapsed());
    let t = std::time::Instant::now();
    let mut e = gpu.device.create_command_encoder(&Default::default());
    r.render(
        &mut e,
        &frame,
        &render::Target { color: &pic.create_view(&Default::default()), depth: None, sky: true },
    );
    r.compose(
        &mut e,
        &pic.create_view(&Default::default()),
        &out.create_view(&Default::default()),
        wgpu::TextureFormat::Rgba8Unorm,
        scene.exposure,
    );
    gpu.queue.submit([e.finish()]);
    gpu.finish("rendering").unwrap();
    eprintln!("render {:?}", t.elapsed());
    eprintln!("{:?}\n{:?}", r.counts(&gpu).unwrap(), r.timing.as_ref().unwrap().collect(&gpu).unwrap());
    let bytes = gpu::read_texture(&gpu, &out, 0).unwrap();
    export::write_png(std::path::Path::new(&a[2]), size, &bytes, false).unwrap();
}
