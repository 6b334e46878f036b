//! Buffers and images: created, filled and read back by id.

use super::device::{Gpu, failure};
use super::fault::Fault;
use super::format::Format;
use super::slots::{Id, Slots};
use crate::fail;
use anyhow::{Result, bail};
use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme, Allocator, AllocatorCreateDesc};
use std::mem::ManuallyDrop;

/// A buffer of a [`Gpu`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BufferId(Id);

/// An image of a [`Gpu`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ImageId(Id);

/// Properties of an image. `attachment` and `storage` enable these uses; every image can be sampled and copied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ImageDesc {
    pub format: Format,
    pub width: u32,
    pub height: u32,
    pub layers: u32,
    pub mips: u32,
    pub attachment: bool,
    pub storage: bool,
}

pub(super) struct BufferSlot {
    pub handle: vk::Buffer,
    pub bytes: u64,
    allocation: Allocation,
}

pub(super) struct ImageSlot {
    pub handle: vk::Image,
    pub desc: ImageDesc,
    /// Views: all layers and mips as an array; the first layer with all mips; all layers of mip 0, for storage and attachments; the first
    /// layer of mip 0.
    pub array: vk::ImageView,
    pub flat: vk::ImageView,
    pub array_mip0: vk::ImageView,
    pub flat_mip0: vk::ImageView,
    allocation: Allocation,
}

pub(super) struct Memory {
    allocator: ManuallyDrop<Allocator>,
    buffers: Slots<BufferSlot>,
    images: Slots<ImageSlot>,
    /// Memory of both, bytes.
    bytes: u64,
}

/// Memory location of a buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Location {
    Device,
    Upload,
    ReadBack,
}

impl Memory {
    pub fn new(instance: &ash::Instance, device: &ash::Device, physical_device: vk::PhysicalDevice) -> Result<Self> {
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.clone(),
            device: device.clone(),
            physical_device,
            debug_settings: Default::default(),
            buffer_device_address: false,
            allocation_sizes: Default::default(),
        })
        .map_err(|error| fail!(NoDevice, "device memory: {error}"))?;
        Ok(Self { allocator: ManuallyDrop::new(allocator), buffers: Slots::new("buffer"), images: Slots::new("image"), bytes: 0 })
    }

    pub fn destroy(&mut self, device: &ash::Device) {
        for slot in self.buffers.take_all() {
            self.free_buffer(device, slot);
        }
        for slot in self.images.take_all() {
            self.free_image(device, slot);
        }
        // Safety: nothing uses the allocator after this; it must go before its device does.
        unsafe { ManuallyDrop::drop(&mut self.allocator) };
    }

    pub fn buffer(&self, id: BufferId) -> &BufferSlot {
        self.buffers.get(id.0)
    }

    pub fn image(&self, id: ImageId) -> &ImageSlot {
        self.images.get(id.0)
    }

    fn add_buffer(&mut self, slot: BufferSlot) -> BufferId {
        self.bytes += slot.allocation.size();
        BufferId(self.buffers.add(slot))
    }

    fn add_image(&mut self, slot: ImageSlot) -> ImageId {
        self.bytes += slot.allocation.size();
        ImageId(self.images.add(slot))
    }

    fn free_buffer(&mut self, device: &ash::Device, slot: BufferSlot) {
        unsafe { device.destroy_buffer(slot.handle, None) };
        self.free(slot.allocation);
    }

    fn free_image(&mut self, device: &ash::Device, slot: ImageSlot) {
        unsafe {
            for view in [slot.array, slot.flat, slot.array_mip0, slot.flat_mip0] {
                device.destroy_image_view(view, None);
            }
            device.destroy_image(slot.handle, None);
        }
        self.free(slot.allocation);
    }

    fn free(&mut self, allocation: Allocation) {
        self.bytes -= allocation.size();
        let freed = self.allocator.free(allocation);
        debug_assert!(freed.is_ok());
    }
}

impl Gpu {
    /// Device memory in use, bytes.
    pub fn memory_in_use(&self) -> u64 {
        self.memory.bytes
    }

    fn check_room(&self, name: &str, bytes: u64) -> Result<()> {
        if self.fault == Some(Fault::OutOfMemory { resource: name.into() }) {
            return Err(failure(vk::Result::ERROR_OUT_OF_DEVICE_MEMORY, name));
        }
        let (used, heap) = (self.memory.bytes, self.adapter.limits.heap_bytes);
        if used.saturating_add(bytes) > heap {
            return Err(fail!(
                OutOfMemory,
                "{name}: {} MB more than the {} MB in use do not fit into the {} MB of {}; lower the sizes and counts in the config",
                bytes >> 20,
                used >> 20,
                heap >> 20,
                self.adapter.name
            ));
        }
        Ok(())
    }

    /// Creates a device buffer with undefined contents.
    pub fn create_buffer(&mut self, name: &str, bytes: u64) -> Result<BufferId> {
        self.create_buffer_at(name, bytes, Location::Device)
    }

    /// Creates a buffer that the host writes, with `contents`.
    pub fn create_upload_buffer(&mut self, name: &str, contents: &[u8]) -> Result<BufferId> {
        let id = self.create_buffer_at(name, contents.len().max(4) as u64, Location::Upload)?;
        self.write_upload_buffer(id, contents);
        Ok(id)
    }

    /// Overwrites the start of an upload buffer; the device must not be using it.
    pub fn write_upload_buffer(&mut self, id: BufferId, contents: &[u8]) {
        let mapped =
            self.memory.buffers.get_mut(id.0).allocation.mapped_slice_mut().unwrap_or_else(|| unreachable!("upload buffers are mapped"));
        mapped[..contents.len()].copy_from_slice(contents);
    }

    /// Creates a buffer that the host reads.
    pub fn create_read_back_buffer(&mut self, name: &str, bytes: u64) -> Result<BufferId> {
        self.create_buffer_at(name, bytes, Location::ReadBack)
    }

    /// Contents of a read-back buffer.
    pub fn read_buffer(&self, id: BufferId) -> &[u8] {
        let slot = self.memory.buffer(id);
        let mapped = slot.allocation.mapped_slice().unwrap_or_else(|| unreachable!("read-back buffers are mapped"));
        &mapped[..slot.bytes as usize]
    }

    fn create_buffer_at(&mut self, name: &str, bytes: u64, location: Location) -> Result<BufferId> {
        let bytes = bytes.max(4);
        let limit = self.adapter.limits.buffer_bytes;
        if bytes > limit {
            return Err(fail!(OutOfMemory, "{name}: a buffer of {bytes} bytes is over the {limit} that {} allows", self.adapter.name));
        }
        self.check_room(name, bytes)?;
        use vk::BufferUsageFlags as Usage;
        let info = vk::BufferCreateInfo::default().size(bytes).usage(
            Usage::STORAGE_BUFFER
                | Usage::UNIFORM_BUFFER
                | Usage::VERTEX_BUFFER
                | Usage::INDEX_BUFFER
                | Usage::INDIRECT_BUFFER
                | Usage::TRANSFER_SRC
                | Usage::TRANSFER_DST,
        );
        let handle = unsafe { self.device.create_buffer(&info, None) }.map_err(|e| failure(e, name))?;
        let requirements = unsafe { self.device.get_buffer_memory_requirements(handle) };
        let allocation = self
            .memory
            .allocator
            .allocate(&AllocationCreateDesc {
                name,
                requirements,
                location: match location {
                    Location::Device => MemoryLocation::GpuOnly,
                    Location::Upload => MemoryLocation::CpuToGpu,
                    Location::ReadBack => MemoryLocation::GpuToCpu,
                },
                linear: true,
                allocation_scheme: AllocationScheme::GpuAllocatorManaged,
            })
            .map_err(|error| fail!(OutOfMemory, "{name}: {error}"))?;
        unsafe { self.device.bind_buffer_memory(handle, allocation.memory(), allocation.offset()) }.map_err(|e| failure(e, name))?;
        self.name_object(handle, name);
        Ok(self.memory.add_buffer(BufferSlot { handle, bytes, allocation }))
    }

    /// Creates images with undefined contents in the layout GENERAL, with one submission for all of them.
    pub fn create_images(&mut self, descs: &[(&str, ImageDesc)]) -> Result<Vec<ImageId>> {
        let ids = descs.iter().map(|(name, desc)| self.create_image_undefined(name, desc)).collect::<Result<Vec<_>>>()?;
        if !ids.is_empty() {
            self.submit("image layouts", |commands| ids.iter().for_each(|id| commands.make_general(*id)))?;
        }
        Ok(ids)
    }

    fn create_image_undefined(&mut self, name: &str, desc: &ImageDesc) -> Result<ImageId> {
        let limits = self.adapter.limits;
        let (size, layers) = (desc.width.max(desc.height), desc.layers);
        if desc.width == 0 || desc.height == 0 || layers == 0 {
            bail!("{name}: an image of {}x{} texels and {layers} layers cannot be made", desc.width, desc.height);
        }
        if size > limits.image_size || layers > limits.image_layers {
            return Err(fail!(
                BadInput,
                "{name}: {}x{} texels in {layers} layers are over the {} texels and {} layers that {} allows",
                desc.width,
                desc.height,
                limits.image_size,
                limits.image_layers,
                self.adapter.name
            ));
        }
        self.check_room(name, u64::from(desc.width) * u64::from(desc.height) * u64::from(layers) * desc.format.texel_bytes() as u64)?;
        use vk::ImageUsageFlags as Usage;
        let mut usage = Usage::SAMPLED | Usage::TRANSFER_SRC | Usage::TRANSFER_DST;
        if desc.attachment {
            usage |= if desc.format.is_depth() { Usage::DEPTH_STENCIL_ATTACHMENT } else { Usage::COLOR_ATTACHMENT };
        }
        if desc.storage {
            usage |= Usage::STORAGE;
        }
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(desc.format.vk())
            .extent(vk::Extent3D { width: desc.width, height: desc.height, depth: 1 })
            .mip_levels(desc.mips)
            .array_layers(layers)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(usage)
            .initial_layout(vk::ImageLayout::UNDEFINED);
        let handle = unsafe { self.device.create_image(&info, None) }.map_err(|e| failure(e, name))?;
        let requirements = unsafe { self.device.get_image_memory_requirements(handle) };
        let allocation = self
            .memory
            .allocator
            .allocate(&AllocationCreateDesc {
                name,
                requirements,
                location: MemoryLocation::GpuOnly,
                linear: false,
                allocation_scheme: AllocationScheme::GpuAllocatorManaged,
            })
            .map_err(|error| fail!(OutOfMemory, "{name}: {error}"))?;
        unsafe { self.device.bind_image_memory(handle, allocation.memory(), allocation.offset()) }.map_err(|e| failure(e, name))?;
        self.name_object(handle, name);
        let view = |kind, layers, mips| {
            let range = vk::ImageSubresourceRange::default().aspect_mask(desc.format.aspect()).layer_count(layers).level_count(mips);
            let info = vk::ImageViewCreateInfo::default().image(handle).view_type(kind).format(desc.format.vk()).subresource_range(range);
            unsafe { self.device.create_image_view(&info, None) }.map_err(|e| failure(e, name))
        };
        let (array_kind, flat_kind) = (vk::ImageViewType::TYPE_2D_ARRAY, vk::ImageViewType::TYPE_2D);
        let slot = ImageSlot {
            handle,
            desc: *desc,
            array: view(array_kind, layers, desc.mips)?,
            flat: view(flat_kind, 1, desc.mips)?,
            array_mip0: view(array_kind, layers, 1)?,
            flat_mip0: view(flat_kind, 1, 1)?,
            allocation,
        };
        Ok(self.memory.add_image(slot))
    }

    /// Destroys a buffer and frees its memory. The device must not be using it, and its id must not be used again.
    pub fn free_buffer(&mut self, id: BufferId) {
        let slot = self.memory.buffers.remove(id.0);
        self.memory.free_buffer(&self.device, slot);
    }

    /// Destroys an image as [`Self::free_buffer`] does a buffer.
    pub fn free_image(&mut self, id: ImageId) {
        let slot = self.memory.images.remove(id.0);
        self.memory.free_image(&self.device, slot);
    }

    fn name_object<T: vk::Handle>(&self, handle: T, name: &str) {
        let (Some(debug), Ok(name)) = (&self.debug, std::ffi::CString::new(name)) else { return };
        let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&name);
        // Ignored: names are for captures alone.
        let _ = unsafe { debug.set_debug_utils_object_name(&info) };
    }
}
