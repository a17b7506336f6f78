//! A counter on the device, known a frame or two late, so that nothing waits for it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use wgpu::BufferUsages;

use super::Gpu;

/// Bytes of the counter.
const BYTES: u64 = 4;

const FREE: u8 = 0;
const COPIED: u8 = 1;
const MAPPING: u8 = 2;
const READY: u8 = 3;
const FAILED: u8 = 4;

/// The last value that has arrived of a word that kernels count up.
#[derive(Debug)]
pub struct LateCount {
    copy: wgpu::Buffer,
    state: Arc<AtomicU8>,
    value: u32,
}

impl LateCount {
    pub fn new(gpu: &Gpu) -> Self {
        let copy = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("a late count"),
            size: BYTES,
            usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Self {
            copy,
            state: Arc::new(AtomicU8::new(FREE)),
            value: 0,
        }
    }

    /// Sends the word at `byte` of a buffer on its way, unless one is on its way already.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, from: &wgpu::Buffer, byte: u64) {
        if self.state.load(Ordering::Acquire) == FREE {
            encoder.copy_buffer_to_buffer(from, byte, &self.copy, 0, BYTES);
            self.state.store(COPIED, Ordering::Release);
        }
    }

    /// Takes in what has arrived, without waiting. Call after the submission.
    pub fn collect(&mut self, gpu: &Gpu) {
        if self.state.load(Ordering::Acquire) == COPIED {
            self.state.store(MAPPING, Ordering::Release);
            let state = Arc::clone(&self.state);
            self.copy.map_async(wgpu::MapMode::Read, .., move |result| {
                let next = if result.is_ok() { READY } else { FAILED };
                state.store(next, Ordering::Release);
            });
        }
        if gpu.device.poll(wgpu::PollType::Poll).is_err() {
            return;
        }
        match self.state.load(Ordering::Acquire) {
            READY => {
                if let Ok(view) = self.copy.slice(..).get_mapped_range() {
                    let words: Vec<u32> = bytemuck::pod_collect_to_vec(&view);
                    self.value = words.first().copied().unwrap_or(self.value);
                }
                self.copy.unmap();
                self.state.store(FREE, Ordering::Release);
            }
            // The next submission tries again.
            FAILED => self.state.store(FREE, Ordering::Release),
            _ => {}
        }
    }

    pub fn value(&self) -> u32 {
        self.value
    }
}
