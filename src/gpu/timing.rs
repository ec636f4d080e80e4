//! Time of each pass by the GPU's own clock, where it offers one.

use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use super::{Gpu, read_buffer};
use crate::Result;

/// Time that one pass took on the GPU.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct PassTime {
    /// Name of the pass.
    pub pass: &'static str,
    /// Milliseconds.
    pub ms: f64,
}

/// Time stamps of a query set: the most that WebGPU promises.
const SLOTS: u32 = 4096;
/// Passes of a query set.
const PASSES: usize = SLOTS as usize / 2;

/// Hands out pairs of time stamps to passes, as many as there are, and reads them after the frame.
/// Where the adapter has no time stamps it hands out nothing and reads nothing.
pub struct Timing {
    device: wgpu::Device,
    queries: Option<Queries>,
    /// The passes since the times were read, in order.
    names: Mutex<Vec<&'static str>>,
    period_ns: f32,
}

/// A query set with the buffer that it goes to, and the next one, made when this one is full.
struct Queries {
    set: wgpu::QuerySet,
    buffer: wgpu::Buffer,
    next: OnceLock<Box<Self>>,
}

impl Queries {
    fn new(device: &wgpu::Device) -> Self {
        let set = device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("pass times"),
            ty: wgpu::QueryType::Timestamp,
            count: SLOTS,
        });
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("pass times"),
            size: u64::from(SLOTS) * 8,
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        Self { set, buffer, next: OnceLock::new() }
    }
}

impl Timing {
    /// A timer for `gpu`; `None`-like where it has no time stamps.
    pub fn new(gpu: &Gpu) -> Self {
        let offered = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        Self {
            device: gpu.device.clone(),
            queries: offered.then(|| Queries::new(&gpu.device)),
            names: Mutex::new(Vec::new()),
            period_ns: gpu.queue.get_timestamp_period(),
        }
    }

    fn names(&self) -> MutexGuard<'_, Vec<&'static str>> {
        self.names.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The query sets that hold the time stamps of `passes` passes, with the number of passes in each.
    fn used(&self, passes: usize) -> impl Iterator<Item = (&Queries, usize)> {
        let sets =
            std::iter::successors(self.queries.as_ref(), |queries| queries.next.get().map(Box::as_ref));
        let counts = (0..passes).step_by(PASSES).map(move |first| PASSES.min(passes - first));
        sets.zip(counts)
    }

    fn next(&self, pass: &'static str) -> Option<(&wgpu::QuerySet, u32)> {
        let mut queries = self.queries.as_ref()?;
        let mut names = self.names();
        let number = names.len();
        for _ in 0..number / PASSES {
            queries = queries.next.get_or_init(|| Box::new(Queries::new(&self.device)));
        }
        names.push(pass);
        Some((&queries.set, 2 * (number % PASSES) as u32))
    }

    /// Time stamps for the next compute pass.
    pub fn compute(&self, pass: &'static str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        self.next(pass).map(|(query_set, first)| wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        })
    }

    /// Time stamps for the next render pass.
    pub fn render(&self, pass: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.next(pass).map(|(query_set, first)| wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        })
    }

    /// To be recorded after the last pass of a frame.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        for (Queries { set, buffer, .. }, passes) in self.used(self.names().len()) {
            encoder.resolve_query_set(set, 0..2 * passes as u32, buffer, 0);
        }
    }

    /// Times since the last call, passes of one name added up, in order of first appearance.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn collect(&self, gpu: &Gpu) -> Result<Vec<PassTime>> {
        let names = std::mem::take(&mut *self.names());
        let mut stamps: Vec<[u64; 2]> = Vec::with_capacity(names.len());
        for (queries, passes) in self.used(names.len()) {
            stamps.extend(read_buffer::<[u64; 2]>(gpu, &queries.buffer)?.into_iter().take(passes));
        }
        let mut times: Vec<PassTime> = Vec::new();
        for ([start, end], pass) in stamps.into_iter().zip(names) {
            let ms = end.saturating_sub(start) as f64 * f64::from(self.period_ns) * 1e-6;
            match times.iter_mut().find(|time| time.pass == pass) {
                Some(time) => time.ms += ms,
                None => times.push(PassTime { pass, ms }),
            }
        }
        Ok(times)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Records passes without work under `names`, and reads their times.
    fn timed(gpu: &Gpu, timing: &Timing, names: &[&'static str]) -> Vec<&'static str> {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for name in names {
            let timestamp_writes = timing.compute(name);
            assert!(timestamp_writes.is_some(), "{name}");
            encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(name), timestamp_writes });
        }
        timing.resolve(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        timing.collect(gpu).unwrap().into_iter().map(|time| time.pass).collect()
    }

    #[test]
    fn passes_beyond_a_query_set_are_timed_too_and_again() {
        let name = std::env::var("NEPHOS_ADAPTER").ok();
        let gpu = pollster::block_on(Gpu::open(name.as_deref())).unwrap();
        let timing = Timing::new(&gpu);
        if timing.queries.is_none() {
            return eprintln!("skipped: this adapter has no time stamps");
        }
        let mut names = vec!["first"; 2 * PASSES + 1];
        names.push("last");
        assert_eq!(timed(&gpu, &timing, &names), ["first", "last"]);
        assert_eq!(
            timing.used(names.len()).map(|(_, passes)| passes).collect::<Vec<_>>(),
            [PASSES, PASSES, 2]
        );
        assert_eq!(timed(&gpu, &timing, &["again"]), ["again"]);
    }
}
