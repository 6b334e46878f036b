//! Buffers and images: made, filled and read back by id.

use super::device::{Gpu, failure};
use super::fault::Fault;
use super::format::Format;
use super::types::{Accesses, Barrier, Stages};
use crate::fail;
use anyhow::{Context, Result, bail};
use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme, Allocator, AllocatorCreateDesc};
use std::mem::ManuallyDrop;

/// A buffer of a [`Gpu`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BufferId(u32);

/// An image of a [`Gpu`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ImageId(u32);

/// An image's shape. `attachment` and `storage` say what it is made for; every image can be sampled and copied.
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
    /// All layers and mips as an array; the first layer, all mips, flat; all layers of mip 0, for storage and attachments;
    /// the first layer of mip 0.
    pub array: vk::ImageView,
    pub flat: vk::ImageView,
    pub array_mip0: vk::ImageView,
    pub flat_mip0: vk::ImageView,
    allocation: Allocation,
}

pub(super) struct Memory {
    allocator: ManuallyDrop<Allocator>,
    buffers: Vec<Option<BufferSlot>>,
    images: Vec<Option<ImageSlot>>,
}

/// Where a buffer lies.
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
        Ok(Self { allocator: ManuallyDrop::new(allocator), buffers: Vec::new(), images: Vec::new() })
    }

    pub fn destroy(&mut self, device: &ash::Device) {
        for i in 0..self.buffers.len() {
            self.free_buffer(device, BufferId(i as u32));
        }
        for i in 0..self.images.len() {
            self.free_image(device, ImageId(i as u32));
        }
        // Safety: nothing uses the allocator after this; it must go before its device does.
        unsafe { ManuallyDrop::drop(&mut self.allocator) };
    }

    pub fn buffer(&self, id: BufferId) -> &BufferSlot {
        self.buffers[id.0 as usize].as_ref().unwrap_or_else(|| unreachable!("buffer {id:?} is used after it was freed"))
    }

    pub fn image(&self, id: ImageId) -> &ImageSlot {
        self.images[id.0 as usize].as_ref().unwrap_or_else(|| unreachable!("image {id:?} is used after it was freed"))
    }

    fn free_buffer(&mut self, device: &ash::Device, id: BufferId) {
        if let Some(slot) = self.buffers[id.0 as usize].take() {
            unsafe { device.destroy_buffer(slot.handle, None) };
            let freed = self.allocator.free(slot.allocation);
            debug_assert!(freed.is_ok());
        }
    }

    fn free_image(&mut self, device: &ash::Device, id: ImageId) {
        if let Some(slot) = self.images[id.0 as usize].take() {
            unsafe {
                for view in [slot.array, slot.flat, slot.array_mip0, slot.flat_mip0] {
                    device.destroy_image_view(view, None);
                }
                device.destroy_image(slot.handle, None);
            }
            let freed = self.allocator.free(slot.allocation);
            debug_assert!(freed.is_ok());
        }
    }

    /// Bytes that buffers and images take.
    fn bytes(&self) -> u64 {
        let buffers = self.buffers.iter().flatten().map(|slot| slot.allocation.size());
        buffers.chain(self.images.iter().flatten().map(|slot| slot.allocation.size())).sum()
    }
}

impl Gpu {
    /// Device memory in use, bytes.
    pub fn memory_in_use(&self) -> u64 {
        self.memory.bytes()
    }

    fn check_room(&self, name: &str, bytes: u64) -> Result<()> {
        if self.fault == Some(Fault::OutOfMemory { resource: name.into() }) {
            return Err(failure(vk::Result::ERROR_OUT_OF_DEVICE_MEMORY, name));
        }
        let (used, heap) = (self.memory.bytes(), self.adapter.limits.heap_bytes);
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

    /// Makes a buffer on the device; its contents are undefined.
    pub fn create_buffer(&mut self, name: &str, bytes: u64) -> Result<BufferId> {
        self.create_buffer_at(name, bytes, Location::Device)
    }

    /// Makes a buffer that the host writes, holding `contents`.
    pub fn create_upload_buffer(&mut self, name: &str, contents: &[u8]) -> Result<BufferId> {
        let id = self.create_buffer_at(name, contents.len().max(4) as u64, Location::Upload)?;
        self.write_upload_buffer(id, contents);
        Ok(id)
    }

    /// Overwrites the start of an upload buffer; the device must not be using it.
    pub fn write_upload_buffer(&mut self, id: BufferId, contents: &[u8]) {
        let slot = self.memory.buffers[id.0 as usize].as_mut().unwrap_or_else(|| unreachable!("a freed buffer is written"));
        let mapped = slot.allocation.mapped_slice_mut().unwrap_or_else(|| unreachable!("upload buffers are mapped"));
        mapped[..contents.len()].copy_from_slice(contents);
    }

    /// Makes a buffer that the host reads.
    pub fn create_read_back_buffer(&mut self, name: &str, bytes: u64) -> Result<BufferId> {
        self.create_buffer_at(name, bytes, Location::ReadBack)
    }

    /// The contents of a read-back buffer.
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
        self.memory.buffers.push(Some(BufferSlot { handle, bytes, allocation }));
        Ok(BufferId(self.memory.buffers.len() as u32 - 1))
    }

    /// Makes images and brings them into the layout GENERAL; their contents are undefined. One submission for all of them.
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
        self.memory.images.push(Some(slot));
        Ok(ImageId(self.memory.images.len() as u32 - 1))
    }

    pub fn free_buffer(&mut self, id: BufferId) {
        self.memory.free_buffer(&self.device, id);
    }

    pub fn free_image(&mut self, id: ImageId) {
        self.memory.free_image(&self.device, id);
    }

    /// A device buffer that holds `contents`.
    pub fn create_filled_buffer(&mut self, name: &str, contents: &[u8]) -> Result<BufferId> {
        /// Staged at a time, so that a large scene does not lie in memory twice.
        const CHUNK: usize = 32 << 20;
        let id = self.create_buffer(name, contents.len() as u64)?;
        if contents.is_empty() {
            return Ok(id);
        }
        let staging = self.create_upload_buffer("staging", &contents[..contents.len().min(CHUNK)])?;
        for (i, chunk) in contents.chunks(CHUNK).enumerate() {
            self.write_upload_buffer(staging, chunk);
            let offset = (i * CHUNK) as u64;
            self.submit(name, |commands| commands.copy_buffer(staging, 0, id, offset, chunk.len() as u64))?;
        }
        self.free_buffer(staging);
        Ok(id)
    }

    /// An image without mips that holds `texels`, row by row, layer by layer, and nothing in particular where they end; shaders may
    /// store to it where `storage`.
    pub fn create_filled_image(&mut self, name: &str, format: Format, size: [u32; 3], texels: &[u8], storage: bool) -> Result<ImageId> {
        /// Staged at a time, as in [`Self::create_filled_buffer`].
        const CHUNK: usize = 32 << 20;
        let [width, height, layers] = size;
        let row = width as usize * format.texel_bytes();
        assert!(texels.len() <= row * height as usize * layers as usize, "{name}: more texels than {width}x{height}x{layers} hold");
        let desc = ImageDesc { format, width, height, layers, mips: 1, attachment: false, storage };
        let id = self.create_images(&[(name, desc)])?[0];
        let rows = (CHUNK / row).clamp(1, height as usize);
        let staging = self.create_upload_buffer("staging", &vec![0; rows * row])?;
        for (layer, texels) in texels.chunks(row * height as usize).enumerate() {
            for (i, chunk) in texels.chunks(rows * row).enumerate() {
                self.write_upload_buffer(staging, chunk);
                let (first, count) = ((i * rows) as u32, chunk.len().div_ceil(row) as u32);
                self.submit(name, |commands| commands.copy_buffer_to_image_rows(staging, id, layer as u32, first, count))?;
            }
        }
        self.free_buffer(staging);
        Ok(id)
    }

    /// A sampled image array: one RGBA8 image a layer, all of the same size, with all mips.
    pub fn create_texture_array(&mut self, name: &str, format: Format, size: [u32; 2], layers: &[&[u8]]) -> Result<ImageId> {
        let [width, height] = size;
        let mips = width.max(height).ilog2() + 1;
        let desc = ImageDesc { format, width, height, layers: layers.len() as u32, mips, attachment: false, storage: false };
        let id = self.create_images(&[(name, desc)]).with_context(|| format!("{} textures of {width}x{height}", layers.len()))?[0];
        let Some(first) = layers.first() else { return Ok(id) };
        let staging = self.create_upload_buffer("staging", first)?;
        for (layer, texels) in layers.iter().enumerate() {
            assert_eq!(texels.len(), (width * height) as usize * format.texel_bytes(), "{name}: a texture of the wrong size");
            self.write_upload_buffer(staging, texels);
            self.submit(name, |commands| commands.copy_buffer_to_image(staging, id, layer as u32))?;
        }
        self.free_buffer(staging);
        self.submit(name, |commands| {
            for mip in 1..mips {
                let both = Accesses::TRANSFER_READ | Accesses::TRANSFER_WRITE;
                let (from, to) = (Stages::TRANSFER, Stages::TRANSFER);
                commands.barrier(&Barrier { from, written: Accesses::TRANSFER_WRITE, to, needed: both });
                commands.halve_into_mip(id, mip);
            }
        })?;
        Ok(id)
    }

    fn name_object<T: vk::Handle>(&self, handle: T, name: &str) {
        let (Some(debug), Ok(name)) = (&self.debug, std::ffi::CString::new(name)) else { return };
        let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&name);
        // A name that does not stick costs nothing but itself.
        let _ = unsafe { debug.set_debug_utils_object_name(&info) };
    }
}
