//! A window's surface: images that the display shows, made anew whenever the window's size changes.

use super::device::{Gpu, failure};
use super::memory::ImageId;
use crate::fail;
use anyhow::{Context, Result};
use ash::{khr, vk};
use raw_window_handle::{HasDisplayHandle, HasWindowHandle};
use std::ffi::CStr;
use std::sync::Arc;

/// What became of a picture that was handed to the display.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Presented {
    Yes,
    /// The window is minimised or hidden, or its size has just changed; [`Gpu::resize_surface`] with its present size lets the next one
    /// through.
    No,
}

/// Maker of a surface; it holds the window, which must outlive the surface.
type Maker = Box<dyn Fn(&ash::Entry, &ash::Instance) -> Result<vk::SurfaceKHR> + Send>;

pub(super) struct Surface {
    make: Maker,
    instance: khr::surface::Instance,
    device: khr::swapchain::Device,
    handle: vk::SurfaceKHR,
    /// Signalled when an image may be written. One is enough: every submission is waited for.
    acquired: vk::Semaphore,
    chain: Option<Chain>,
    /// Size that the window asks for, pixels; 0 while it is minimised.
    size: [u32; 2],
    waits_for_display: bool,
}

struct Chain {
    handle: vk::SwapchainKHR,
    images: Vec<vk::Image>,
    /// Signalled when an image may be shown, one an image: a display may still wait for one of an earlier frame.
    rendered: Vec<vk::Semaphore>,
    extent: vk::Extent2D,
}

/// Instance extensions with which a display's windows have surfaces, for [`super::Options::display`].
///
/// # Errors
/// `NoDevice` for a display that Vulkan cannot show pictures on.
pub fn extensions(display: &impl HasDisplayHandle) -> Result<Vec<&'static CStr>> {
    let handle = display.display_handle().map_err(|error| fail!(NoDevice, "the display cannot be used: {error}"))?;
    let names = ash_window::enumerate_required_extensions(handle.as_raw())
        .map_err(|error| fail!(NoDevice, "Vulkan cannot show pictures on this display: {error}"))?;
    // Safety: ash_window returns static, terminated strings.
    Ok(names.iter().map(|name| unsafe { CStr::from_ptr(*name) }).collect())
}

impl Gpu {
    /// Opens the surface of a window on a device that was opened with the display's [`extensions`]. The window lives as long as the device.
    ///
    /// # Errors
    /// `NoDevice` if the device cannot present to the window.
    pub fn open_surface<W>(&mut self, window: Arc<W>, size: [u32; 2]) -> Result<()>
    where
        W: HasDisplayHandle + HasWindowHandle + Send + Sync + 'static,
    {
        let make: Maker = Box::new(move |entry, instance| {
            let gone = |error| fail!(NoDevice, "the window cannot be used: {error}");
            let display = window.display_handle().map_err(gone)?.as_raw();
            let window = window.window_handle().map_err(gone)?.as_raw();
            // Safety: the closure holds the window, and the surface is destroyed before the closure is dropped.
            unsafe { ash_window::create_surface(entry, instance, display, window, None) }
                .map_err(|error| failure(error, "the window's surface"))
        });
        let (entry, handle) = self.instance();
        let surface = make(entry, handle)?;
        let acquired = unsafe { self.device.create_semaphore(&vk::SemaphoreCreateInfo::default(), None) };
        self.surface = Some(Surface {
            make,
            instance: khr::surface::Instance::new(entry, handle),
            device: khr::swapchain::Device::new(handle, &self.device),
            handle: surface,
            acquired: acquired.map_err(|error| failure(error, "a semaphore"))?,
            chain: None,
            size,
            waits_for_display: true,
        });
        let shown = unsafe { self.surface().instance.get_physical_device_surface_support(self.adapter.handle, self.family(), surface) };
        if shown != Ok(true) {
            return Err(fail!(NoDevice, "{} cannot show pictures in this window; --device names another", self.adapter.name));
        }
        Ok(())
    }

    /// Tells the window's size in pixels, and whether pictures wait for the display's next refresh. Nothing is shown while a side is 0.
    pub fn resize_surface(&mut self, size: [u32; 2], waits_for_display: bool) {
        let surface = self.surface_mut();
        (surface.size, surface.waits_for_display) = (size, waits_for_display);
        self.drop_chain();
    }

    /// Shows an image in the window, scaled to it if it has another size. It waits until the display has taken the image over, and for a
    /// free one for at most a tenth of a second.
    ///
    /// # Errors
    /// The device's own. A surface that was lost is made anew.
    pub fn present(&mut self, image: ImageId) -> Result<Presented> {
        match self.try_present(image) {
            Ok(presented) => presented,
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => {
                self.drop_chain();
                Ok(Presented::No)
            }
            Err(vk::Result::ERROR_SURFACE_LOST_KHR) => {
                self.drop_chain();
                let (entry, instance) = self.instance();
                let surface = (self.surface().make)(entry, instance).context("making the window's surface anew")?;
                let surfaces = self.surface_mut();
                let lost = std::mem::replace(&mut surfaces.handle, surface);
                unsafe { surfaces.instance.destroy_surface(lost, None) };
                Ok(Presented::No)
            }
            Err(error) => Err(failure(error, "showing a picture")),
        }
    }

    /// Errors of presentation are left as they are; those of the submission are in the result.
    fn try_present(&mut self, image: ImageId) -> Result<Result<Presented>, vk::Result> {
        /// Nanoseconds to wait for an image. A compositor may keep all of them while it does not show the window.
        const PATIENCE: u64 = 100_000_000;
        if self.surface().chain.is_none() && !self.make_chain()? {
            return Ok(Ok(Presented::No));
        }
        let surface = self.surface();
        let Some(chain) = &surface.chain else { return Ok(Ok(Presented::No)) };
        let index = match unsafe { surface.device.acquire_next_image(chain.handle, PATIENCE, surface.acquired, vk::Fence::null()) } {
            Ok((index, _)) => index,
            Err(vk::Result::TIMEOUT | vk::Result::NOT_READY) => return Ok(Ok(Presented::No)),
            Err(error) => return Err(error),
        };
        let (handle, to, extent) = (chain.handle, chain.images[index as usize], chain.extent);
        let (acquired, rendered) = (surface.acquired, chain.rendered[index as usize]);
        let submitted = self.submit_between("showing a picture", Some((acquired, rendered)), |commands| {
            commands.copy_to_surface(image, to, extent);
        });
        if let Err(error) = submitted {
            return Ok(Err(error));
        }
        let (semaphores, chains, indices) = ([rendered], [handle], [index]);
        let info = vk::PresentInfoKHR::default().wait_semaphores(&semaphores).swapchains(&chains).image_indices(&indices);
        let is_suboptimal = unsafe { self.surface().device.queue_present(self.queue, &info) }?;
        if is_suboptimal {
            self.drop_chain();
        }
        Ok(Ok(Presented::Yes))
    }

    /// Makes the images for the window's size; false if it has none now.
    fn make_chain(&mut self) -> Result<bool, vk::Result> {
        let (surface, physical) = (self.surface(), self.adapter.handle);
        let [width, height] = surface.size;
        let (capabilities, formats, modes) = unsafe {
            (
                surface.instance.get_physical_device_surface_capabilities(physical, surface.handle)?,
                surface.instance.get_physical_device_surface_formats(physical, surface.handle)?,
                surface.instance.get_physical_device_surface_present_modes(physical, surface.handle)?,
            )
        };
        // A display that leaves the size to the program says so by the largest number.
        let (least, most) = (capabilities.min_image_extent, capabilities.max_image_extent);
        let extent = match capabilities.current_extent.width {
            u32::MAX => vk::Extent2D {
                width: width.clamp(least.width, most.width.max(least.width)),
                height: height.clamp(least.height, most.height.max(least.height)),
            },
            _ => capabilities.current_extent,
        };
        if width == 0 || height == 0 || extent.width == 0 || extent.height == 0 {
            return Ok(false);
        }
        // Pictures are encoded already, and an sRGB format would encode them again.
        let plain = [vk::Format::B8G8R8A8_UNORM, vk::Format::R8G8B8A8_UNORM, vk::Format::A8B8G8R8_UNORM_PACK32];
        let Some(format) = formats.iter().find(|format| plain.contains(&format.format)) else {
            return Err(vk::Result::ERROR_FORMAT_NOT_SUPPORTED);
        };
        let unbound = [vk::PresentModeKHR::MAILBOX, vk::PresentModeKHR::IMMEDIATE];
        let unbound = unbound.into_iter().find(|mode| !surface.waits_for_display && modes.contains(mode));
        let alpha = [vk::CompositeAlphaFlagsKHR::OPAQUE, vk::CompositeAlphaFlagsKHR::INHERIT, vk::CompositeAlphaFlagsKHR::PRE_MULTIPLIED];
        let alpha = alpha.into_iter().find(|alpha| capabilities.supported_composite_alpha.contains(*alpha));
        let most = if capabilities.max_image_count == 0 { u32::MAX } else { capabilities.max_image_count };
        let info = vk::SwapchainCreateInfoKHR::default()
            .surface(surface.handle)
            .min_image_count((capabilities.min_image_count + 1).min(most))
            .image_format(format.format)
            .image_color_space(format.color_space)
            .image_extent(extent)
            .image_array_layers(1)
            .image_usage(vk::ImageUsageFlags::TRANSFER_DST)
            .pre_transform(capabilities.current_transform)
            .composite_alpha(alpha.unwrap_or(vk::CompositeAlphaFlagsKHR::POST_MULTIPLIED))
            .present_mode(unbound.unwrap_or(vk::PresentModeKHR::FIFO))
            .clipped(true);
        let handle = unsafe { surface.device.create_swapchain(&info, None) }?;
        let mut chain = Chain { handle, images: Vec::new(), rendered: Vec::new(), extent };
        let filled = unsafe { surface.device.get_swapchain_images(handle) }.and_then(|images| {
            for _ in &images {
                chain.rendered.push(unsafe { self.device.create_semaphore(&vk::SemaphoreCreateInfo::default(), None) }?);
            }
            chain.images = images;
            Ok(true)
        });
        self.surface_mut().chain = Some(chain);
        filled.inspect_err(|_| self.drop_chain())
    }

    fn drop_chain(&mut self) {
        let Some(surface) = &mut self.surface else { return };
        let Some(chain) = surface.chain.take() else { return };
        unsafe {
            // Ignored: on a lost device there is nothing to wait for.
            let _ = self.device.device_wait_idle();
            chain.rendered.iter().for_each(|semaphore| self.device.destroy_semaphore(*semaphore, None));
            surface.device.destroy_swapchain(chain.handle, None);
        }
    }

    /// Closes the surface, before its device and its instance go.
    pub(super) fn close_surface(&mut self) {
        self.drop_chain();
        let Some(surface) = self.surface.take() else { return };
        unsafe {
            self.device.destroy_semaphore(surface.acquired, None);
            surface.instance.destroy_surface(surface.handle, None);
        }
    }

    fn surface(&self) -> &Surface {
        self.surface.as_ref().unwrap_or_else(|| unreachable!("open_surface() comes first"))
    }

    fn surface_mut(&mut self) -> &mut Surface {
        self.surface.as_mut().unwrap_or_else(|| unreachable!("open_surface() comes first"))
    }
}
