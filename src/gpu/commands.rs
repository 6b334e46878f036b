//! Recording of commands. It adds no barriers: the caller derives them ([`crate::graph`]).

use super::device::{Gpu, QUERY_COUNT};
use super::fault::Fault;
use super::memory::{BufferId, ImageId};
use super::pipeline::PipelineId;
use super::types::{Barrier, Bound, accesses, stages};
use ash::vk;

/// Contents of an attachment when rendering begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Load {
    Clear([f32; 4]),
    Keep,
}

/// An image that is rendered to, with all of its layers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attachment {
    pub image: ImageId,
    pub load: Load,
}

/// A command buffer in recording.
pub struct Commands<'g> {
    gpu: &'g Gpu,
    buffer: vk::CommandBuffer,
    stamps: u32,
    /// Capacity for timestamps.
    room: u32,
    lost_at: Option<String>,
}

impl<'g> Commands<'g> {
    pub(super) fn new(gpu: &'g Gpu, buffer: vk::CommandBuffer) -> Self {
        Self { gpu, buffer, stamps: 0, room: 0, lost_at: None }
    }

    pub(super) fn injected_loss(&self) -> Option<String> {
        self.lost_at.clone()
    }

    pub fn barrier(&mut self, barrier: &Barrier) {
        let memory = [vk::MemoryBarrier2::default()
            .src_stage_mask(stages(barrier.from))
            .src_access_mask(accesses(barrier.written))
            .dst_stage_mask(stages(barrier.to))
            .dst_access_mask(accesses(barrier.needed))];
        let info = vk::DependencyInfo::default().memory_barriers(&memory);
        unsafe { self.gpu.device.cmd_pipeline_barrier2(self.buffer, &info) };
    }

    /// Makes all earlier writes visible to the host's reads after the submission.
    pub fn barrier_to_host(&mut self) {
        let memory = [vk::MemoryBarrier2::default()
            .src_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
            .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
            .dst_stage_mask(vk::PipelineStageFlags2::HOST)
            .dst_access_mask(vk::AccessFlags2::HOST_READ)];
        let info = vk::DependencyInfo::default().memory_barriers(&memory);
        unsafe { self.gpu.device.cmd_pipeline_barrier2(self.buffer, &info) };
    }

    pub(super) fn make_general(&mut self, image: ImageId) {
        let slot = self.gpu.memory.image(image);
        let range = vk::ImageSubresourceRange::default()
            .aspect_mask(slot.desc.format.aspect())
            .layer_count(vk::REMAINING_ARRAY_LAYERS)
            .level_count(vk::REMAINING_MIP_LEVELS);
        let barriers = [vk::ImageMemoryBarrier2::default()
            .src_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
            .dst_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
            .dst_access_mask(vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE)
            .old_layout(vk::ImageLayout::UNDEFINED)
            .new_layout(vk::ImageLayout::GENERAL)
            .image(slot.handle)
            .subresource_range(range)];
        let info = vk::DependencyInfo::default().image_memory_barriers(&barriers);
        unsafe { self.gpu.device.cmd_pipeline_barrier2(self.buffer, &info) };
    }

    /// Begins a named range in captures. An injected device loss is found by this name.
    pub fn begin_label(&mut self, name: &str) {
        if self.gpu.fault == Some(Fault::DeviceLost { pass: name.into() }) {
            self.lost_at = Some(name.into());
        }
        if let (Some(debug), Ok(name)) = (&self.gpu.debug, std::ffi::CString::new(name)) {
            let label = vk::DebugUtilsLabelEXT::default().label_name(&name);
            unsafe { debug.cmd_begin_debug_utils_label(self.buffer, &label) };
        }
    }

    pub fn end_label(&mut self) {
        if let Some(debug) = &self.gpu.debug {
            unsafe { debug.cmd_end_debug_utils_label(self.buffer) };
        }
    }

    /// Reserves `count` timestamps, before the first is taken. Only the needed ones are reset: the software driver and the validation layer
    /// visit each, and resetting the whole pool would cost more than a small frame.
    pub fn expect_stamps(&mut self, count: u32) {
        assert!(count <= QUERY_COUNT, "a submission takes more than {QUERY_COUNT} timestamps");
        unsafe { self.gpu.device.cmd_reset_query_pool(self.buffer, self.gpu.queries, 0, count) };
        self.room = count;
    }

    /// Takes the next timestamp, after all commands recorded so far have completed.
    pub fn stamp(&mut self) {
        assert!(self.stamps < self.room, "a submission takes more timestamps than the {} that it said", self.room);
        unsafe {
            self.gpu.device.cmd_write_timestamp2(self.buffer, vk::PipelineStageFlags2::ALL_COMMANDS, self.gpu.queries, self.stamps);
        }
        self.stamps += 1;
    }

    pub fn bind(&mut self, pipeline: PipelineId) {
        let slot = self.gpu.pipelines.get(pipeline);
        unsafe { self.gpu.device.cmd_bind_pipeline(self.buffer, slot.bind_point, slot.handle) };
    }

    /// Binds resources to the pipeline's bindings by number.
    pub fn push_descriptors(&mut self, pipeline: PipelineId, bound: &[(u32, Bound)]) {
        if bound.is_empty() {
            return;
        }
        let slot = self.gpu.pipelines.get(pipeline);
        let memory = &self.gpu.memory;
        let buffers: Vec<[vk::DescriptorBufferInfo; 1]> = bound
            .iter()
            .map(|(_, bound)| match bound {
                Bound::UniformBuffer(id) | Bound::StorageBuffer(id) => {
                    [vk::DescriptorBufferInfo::default().buffer(memory.buffer(*id).handle).range(vk::WHOLE_SIZE)]
                }
                Bound::UniformRange { buffer, offset, bytes } => {
                    [vk::DescriptorBufferInfo::default().buffer(memory.buffer(*buffer).handle).offset(*offset).range(*bytes)]
                }
                _ => [vk::DescriptorBufferInfo::default()],
            })
            .collect();
        let images: Vec<[vk::DescriptorImageInfo; 1]> = bound
            .iter()
            .map(|(_, bound)| {
                let info = vk::DescriptorImageInfo::default().image_layout(vk::ImageLayout::GENERAL);
                match *bound {
                    Bound::SampledImage { image, array, sampler } => {
                        let slot = memory.image(image);
                        [info.image_view(if array { slot.array } else { slot.flat }).sampler(self.gpu.sampler_handle(sampler))]
                    }
                    Bound::StorageImage { image, array } => {
                        let slot = memory.image(image);
                        [info.image_view(if array { slot.array_mip0 } else { slot.flat_mip0 })]
                    }
                    _ => [info],
                }
            })
            .collect();
        let writes: Vec<vk::WriteDescriptorSet<'_>> = bound
            .iter()
            .enumerate()
            .map(|(i, (binding, bound))| {
                let write = vk::WriteDescriptorSet::default().dst_binding(*binding);
                match bound {
                    Bound::UniformBuffer(_) | Bound::UniformRange { .. } => {
                        write.descriptor_type(vk::DescriptorType::UNIFORM_BUFFER).buffer_info(&buffers[i])
                    }
                    Bound::StorageBuffer(_) => write.descriptor_type(vk::DescriptorType::STORAGE_BUFFER).buffer_info(&buffers[i]),
                    Bound::SampledImage { .. } => write.descriptor_type(vk::DescriptorType::COMBINED_IMAGE_SAMPLER).image_info(&images[i]),
                    Bound::StorageImage { .. } => write.descriptor_type(vk::DescriptorType::STORAGE_IMAGE).image_info(&images[i]),
                }
            })
            .collect();
        unsafe { self.gpu.push_descriptor.cmd_push_descriptor_set(self.buffer, slot.bind_point, slot.layout, 0, &writes) };
    }

    pub fn push_constants(&mut self, pipeline: PipelineId, bytes: &[u8]) {
        let slot = self.gpu.pipelines.get(pipeline);
        if !bytes.is_empty() {
            unsafe { self.gpu.device.cmd_push_constants(self.buffer, slot.layout, slot.stages, 0, bytes) };
        }
    }

    pub fn dispatch(&mut self, groups: [u32; 3]) {
        unsafe { self.gpu.device.cmd_dispatch(self.buffer, groups[0], groups[1], groups[2]) };
    }

    /// Begins rendering to all layers of the attachments, with viewport and scissor of `size`.
    pub fn begin_rendering(&mut self, size: [u32; 2], color: &[Attachment], depth: Option<Attachment>) {
        let info = |attachment: &Attachment| {
            let slot = self.gpu.memory.image(attachment.image);
            let (load, clear) = match attachment.load {
                Load::Keep => (vk::AttachmentLoadOp::LOAD, vk::ClearValue::default()),
                Load::Clear([depth, ..]) if slot.desc.format.is_depth() => {
                    (vk::AttachmentLoadOp::CLEAR, vk::ClearValue { depth_stencil: vk::ClearDepthStencilValue { depth, stencil: 0 } })
                }
                Load::Clear(float32) => (vk::AttachmentLoadOp::CLEAR, vk::ClearValue { color: vk::ClearColorValue { float32 } }),
            };
            vk::RenderingAttachmentInfo::default()
                .image_view(slot.array_mip0)
                .image_layout(vk::ImageLayout::GENERAL)
                .load_op(load)
                .store_op(vk::AttachmentStoreOp::STORE)
                .clear_value(clear)
        };
        let attachments = || color.iter().chain(&depth);
        let layers = attachments().map(|a| self.gpu.memory.image(a.image).desc.layers).min().unwrap_or(1);
        let color_infos: Vec<_> = color.iter().map(info).collect();
        let depth_info = depth.as_ref().map(info);
        let area = vk::Rect2D { offset: vk::Offset2D::default(), extent: vk::Extent2D { width: size[0], height: size[1] } };
        let mut rendering = vk::RenderingInfo::default().render_area(area).layer_count(layers).color_attachments(&color_infos);
        if let Some(depth_info) = &depth_info {
            rendering = rendering.depth_attachment(depth_info);
        }
        let viewport = vk::Viewport { width: size[0] as f32, height: size[1] as f32, max_depth: 1.0, ..Default::default() };
        unsafe {
            self.gpu.device.cmd_begin_rendering(self.buffer, &rendering);
            self.gpu.device.cmd_set_viewport(self.buffer, 0, &[viewport]);
            self.gpu.device.cmd_set_scissor(self.buffer, 0, &[area]);
        }
    }

    pub fn end_rendering(&mut self) {
        unsafe { self.gpu.device.cmd_end_rendering(self.buffer) };
    }

    /// Binds vertices, and indices if the draws have some.
    pub fn bind_geometry(&mut self, vertices: BufferId, indices: Option<BufferId>) {
        unsafe {
            self.gpu.device.cmd_bind_vertex_buffers(self.buffer, 0, &[self.gpu.memory.buffer(vertices).handle], &[0]);
        }
        let Some(indices) = indices else { return };
        unsafe {
            self.gpu.device.cmd_bind_index_buffer(self.buffer, self.gpu.memory.buffer(indices).handle, 0, vk::IndexType::UINT32);
        }
    }

    /// Draws by `count` `VkDrawIndexedIndirectCommand`s from number `first` on.
    pub fn draw_indexed_indirect(&mut self, arguments: BufferId, first: u32, count: u32) {
        self.draw_indirect_of(arguments, first, count, true);
    }

    /// Draws without indices, by `count` `VkDrawIndirectCommand`s from number `first` on.
    pub fn draw_indirect(&mut self, arguments: BufferId, first: u32, count: u32) {
        self.draw_indirect_of(arguments, first, count, false);
    }

    fn draw_indirect_of(&mut self, arguments: BufferId, first: u32, count: u32, indexed: bool) {
        let bytes = if indexed { size_of::<vk::DrawIndexedIndirectCommand>() } else { size_of::<vk::DrawIndirectCommand>() };
        let (stride, device) = (bytes as u32, &self.gpu.device);
        let limit = self.gpu.adapter.limits.draw_indirect_count.max(1);
        let mut done = 0;
        while done < count {
            let now = (count - done).min(limit);
            let offset = u64::from(first + done) * u64::from(stride);
            let arguments = self.gpu.memory.buffer(arguments).handle;
            unsafe {
                if indexed {
                    device.cmd_draw_indexed_indirect(self.buffer, arguments, offset, now, stride);
                } else {
                    device.cmd_draw_indirect(self.buffer, arguments, offset, now, stride);
                }
            }
            done += now;
        }
    }

    pub fn copy_buffer(&mut self, from: BufferId, from_offset: u64, to: BufferId, to_offset: u64, bytes: u64) {
        let regions = [vk::BufferCopy { src_offset: from_offset, dst_offset: to_offset, size: bytes }];
        let memory = &self.gpu.memory;
        unsafe { self.gpu.device.cmd_copy_buffer(self.buffer, memory.buffer(from).handle, memory.buffer(to).handle, &regions) };
    }

    /// Copies as much as both buffers hold.
    pub fn copy_whole_buffer(&mut self, from: BufferId, to: BufferId) {
        self.copy_buffer(from, 0, to, 0, self.gpu.memory.buffer(to).bytes.min(self.gpu.memory.buffer(from).bytes));
    }

    /// Copies a layer's mips, the largest first, tightly packed.
    pub(super) fn copy_buffer_to_mips(&mut self, from: BufferId, to: ImageId, layer: u32) {
        let slot = self.gpu.memory.image(to);
        let (from, desc) = (self.gpu.memory.buffer(from), slot.desc);
        let mut offset = 0;
        let regions: Vec<vk::BufferImageCopy> = (0..desc.mips)
            .map(|mip| {
                let [width, height] = [desc.width, desc.height].map(|side| (side >> mip).max(1));
                let region = image_region(desc.format.aspect(), layer, 1, width, height).buffer_offset(offset);
                offset += u64::from(width) * u64::from(height) * desc.format.texel_bytes() as u64;
                region.image_subresource(region.image_subresource.mip_level(mip))
            })
            .collect();
        assert_eq!(offset, from.bytes, "texels of {}x{} with {} mips", desc.width, desc.height, desc.mips);
        unsafe { self.gpu.device.cmd_copy_buffer_to_image(self.buffer, from.handle, slot.handle, vk::ImageLayout::GENERAL, &regions) };
    }

    /// Copies `rows` rows into a layer, from row `first` on.
    pub(super) fn copy_buffer_to_image_rows(&mut self, from: BufferId, to: ImageId, layer: u32, first: u32, rows: u32) {
        let slot = self.gpu.memory.image(to);
        let region = image_region(slot.desc.format.aspect(), layer, 1, slot.desc.width, rows);
        let regions = [region.image_offset(vk::Offset3D { x: 0, y: first as i32, z: 0 })];
        let from = self.gpu.memory.buffer(from).handle;
        unsafe { self.gpu.device.cmd_copy_buffer_to_image(self.buffer, from, slot.handle, vk::ImageLayout::GENERAL, &regions) };
    }

    /// Copies mip 0 of all layers, tightly packed, layer after layer.
    pub fn copy_image_to_buffer(&mut self, from: ImageId, to: BufferId) {
        let slot = self.gpu.memory.image(from);
        let regions = [image_region(slot.desc.format.aspect(), 0, slot.desc.layers, slot.desc.width, slot.desc.height)];
        let to = self.gpu.memory.buffer(to).handle;
        unsafe { self.gpu.device.cmd_copy_image_to_buffer(self.buffer, slot.handle, vk::ImageLayout::GENERAL, to, &regions) };
    }

    /// Copies an image's first layer to an image of a surface, scaled to it, and hands that one to the display.
    pub(super) fn copy_to_surface(&mut self, from: ImageId, to: vk::Image, extent: vk::Extent2D) {
        let slot = self.gpu.memory.image(from);
        let range = vk::ImageSubresourceRange::default().aspect_mask(vk::ImageAspectFlags::COLOR).layer_count(1).level_count(1);
        let transition = |old, new| {
            vk::ImageMemoryBarrier2::default()
                .src_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
                .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
                .dst_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
                .dst_access_mask(vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE)
                .old_layout(old)
                .new_layout(new)
                .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                .image(to)
                .subresource_range(range)
        };
        let writable = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        let corner = |width: u32, height: u32| vk::Offset3D { x: width as i32, y: height as i32, z: 1 };
        let layers = vk::ImageSubresourceLayers::default().aspect_mask(vk::ImageAspectFlags::COLOR).layer_count(1);
        let regions = [vk::ImageBlit::default()
            .src_subresource(layers)
            .src_offsets([vk::Offset3D::default(), corner(slot.desc.width, slot.desc.height)])
            .dst_subresource(layers)
            .dst_offsets([vk::Offset3D::default(), corner(extent.width, extent.height)])];
        let scaled = [slot.desc.width, slot.desc.height] != [extent.width, extent.height];
        let filter = if scaled { vk::Filter::LINEAR } else { vk::Filter::NEAREST };
        let (to_write, to_show) =
            ([transition(vk::ImageLayout::UNDEFINED, writable)], [transition(writable, vk::ImageLayout::PRESENT_SRC_KHR)]);
        let device = &self.gpu.device;
        unsafe {
            device.cmd_pipeline_barrier2(self.buffer, &vk::DependencyInfo::default().image_memory_barriers(&to_write));
            device.cmd_blit_image(self.buffer, slot.handle, vk::ImageLayout::GENERAL, to, writable, &regions, filter);
            device.cmd_pipeline_barrier2(self.buffer, &vk::DependencyInfo::default().image_memory_barriers(&to_show));
        }
    }

    /// Sets 4 bytes of a buffer.
    pub fn fill_word(&mut self, buffer: BufferId, offset: u64, word: u32) {
        unsafe { self.gpu.device.cmd_fill_buffer(self.buffer, self.gpu.memory.buffer(buffer).handle, offset, 4, word) };
    }

    /// Fills a whole buffer with zeros.
    pub fn fill_zeros(&mut self, buffer: BufferId) {
        unsafe { self.gpu.device.cmd_fill_buffer(self.buffer, self.gpu.memory.buffer(buffer).handle, 0, vk::WHOLE_SIZE, 0) };
    }
}

fn image_region(aspect: vk::ImageAspectFlags, layer: u32, layers: u32, width: u32, height: u32) -> vk::BufferImageCopy {
    vk::BufferImageCopy::default()
        .image_subresource(vk::ImageSubresourceLayers::default().aspect_mask(aspect).base_array_layer(layer).layer_count(layers))
        .image_extent(vk::Extent3D { width, height, depth: 1 })
}
