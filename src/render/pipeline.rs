//! Render pipelines, said in few words.

use crate::gpu::{Gpu, GpuError, wgsl};

use super::{LIGHT_FORMAT, SHADERS};

/// Format of every depth target.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// How a layer uses the depth target.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum DepthUse {
    /// Hides what lies behind it.
    Write,
    /// Is hidden by what lies before it.
    TestOnly,
    /// Fills a shadow map: depth runs forwards, and there is no colour.
    Shadow,
    None,
}

/// One way of drawing: a shader's entry points and the fixed stages around them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drawing<'a> {
    /// File in `shaders/`.
    pub shader: &'a str,
    pub vertex: &'a str,
    pub fragment: &'a str,
    /// Bind groups: 0 the field, 1 the view, 2 the shadow map, 3 the layer's own.
    pub groups: [Option<&'a wgpu::BindGroupLayout>; 4],
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub format: wgpu::TextureFormat,
    pub samples: u32,
    pub depth: DepthUse,
    pub cull: Option<wgpu::Face>,
    pub topology: wgpu::PrimitiveTopology,
    pub blend: Option<wgpu::BlendState>,
    /// Turn alpha into the share of a pixel's samples that are covered.
    pub alpha_to_coverage: bool,
}

impl Default for Drawing<'_> {
    fn default() -> Self {
        Self {
            shader: "",
            vertex: "",
            fragment: "",
            groups: [None; 4],
            buffers: &[],
            format: LIGHT_FORMAT,
            samples: 1,
            depth: DepthUse::Write,
            cull: None,
            topology: wgpu::PrimitiveTopology::TriangleList,
            blend: None,
            alpha_to_coverage: false,
        }
    }
}

impl Drawing<'_> {
    /// Compiles the shader and makes the pipeline.
    ///
    /// # Errors
    /// `Wgsl` or `Rejected`, naming the shader.
    pub(super) fn pipeline(&self, gpu: &Gpu) -> Result<wgpu::RenderPipeline, GpuError> {
        let source = wgsl::assemble_named(self.shader, &[SHADERS, wgsl::SHARED])?;
        let module = gpu.shader(&source)?;
        let targets = [Some(wgpu::ColorTargetState {
            format: self.format,
            blend: self.blend,
            write_mask: wgpu::ColorWrites::ALL,
        })];
        let is_shadow = self.depth == DepthUse::Shadow;
        let what = format!("pipeline {} of {}", self.vertex, self.shader);
        gpu.guarded(&what, || {
            let used = self.groups.iter().rposition(Option::is_some);
            let layout = gpu
                .device
                .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some(self.shader),
                    bind_group_layouts: &self.groups[..used.map_or(0, |last| last + 1)],
                    immediate_size: 0,
                });
            gpu.device
                .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                    label: Some(self.vertex),
                    layout: Some(&layout),
                    vertex: wgpu::VertexState {
                        module: &module,
                        entry_point: Some(self.vertex),
                        compilation_options: Default::default(),
                        buffers: self.buffers,
                    },
                    primitive: wgpu::PrimitiveState {
                        topology: self.topology,
                        cull_mode: self.cull,
                        ..Default::default()
                    },
                    depth_stencil: self.depth_state(),
                    multisample: wgpu::MultisampleState {
                        count: self.samples,
                        mask: !0,
                        alpha_to_coverage_enabled: self.alpha_to_coverage,
                    },
                    fragment: (!is_shadow).then(|| wgpu::FragmentState {
                        module: &module,
                        entry_point: Some(self.fragment),
                        compilation_options: Default::default(),
                        targets: &targets,
                    }),
                    multiview_mask: None,
                    cache: None,
                })
        })
    }

    fn depth_state(&self) -> Option<wgpu::DepthStencilState> {
        let (write, compare, bias) = match self.depth {
            DepthUse::None => return None,
            DepthUse::Write => (true, wgpu::CompareFunction::Greater, 0),
            DepthUse::TestOnly => (false, wgpu::CompareFunction::GreaterEqual, 0),
            DepthUse::Shadow => (true, wgpu::CompareFunction::Less, 2),
        };
        Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(write),
            depth_compare: Some(compare),
            stencil: Default::default(),
            bias: wgpu::DepthBiasState {
                constant: bias,
                slope_scale: if bias == 0 { 0.0 } else { 1.5 },
                clamp: 0.0,
            },
        })
    }
}

/// A bind group layout of entries 0, 1, …, each seen by the given stages.
pub(super) fn group_layout(
    gpu: &Gpu,
    label: &str,
    entries: &[(wgpu::ShaderStages, wgpu::BindingType)],
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = entries
        .iter()
        .zip(0..)
        .map(|(&(visibility, ty), binding)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty,
            count: None,
        })
        .collect();
    gpu.device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &entries,
        })
}

/// A bind group of resources 0, 1, …
pub(super) fn bind_group(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    let entries: Vec<_> = resources
        .iter()
        .zip(0..)
        .map(|(resource, binding)| wgpu::BindGroupEntry {
            binding,
            resource: resource.clone(),
        })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(label),
        layout,
        entries: &entries,
    })
}

/// A storage buffer that shaders only read.
pub(super) const READ_STORAGE: wgpu::BindingType = wgpu::BindingType::Buffer {
    ty: wgpu::BufferBindingType::Storage { read_only: true },
    has_dynamic_offset: false,
    min_binding_size: None,
};

/// A uniform buffer.
pub(super) const UNIFORM: wgpu::BindingType = wgpu::BindingType::Buffer {
    ty: wgpu::BufferBindingType::Uniform,
    has_dynamic_offset: false,
    min_binding_size: None,
};
/// A texture of colours, sampled between its texels.
pub(super) const TEXTURE: wgpu::BindingType = wgpu::BindingType::Texture {
    sample_type: wgpu::TextureSampleType::Float { filterable: true },
    view_dimension: wgpu::TextureViewDimension::D2,
    multisampled: false,
};
/// The sampler of a [`TEXTURE`].
pub(super) const SAMPLER: wgpu::BindingType =
    wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
