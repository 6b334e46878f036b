//! An open device.

use super::adapter::{self, Adapter, DeviceChoice, Feature};
use super::commands::Commands;
use super::fault::Fault;
use super::memory::Memory;
use super::pipeline::Pipelines;
use super::surface::Surface;
use super::types::{Sampler, Wrapping};
use crate::fail;
use crate::trace;
use anyhow::{Context, Result};
use ash::{ext, khr, vk};
use std::collections::HashMap;
use std::ffi::{CStr, c_void};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// Options for opening a device.
#[derive(Debug, Clone, Default)]
pub struct Options {
    pub device: DeviceChoice,
    /// Enables the Khronos validation layer with synchronization validation; see [`Gpu::validation_messages`].
    pub validate: bool,
    /// Extensions of the display that windows are shown on ([`super::surface::extensions`]); empty without windows.
    pub display: Vec<&'static CStr>,
}

/// A device, its one queue and all objects created on it. Dropping it destroys them.
pub struct Gpu {
    pub adapter: Adapter,
    pub(super) device: ash::Device,
    pub(super) push_descriptor: khr::push_descriptor::Device,
    pub(super) debug: Option<ext::debug_utils::Device>,
    pub(super) memory: Memory,
    pub(super) pipelines: Pipelines,
    samplers: HashMap<Sampler, vk::Sampler>,
    pub(super) queue: vk::Queue,
    command_pool: vk::CommandPool,
    fence: vk::Fence,
    pub(super) queries: vk::QueryPool,
    submitted: Instant,
    pub(super) fault: Option<Fault>,
    messages: Arc<Mutex<Vec<String>>>,
    pub(super) surface: Option<Surface>,
    instance: Instance,
}

/// Timestamps that one submission can take, at most.
pub(super) const QUERY_COUNT: u32 = 4096;

struct Instance {
    entry: ash::Entry,
    handle: ash::Instance,
    has_debug_utils: bool,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    /// Target of the messenger's callback; it must live as long as the messenger.
    _messages: Arc<Mutex<Vec<String>>>,
}

unsafe extern "system" fn on_message(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut c_void,
) -> vk::Bool32 {
    let (data, messages) = unsafe { (&*data, &*user.cast::<Mutex<Vec<String>>>()) };
    if let Some(text) = unsafe { data.message_as_c_str() } {
        messages.lock().unwrap_or_else(PoisonError::into_inner).push(text.to_string_lossy().into_owned());
    }
    vk::FALSE
}

impl Instance {
    fn new(validate: bool, display: &[&'static CStr], messages: &Arc<Mutex<Vec<String>>>) -> Result<Self> {
        let entry = unsafe { ash::Entry::load() }.map_err(|error| {
            fail!(NoDevice, "the Vulkan loader was not found ({error}); on Debian or Ubuntu, `apt install libvulkan1 mesa-vulkan-drivers` brings it and a software driver")
        })?;
        let extensions = unsafe { entry.enumerate_instance_extension_properties(None) }.unwrap_or_default();
        let has_debug_utils = extensions.iter().any(|e| e.extension_name_as_c_str() == Ok(ext::debug_utils::NAME)) || validate;
        let layers = unsafe { entry.enumerate_instance_layer_properties() }.unwrap_or_default();
        if validate && !layers.iter().any(|layer| layer.layer_name_as_c_str() == Ok(VALIDATION_LAYER)) {
            return Err(fail!(
                NoDevice,
                "--validate needs the Khronos validation layer; on Debian or Ubuntu, `apt install vulkan-validationlayers` brings it"
            ));
        }
        let application = vk::ApplicationInfo::default().application_name(c"manylight").api_version(vk::API_VERSION_1_3);
        let layer_names: Vec<_> = validate.then_some(VALIDATION_LAYER.as_ptr()).into_iter().collect();
        if let Some(missing) = display.iter().find(|name| !extensions.iter().any(|known| known.extension_name_as_c_str() == Ok(**name))) {
            let missing = missing.to_string_lossy();
            return Err(fail!(NoDevice, "no Vulkan driver shows pictures in windows of this display: none has {missing}"));
        }
        let extension_names: Vec<_> =
            has_debug_utils.then_some(ext::debug_utils::NAME).into_iter().chain(display.iter().copied()).map(CStr::as_ptr).collect();
        // Enabled here and not by environment variables: those of newer layers are ignored by older ones.
        let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
        let mut validation = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
        let mut messenger_info = vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(vk::DebugUtilsMessageSeverityFlagsEXT::ERROR | vk::DebugUtilsMessageSeverityFlagsEXT::WARNING)
            // No performance messages: they ask for transfer layouts, and images here stay in GENERAL.
            .message_type(vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION)
            .pfn_user_callback(Some(on_message))
            .user_data(Arc::as_ptr(messages).cast_mut().cast());
        let mut info = vk::InstanceCreateInfo::default()
            .application_info(&application)
            .enabled_layer_names(&layer_names)
            .enabled_extension_names(&extension_names);
        if validate {
            info = info.push_next(&mut validation).push_next(&mut messenger_info);
        }
        let handle = unsafe { entry.create_instance(&info, None) }
            .map_err(|error| fail!(NoDevice, "no Vulkan driver could be started ({error}); on Debian or Ubuntu, `apt install mesa-vulkan-drivers` brings a software driver"))?;
        let messenger = if validate {
            let loader = ext::debug_utils::Instance::new(&entry, &handle);
            messenger_info.p_next = std::ptr::null();
            let messenger = unsafe { loader.create_debug_utils_messenger(&messenger_info, None) }
                .map_err(|e| failure(e, "the validation messenger"))?;
            Some((loader, messenger))
        } else {
            None
        };
        Ok(Self { entry, handle, has_debug_utils, messenger, _messages: messages.clone() })
    }

    fn adapters(&self) -> Result<Vec<Adapter>> {
        let devices = unsafe { self.handle.enumerate_physical_devices() }.map_err(|e| failure(e, "listing devices"))?;
        devices.into_iter().map(|device| Adapter::query(&self.handle, device)).collect()
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        unsafe {
            if let Some((loader, messenger)) = self.messenger.take() {
                loader.destroy_debug_utils_messenger(messenger, None);
            }
            self.handle.destroy_instance(None);
        }
    }
}

/// Converts a Vulkan error.
pub(super) fn failure(error: vk::Result, what: &str) -> anyhow::Error {
    match error {
        vk::Result::ERROR_DEVICE_LOST => fail!(DeviceLost, "{what}: the device was lost"),
        vk::Result::ERROR_OUT_OF_DEVICE_MEMORY => fail!(OutOfMemory, "{what}: out of device memory"),
        vk::Result::ERROR_OUT_OF_HOST_MEMORY => fail!(OutOfMemory, "{what}: out of host memory"),
        other => fail!(NoDevice, "{what}: {other}"),
    }
}

impl Gpu {
    /// All devices that the loader lists, in its order.
    pub fn adapters() -> Result<Vec<Adapter>> {
        Instance::new(false, &[], &Arc::default())?.adapters()
    }

    /// Opens the device that `options` choose.
    ///
    /// # Errors
    /// They name available devices, missing features, and the package that helps.
    pub fn new(options: &Options) -> Result<Self> {
        let _span = trace::span("opening the device");
        let fault = Fault::from_environment()?;
        let messages = Arc::default();
        let instance = Instance::new(options.validate, &options.display, &messages)?;
        let adapter = adapter::choose(&instance.adapters()?, &options.device)?;
        let Some(queue_family) = adapter.queue_family else { unreachable!("choose() takes no device without a queue") };

        let has = |feature| adapter.has(feature);
        let core = vk::PhysicalDeviceFeatures::default()
            .multi_draw_indirect(has(Feature::MultiDrawIndirect))
            .draw_indirect_first_instance(has(Feature::MultiDrawIndirect))
            .tessellation_shader(has(Feature::TessellationShader))
            .geometry_shader(has(Feature::GeometryShader))
            .shader_clip_distance(has(Feature::ClipDistance))
            .large_points(has(Feature::LargePoints))
            .shader_tessellation_and_geometry_point_size(has(Feature::LargePoints))
            .vertex_pipeline_stores_and_atomics(has(Feature::VertexPipelineStores))
            .fragment_stores_and_atomics(has(Feature::FragmentStores));
        let mut v11 = vk::PhysicalDeviceVulkan11Features::default().shader_draw_parameters(has(Feature::ShaderDrawParameters));
        let mut v12 = vk::PhysicalDeviceVulkan12Features::default()
            .scalar_block_layout(true)
            .subgroup_broadcast_dynamic_id(has(Feature::SubgroupBallot))
            .shader_output_layer(has(Feature::LayerFromVertexShader));
        let mut v13 = vk::PhysicalDeviceVulkan13Features::default().dynamic_rendering(true).synchronization2(true).maintenance4(true);
        let mut extensions = vec![khr::push_descriptor::NAME.as_ptr()];
        if has(Feature::ConservativeRasterization) {
            extensions.push(ext::conservative_rasterization::NAME.as_ptr());
        }
        if !options.display.is_empty() {
            let known = unsafe { instance.handle.enumerate_device_extension_properties(adapter.handle) }.unwrap_or_default();
            if !known.iter().any(|known| known.extension_name_as_c_str() == Ok(khr::swapchain::NAME)) {
                return Err(fail!(NoDevice, "{} cannot show pictures in windows; --device names another", adapter.name));
            }
            extensions.push(khr::swapchain::NAME.as_ptr());
        }
        let priorities = [1.0];
        let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(queue_family).queue_priorities(&priorities)];
        let info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_extension_names(&extensions)
            .enabled_features(&core)
            .push_next(&mut v11)
            .push_next(&mut v12)
            .push_next(&mut v13);
        let device = unsafe { instance.handle.create_device(adapter.handle, &info, None) }
            .map_err(|e| failure(e, &adapter.name))
            .with_context(|| format!("opening {}", adapter.name))?;

        let create = |what| move |error| failure(error, what);
        let pool_info =
            vk::CommandPoolCreateInfo::default().queue_family_index(queue_family).flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
        let query_info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(QUERY_COUNT);
        let (command_pool, fence, queries, queue) = unsafe {
            (
                device.create_command_pool(&pool_info, None).map_err(create("command pool"))?,
                device.create_fence(&vk::FenceCreateInfo::default(), None).map_err(create("fence"))?,
                device.create_query_pool(&query_info, None).map_err(create("query pool"))?,
                device.get_device_queue(queue_family, 0),
            )
        };
        Ok(Self {
            push_descriptor: khr::push_descriptor::Device::new(&instance.handle, &device),
            debug: instance.has_debug_utils.then(|| ext::debug_utils::Device::new(&instance.handle, &device)),
            memory: Memory::new(&instance.handle, &device, adapter.handle)?,
            pipelines: Pipelines::default(),
            samplers: HashMap::new(),
            submitted: Instant::now(),
            fault,
            adapter,
            device,
            queue,
            command_pool,
            fence,
            queries,
            messages,
            surface: None,
            instance,
        })
    }

    /// Messages of the validation layer so far; empty without `validate`, and in a program without bugs.
    pub fn validation_messages(&self) -> Vec<String> {
        self.messages.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Injects an error, for tests; see [`super::fault`].
    pub fn inject(&mut self, fault: Option<Fault>) {
        self.fault = fault;
    }

    /// Records commands, submits them and waits until the device has completed them.
    pub fn submit(&mut self, what: &str, record: impl FnOnce(&mut Commands<'_>)) -> Result<()> {
        self.submit_between(what, None, record)
    }

    /// [`Self::submit`] that begins after the first semaphore, and signals the second.
    pub(super) fn submit_between(
        &mut self,
        what: &str,
        between: Option<(vk::Semaphore, vk::Semaphore)>,
        record: impl FnOnce(&mut Commands<'_>),
    ) -> Result<()> {
        let error = |error| failure(error, what);
        let recording = trace::span(format_args!("recording {what}"));
        let info = vk::CommandBufferAllocateInfo::default().command_pool(self.command_pool).command_buffer_count(1);
        let buffer = unsafe { self.device.allocate_command_buffers(&info) }.map_err(error)?[0];
        let begin = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        unsafe { self.device.begin_command_buffer(buffer, &begin) }.map_err(error)?;
        let mut commands = Commands::new(self, buffer);
        record(&mut commands);
        let lost_at = commands.injected_loss();
        unsafe { self.device.end_command_buffer(buffer) }.map_err(error)?;
        drop(recording);
        let waiting = trace::span(format_args!("submitting and waiting for {what}"));
        self.submitted = Instant::now();
        let result = unsafe {
            if lost_at.is_some() {
                Err(vk::Result::ERROR_DEVICE_LOST)
            } else {
                let buffers = [vk::CommandBufferSubmitInfo::default().command_buffer(buffer)];
                let semaphore =
                    |handle| vk::SemaphoreSubmitInfo::default().semaphore(handle).stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS);
                let (after, signals) = (between.map(|pair| semaphore(pair.0)), between.map(|pair| semaphore(pair.1)));
                let submits = [vk::SubmitInfo2::default()
                    .wait_semaphore_infos(after.as_slice())
                    .command_buffer_infos(&buffers)
                    .signal_semaphore_infos(signals.as_slice())];
                self.device
                    .queue_submit2(self.queue, &submits, self.fence)
                    .and_then(|()| self.device.wait_for_fences(&[self.fence], true, u64::MAX))
                    .and_then(|()| self.device.reset_fences(&[self.fence]))
            }
        };
        drop(waiting);
        unsafe { self.device.free_command_buffers(self.command_pool, &[buffer]) };
        result.map_err(|error| failure(error, lost_at.as_deref().unwrap_or(what)))
    }

    pub(super) fn instance(&self) -> (&ash::Entry, &ash::Instance) {
        (&self.instance.entry, &self.instance.handle)
    }

    /// Index of the queue's family.
    pub(super) fn family(&self) -> u32 {
        self.adapter.queue_family.unwrap_or_else(|| unreachable!("an open device has a queue"))
    }

    /// Host time of the last submission.
    pub fn submitted(&self) -> Instant {
        self.submitted
    }

    /// First `count` timestamps of the last submission, milliseconds after the first.
    pub fn timestamps(&self, count: u32) -> Result<Vec<f64>> {
        let mut ticks = vec![0u64; count as usize];
        unsafe {
            self.device.get_query_pool_results(self.queries, 0, &mut ticks, vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT)
        }
        .map_err(|e| failure(e, "timestamps"))?;
        let period = f64::from(self.adapter.limits.timestamp_period) * 1e-6;
        let first = ticks.first().copied().unwrap_or(0);
        Ok(ticks.iter().map(|tick| tick.wrapping_sub(first) as f64 * period).collect())
    }

    /// Creates the sampler unless it exists, for [`Self::sampler_handle`].
    pub fn prepare_sampler(&mut self, sampler: Sampler) -> Result<()> {
        if self.samplers.contains_key(&sampler) {
            return Ok(());
        }
        let (u, v, linear, mips) = match sampler {
            Sampler::Nearest => (Wrapping::ClampToEdge, Wrapping::ClampToEdge, false, false),
            Sampler::Linear => (Wrapping::ClampToEdge, Wrapping::ClampToEdge, true, false),
            Sampler::Material { u, v, linear } => (u, v, linear, true),
        };
        let filter = if linear { vk::Filter::LINEAR } else { vk::Filter::NEAREST };
        let mode = |wrapping| match wrapping {
            Wrapping::Repeat => vk::SamplerAddressMode::REPEAT,
            Wrapping::MirroredRepeat => vk::SamplerAddressMode::MIRRORED_REPEAT,
            Wrapping::ClampToEdge => vk::SamplerAddressMode::CLAMP_TO_EDGE,
        };
        let info = vk::SamplerCreateInfo::default()
            .mag_filter(filter)
            .min_filter(filter)
            .mipmap_mode(if linear { vk::SamplerMipmapMode::LINEAR } else { vk::SamplerMipmapMode::NEAREST })
            .address_mode_u(mode(u))
            .address_mode_v(mode(v))
            .max_lod(if mips { vk::LOD_CLAMP_NONE } else { 0.0 });
        let handle = unsafe { self.device.create_sampler(&info, None) }.map_err(|e| failure(e, "sampler"))?;
        self.samplers.insert(sampler, handle);
        Ok(())
    }

    pub(super) fn sampler_handle(&self, sampler: Sampler) -> vk::Sampler {
        self.samplers[&sampler]
    }
}

impl Drop for Gpu {
    fn drop(&mut self) {
        self.close_surface();
        unsafe {
            // Ignored: on a lost device there is nothing to wait for.
            let _ = self.device.device_wait_idle();
            for sampler in self.samplers.values() {
                self.device.destroy_sampler(*sampler, None);
            }
            self.pipelines.destroy(&self.device);
            self.memory.destroy(&self.device);
            self.device.destroy_query_pool(self.queries, None);
            self.device.destroy_fence(self.fence, None);
            self.device.destroy_command_pool(self.command_pool, None);
            self.device.destroy_device(None);
        }
        let _ = &self.instance;
    }
}
