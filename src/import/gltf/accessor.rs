//! Numbers of accessors (glTF 2.0, 3.6.2).

use super::{
    Gltf,
    document::{Accessor, SparsePart},
};
use crate::Result;

/// Most numbers that an accessor may have without bytes of a file behind them.
const MOST_ZEROS: usize = 100_000_000;

/// What the numbers of an accessor may be.
#[derive(Clone, Copy)]
pub(super) enum Stored {
    Floats,
    /// Floats, or whole numbers that stand for them (KHR_mesh_quantization).
    Quantized,
    /// Whole numbers from 0 on.
    Indices,
}

/// How one number is stored.
#[derive(Clone, Copy)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(number: u32) -> Option<Self> {
        Some(match number {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn is(self, stored: Stored) -> bool {
        match stored {
            Stored::Floats => matches!(self, Self::F32),
            Stored::Quantized => !matches!(self, Self::U32),
            Stored::Indices => matches!(self, Self::U8 | Self::U16 | Self::U32),
        }
    }

    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    fn read(self, at: &[u8]) -> f64 {
        match self {
            Self::I8 => f64::from(at[0] as i8),
            Self::U8 => f64::from(at[0]),
            Self::I16 => f64::from(i16::from_le_bytes([at[0], at[1]])),
            Self::U16 => f64::from(u16::from_le_bytes([at[0], at[1]])),
            Self::U32 => f64::from(u32::from_le_bytes([at[0], at[1], at[2], at[3]])),
            Self::F32 => f64::from(f32::from_le_bytes([at[0], at[1], at[2], at[3]])),
        }
    }

    /// The number that stands for 1 where numbers are normalized.
    fn one(self) -> f64 {
        match self {
            Self::I8 => f64::from(i8::MAX),
            Self::U8 => f64::from(u8::MAX),
            Self::I16 => f64::from(i16::MAX),
            Self::U16 => f64::from(u16::MAX),
            Self::U32 | Self::F32 => 1.0,
        }
    }
}

impl Gltf {
    /// All numbers of an accessor of type `kind`, one after another.
    pub(super) fn numbers(&self, index: usize, kind: &str, stored: Stored) -> Result<Vec<f64>> {
        let damaged = || self.foreign(&format!("accessor {index} does not hold what is taken from it"));
        let found = self.document.accessors.get(index);
        let Some(accessor) = found else {
            return Err(self.foreign(&format!("it names accessor {index}, which is not there")));
        };
        let component = Component::of(accessor.component_type)
            .filter(|component| component.is(stored) && accessor.kind == kind && accessor.count > 0);
        let (Some(component), Some(width)) = (component, width(kind)) else { return Err(damaged()) };
        let mut numbers = match accessor.buffer_view {
            Some(view) => {
                let place = (accessor.byte_offset, accessor.count);
                self.stretch(view, place, component, width)?.ok_or_else(damaged)?
            }
            None if accessor.count <= MOST_ZEROS => vec![0.0; accessor.count * width],
            None => return Err(damaged()),
        };
        self.replace(accessor, &mut numbers, component, width)?.ok_or_else(damaged)?;
        if accessor.normalized {
            numbers.iter_mut().for_each(|number| *number = (*number / component.one()).max(-1.0));
        }
        Ok(numbers)
    }

    /// Puts in what a sparse accessor has in place of its other numbers; nothing where that is damaged.
    fn replace(
        &self,
        accessor: &Accessor,
        numbers: &mut [f64],
        component: Component,
        width: usize,
    ) -> Result<Option<()>> {
        let Some(sparse) = &accessor.sparse else { return Ok(Some(())) };
        let part = |part: &SparsePart, component, width| {
            self.stretch(part.buffer_view, (part.byte_offset, sparse.count), component, width)
        };
        let kind = sparse.indices.component_type.and_then(Component::of);
        let Some(kind) = kind.filter(|kind| kind.is(Stored::Indices)) else { return Ok(None) };
        let (Some(indices), Some(values)) =
            (part(&sparse.indices, kind, 1)?, part(&sparse.values, component, width)?)
        else {
            return Ok(None);
        };
        for (&index, value) in indices.iter().zip(values.chunks_exact(width)) {
            let Some(own) = numbers.chunks_exact_mut(width).nth(index as usize) else { return Ok(None) };
            own.copy_from_slice(value);
        }
        Ok(Some(()))
    }

    /// `count` times `width` numbers of a view of a buffer, from byte `offset` on; nothing where it has not as many.
    fn stretch(
        &self,
        view: usize,
        (offset, count): (usize, usize),
        component: Component,
        width: usize,
    ) -> Result<Option<Vec<f64>>> {
        let Some(view) = self.document.buffer_views.get(view) else { return Ok(None) };
        let packed = ["EXT_meshopt_compression", "KHR_meshopt_compression"];
        if let Some(name) = packed.iter().find(|name| view.extensions.contains_key(**name)) {
            return Err(self.needs(name));
        }
        let buffer = self.buffer(view.buffer)?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let bytes = end.and_then(|end| buffer.get(view.byte_offset..end)).unwrap_or_default();
        let (step, size) = (component.bytes(), width * component.bytes());
        let stride = view.byte_stride.unwrap_or(size);
        let last = count.checked_sub(1).and_then(|before| before.checked_mul(stride)?.checked_add(offset));
        let end = last.and_then(|last| last.checked_add(size));
        if stride < size || end.is_none_or(|end| end > bytes.len()) {
            return Ok(None);
        }
        let element = |i: usize| &bytes[offset + i * stride..][..size];
        let numbers = (0..count).flat_map(|i| element(i).chunks_exact(step).map(|at| component.read(at)));
        Ok(Some(numbers.collect()))
    }
}

/// How many numbers an element has. (Columns of small matrices have gaps; no mesh has those.)
fn width(kind: &str) -> Option<usize> {
    Some(match kind {
        "SCALAR" => 1,
        "VEC3" => 3,
        "VEC4" => 4,
        "MAT4" => 16,
        _ => return None,
    })
}
