//! The device and queue, what they run on, and the errors they report late.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::GpuError;
use super::wgsl::Assembled;

/// What the device runs on.
#[derive(Clone, Debug, PartialEq)]
pub struct AdapterReport {
    pub name: String,
    /// Driver and its version.
    pub driver: String,
    pub backend: String,
    pub device_type: String,
    /// True for a rasteriser on the CPU: correct, but 100 to 1000 times slower.
    pub is_software: bool,
}

impl AdapterReport {
    fn new(info: &wgpu::AdapterInfo) -> Self {
        Self {
            name: info.name.clone(),
            driver: format!("{} {}", info.driver, info.driver_info)
                .trim()
                .to_owned(),
            backend: info.backend.to_string(),
            device_type: format!("{:?}", info.device_type),
            is_software: info.device_type == wgpu::DeviceType::Cpu,
        }
    }
}

/// A graphics device with its queue.
#[derive(Clone, Debug)]
pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub adapter: AdapterReport,
    faults: Arc<Mutex<Faults>>,
}

/// Errors that no call returned.
#[derive(Debug, Default)]
struct Faults {
    lost: Option<String>,
    uncaptured: Vec<String>,
    /// Uncaptured errors beyond the first few, which are not kept.
    more: u64,
}

/// Uncaptured errors kept with their text; a broken frame repeats its errors at every frame.
const FAULTS_KEPT: usize = 8;

impl Gpu {
    /// Opens the fastest adapter without a window. Blocks until the driver answers.
    ///
    /// # Errors
    /// `NoAdapter` says what to install; `NoDevice` if the adapter is below WebGPU's defaults.
    pub fn headless() -> Result<Self, GpuError> {
        if wgpu::Instance::enabled_backend_features().is_empty() {
            return Err(GpuError::NoAdapter {
                reason: "this build has no graphics backend for the platform".into(),
            });
        }
        let descriptor = wgpu::InstanceDescriptor::new_without_display_handle().with_env();
        Self::open(&wgpu::Instance::new(descriptor), None)
    }

    /// Opens the fastest adapter that can present to `surface`.
    ///
    /// # Errors
    /// As for [`Gpu::headless`].
    pub fn for_surface(
        instance: &wgpu::Instance,
        surface: &wgpu::Surface<'_>,
    ) -> Result<Self, GpuError> {
        Self::open(instance, Some(surface))
    }

    /// Takes the device of a program that embeds this library. The program's own error handlers
    /// stay in place, so [`Gpu::check`] knows nothing of that device's late errors; calls that
    /// return a `Result` still report theirs.
    pub fn from_parts(info: &wgpu::AdapterInfo, device: wgpu::Device, queue: wgpu::Queue) -> Self {
        Self {
            device,
            queue,
            adapter: AdapterReport::new(info),
            faults: Arc::default(),
        }
    }

    fn open(
        instance: &wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<Self, GpuError> {
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: surface,
            ..Default::default()
        }))
        .map_err(|error| GpuError::NoAdapter {
            reason: error.to_string(),
        })?;
        let info = adapter.get_info();
        let own = adapter.limits();
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("sward"),
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: wgpu::Limits {
                max_storage_buffer_binding_size: own.max_storage_buffer_binding_size,
                max_buffer_size: own.max_buffer_size,
                ..wgpu::Limits::defaults()
            },
            ..Default::default()
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|error| {
                GpuError::NoDevice {
                    adapter: info.name.clone(),
                    reason: error.to_string(),
                }
            })?;
        let gpu = Self::from_parts(&info, device, queue);
        gpu.collect_faults();
        Ok(gpu)
    }

    /// From now on uncaptured errors and the loss of the device are kept for [`Gpu::check`],
    /// instead of going to the handlers installed before.
    pub fn collect_faults(&self) {
        let faults = Arc::clone(&self.faults);
        self.device
            .on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
                let mut faults = lock(&faults);
                if faults.uncaptured.len() < FAULTS_KEPT {
                    faults.uncaptured.push(error.to_string());
                } else {
                    faults.more += 1;
                }
            }));
        let faults = Arc::clone(&self.faults);
        self.device.set_device_lost_callback(move |reason, text| {
            // Dropping the last handle also 'loses' a device; nobody is left to ask then.
            lock(&faults).lost = Some(format!("{reason:?}: {text}"));
        });
    }

    /// Hands out the errors collected since the last call.
    ///
    /// # Errors
    /// `Lost` (every time from then on) or `Rejected` with all collected texts.
    pub fn check(&self) -> Result<(), GpuError> {
        let mut faults = lock(&self.faults);
        if let Some(reason) = &faults.lost {
            return Err(GpuError::Lost {
                reason: reason.clone(),
            });
        }
        if faults.uncaptured.is_empty() {
            return Ok(());
        }
        let mut reason = std::mem::take(&mut faults.uncaptured).join("; ");
        let more = std::mem::take(&mut faults.more);
        if more > 0 {
            reason.push_str(&format!("; and {more} more"));
        }
        Err(GpuError::Rejected {
            what: "the driver".into(),
            reason,
        })
    }

    /// True if passes can be timed on the device.
    pub fn has_timestamps(&self) -> bool {
        self.device
            .features()
            .contains(wgpu::Features::TIMESTAMP_QUERY)
    }

    /// Waits until everything submitted so far is done.
    ///
    /// # Errors
    /// As for [`Gpu::check`], or if the driver refuses to wait.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|error| GpuError::Rejected {
                what: "waiting for the device".into(),
                reason: error.to_string(),
            })?;
        self.check()
    }

    /// Runs `make` and returns what it made, or the error the device raised meanwhile.
    ///
    /// # Errors
    /// `Rejected`, naming `what`.
    pub fn guarded<T>(&self, what: &str, make: impl FnOnce() -> T) -> Result<T, GpuError> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validity = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let made = make();
        let invalid = pollster::block_on(validity.pop());
        let out_of_memory = pollster::block_on(memory.pop());
        match invalid.or(out_of_memory) {
            None => Ok(made),
            Some(error) => Err(GpuError::Rejected {
                what: what.to_owned(),
                reason: error.to_string(),
            }),
        }
    }

    /// Compiles an assembled shader.
    ///
    /// # Errors
    /// `Rejected`, with file and line of each of the compiler's messages.
    pub fn shader(&self, source: &Assembled) -> Result<wgpu::ShaderModule, GpuError> {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let module = self
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(source.path),
                source: wgpu::ShaderSource::Wgsl(source.text.as_str().into()),
            });
        let Some(error) = pollster::block_on(scope.pop()) else {
            return Ok(module);
        };
        Err(GpuError::Rejected {
            what: format!("shader {}", source.path),
            reason: source.explain(&error.to_string()),
        })
    }

    /// Makes a compute pipeline. `groups` are the layouts of bind groups 0, 1, …
    ///
    /// # Errors
    /// `Rejected`, with file and line for the shader's own errors.
    pub fn compute_pipeline(
        &self,
        source: &Assembled,
        entry_point: &str,
        groups: &[&wgpu::BindGroupLayout],
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        let module = self.shader(source)?;
        let what = format!("pipeline {} of {}", entry_point, source.path);
        self.guarded(&what, || {
            let layout = self.pipeline_layout(source.path, groups);
            self.device
                .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(source.path),
                    layout: Some(&layout),
                    module: &module,
                    entry_point: Some(entry_point),
                    compilation_options: Default::default(),
                    cache: None,
                })
        })
    }

    /// A pipeline layout of bind groups 0, 1, …
    pub fn pipeline_layout(
        &self,
        label: &str,
        groups: &[&wgpu::BindGroupLayout],
    ) -> wgpu::PipelineLayout {
        let groups: Vec<_> = groups.iter().copied().map(Some).collect();
        self.device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: &groups,
                immediate_size: 0,
            })
    }
}

/// A thread that died while it held the list left it whole: each change is one push or store.
fn lock(faults: &Mutex<Faults>) -> MutexGuard<'_, Faults> {
    faults.lock().unwrap_or_else(PoisonError::into_inner)
}
