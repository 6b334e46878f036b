//! Sources of bytes: the binary chunk, data: URIs and files beside the scene; and buffer views.

use super::{File, refuse};
use anyhow::{Context, Result};
use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf_json::{Index, Root, buffer};
use std::borrow::Cow;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Limit of bytes of all buffers together (8 GiB).
const MAX_BYTES: u64 = 8 << 30;

/// The bytes of all buffers.
pub struct Buffers<'a>(Vec<Cow<'a, [u8]>>);

/// A buffer view's bytes, and the stride of its elements if given.
#[derive(Clone, Copy)]
pub struct View<'a> {
    pub bytes: &'a [u8],
    pub stride: Option<usize>,
}

impl<'a> Buffers<'a> {
    /// Loads every buffer, exactly as many bytes as its declared length.
    pub fn load(root: &Root, bin: Option<&'a [u8]>, base: Option<&Path>) -> Result<Self> {
        let mut total = 0u64;
        let load = |(index, buffer): (usize, &buffer::Buffer)| {
            let length = buffer.byte_length.0;
            total = total.saturating_add(length);
            if total > MAX_BYTES {
                refuse!("it and those before it have {total} bytes, more than the {MAX_BYTES} that are supported");
            }
            let bytes = match (&buffer.uri, bin) {
                (Some(uri), _) => Cow::Owned(fetch(uri, base, length)?),
                (None, Some(bin)) if index == 0 => Cow::Borrowed(bin),
                _ => refuse!("it has no uri, and the file has no binary chunk for it"),
            };
            let Some(exact) = usize::try_from(length).ok().filter(|&length| length <= bytes.len()) else {
                refuse!("it says {length} bytes, but has {}", bytes.len());
            };
            Ok(match bytes {
                Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[..exact]),
                Cow::Owned(mut bytes) => {
                    bytes.truncate(exact);
                    Cow::Owned(bytes)
                }
            })
        };
        let mut load = load;
        let all = root.buffers.iter().enumerate().map(|(i, b)| load((i, b)).with_context(|| format!("buffer {i}")));
        Ok(Self(all.collect::<Result<_>>()?))
    }
}

impl File<'_> {
    /// The bytes of a buffer view.
    pub fn view(&self, index: Index<buffer::View>) -> Result<View<'_>> {
        let view = self.get(index, "buffer view")?;
        let context = || format!("buffer view {index}");
        self.get(view.buffer, "buffer").with_context(context)?;
        let bytes = &self.buffers.0[view.buffer.value()];
        let (offset, length) = (view.byte_offset.unwrap_or_default().0, view.byte_length.0);
        let range = offset.checked_add(length).filter(|&end| end <= bytes.len() as u64).map(|end| offset as usize..end as usize);
        let Some(range) = range else {
            refuse!("buffer view {index} has {length} bytes from {offset}, past the end of buffer {} ({} bytes)", view.buffer, bytes.len());
        };
        let stride = view.byte_stride.map(|stride| stride.0);
        if stride.is_some_and(|stride| !(buffer::MIN_BYTE_STRIDE..=buffer::MAX_BYTE_STRIDE).contains(&stride)) {
            refuse!("buffer view {index} has a byteStride of {}, it must be from 4 to 252", stride.unwrap_or_default());
        }
        Ok(View { bytes: &bytes[range], stride })
    }
}

/// The bytes of a URI: a data: URI decoded, or at most `limit` bytes of the named file.
pub fn fetch(uri: &str, base: Option<&Path>, limit: u64) -> Result<Vec<u8>> {
    if let Some(data) = uri.strip_prefix("data:") {
        return decode_data(data);
    }
    // A scheme comes before the first slash. A drive letter is refused with it: such a path would only work on one machine.
    let scheme = uri.split_once(':').filter(|(scheme, _)| !scheme.contains('/'));
    if let Some((scheme, _)) = scheme {
        refuse!("its uri has the scheme {:?}, only data: and files beside the scene are supported", shorten(scheme));
    }
    let Ok(relative) = percent_encoding::percent_decode_str(uri).decode_utf8() else {
        refuse!("its uri {:?} is not UTF-8 once decoded", shorten(uri));
    };
    let Some(base) = base else {
        refuse!("its uri names a file, {:?}, and there is no folder to look for it in", shorten(&relative));
    };
    let relative = PathBuf::from(&*relative);
    if relative.has_root() || relative.is_absolute() {
        refuse!("its uri {:?} is an absolute path, it must be relative to the scene's file", shorten(uri));
    }
    read_file(&base.join(&relative), limit).with_context(|| relative.display().to_string())
}

/// Reads at most `limit` bytes of a file. Only regular files are read: a pipe or a device might never end.
pub fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let metadata = match std::fs::metadata(path) {
        Ok(metadata) => metadata,
        Err(error) => refuse!("cannot be read: {error}"),
    };
    if !metadata.is_file() {
        refuse!("is not a file");
    }
    let mut bytes = Vec::with_capacity(usize::try_from(metadata.len().min(limit))?);
    match std::fs::File::open(path).and_then(|file| file.take(limit).read_to_end(&mut bytes)) {
        Ok(_) => Ok(bytes),
        Err(error) => refuse!("cannot be read: {error}"),
    }
}

/// Decodes the contents of a data: URI without its scheme: `[type][;base64],contents`.
fn decode_data(data: &str) -> Result<Vec<u8>> {
    let Some((kind, contents)) = data.split_once(',') else {
        refuse!("its data: uri has no comma");
    };
    let contents: Vec<u8> = percent_encoding::percent_decode_str(contents).collect();
    if !kind.ends_with(";base64") {
        return Ok(contents);
    }
    let config = GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
    match GeneralPurpose::new(&base64::alphabet::STANDARD, config).decode(&contents) {
        Ok(bytes) => Ok(bytes),
        Err(error) => refuse!("its data: uri is not base64: {error}"),
    }
}

/// The first 80 characters of a string of any length.
fn shorten(text: &str) -> String {
    text.chars().take(80).collect()
}
