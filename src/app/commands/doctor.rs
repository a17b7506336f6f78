//! `sward doctor`.

use std::io::{self, Write};

use crate::app::Failure;
use crate::run::Exit;
use crate::scene::Solver;
use crate::sim::slab::slab_bytes;

const MIB: u64 = 1 << 20;

/// What one adapter can do, as far as sward cares.
struct Adapter {
    name: String,
    backend: String,
    driver: String,
    device_type: wgpu::DeviceType,
    /// Names of WebGPU's default limits that the adapter stays below.
    below_webgpu: Vec<&'static str>,
    compute: bool,
    indirect: bool,
    timestamps: bool,
    /// Four samples per pixel for high-dynamic-range colour and depth.
    four_samples: bool,
    binding_bytes: u64,
    texture_edge: u32,
}

/// Prints the adapters and what their limits and features mean.
pub fn run(out: &mut impl Write) -> Result<Exit, Failure> {
    write_machine(out)?;
    let adapters = adapters();
    if adapters.is_empty() {
        write_no_adapter(out)?;
    }
    for adapter in &adapters {
        adapter.write(out)?;
    }
    let hardware = adapters.iter().any(Adapter::is_hardware);
    let engine = if hardware { "gpu" } else { "cpu" };
    writeln!(
        out,
        "\n`sward run` takes the {engine} engine by default here."
    )?;
    Ok(Exit::Ok)
}

fn write_machine(out: &mut impl Write) -> io::Result<()> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    writeln!(out, "sward {}", env!("CARGO_PKG_VERSION"))?;
    writeln!(out, "cpu engine: {threads} threads, always available")?;
    if cfg!(target_os = "linux") {
        let display = ["WAYLAND_DISPLAY", "DISPLAY"]
            .into_iter()
            .find_map(|name| Some((name, std::env::var(name).ok().filter(|v| !v.is_empty())?)));
        match display {
            Some((name, value)) => writeln!(out, "window: yes, {name}={value}")?,
            None => writeln!(
                out,
                "window: no display (neither WAYLAND_DISPLAY nor DISPLAY is set); scenes run \
                 headless, or start sward under `xvfb-run`"
            )?,
        }
    }
    Ok(())
}

fn write_no_adapter(out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "\nno graphics adapter: no gpu engine, no pictures, no window\n  \
         on Debian or Ubuntu a software one comes with\n    \
         apt-get install mesa-vulkan-drivers libvulkan1\n  \
         with a graphics card, install its maker's Vulkan driver"
    )
}

fn adapters() -> Vec<Adapter> {
    // Without any backend compiled in, wgpu panics instead of finding nothing.
    if wgpu::Instance::enabled_backend_features().is_empty() {
        return Vec::new();
    }
    let descriptor = wgpu::InstanceDescriptor::new_without_display_handle().with_env();
    let instance = wgpu::Instance::new(descriptor);
    let found = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    found.iter().map(Adapter::new).collect()
}

impl Adapter {
    fn new(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        let limits = adapter.limits();
        let mut below_webgpu = Vec::new();
        wgpu::Limits::defaults().check_limits_with_fail_fn(&limits, false, |name, _, _| {
            below_webgpu.push(name);
        });
        let downlevel = adapter.get_downlevel_capabilities().flags;
        let four_samples = [
            wgpu::TextureFormat::Rgba16Float,
            wgpu::TextureFormat::Depth32Float,
        ]
        .into_iter()
        .all(|format| {
            let flags = adapter.get_texture_format_features(format).flags;
            flags.contains(wgpu::TextureFormatFeatureFlags::MULTISAMPLE_X4)
        });
        Self {
            driver: format!("{} {}", info.driver, info.driver_info)
                .trim()
                .to_owned(),
            name: info.name,
            backend: info.backend.to_string(),
            device_type: info.device_type,
            below_webgpu,
            compute: downlevel.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS),
            indirect: downlevel.contains(wgpu::DownlevelFlags::INDIRECT_EXECUTION),
            timestamps: adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY),
            four_samples,
            binding_bytes: limits.max_storage_buffer_binding_size,
            texture_edge: limits.max_texture_dimension_2d,
        }
    }

    fn is_hardware(&self) -> bool {
        self.is_usable() && self.device_type != wgpu::DeviceType::Cpu
    }

    fn is_usable(&self) -> bool {
        self.below_webgpu.is_empty() && self.compute && self.indirect
    }

    fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let kind = match self.device_type {
            wgpu::DeviceType::Cpu => {
                "software: right, but 100 to 1000 times slower than a graphics card"
            }
            wgpu::DeviceType::IntegratedGpu => "integrated",
            wgpu::DeviceType::DiscreteGpu => "discrete",
            wgpu::DeviceType::VirtualGpu => "virtual",
            wgpu::DeviceType::Other => "of unknown kind",
        };
        writeln!(out, "\nadapter {} ({kind})", self.name)?;
        writeln!(
            out,
            "  backend     {}, driver {}",
            self.backend, self.driver
        )?;
        writeln!(out, "  gpu engine  {}", self.usable())?;
        let plant_bytes = slab_bytes(1, Solver::default().segments);
        writeln!(
            out,
            "  storage     {} MiB in one binding: state of {} active plants of {} segments",
            self.binding_bytes / MIB,
            self.binding_bytes / plant_bytes,
            Solver::default().segments
        )?;
        let timing = if self.timestamps {
            "on the device, pass by pass"
        } else {
            "no timestamps: only whole ticks are timed, from the outside"
        };
        writeln!(out, "  pass times  {timing}")?;
        let edges = if self.four_samples {
            "alpha-to-coverage with 4 samples"
        } else {
            "1 sample: blades get jagged edges"
        };
        writeln!(out, "  edges       {edges}")?;
        writeln!(
            out,
            "  pictures    up to {0} x {0} pixels",
            self.texture_edge
        )
    }

    fn usable(&self) -> String {
        if self.is_usable() {
            return "yes".into();
        }
        let mut missing = self.below_webgpu.clone();
        if !self.compute {
            missing.push("compute shaders");
        }
        if !self.indirect {
            missing.push("indirect dispatch");
        }
        format!("no, below WebGPU's defaults in: {}", missing.join(", "))
    }
}
