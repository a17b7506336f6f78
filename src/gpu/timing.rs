//! Milliseconds of every pass, from timestamps at its borders.
//!
//! Results come a frame or two late, so that nothing waits for the device. Of a device that falls
//! behind some frames are not timed; a median of the others is as good. Where the device has
//! no timestamps every call is harmless and the list of medians stays empty.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use wgpu::BufferUsages;

use super::Gpu;
use crate::base::statistics;

/// Frames over which a median is taken.
const WINDOW: usize = 64;
/// Frames that may be on their way at once.
const IN_FLIGHT: usize = 3;

/// Times passes by name; passes of one name within a frame add up.
#[derive(Debug)]
pub struct PassTimer {
    device: Option<Queries>,
    /// Names of this frame's passes, in order: pass i owns timestamps 2i and 2i + 1.
    names: Vec<&'static str>,
    /// Milliseconds of the last frames, by pass.
    frames_ms: BTreeMap<&'static str, VecDeque<f64>>,
}

#[derive(Debug)]
struct Queries {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    slots: Vec<Slot>,
    ms_per_tick: f64,
    most_passes: usize,
}

#[derive(Debug)]
struct Slot {
    copy: wgpu::Buffer,
    /// Names of the frame on its way; empty when the slot is free.
    names: Vec<&'static str>,
    state: Arc<AtomicU8>,
}

const COPIED: u8 = 0;
const MAPPING: u8 = 1;
const READY: u8 = 2;
const FAILED: u8 = 3;

impl PassTimer {
    /// A timer for up to `most_passes` passes a frame, at most 2,048 (WebGPU's query limit).
    pub fn new(gpu: &Gpu, most_passes: usize) -> Self {
        let most_passes = most_passes.clamp(1, 2048);
        let device = gpu.has_timestamps().then(|| Queries::new(gpu, most_passes));
        Self {
            device,
            names: Vec::new(),
            frames_ms: BTreeMap::new(),
        }
    }

    /// Timestamps for a compute pass of this frame; give them to its descriptor.
    pub fn compute(&mut self, name: &'static str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let (first, set) = self.claim(name)?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set: set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        })
    }

    /// Timestamps for a render pass of this frame; give them to its descriptor.
    pub fn render(&mut self, name: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let (first, set) = self.claim(name)?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set: set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        })
    }

    /// Ends the frame: call once, after its last pass and before its submission.
    pub fn finish_frame(&mut self, encoder: &mut wgpu::CommandEncoder) {
        let names = std::mem::take(&mut self.names);
        let Some(queries) = &mut self.device else {
            return;
        };
        if names.is_empty() {
            return;
        }
        let Some(slot) = queries.slots.iter_mut().find(|slot| slot.names.is_empty()) else {
            // Too many frames are on their way: this one is not timed.
            return;
        };
        let count = 2 * names.len() as u32;
        encoder.resolve_query_set(&queries.set, 0..count, &queries.resolved, 0);
        encoder.copy_buffer_to_buffer(&queries.resolved, 0, &slot.copy, 0, u64::from(count) * 8);
        slot.names = names;
        slot.state.store(COPIED, Ordering::Release);
    }

    /// Takes in the frames that have arrived, without waiting. Call after a submission.
    pub fn collect(&mut self, gpu: &Gpu) {
        let Some(queries) = &mut self.device else {
            return;
        };
        for slot in &queries.slots {
            if !slot.names.is_empty() && slot.state.load(Ordering::Acquire) == COPIED {
                slot.state.store(MAPPING, Ordering::Release);
                let state = Arc::clone(&slot.state);
                slot.copy.map_async(wgpu::MapMode::Read, .., move |result| {
                    let next = if result.is_ok() { READY } else { FAILED };
                    state.store(next, Ordering::Release);
                });
            }
        }
        if gpu.device.poll(wgpu::PollType::Poll).is_err() {
            return;
        }
        let ms_per_tick = queries.ms_per_tick;
        for slot in &mut queries.slots {
            let names = match slot.state.load(Ordering::Acquire) {
                READY => std::mem::take(&mut slot.names),
                FAILED => {
                    slot.names.clear();
                    continue;
                }
                _ => continue,
            };
            slot.state.store(COPIED, Ordering::Release);
            if let Ok(view) = slot.copy.slice(..).get_mapped_range() {
                let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(&view);
                record(&mut self.frames_ms, &names, &ticks, ms_per_tick);
            }
            slot.copy.unmap();
        }
    }

    /// Median milliseconds per frame of every pass seen, by name.
    pub fn medians_ms(&self) -> Vec<(&'static str, f64)> {
        self.frames_ms
            .iter()
            .filter_map(|(name, frames)| {
                let values: Vec<f64> = frames.iter().copied().collect();
                statistics::median(&values).map(|ms| (*name, ms))
            })
            .collect()
    }

    fn claim(&mut self, name: &'static str) -> Option<(u32, &wgpu::QuerySet)> {
        let queries = self.device.as_ref()?;
        if self.names.len() == queries.most_passes {
            return None;
        }
        let first = 2 * self.names.len() as u32;
        self.names.push(name);
        Some((first, &queries.set))
    }
}

impl Queries {
    fn new(gpu: &Gpu, most_passes: usize) -> Self {
        let count = 2 * most_passes as u32;
        let buffer = |label, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: u64::from(count) * 8,
                usage,
                mapped_at_creation: false,
            })
        };
        Self {
            set: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("pass times"),
                ty: wgpu::QueryType::Timestamp,
                count,
            }),
            resolved: buffer(
                "pass times, resolved",
                BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
            ),
            slots: (0..IN_FLIGHT)
                .map(|_| Slot {
                    copy: buffer(
                        "pass times, read back",
                        BufferUsages::COPY_DST | BufferUsages::MAP_READ,
                    ),
                    names: Vec::new(),
                    state: Arc::new(AtomicU8::new(COPIED)),
                })
                .collect(),
            ms_per_tick: f64::from(gpu.queue.get_timestamp_period()) * 1e-6,
            most_passes,
        }
    }
}

/// Adds a frame's passes to the lists of their names.
fn record(
    frames_ms: &mut BTreeMap<&'static str, VecDeque<f64>>,
    names: &[&'static str],
    ticks: &[u64],
    ms_per_tick: f64,
) {
    let mut frame: BTreeMap<&'static str, f64> = BTreeMap::new();
    for (name, pair) in names.iter().zip(ticks.chunks_exact(2)) {
        // A clock that was reset between the two stamps would give a negative span.
        let span = pair[1].saturating_sub(pair[0]);
        *frame.entry(name).or_default() += span as f64 * ms_per_tick;
    }
    for (name, ms) in frame {
        let list = frames_ms.entry(name).or_default();
        if list.len() == WINDOW {
            list.pop_front();
        }
        list.push_back(ms);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_of_one_name_add_up() {
        let mut frames = BTreeMap::new();
        record(
            &mut frames,
            &["relax", "collide", "relax"],
            &[0, 10, 10, 15, 20, 50],
            0.5,
        );
        assert_eq!(frames["relax"], [20.0]);
        assert_eq!(frames["collide"], [2.5]);
    }

    #[test]
    fn old_frames_leave_the_window() {
        let mut frames = BTreeMap::new();
        for i in 0..WINDOW as u64 + 3 {
            record(&mut frames, &["draw"], &[0, i], 1.0);
        }
        assert_eq!(frames["draw"].len(), WINDOW);
        assert_eq!(frames["draw"][0], 3.0);
    }
}
