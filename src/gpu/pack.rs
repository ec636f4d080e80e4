//! Many small values in one buffer: making a buffer costs far more than filling it.

use super::{
    made::Made,
    texture::{UNIFORM, filled_buffer},
};

/// Gathers values; each begins where a binding may.
#[derive(Default)]
pub(crate) struct Pack {
    bytes: Vec<u8>,
}

/// Where values lie in the buffer of their [`Pack`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    offset: u64,
    size: u64,
}

/// Alignment that every WebGPU device can bind at, bytes.
const ALIGNMENT: usize = 256;

impl Pack {
    /// Appends `values`; none still take up the room of one (zeroed), because bindings of no size are
    /// not allowed.
    pub fn add<T: bytemuck::Pod>(&mut self, values: &[T]) -> Place {
        let one = [T::zeroed()];
        let contents = bytemuck::cast_slice(if values.is_empty() { &one } else { values });
        let offset = self.bytes.len().next_multiple_of(ALIGNMENT);
        self.bytes.resize(offset, 0);
        self.bytes.extend_from_slice(contents);
        Place { offset: offset as u64, size: contents.len() as u64 }
    }

    /// The buffer, for shaders to read as uniform or storage.
    pub fn buffer(&self, device: &wgpu::Device, label: &str) -> wgpu::Buffer {
        filled_buffer(device, label, UNIFORM, &self.bytes)
    }
}

/// A buffer that is kept from picture to picture, filled anew, and made anew only where it is too small.
pub(crate) struct Shelf {
    label: &'static str,
    /// Bytes from one value to the next.
    stride: u64,
    buffer: Option<wgpu::Buffer>,
}

impl Shelf {
    /// For values that shaders read as one array.
    pub fn new(label: &'static str) -> Self {
        Self { label, stride: 0, buffer: None }
    }

    /// For values that are bound one at a time, at [`Shelf::offset`].
    pub fn of_places(label: &'static str) -> Self {
        Self { label, stride: ALIGNMENT as u64, buffer: None }
    }

    /// Where the value of this number lies, bytes.
    pub fn offset(number: usize) -> u32 {
        (number * ALIGNMENT) as u32
    }

    /// Fills it with `values` for the next submission; returns the buffer, which is another one where it had to grow.
    pub fn fill<T: bytemuck::Pod>(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        values: &[T],
    ) -> &wgpu::Buffer {
        let each = (size_of::<T>() as u64).next_multiple_of(self.stride.max(1)) as usize;
        let size = (each * values.len().max(1)) as u64;
        let known = self.buffer.take().filter(|buffer| buffer.size() >= size);
        let buffer = self.buffer.insert(known.unwrap_or_else(|| {
            Made::one(|made| &mut made.buffers);
            let (label, size) = (Some(self.label), size.next_power_of_two().max(ALIGNMENT as u64));
            device.create_buffer(&wgpu::BufferDescriptor {
                label,
                size,
                usage: UNIFORM,
                mapped_at_creation: false,
            })
        }));
        Made::one(|made| &mut made.writes);
        if each == size_of::<T>() {
            queue.write_buffer(buffer, 0, bytemuck::cast_slice(values));
        } else {
            let mut spread = vec![0; each * values.len()];
            for (place, value) in spread.chunks_exact_mut(each).zip(values) {
                place[..size_of::<T>()].copy_from_slice(bytemuck::bytes_of(value));
            }
            queue.write_buffer(buffer, 0, &spread);
        }
        buffer
    }
}

/// The first value of a buffer whose values are bound one at a time.
pub(crate) fn one_of<T>(buffer: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    let size = std::num::NonZeroU64::new(size_of::<T>() as u64);
    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: 0, size })
}

impl Place {
    /// These values alone, of their buffer.
    pub fn binding(self, buffer: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
        let size = std::num::NonZeroU64::new(self.size);
        wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: self.offset, size })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shelf_is_filled_in_place_and_grows_only_where_it_is_too_small() {
        let name = std::env::var("NEPHOS_ADAPTER").ok();
        let gpu = pollster::block_on(crate::gpu::Gpu::open(name.as_deref())).unwrap();
        let mut shelf = Shelf::of_places("numbers");
        let mut fill = |values: &[f32]| shelf.fill(&gpu.device, &gpu.queue, values).clone();
        let (few, fewer) = (fill(&[1.0, 2.0, 3.0]), fill(&[4.0]));
        assert!(few == fewer && few.size() >= 3 * ALIGNMENT as u64);
        let more = fill(&[0.0; 9]);
        assert!(more != few && more.size() >= u64::from(Shelf::offset(9)));
        assert!(fill(&[]) == more, "none take up no more");
    }

    #[test]
    fn values_lie_apart_and_none_is_lost() {
        let mut pack = Pack::default();
        let places =
            [pack.add(&[1u32, 2, 3]), pack.add::<f32>(&[]), pack.add(&[7u32; 100]), pack.add(&[9u32])];
        let ends: Vec<_> = places.iter().map(|place| (place.offset, place.size)).collect();
        assert_eq!(ends, [(0, 12), (256, 4), (512, 400), (1024, 4)]);
        assert_eq!(pack.bytes[..12], bytemuck::cast::<_, [u8; 12]>([1u32, 2, 3]));
        assert_eq!(pack.bytes[1024..], 9u32.to_le_bytes());
    }
}
