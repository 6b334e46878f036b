//! Images and buffers of a sequence of frames: they are lent to each frame's resources by name and shape.

use crate::gpu::{BufferId, Gpu, ImageDesc, ImageId};
use anyhow::Result;
use std::collections::HashMap;

/// What a lent buffer is for.
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

/// What a sequence of frames keeps from one to the next: memory, and what [`Graph::history`](super::Graph::history) holds. Two sequences
/// on one [`Engine`](super::Engine) have a pool each; the device owns what is in it.
#[derive(Default)]
pub struct Pool {
    frame: u64,
    /// The next frame's history is zeros.
    cut: bool,
    /// A frame has begun, and has not ended well.
    is_running: bool,
    images: HashMap<(String, ImageDesc), Lent<ImageId>>,
    buffers: HashMap<(String, u64, BufferKind), Lent<BufferId>>,
    /// Buffers whose contents stay from frame to frame, by name and size.
    history: HashMap<(String, u64), Lent<BufferId>>,
}

impl Pool {
    /// The next frame starts anew: its history is zeros.
    pub fn cut(&mut self) {
        self.cut = true;
    }

    /// Begins a frame: everything may be lent again. After a frame that failed, history is what nobody knows.
    pub(super) fn begin(&mut self) {
        self.frame += 1;
        self.cut |= std::mem::replace(&mut self.is_running, true);
    }

    /// Images of these names and shapes; those that are new are made together.
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

    /// A buffer of this name and size.
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

    /// A buffer of this name and size that holds what the frame before left in it; beside it, whether there is no such thing and it
    /// starts with zeros.
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

    /// Ends a frame, and frees what it did not use: a resize or another preset leaves nothing behind, and history that a frame did not
    /// touch is gone.
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
