//! One way to choose an adapter and open a device, for the command line, the
//! tests and the editor alike.

use std::sync::{
    Arc, Mutex,
    atomic::{AtomicBool, Ordering},
};

use super::shader::MOST_BUFFERS;
use crate::{Error, Result};

/// What `nephos info` tells of an adapter.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct AdapterSummary {
    /// Name as the driver gives it; `--adapter` takes any part of it.
    pub name: String,
    /// Discrete, integrated, virtual, CPU or other.
    pub kind: String,
    /// Vulkan, Metal, Dx12, Gl or BrowserWebGpu.
    pub backend: String,
    /// The driver and its version.
    pub driver: String,
}

impl From<wgpu::AdapterInfo> for AdapterSummary {
    fn from(info: wgpu::AdapterInfo) -> Self {
        Self {
            name: info.name,
            kind: format!("{:?}", info.device_type),
            backend: format!("{:?}", info.backend),
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        }
    }
}

/// An open device with its queue, and what the driver complained of. Clones are the same device.
#[derive(Debug, Clone)]
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// The adapter it was opened on.
    pub adapter: AdapterSummary,
    lost: Arc<AtomicBool>,
    complaint: Arc<Mutex<Option<String>>>,
    stop: Arc<AtomicBool>,
}

/// Every adapter of this machine, best first.
pub async fn adapters() -> Vec<AdapterSummary> {
    let mut list = all(&instance()).await;
    list.sort_by_key(|adapter| rank(&adapter.get_info()));
    list.into_iter().map(|adapter| adapter.get_info().into()).collect()
}

impl Gpu {
    /// Opens the best adapter, or the best whose name contains `name`
    /// (upper and lower case alike). Asks for no feature beyond WebGPU's core,
    /// but takes time stamps where they are offered.
    ///
    /// # Errors
    /// [`Error::Adapter`] when there is none, with what to install.
    pub async fn open(name: Option<&str>) -> Result<Self> {
        let adapter = choose(all(&instance()).await, name)?;
        let wanted = wanted(&adapter);
        Self::request(&adapter, &wanted).await
    }

    async fn request(adapter: &wgpu::Adapter, wanted: &wgpu::DeviceDescriptor<'_>) -> Result<Self> {
        let info = adapter.get_info();
        tracing::info!(adapter = info.name, backend = ?info.backend, "opening adapter");
        let (device, queue) = adapter.request_device(wanted).await.map_err(|error| {
            Error::Adapter(format!(
                "the adapter `{}` would not open: {error}. `nephos info` lists the others; \
                     choose one with --adapter NAME.",
                info.name
            ))
        })?;
        Ok(Self::watch(device, queue, info.into()))
    }

    /// Takes over a device that the caller opened, and watches it for errors and loss.
    pub fn from_device(device: wgpu::Device, queue: wgpu::Queue, adapter: wgpu::AdapterInfo) -> Self {
        Self::watch(device, queue, adapter.into())
    }

    fn watch(device: wgpu::Device, queue: wgpu::Queue, adapter: AdapterSummary) -> Self {
        let lost = Arc::new(AtomicBool::new(false));
        let complaint = Arc::new(Mutex::new(None));
        let (lost_flag, first_complaint) = (lost.clone(), complaint.clone());
        device.set_device_lost_callback(move |_, reason| {
            tracing::error!(reason, "the graphics device was lost");
            lost_flag.store(true, Ordering::Release);
        });
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            tracing::error!(%error, "graphics error");
            if let Ok(mut slot) = first_complaint.lock() {
                slot.get_or_insert_with(|| error.to_string());
            }
        }));
        Self { device, queue, adapter, lost, complaint, stop: Arc::default() }
    }

    /// While this is true, waiting for the device ends in [`Error::Stopped`]: for those who catch Ctrl-C, or
    /// stop long work from another thread. Clones share it, others have their own.
    pub fn stop_token(&self) -> &Arc<AtomicBool> {
        &self.stop
    }

    /// The same device with waits that `token` stops, and not those of other clones.
    #[must_use]
    pub fn stopped_by(self, token: Arc<AtomicBool>) -> Self {
        Self { stop: token, ..self }
    }

    /// Whether work was asked to stop.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Waits until all submitted work is done.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the device was lost or the driver complained since the last call,
    /// [`Error::Stopped`] when [`Gpu::stop_token`] was set.
    pub fn finish(&self, doing: &str) -> Result<()> {
        let fail = |reason: String| Err(Error::Gpu { doing: doing.to_owned(), reason });
        if let Err(error) = self.device.poll(wgpu::PollType::wait_indefinitely()) {
            return fail(error.to_string());
        }
        if self.lost.load(Ordering::Acquire) {
            return fail(
                "the device was lost; start again, and if it happens again lower the \
                         picture size or the quality"
                    .to_owned(),
            );
        }
        if self.is_stopped() {
            return Err(Error::Stopped { kept: "files that were written are whole".to_owned() });
        }
        match self.complaint.lock().ok().and_then(|mut slot| slot.take()) {
            Some(reason) => fail(reason),
            None => Ok(()),
        }
    }
}

/// Bytes of all targets of a pixel that let light and what is where be drawn at once.
const MOST_TARGET_BYTES: u32 = 64;

/// The device that this crate asks of an adapter: what it may offer beyond WebGPU's least is taken, and done without
/// where it is not.
pub(crate) fn wanted(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
    let (least, offered) = (wgpu::Limits::default(), adapter.limits());
    let buffers = |limits: &wgpu::Limits| limits.max_storage_buffers_per_shader_stage;
    let bytes = |limits: &wgpu::Limits| limits.max_color_attachment_bytes_per_sample;
    let required_limits = wgpu::Limits {
        max_storage_buffers_per_shader_stage: buffers(&offered).clamp(buffers(&least), MOST_BUFFERS),
        max_color_attachment_bytes_per_sample: bytes(&offered).clamp(bytes(&least), MOST_TARGET_BYTES),
        ..least
    };
    wgpu::DeviceDescriptor {
        label: Some("nephos"),
        required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
        required_limits,
        ..Default::default()
    }
}

fn instance() -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle())
}

async fn all(instance: &wgpu::Instance) -> Vec<wgpu::Adapter> {
    instance.enumerate_adapters(wgpu::Backends::PRIMARY).await
}

/// Lower is better: real GPUs before software.
fn rank(info: &wgpu::AdapterInfo) -> u8 {
    match info.device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

/// The best of `adapters`, or the best whose name contains `name`.
pub(crate) fn choose(mut adapters: Vec<wgpu::Adapter>, name: Option<&str>) -> Result<wgpu::Adapter> {
    adapters.sort_by_key(|adapter| rank(&adapter.get_info()));
    let names: Vec<_> = adapters.iter().map(|adapter| adapter.get_info().name).collect();
    if names.is_empty() {
        return Err(Error::Adapter(no_adapter()));
    }
    let wanted = name.unwrap_or_default().to_lowercase();
    adapters.into_iter().find(|adapter| adapter.get_info().name.to_lowercase().contains(&wanted)).ok_or_else(
        || {
            Error::Adapter(format!(
                "no adapter's name contains `{wanted}`; this machine has: {}.",
                names.join(", ")
            ))
        },
    )
}

fn no_adapter() -> String {
    let remedy = if cfg!(target_os = "linux") {
        "Install your graphics card's Vulkan driver, or Mesa's software Vulkan: on Debian and \
         Ubuntu `apt-get install mesa-vulkan-drivers libvulkan1`, on Fedora `dnf install \
         mesa-vulkan-drivers vulkan-loader`, on Arch `pacman -S vulkan-swrast vulkan-icd-loader`."
    } else {
        "Update the driver of your graphics card."
    };
    format!("no graphics adapter was found (Vulkan, Metal or DirectX 12). {remedy}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_stops_the_waits_that_it_was_given_to_and_no_others() {
        let gpu = pollster::block_on(Gpu::open(std::env::var("NEPHOS_ADAPTER").ok().as_deref())).unwrap();
        let (clone, other) = (gpu.clone(), gpu.clone().stopped_by(Arc::default()));
        let ends =
            || [&gpu, &clone, &other].map(|gpu| matches!(gpu.finish("waiting"), Err(Error::Stopped { .. })));
        assert_eq!(ends(), [false; 3]);
        gpu.stop_token().store(true, Ordering::Relaxed);
        assert_eq!(ends(), [true, true, false]);
        other.stop_token().store(true, Ordering::Relaxed);
        clone.stop_token().store(false, Ordering::Relaxed);
        assert_eq!(ends(), [false, false, true]);
    }

    #[test]
    fn an_adapter_whose_limits_are_too_low_is_refused_with_a_sentence() {
        pollster::block_on(async {
            let adapter = choose(all(&instance()).await, None).unwrap();
            let mut wanted = wanted(&adapter);
            let most = adapter.limits().max_texture_dimension_2d;
            wanted.required_limits.max_texture_dimension_2d = 2 * most;
            let error = Gpu::request(&adapter, &wanted).await.unwrap_err().to_string();
            let (asked, most) = ((2 * most).to_string(), most.to_string());
            for word in
                [&adapter.get_info().name, "max_texture_dimension_2d", &asked, &most, "--adapter NAME"]
            {
                assert!(error.contains(word), "{error}");
            }
        });
    }
}
