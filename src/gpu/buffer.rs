//! Buffers that know what they hold, checked against the device's limits before they are made.

use std::marker::PhantomData;
use std::ops::Range;

use bytemuck::Pod;
use wgpu::BufferUsages;

use super::{Gpu, GpuError};

/// A buffer of `len` elements of `T` on the device.
#[derive(Clone, Debug)]
pub struct Buffer<T> {
    pub raw: wgpu::Buffer,
    len: usize,
    label: &'static str,
    element: PhantomData<T>,
}

/// Bytes of `count` elements of `element_bytes`, if the device can hold and bind them.
///
/// # Errors
/// `TooLarge` with the limit that is exceeded.
pub fn checked_bytes(
    gpu: &Gpu,
    what: &str,
    count: u64,
    element_bytes: u64,
    usage: BufferUsages,
) -> Result<u64, GpuError> {
    let limits = gpu.device.limits();
    let asked = count.saturating_mul(element_bytes);
    let (limit, limit_name) = if usage.contains(BufferUsages::UNIFORM) {
        (
            limits.max_uniform_buffer_binding_size,
            "max_uniform_buffer_binding_size",
        )
    } else if usage.contains(BufferUsages::STORAGE) {
        (
            limits.max_storage_buffer_binding_size,
            "max_storage_buffer_binding_size",
        )
    } else {
        (limits.max_buffer_size, "max_buffer_size")
    };
    if asked > limit {
        return Err(GpuError::TooLarge {
            what: what.to_owned(),
            asked,
            limit,
            limit_name,
        });
    }
    Ok(asked)
}

impl<T: Pod> Buffer<T> {
    /// A buffer of `len` zeroed elements, at least one (a binding may not be empty). It can
    /// always be written and read back.
    ///
    /// # Errors
    /// `TooLarge`, or `Rejected` if the device is out of memory.
    pub fn new(
        gpu: &Gpu,
        label: &'static str,
        len: usize,
        usage: BufferUsages,
    ) -> Result<Self, GpuError> {
        let element_bytes = size_of::<T>() as u64;
        let bytes = checked_bytes(gpu, label, len.max(1) as u64, element_bytes, usage)?;
        let raw = gpu.guarded(label, || {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                // Copies are in steps of four bytes.
                size: bytes.next_multiple_of(4),
                usage: usage | BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        })?;
        Ok(Self {
            raw,
            len,
            label,
            element: PhantomData,
        })
    }

    /// A buffer with the given elements.
    ///
    /// # Errors
    /// As for [`Buffer::new`].
    pub fn with(
        gpu: &Gpu,
        label: &'static str,
        elements: &[T],
        usage: BufferUsages,
    ) -> Result<Self, GpuError> {
        let buffer = Self::new(gpu, label, elements.len(), usage)?;
        buffer.write(gpu, 0, elements)?;
        Ok(buffer)
    }

    /// Elements asked for when the buffer was made.
    pub fn len(&self) -> usize {
        self.len
    }

    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The whole buffer as a binding.
    pub fn binding(&self) -> wgpu::BindingResource<'_> {
        self.raw.as_entire_binding()
    }

    /// Writes elements from index `first` on, before the next submission.
    ///
    /// # Errors
    /// `Rejected` if they do not fit.
    pub fn write(&self, gpu: &Gpu, first: usize, elements: &[T]) -> Result<(), GpuError> {
        if first.saturating_add(elements.len()) > self.len {
            return Err(GpuError::Rejected {
                what: self.label.to_owned(),
                reason: format!(
                    "{} elements written at {first} do not fit into {}",
                    elements.len(),
                    self.len
                ),
            });
        }
        if !elements.is_empty() {
            let offset = (first * size_of::<T>()) as u64;
            gpu.queue
                .write_buffer(&self.raw, offset, bytemuck::cast_slice(elements));
        }
        Ok(())
    }

    /// Writes all `elements` from the start, into a larger buffer if this one is too small.
    /// Returns true if the buffer was replaced, so that bind groups must be made anew.
    ///
    /// # Errors
    /// As for [`Buffer::new`].
    pub fn write_or_grow(&mut self, gpu: &Gpu, elements: &[T]) -> Result<bool, GpuError> {
        let grow = elements.len() > self.len;
        if grow {
            let usage = self.raw.usage();
            *self = Self::new(gpu, self.label, elements.len().next_power_of_two(), usage)
                .or_else(|_| Self::new(gpu, self.label, elements.len(), usage))?;
        }
        self.write(gpu, 0, elements)?;
        Ok(grow)
    }

    /// Another buffer of this label and usage, zeroed.
    ///
    /// # Errors
    /// As for [`Buffer::new`].
    pub fn of_len(&self, gpu: &Gpu, len: usize) -> Result<Self, GpuError> {
        Self::new(gpu, self.label, len, self.raw.usage())
    }

    /// Makes room for `len` elements, keeping those there are. Returns true if the buffer was
    /// replaced, so that bind groups must be made anew.
    ///
    /// # Errors
    /// As for [`Buffer::new`].
    pub fn grow_to(&mut self, gpu: &Gpu, len: usize) -> Result<bool, GpuError> {
        if len <= self.len {
            return Ok(false);
        }
        let grown = Self::new(gpu, self.label, len, self.raw.usage())?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&self.raw, 0, &grown.raw, 0, self.raw.size());
        gpu.queue.submit([encoder.finish()]);
        *self = grown;
        Ok(true)
    }

    /// Makes room for `len` elements and half as many again, without keeping what was there. Returns
    /// true if the buffer was replaced, so that bind groups must be made anew.
    ///
    /// # Errors
    /// As for [`Buffer::new`].
    pub fn reserve(&mut self, gpu: &Gpu, len: usize) -> Result<bool, GpuError> {
        if len <= self.len {
            return Ok(false);
        }
        *self = self
            .of_len(gpu, len + len / 2)
            .or_else(|_| self.of_len(gpu, len))?;
        Ok(true)
    }

    /// Reads the first `count` elements back. Waits for the device; for tests and headless runs.
    ///
    /// # Errors
    /// `ReadBack` or the device's own errors.
    pub fn read(&self, gpu: &Gpu, count: usize) -> Result<Vec<T>, GpuError> {
        self.read_runs(gpu, std::slice::from_ref(&(0..count.min(self.len))))
    }

    /// Reads runs of elements back, one after the other. Waits for the device.
    ///
    /// # Errors
    /// As for [`Buffer::read`]; runs beyond the buffer's end are refused.
    pub fn read_runs(&self, gpu: &Gpu, runs: &[Range<usize>]) -> Result<Vec<T>, GpuError> {
        let bytes = read_together(gpu, self.label, &self.parts(runs)?)?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }

    /// Runs of elements as parts of a reading that may have parts of other buffers.
    ///
    /// # Errors
    /// `ReadBack` for runs beyond the buffer's end.
    pub(super) fn parts(&self, runs: &[Range<usize>]) -> Result<Vec<Part<'_>>, GpuError> {
        if let Some(run) = runs.iter().find(|run| run.end > self.len) {
            return Err(GpuError::ReadBack {
                what: self.label.to_owned(),
                reason: format!("elements {run:?} were asked for, there are {}", self.len),
            });
        }
        let element = size_of::<T>() as u64;
        let bytes = |run: &Range<usize>| run.start as u64 * element..run.end as u64 * element;
        let parts = runs.iter().filter(|run| !run.is_empty());
        Ok(parts.map(|run| (&self.raw, bytes(run))).collect())
    }
}

/// A buffer with the bytes of it that are wanted.
pub(super) type Part<'a> = (&'a wgpu::Buffer, Range<u64>);

/// Reads parts of buffers back, one after the other, with one wait for the device.
///
/// # Errors
/// As for [`Buffer::read`].
pub(super) fn read_together(
    gpu: &Gpu,
    what: &str,
    parts: &[Part<'_>],
) -> Result<Vec<u8>, GpuError> {
    let count: u64 = parts.iter().map(|(_, bytes)| bytes.end - bytes.start).sum();
    if count == 0 {
        return Ok(Vec::new());
    }
    let copy = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size: count.next_multiple_of(4),
        usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut at = 0;
    for (buffer, bytes) in parts {
        let length = bytes.end - bytes.start;
        // Copies are in steps of four bytes; what one part's last step adds, the next overwrites.
        let copied = length.next_multiple_of(4);
        encoder.copy_buffer_to_buffer(buffer, bytes.start, &copy, at, copied);
        at += length;
    }
    gpu.queue.submit([encoder.finish()]);
    let mut bytes = read_mapped(gpu, what, &copy)?;
    bytes.truncate(count as usize);
    Ok(bytes)
}

/// Maps a read-back buffer, waits and copies its bytes.
pub(crate) fn read_mapped(
    gpu: &Gpu,
    what: &str,
    buffer: &wgpu::Buffer,
) -> Result<Vec<u8>, GpuError> {
    let failed = |reason: String| GpuError::ReadBack {
        what: what.to_owned(),
        reason,
    };
    let (send, receive) = std::sync::mpsc::channel();
    let slice = buffer.slice(..);
    slice.map_async(wgpu::MapMode::Read, move |result| {
        // The receiver is gone only if the wait below failed, which is reported there.
        let _ = send.send(result);
    });
    gpu.wait()?;
    // Another thread's wait may have taken up the answer and still be passing it on.
    receive
        .recv()
        .map_err(|error| failed(error.to_string()))?
        .map_err(|error| failed(error.to_string()))?;
    let view = slice
        .get_mapped_range()
        .map_err(|error| failed(error.to_string()))?;
    let bytes = view.to_vec();
    drop(view);
    buffer.unmap();
    Ok(bytes)
}
