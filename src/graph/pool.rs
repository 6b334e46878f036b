//! Pool of the images and buffers of a sequence of frames, lent to each frame's resources by name and shape.

use super::reuse::Memory;
use crate::gpu::{BufferId, Gpu, ImageDesc, ImageId};
use anyhow::Result;
use std::collections::HashMap;

/// Purpose of a lent buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum BufferKind {
    Device,
    Upload,
    ReadBack,
}

struct Lent<T> {
    id: T,
    frame: u64,
}

/// State of a sequence of frames: memory, and the contents of [`Graph::history`](super::Graph::history). Each sequence on an
/// [`Engine`](super::Engine) has its own pool; the device owns the resources.
#[derive(Default)]
pub struct Pool {
    frame: u64,
    /// Whether the next frame's history is zeroed.
    cut: bool,
    /// Whether a frame has begun and has not ended successfully.
    is_running: bool,
    images: HashMap<(String, ImageDesc), Lent<ImageId>>,
    buffers: HashMap<(String, u64, BufferKind), Lent<BufferId>>,
    /// Buffers whose contents are kept from frame to frame, by name and size.
    history: HashMap<(String, u64), Lent<BufferId>>,
    /// Passes of the frame before, if their results may be taken over.
    pub(super) memory: Option<Memory>,
}

impl Pool {
    /// Ends the sequence: the next frame's history is zeroed.
    pub fn cut(&mut self) {
        self.cut = true;
    }

    /// Begins a frame: all resources may be lent again. After a failed frame the history is undefined, so it is cut.
    pub(super) fn begin(&mut self) {
        self.frame += 1;
        self.cut |= std::mem::replace(&mut self.is_running, true);
    }

    /// Lends images of these names and shapes; new ones are created together.
    pub(super) fn images(&mut self, gpu: &mut Gpu, wanted: &[(String, ImageDesc)]) -> Result<Vec<ImageId>> {
        let missing: Vec<&(String, ImageDesc)> = wanted.iter().filter(|key| !self.images.contains_key(*key)).collect();
        let descs: Vec<(&str, ImageDesc)> = missing.iter().map(|(name, desc)| (name.as_str(), *desc)).collect();
        let made = gpu.create_images(&descs)?;
        let new: Vec<_> = missing.into_iter().cloned().zip(made).collect();
        self.images.extend(new.into_iter().map(|(key, id)| (key, Lent { id, frame: 0 })));
        let mut ids = Vec::with_capacity(wanted.len());
        for key in wanted {
            if let Some(lent) = self.images.get_mut(key) {
                assert_ne!(lent.frame, self.frame, "two images of a frame have the name and shape of {}", key.0);
                lent.frame = self.frame;
                ids.push(lent.id);
            }
        }
        Ok(ids)
    }

    /// Lends a buffer of this name and size.
    pub(super) fn buffer(&mut self, gpu: &mut Gpu, name: &str, bytes: u64, kind: BufferKind) -> Result<BufferId> {
        let key = (name.to_owned(), bytes, kind);
        if let Some(lent) = self.buffers.get_mut(&key) {
            assert_ne!(lent.frame, self.frame, "two buffers of a frame have the name and size of {name}");
            lent.frame = self.frame;
            return Ok(lent.id);
        }
        let id = match kind {
            BufferKind::Device => gpu.create_buffer(name, bytes)?,
            BufferKind::Upload => gpu.create_upload_buffer(name, &vec![0; bytes as usize])?,
            BufferKind::ReadBack => gpu.create_read_back_buffer(name, bytes)?,
        };
        self.buffers.insert(key, Lent { id, frame: self.frame });
        Ok(id)
    }

    /// Lends the history buffer of this name and size, and returns whether it must be zeroed because it is new or was cut.
    pub(super) fn history(&mut self, gpu: &mut Gpu, name: &str, bytes: u64) -> Result<(BufferId, bool)> {
        let key = (name.to_owned(), bytes);
        if let Some(lent) = self.history.get_mut(&key) {
            assert_ne!(lent.frame, self.frame, "two buffers of a frame have the name and size of {name}");
            lent.frame = self.frame;
            return Ok((lent.id, self.cut));
        }
        let id = gpu.create_buffer(name, bytes)?;
        self.history.insert(key, Lent { id, frame: self.frame });
        Ok((id, true))
    }

    /// Ends a frame and frees all resources that it did not use, history included. A resize or another preset leaves nothing behind.
    pub(super) fn end(&mut self, gpu: &mut Gpu) {
        (self.cut, self.is_running) = (false, false);
        let frame = self.frame;
        self.images.retain(|_, lent| {
            lent.frame == frame || {
                gpu.free_image(lent.id);
                false
            }
        });
        let mut in_use = |lent: &Lent<BufferId>| {
            lent.frame == frame || {
                gpu.free_buffer(lent.id);
                false
            }
        };
        self.buffers.retain(|_, lent| in_use(lent));
        self.history.retain(|_, lent| in_use(lent));
    }
}
