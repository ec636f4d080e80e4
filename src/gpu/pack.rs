//! Many small values in one buffer: making a buffer costs far more than filling it.

use super::texture::{UNIFORM, filled_buffer};

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
