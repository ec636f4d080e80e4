//! What the GPU tests share: one device a process, and `Kernel`, which runs a
//! function of `shaders/lib` over many inputs.
#![allow(dead_code, reason = "every test file uses its own part of it")]

pub mod atmosphere;
pub mod compiled;
pub mod constants;
pub mod hull;
#[cfg(feature = "export")]
pub mod picture;
#[cfg(feature = "export")]
pub mod random;
#[cfg(feature = "export")]
pub mod readers;
#[cfg(feature = "export")]
pub mod truth;

use std::sync::OnceLock;

use nephos::gpu::{ComputeProgram, Gpu, read_buffer, storage_buffer};

/// The device of this test process. A machine without any adapter fails here:
/// these tests are not skipped.
pub fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| {
        let name = std::env::var("NEPHOS_ADAPTER").ok();
        pollster::block_on(Gpu::open(name.as_deref())).expect("tests need a graphics adapter")
    })
}

/// Evaluates WGSL over a list of inputs. `uses` names library modules, `body` is
/// the inside of `fn evaluate(x: array<vec4f, N>) -> vec4f`.
pub fn evaluate<const N: usize>(uses: &str, body: &str, inputs: &[[[f32; 4]; N]]) -> Vec<[f32; 4]> {
    evaluate_with(uses, "", body, inputs)
}

/// The same with module-scope declarations of the caller's own.
pub fn evaluate_with<const N: usize>(
    uses: &str,
    declarations: &str,
    body: &str,
    inputs: &[[[f32; 4]; N]],
) -> Vec<[f32; 4]> {
    evaluate_bound(uses, declarations, body, inputs, &[])
}

/// The same with resources for bindings 2 and on, which the declarations name.
pub fn evaluate_bound<const N: usize>(
    uses: &str,
    declarations: &str,
    body: &str,
    inputs: &[[[f32; 4]; N]],
    resources: &[wgpu::BindingResource<'_>],
) -> Vec<[f32; 4]> {
    let source = format!(
        "// @use {uses}
        {declarations}
        @group(0) @binding(0) var<storage, read_write> inputs: array<array<vec4f, {N}>>;
        @group(0) @binding(1) var<storage, read_write> outputs: array<vec4f>;
        fn evaluate(x: array<vec4f, {N}>) -> vec4f {{ {body} }}
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {{
            if id.x < arrayLength(&outputs) {{ outputs[id.x] = evaluate(inputs[id.x]); }}
        }}"
    );
    let gpu = gpu();
    let flat: Vec<[f32; 4]> = inputs.iter().flatten().copied().collect();
    let input = storage_buffer(&gpu.device, "inputs", &flat);
    let output = storage_buffer(&gpu.device, "outputs", &vec![[0.0f32; 4]; inputs.len()]);
    let program = ComputeProgram::from_source(&gpu.device, "kernel", nephos::gpu::link(&source, &[]));
    let mut bindings = vec![Some(input.as_entire_binding()), Some(output.as_entire_binding())];
    bindings.extend(resources.iter().cloned().map(Some));
    let group = program.bind(&gpu.device, &bindings);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    program.dispatch_over(&mut encoder, &[&group], [inputs.len() as u32, 1, 1], None);
    gpu.queue.submit([encoder.finish()]);
    read_buffer(gpu, &output).expect("the kernel runs")
}
