//! Pipelines: shaders with their bindings numbered by name, specialization constants and raster state.

use super::device::{Gpu, failure};
use super::format::Format;
use super::shader::{Binding, BindingKind, Shader, ShaderAccess, ShaderStage};
use super::vertex::VertexLayout;
use anyhow::{Result, bail};
use ash::vk;
use std::collections::{BTreeMap, HashMap};

/// A pipeline of a [`Gpu`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct PipelineId(u32);

/// How a fragment's colour joins what a target holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Blend {
    /// It takes its place.
    #[default]
    Replace,
    /// It is added.
    Add,
    /// It lies over it; its colours are multiplied by its alpha.
    Over,
}

/// State of a raster pipeline. Depth is reversed everywhere: 1 is near, 0 is far, and the greater wins.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct RasterState {
    pub vertex: VertexLayout,
    pub color: Vec<Format>,
    pub depth: Option<Format>,
    /// Draws points, one a vertex, in place of triangles.
    pub points: bool,
    /// Culls triangles that face away.
    pub cull_back: bool,
    /// Blending into the colour targets.
    pub blend: Blend,
    /// Rasterizes every pixel that a triangle touches, and not only those whose centre it covers. The device needs
    /// [`ConservativeRasterization`](super::Feature::ConservativeRasterization).
    pub conservative: bool,
}

pub(super) struct PipelineSlot {
    pub handle: vk::Pipeline,
    pub layout: vk::PipelineLayout,
    pub bind_point: vk::PipelineBindPoint,
    pub stages: vk::ShaderStageFlags,
    set_layout: vk::DescriptorSetLayout,
    /// Number and binding by name; access is joined over the stages.
    pub bindings: BTreeMap<String, (u32, Binding)>,
    pub local_size: [u32; 3],
}

#[derive(Default)]
pub(super) struct Pipelines(Vec<Option<PipelineSlot>>);

impl Pipelines {
    pub fn get(&self, id: PipelineId) -> &PipelineSlot {
        self.0[id.0 as usize].as_ref().unwrap_or_else(|| unreachable!("a pipeline is not used after it was freed"))
    }

    pub fn destroy(&mut self, device: &ash::Device) {
        self.0.drain(..).flatten().for_each(|slot| slot.destroy(device));
    }
}

impl PipelineSlot {
    fn destroy(self, device: &ash::Device) {
        unsafe {
            device.destroy_pipeline(self.handle, None);
            device.destroy_pipeline_layout(self.layout, None);
            device.destroy_descriptor_set_layout(self.set_layout, None);
        }
    }
}

/// Joins the bindings of a pipeline's shaders by name, and numbers them in the order of their names.
pub fn join_bindings(shaders: &[&Shader]) -> Result<BTreeMap<String, (u32, Binding)>> {
    let mut joined: BTreeMap<String, (u32, Binding)> = BTreeMap::new();
    for shader in shaders {
        for binding in &shader.bindings {
            let (_, known) = joined.entry(binding.name.clone()).or_insert_with(|| (0, binding.clone()));
            if known.kind != binding.kind {
                bail!("glsl/{}: {} is declared otherwise than in the pipeline's other stages", shader.name, binding.name);
            }
            if known.access != binding.access {
                known.access = ShaderAccess::ReadWrite;
            }
        }
    }
    for (number, (_, slot)) in joined.iter_mut().enumerate() {
        slot.0 = number as u32;
    }
    Ok(joined)
}

struct Prepared {
    modules: Vec<vk::ShaderModule>,
    slot: PipelineSlot,
}

impl Gpu {
    /// Bindings of a pipeline by name, with their numbers.
    pub fn bindings(&self, id: PipelineId) -> &BTreeMap<String, (u32, Binding)> {
        &self.pipelines.get(id).bindings
    }

    /// Destroys a pipeline. The device must not be using it, and its id must not be used again.
    pub fn free_pipeline(&mut self, id: PipelineId) {
        if let Some(slot) = self.pipelines.0[id.0 as usize].take() {
            slot.destroy(&self.device);
        }
    }

    /// Workgroup size of a compute pipeline.
    pub fn local_size(&self, id: PipelineId) -> [u32; 3] {
        self.pipelines.get(id).local_size
    }

    /// Creates a compute pipeline; `constants` are specialization constants by id.
    pub fn create_compute_pipeline(&mut self, name: &str, shader: &Shader, constants: &[(u32, u32)]) -> Result<PipelineId> {
        let mut prepared = self.prepare(name, &[shader], vk::PipelineBindPoint::COMPUTE)?;
        prepared.slot.local_size = shader.local_size(constants);
        let (entries, data) = specialization(constants);
        let info = vk::SpecializationInfo::default().map_entries(&entries).data(&data);
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(prepared.modules[0])
            .name(c"main")
            .specialization_info(&info);
        let create = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(prepared.slot.layout)];
        let result = unsafe { self.device.create_compute_pipelines(vk::PipelineCache::null(), &create, None) };
        self.finish(name, prepared, result)
    }

    /// Creates a raster pipeline of a vertex shader and later stages in their order, each with specialization constants by its own ids.
    /// Tessellated triangles are patches of three corners. Without targets rasterization is off.
    pub fn create_raster_pipeline(
        &mut self,
        name: &str,
        shaders: &[(&Shader, Vec<(u32, u32)>)],
        state: &RasterState,
    ) -> Result<PipelineId> {
        let only: Vec<&Shader> = shaders.iter().map(|(shader, _)| *shader).collect();
        let attributes = state.vertex.inputs(only[0])?;
        let prepared = self.prepare(name, &only, vk::PipelineBindPoint::GRAPHICS)?;
        let tessellated = only.iter().any(|shader| shader.stage == ShaderStage::TessellationControl);
        let constants: Vec<_> = shaders.iter().map(|(_, constants)| specialization(constants)).collect();
        let infos: Vec<_> =
            constants.iter().map(|(entries, data)| vk::SpecializationInfo::default().map_entries(entries).data(data)).collect();
        let stages: Vec<_> = (0..shaders.len())
            .map(|i| {
                vk::PipelineShaderStageCreateInfo::default()
                    .stage(stage_flag(only[i].stage))
                    .module(prepared.modules[i])
                    .name(c"main")
                    .specialization_info(&infos[i])
            })
            .collect();
        let buffers = [vk::VertexInputBindingDescription { binding: 0, stride: state.vertex.stride, ..Default::default() }];
        let vertex_input = vk::PipelineVertexInputStateCreateInfo::default()
            .vertex_attribute_descriptions(&attributes)
            .vertex_binding_descriptions(if attributes.is_empty() { &[] } else { &buffers });
        let topology = match (tessellated, state.points) {
            (true, _) => vk::PrimitiveTopology::PATCH_LIST,
            (false, true) => vk::PrimitiveTopology::POINT_LIST,
            (false, false) => vk::PrimitiveTopology::TRIANGLE_LIST,
        };
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default().topology(topology);
        let tessellation = vk::PipelineTessellationStateCreateInfo::default().patch_control_points(3);
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let mut conservative = vk::PipelineRasterizationConservativeStateCreateInfoEXT::default()
            .conservative_rasterization_mode(vk::ConservativeRasterizationModeEXT::OVERESTIMATE);
        let mut raster = vk::PipelineRasterizationStateCreateInfo::default()
            .cull_mode(if state.cull_back { vk::CullModeFlags::BACK } else { vk::CullModeFlags::NONE })
            .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
            .rasterizer_discard_enable(state.color.is_empty() && state.depth.is_none())
            .line_width(1.0);
        if state.conservative {
            raster = raster.push_next(&mut conservative);
        }
        let samples = vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let depth = vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(state.depth.is_some())
            .depth_write_enable(state.depth.is_some())
            .depth_compare_op(vk::CompareOp::GREATER);
        let (behind, alpha_ahead) = match state.blend {
            Blend::Replace | Blend::Add => (vk::BlendFactor::ONE, vk::BlendFactor::ONE),
            Blend::Over => (vk::BlendFactor::ONE_MINUS_SRC_ALPHA, vk::BlendFactor::ONE_MINUS_DST_ALPHA),
        };
        let blends: Vec<_> = state
            .color
            .iter()
            .map(|_| {
                vk::PipelineColorBlendAttachmentState::default()
                    .color_write_mask(vk::ColorComponentFlags::RGBA)
                    .blend_enable(state.blend != Blend::Replace)
                    .src_color_blend_factor(vk::BlendFactor::ONE)
                    .dst_color_blend_factor(behind)
                    .src_alpha_blend_factor(alpha_ahead)
                    .dst_alpha_blend_factor(vk::BlendFactor::ONE)
            })
            .collect();
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&blends);
        let dynamic =
            vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&[vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR]);
        let formats: Vec<_> = state.color.iter().map(|format| format.vk()).collect();
        let mut rendering = vk::PipelineRenderingCreateInfo::default()
            .color_attachment_formats(&formats)
            .depth_attachment_format(state.depth.map_or(vk::Format::UNDEFINED, Format::vk));
        let create = [vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&vertex_input)
            .input_assembly_state(&assembly)
            .tessellation_state(&tessellation)
            .viewport_state(&viewport)
            .rasterization_state(&raster)
            .multisample_state(&samples)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(prepared.slot.layout)
            .push_next(&mut rendering)];
        let result = unsafe { self.device.create_graphics_pipelines(vk::PipelineCache::null(), &create, None) };
        self.finish(name, prepared, result)
    }

    fn prepare(&mut self, name: &str, shaders: &[&Shader], bind_point: vk::PipelineBindPoint) -> Result<Prepared> {
        let bindings = join_bindings(shaders)?;
        let all = shaders.iter().fold(vk::ShaderStageFlags::empty(), |all, shader| all | stage_flag(shader.stage));
        let entries: Vec<_> = bindings
            .values()
            .map(|(number, binding)| {
                let kind = match binding.kind {
                    BindingKind::UniformBlock(_) => vk::DescriptorType::UNIFORM_BUFFER,
                    BindingKind::StorageBlock(_) => vk::DescriptorType::STORAGE_BUFFER,
                    BindingKind::Sampled { .. } => vk::DescriptorType::COMBINED_IMAGE_SAMPLER,
                    BindingKind::StorageImage { .. } => vk::DescriptorType::STORAGE_IMAGE,
                };
                vk::DescriptorSetLayoutBinding::default().binding(*number).descriptor_type(kind).descriptor_count(1).stage_flags(all)
            })
            .collect();
        let layout =
            vk::DescriptorSetLayoutCreateInfo::default().flags(vk::DescriptorSetLayoutCreateFlags::PUSH_DESCRIPTOR_KHR).bindings(&entries);
        let set_layout = unsafe { self.device.create_descriptor_set_layout(&layout, None) }.map_err(|e| failure(e, name))?;
        let block_bytes = |shader: &&Shader| {
            let members = shader.push_constants.iter().flat_map(|block| &block.members);
            members.map(|member| member.offset + member.bytes).max().unwrap_or(0)
        };
        let push_bytes = shaders.iter().map(block_bytes).max().unwrap_or(0) as u32;
        if push_bytes > 128 {
            bail!("pass {name}: its push constants take {push_bytes} bytes, over the 128 that every device has");
        }
        let ranges = [vk::PushConstantRange { stage_flags: all, offset: 0, size: push_bytes.next_multiple_of(4) }];
        let set_layouts = [set_layout];
        let layout = vk::PipelineLayoutCreateInfo::default().set_layouts(&set_layouts).push_constant_ranges(if push_bytes > 0 {
            &ranges
        } else {
            &[]
        });
        let layout = unsafe { self.device.create_pipeline_layout(&layout, None) }.map_err(|e| failure(e, name))?;
        let numbers: HashMap<&str, u32> = bindings.iter().map(|(name, (number, _))| (name.as_str(), *number)).collect();
        let mut modules = Vec::new();
        for shader in shaders {
            let words = shader.words_bound(&numbers);
            let info = vk::ShaderModuleCreateInfo::default().code(&words);
            modules.push(unsafe { self.device.create_shader_module(&info, None) }.map_err(|e| failure(e, &shader.name))?);
        }
        let slot = PipelineSlot { handle: vk::Pipeline::null(), layout, bind_point, stages: all, set_layout, bindings, local_size: [1; 3] };
        Ok(Prepared { modules, slot })
    }

    fn finish(
        &mut self,
        name: &str,
        mut prepared: Prepared,
        result: Result<Vec<vk::Pipeline>, (Vec<vk::Pipeline>, vk::Result)>,
    ) -> Result<PipelineId> {
        for module in prepared.modules {
            unsafe { self.device.destroy_shader_module(module, None) };
        }
        let result = result.map(|pipelines| pipelines[0]).map_err(|(_, error)| failure(error, name));
        prepared.slot.handle = *result.as_ref().unwrap_or(&vk::Pipeline::null());
        self.pipelines.0.push(Some(prepared.slot));
        result.map(|_| PipelineId(self.pipelines.0.len() as u32 - 1))
    }
}

fn stage_flag(stage: ShaderStage) -> vk::ShaderStageFlags {
    match stage {
        ShaderStage::Vertex => vk::ShaderStageFlags::VERTEX,
        ShaderStage::TessellationControl => vk::ShaderStageFlags::TESSELLATION_CONTROL,
        ShaderStage::TessellationEvaluation => vk::ShaderStageFlags::TESSELLATION_EVALUATION,
        ShaderStage::Geometry => vk::ShaderStageFlags::GEOMETRY,
        ShaderStage::Fragment => vk::ShaderStageFlags::FRAGMENT,
        ShaderStage::Compute => vk::ShaderStageFlags::COMPUTE,
    }
}

fn specialization(constants: &[(u32, u32)]) -> (Vec<vk::SpecializationMapEntry>, Vec<u8>) {
    let entry = |(i, (id, _)): (usize, &(u32, u32))| vk::SpecializationMapEntry { constant_id: *id, offset: 4 * i as u32, size: 4 };
    let entries = constants.iter().enumerate().map(entry).collect();
    (entries, constants.iter().flat_map(|(_, value)| value.to_ne_bytes()).collect())
}
