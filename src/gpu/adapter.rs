//! The devices of this machine, their features and limits.

use crate::fail;
use anyhow::Result;
use ash::vk;
use std::ffi::CStr;
use std::fmt;

/// Choice of a device.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum DeviceChoice {
    /// The fastest kind available: discrete, integrated, virtual, then a processor.
    #[default]
    Best,
    /// A software driver.
    Cpu,
    /// A device by its index in `manylight list`.
    Index(usize),
    /// The first device whose name contains this, letter case aside.
    Name(String),
}

impl DeviceChoice {
    /// Parses `cpu`, an index, or a part of a name.
    pub fn parse(text: &str) -> Self {
        match text.parse() {
            _ if text.eq_ignore_ascii_case("cpu") => Self::Cpu,
            Ok(index) => Self::Index(index),
            Err(_) => Self::Name(text.into()),
        }
    }
}

/// Features beyond Vulkan 1.3's core that a method may need.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Feature {
    Vulkan13,
    PushDescriptors,
    ScalarBlockLayout,
    MultiDrawIndirect,
    ShaderDrawParameters,
    LayerFromVertexShader,
    /// Storage and linear filtering of R32G32_SFLOAT.
    FilteredRg32Float,
    /// R16G16_SNORM as a colour attachment, and read without a sampler.
    Snorm16Images,
    /// Ballots and broadcasts in subgroups of at least 4 lanes, in compute shaders.
    SubgroupBallot,
    TessellationShader,
    GeometryShader,
    ClipDistance,
    /// Points of up to 64 pixels from geometry shaders.
    LargePoints,
    /// Storage writes and atomics in vertex, tessellation and geometry shaders.
    VertexPipelineStores,
    /// Storage writes and atomics in fragment shaders.
    FragmentStores,
    /// Blending in a colour attachment of R32G32B32A32_SFLOAT.
    BlendedRgba32Float,
    /// Overestimating VK_EXT_conservative_rasterization that also rasterizes degenerate triangles.
    ConservativeRasterization,
    /// Timestamps on the queue for graphics and compute.
    Timestamps,
}

impl Feature {
    pub const ALL: [Self; 18] = [
        Self::Vulkan13,
        Self::PushDescriptors,
        Self::ScalarBlockLayout,
        Self::MultiDrawIndirect,
        Self::ShaderDrawParameters,
        Self::LayerFromVertexShader,
        Self::FilteredRg32Float,
        Self::Snorm16Images,
        Self::SubgroupBallot,
        Self::TessellationShader,
        Self::GeometryShader,
        Self::ClipDistance,
        Self::LargePoints,
        Self::VertexPipelineStores,
        Self::FragmentStores,
        Self::BlendedRgba32Float,
        Self::ConservativeRasterization,
        Self::Timestamps,
    ];
    /// Features without which no slot works.
    pub const ESSENTIAL: [Self; 3] = [Self::Vulkan13, Self::PushDescriptors, Self::ScalarBlockLayout];
}

impl fmt::Display for Feature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Vulkan13 => "Vulkan 1.3 with dynamic rendering and synchronization2",
            Self::PushDescriptors => "VK_KHR_push_descriptor with 32 descriptors",
            Self::ScalarBlockLayout => "scalarBlockLayout",
            Self::MultiDrawIndirect => "multiDrawIndirect with drawIndirectFirstInstance",
            Self::ShaderDrawParameters => "shaderDrawParameters",
            Self::LayerFromVertexShader => "shaderOutputLayer",
            Self::FilteredRg32Float => "storage and linear filtering of R32G32_SFLOAT",
            Self::Snorm16Images => "R16G16_SNORM colour attachments and storage images",
            Self::SubgroupBallot => "subgroup ballots, and broadcasts from any lane, in compute shaders",
            Self::TessellationShader => "tessellationShader",
            Self::GeometryShader => "geometryShader",
            Self::ClipDistance => "shaderClipDistance",
            Self::LargePoints => "largePoints and shaderTessellationAndGeometryPointSize, to 64 pixels",
            Self::VertexPipelineStores => "vertexPipelineStoresAndAtomics",
            Self::FragmentStores => "fragmentStoresAndAtomics",
            Self::BlendedRgba32Float => "blending of R32G32B32A32_SFLOAT colour attachments",
            Self::ConservativeRasterization => "VK_EXT_conservative_rasterization with degenerateTrianglesRasterized",
            Self::Timestamps => "timestamp queries",
        })
    }
}

/// A device as the loader lists it.
#[derive(Debug, Clone)]
pub struct Adapter {
    pub(super) handle: vk::PhysicalDevice,
    pub(super) queue_family: Option<u32>,
    pub name: String,
    /// Name and version of the driver, as reported by itself.
    pub driver: String,
    /// Whether the driver is a software driver.
    pub is_cpu: bool,
    rank: u32,
    /// Vulkan version of the device: major, minor, patch.
    pub version: [u32; 3],
    pub features: Vec<Feature>,
    pub limits: Limits,
}

/// Limits that scenes and configs are checked against.
#[derive(Debug, Clone, Copy, Default)]
pub struct Limits {
    pub image_size: u32,
    pub image_layers: u32,
    pub storage_buffer_bytes: u64,
    pub buffer_bytes: u64,
    pub draw_indirect_count: u32,
    pub framebuffer_size: [u32; 2],
    pub framebuffer_layers: u32,
    /// Size of the largest device-local heap.
    pub heap_bytes: u64,
    pub push_constant_bytes: u32,
    /// Nanoseconds a timestamp tick.
    pub timestamp_period: f32,
}

impl Adapter {
    pub fn has(&self, feature: Feature) -> bool {
        self.features.contains(&feature)
    }

    /// Features of `needed` that the device lacks.
    pub fn missing(&self, needed: &[Feature]) -> Vec<Feature> {
        needed.iter().copied().filter(|feature| !self.has(*feature)).collect()
    }

    /// Label of the device's figures: "cpu" or "gpu".
    pub fn kind(&self) -> &'static str {
        if self.is_cpu { "cpu" } else { "gpu" }
    }

    pub(super) fn query(instance: &ash::Instance, handle: vk::PhysicalDevice) -> Result<Self> {
        let basic = unsafe { instance.get_physical_device_properties(handle) };
        let version = basic.api_version;
        let extensions = unsafe { instance.enumerate_device_extension_properties(handle) }.unwrap_or_default();
        let has_extension = |name: &CStr| extensions.iter().any(|e| e.extension_name_as_c_str() == Ok(name));
        let families = unsafe { instance.get_physical_device_queue_family_properties(handle) };
        let wanted = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
        let queue_family = families.iter().position(|family| family.queue_flags.contains(wanted)).map(|i| i as u32);
        let timestamp_bits = queue_family.map_or(0, |i| families[i as usize].timestamp_valid_bits);

        let modern = version >= vk::API_VERSION_1_3;
        let (mut driver, mut max_buffer) = (String::new(), u64::from(u32::MAX));
        let mut features = Vec::new();
        if version >= vk::API_VERSION_1_2 {
            let mut driver_properties = vk::PhysicalDeviceDriverProperties::default();
            let mut push = vk::PhysicalDevicePushDescriptorPropertiesKHR::default();
            let mut subgroup = vk::PhysicalDeviceSubgroupProperties::default();
            let mut conservative = vk::PhysicalDeviceConservativeRasterizationPropertiesEXT::default();
            let has_conservative = has_extension(ash::ext::conservative_rasterization::NAME);
            let mut maintenance4 = vk::PhysicalDeviceMaintenance4Properties::default();
            let mut properties =
                vk::PhysicalDeviceProperties2::default().push_next(&mut driver_properties).push_next(&mut push).push_next(&mut subgroup);
            if modern {
                properties = properties.push_next(&mut maintenance4);
            }
            if has_conservative {
                properties = properties.push_next(&mut conservative);
            }
            unsafe { instance.get_physical_device_properties2(handle, &mut properties) };
            driver = format!("{} {}", text(&driver_properties.driver_name), text(&driver_properties.driver_info)).trim().to_owned();
            let max_push_descriptors = push.max_push_descriptors;
            max_buffer = if modern { maintenance4.max_buffer_size } else { max_buffer };

            let ballot = subgroup.supported_operations.contains(vk::SubgroupFeatureFlags::BASIC | vk::SubgroupFeatureFlags::BALLOT)
                && subgroup.supported_stages.contains(vk::ShaderStageFlags::COMPUTE)
                && subgroup.subgroup_size >= 4;
            let mut v11 = vk::PhysicalDeviceVulkan11Features::default();
            let mut v12 = vk::PhysicalDeviceVulkan12Features::default();
            let mut v13 = vk::PhysicalDeviceVulkan13Features::default();
            let mut all = vk::PhysicalDeviceFeatures2::default().push_next(&mut v11).push_next(&mut v12);
            if modern {
                all = all.push_next(&mut v13);
            }
            unsafe { instance.get_physical_device_features2(handle, &mut all) };
            let core = all.features;
            let format = |format| unsafe { instance.get_physical_device_format_properties(handle, format) }.optimal_tiling_features;
            let filtered = format(vk::Format::R32G32_SFLOAT)
                .contains(vk::FormatFeatureFlags::SAMPLED_IMAGE_FILTER_LINEAR | vk::FormatFeatureFlags::STORAGE_IMAGE);
            let blended = format(vk::Format::R32G32B32A32_SFLOAT).contains(vk::FormatFeatureFlags::COLOR_ATTACHMENT_BLEND);
            let snorm =
                format(vk::Format::R16G16_SNORM).contains(vk::FormatFeatureFlags::COLOR_ATTACHMENT | vk::FormatFeatureFlags::STORAGE_IMAGE);
            let on = vk::TRUE;
            features.extend(Feature::ALL.into_iter().filter(|feature| match feature {
                Feature::Vulkan13 => modern && [v13.dynamic_rendering, v13.synchronization2, v13.maintenance4] == [on; 3],
                Feature::PushDescriptors => has_extension(ash::khr::push_descriptor::NAME) && max_push_descriptors >= 32,
                Feature::ScalarBlockLayout => v12.scalar_block_layout == on,
                Feature::MultiDrawIndirect => [core.multi_draw_indirect, core.draw_indirect_first_instance] == [on; 2],
                Feature::ShaderDrawParameters => v11.shader_draw_parameters == on,
                Feature::LayerFromVertexShader => v12.shader_output_layer == on,
                Feature::FilteredRg32Float => filtered,
                Feature::Snorm16Images => snorm,
                Feature::SubgroupBallot => ballot && v12.subgroup_broadcast_dynamic_id == on,
                Feature::TessellationShader => core.tessellation_shader == on,
                Feature::GeometryShader => core.geometry_shader == on,
                Feature::ClipDistance => core.shader_clip_distance == on,
                Feature::LargePoints => {
                    [core.large_points, core.shader_tessellation_and_geometry_point_size] == [on; 2]
                        && basic.limits.point_size_range[1] >= 64.0
                }
                Feature::VertexPipelineStores => core.vertex_pipeline_stores_and_atomics == on,
                Feature::FragmentStores => core.fragment_stores_and_atomics == on,
                Feature::BlendedRgba32Float => blended,
                Feature::ConservativeRasterization => has_conservative && conservative.degenerate_triangles_rasterized == on,
                Feature::Timestamps => timestamp_bits > 0,
            }));
        }
        let memory = unsafe { instance.get_physical_device_memory_properties(handle) };
        let heap_bytes = memory.memory_heaps_as_slice().iter().filter(|heap| heap.flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL));
        let rank = match basic.device_type {
            vk::PhysicalDeviceType::DISCRETE_GPU => 0,
            vk::PhysicalDeviceType::INTEGRATED_GPU => 1,
            vk::PhysicalDeviceType::VIRTUAL_GPU => 2,
            vk::PhysicalDeviceType::CPU => 3,
            _ => 4,
        };
        Ok(Self {
            handle,
            queue_family,
            name: text(&basic.device_name),
            driver,
            is_cpu: basic.device_type == vk::PhysicalDeviceType::CPU,
            rank,
            version: [vk::api_version_major(version), vk::api_version_minor(version), vk::api_version_patch(version)],
            features,
            limits: Limits {
                image_size: basic.limits.max_image_dimension2_d,
                image_layers: basic.limits.max_image_array_layers,
                storage_buffer_bytes: u64::from(basic.limits.max_storage_buffer_range),
                buffer_bytes: max_buffer,
                draw_indirect_count: basic.limits.max_draw_indirect_count,
                framebuffer_size: [basic.limits.max_framebuffer_width, basic.limits.max_framebuffer_height],
                framebuffer_layers: basic.limits.max_framebuffer_layers,
                heap_bytes: heap_bytes.map(|heap| heap.size).max().unwrap_or(0),
                push_constant_bytes: basic.limits.max_push_constants_size,
                timestamp_period: basic.limits.timestamp_period,
            },
        })
    }
}

fn text(chars: &[std::ffi::c_char]) -> String {
    let bytes: Vec<u8> = chars.iter().take_while(|c| **c != 0).map(|c| *c as u8).collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Chooses a device that can run the engine; the error names available devices and missing features.
pub(super) fn choose(adapters: &[Adapter], choice: &DeviceChoice) -> Result<Adapter> {
    let mut order: Vec<&Adapter> = adapters.iter().collect();
    order.sort_by_key(|adapter| adapter.rank);
    let found = match choice {
        DeviceChoice::Best => order.iter().find(|adapter| adapter.missing(&Feature::ESSENTIAL).is_empty()).or(order.first()).copied(),
        DeviceChoice::Cpu => adapters.iter().find(|adapter| adapter.is_cpu),
        DeviceChoice::Index(index) => adapters.get(*index),
        DeviceChoice::Name(name) => adapters.iter().find(|adapter| adapter.name.to_lowercase().contains(&name.to_lowercase())),
    };
    let names = || adapters.iter().enumerate().map(|(i, adapter)| format!("{i}: {}", adapter.name)).collect::<Vec<_>>().join(", ");
    let Some(adapter) = found else {
        if adapters.is_empty() {
            return Err(fail!(
                NoDevice,
                "no Vulkan device was found; on Debian or Ubuntu, `apt install mesa-vulkan-drivers` brings a software driver"
            ));
        }
        return Err(match choice {
            DeviceChoice::Cpu => fail!(
                NoDevice,
                "no software Vulkan driver was found (there is {}); on Debian or Ubuntu, `apt install mesa-vulkan-drivers` brings one",
                names()
            ),
            _ => fail!(NoDevice, "no Vulkan device answers to that choice; there is {}", names()),
        });
    };
    let missing = adapter.missing(&Feature::ESSENTIAL);
    if !missing.is_empty() || adapter.queue_family.is_none() {
        let list = missing.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        return Err(fail!(NoDevice, "{} lacks {list}; choose another device with --device ({})", adapter.name, names()));
    }
    Ok(adapter.clone())
}
