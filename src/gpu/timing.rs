//! Time of each pass by the GPU's own clock, where it offers one.

use std::cell::{Cell, RefCell};

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

/// The most that WebGPU promises of one query set.
const SLOTS: u32 = 4096;

/// Hands out pairs of time stamps to passes and reads them after the frame.
/// Where the adapter has no time stamps it hands out nothing and reads nothing.
pub struct Timing {
    queries: Option<(wgpu::QuerySet, wgpu::Buffer)>,
    names: RefCell<Vec<&'static str>>,
    used: Cell<u32>,
    period_ns: f32,
}

impl Timing {
    /// A timer for `gpu`; `None`-like where it has no time stamps.
    pub fn new(gpu: &Gpu) -> Self {
        let offered = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let queries = offered.then(|| {
            let set = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("pass times"),
                ty: wgpu::QueryType::Timestamp,
                count: SLOTS,
            });
            let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("pass times"),
                size: u64::from(SLOTS) * 8,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            });
            (set, buffer)
        });
        Self {
            queries,
            names: RefCell::new(Vec::new()),
            used: Cell::new(0),
            period_ns: gpu.queue.get_timestamp_period(),
        }
    }

    fn next(&self, pass: &'static str) -> Option<(&wgpu::QuerySet, u32)> {
        let (set, _) = self.queries.as_ref()?;
        let first = self.used.get();
        if first + 2 > SLOTS {
            return None;
        }
        self.used.set(first + 2);
        self.names.borrow_mut().push(pass);
        Some((set, first))
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
        if let (Some((set, buffer)), used @ 1..) = (&self.queries, self.used.get()) {
            encoder.resolve_query_set(set, 0..used, buffer, 0);
        }
    }

    /// Times since the last call, passes of one name added up, in order of first appearance.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn collect(&self, gpu: &Gpu) -> Result<Vec<PassTime>> {
        let Some((_, buffer)) = &self.queries else { return Ok(Vec::new()) };
        let stamps: Vec<u64> = read_buffer(gpu, buffer)?;
        let mut times: Vec<PassTime> = Vec::new();
        for (pair, pass) in stamps.chunks_exact(2).zip(self.names.take()) {
            let ms = pair[1].saturating_sub(pair[0]) as f64 * f64::from(self.period_ns) * 1e-6;
            match times.iter_mut().find(|time| time.pass == pass) {
                Some(time) => time.ms += ms,
                None => times.push(PassTime { pass, ms }),
            }
        }
        self.used.set(0);
        Ok(times)
    }
}
