//! Cache of results between runs, in the user's cache folder, by a hash of their inputs.
//!
//! A cache only saves time: a missing, damaged or unreadable result is made anew, and an unwritable folder gives one warning, never an
//! error.

use crate::files::{not_written, replace};
use blake3::{Hash, Hasher};
use etcetera::BaseStrategy;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// A cache folder. Several threads and processes may use it at a time.
#[derive(Debug)]
pub struct Cache {
    folder: Option<PathBuf>,
    warned: AtomicBool,
}

/// The user's cache: `manylight` in `$XDG_CACHE_HOME` or `~/.cache`, or the equivalent on other systems.
pub fn user() -> &'static Cache {
    static USER: LazyLock<Cache> = LazyLock::new(|| Cache {
        folder: etcetera::base_strategy::choose_native_strategy().ok().map(|user| user.cache_dir().join("manylight")),
        warned: AtomicBool::new(false),
    });
    &USER
}

impl Cache {
    /// A cache in a given folder, which need not exist yet.
    pub fn at(folder: impl Into<PathBuf>) -> Self {
        Self { folder: Some(folder.into()), warned: AtomicBool::new(false) }
    }

    /// Folder of the cache; `None` if the system has no home folder.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Content that was written under `key`, or `None` if it is missing or damaged. `kind` is a folder's name: `spirv`.
    pub fn read(&self, kind: &str, key: &Hash) -> Option<Vec<u8>> {
        let mut bytes = fs::read(self.path(kind, key)?).ok()?;
        let (stored, content) = bytes.split_first_chunk::<{ blake3::OUT_LEN }>()?;
        if Hash::from_bytes(*stored) != seal(kind, key, content) {
            return None;
        }
        bytes.drain(..blake3::OUT_LEN);
        Some(bytes)
    }

    /// Writes `content` under `key`. A failure only costs time: the first returns a warning to print, later ones are silent.
    #[must_use = "the warning is for the user"]
    pub fn write(&self, kind: &str, key: &Hash, content: &[u8]) -> Option<String> {
        let problem = match self.path(kind, key) {
            None => "no home folder to keep results in".to_owned(),
            Some(path) => {
                let folder = path.parent().unwrap_or(Path::new("."));
                let written = fs::create_dir_all(folder).and_then(|()| {
                    replace(&path, |file| {
                        file.write_all(seal(kind, key, content).as_bytes())?;
                        file.write_all(content)
                    })
                });
                not_written(&path, &written.err()?).to_string()
            }
        };
        let first = !self.warned.swap(true, Ordering::Relaxed);
        first.then(|| format!("nothing is kept for the next start: {problem}"))
    }

    fn path(&self, kind: &str, key: &Hash) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(kind).join(key.to_hex().as_str()))
    }
}

/// Hash of the content, its kind and its key, so that a file that was cut, changed or renamed counts as missing.
fn seal(kind: &str, key: &Hash, content: &[u8]) -> Hash {
    let mut hasher = Hasher::new_keyed(key.as_bytes());
    hasher.update(blake3::hash(kind.as_bytes()).as_bytes()).update(content);
    hasher.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cache() -> (tempfile::TempDir, Cache, Hash) {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::at(folder.path().join("manylight"));
        (folder, cache, blake3::hash(b"source"))
    }

    #[test]
    fn what_was_kept_comes_back_and_nothing_else_does() {
        let (_folder, cache, key) = cache();
        assert_eq!(cache.read("spirv", &key), None);
        for content in [&b"compiled"[..], b"", &[7; 100_000]] {
            assert_eq!(cache.write("spirv", &key, content), None);
            assert_eq!(cache.read("spirv", &key).as_deref(), Some(content));
        }
        assert_eq!(cache.read("spirv", &blake3::hash(b"other source")), None);
        assert_eq!(cache.read("mesh", &key), None);
    }

    #[test]
    fn a_damaged_file_is_as_good_as_missing_and_is_replaced() {
        let (_folder, cache, key) = cache();
        let path = cache.path("spirv", &key).unwrap();
        assert_eq!(cache.write("spirv", &key, b"compiled"), None);
        let good = fs::read(&path).unwrap();
        let mut flipped = good.clone();
        *flipped.last_mut().unwrap() ^= 1;
        let longer = [&good[..], b"x"].concat();
        for damaged in [&b""[..], &good[..10], &good[..good.len() - 1], &flipped, &longer] {
            fs::write(&path, damaged).unwrap();
            assert_eq!(cache.read("spirv", &key), None);
        }
        assert_eq!(cache.write("spirv", &key, b"compiled"), None);
        assert_eq!(cache.read("spirv", &key).as_deref(), Some(&b"compiled"[..]));
    }

    #[test]
    fn a_file_under_another_files_name_is_not_taken_for_it() {
        let (_folder, cache, key) = cache();
        let other = blake3::hash(b"other source");
        assert_eq!(cache.write("spirv", &key, b"compiled"), None);
        fs::rename(cache.path("spirv", &key).unwrap(), cache.path("spirv", &other).unwrap()).unwrap();
        assert_eq!(cache.read("spirv", &other), None);
    }

    #[test]
    fn an_unwritable_cache_warns_once_and_harms_nothing() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("file"), "in the way").unwrap();
        let key = blake3::hash(b"source");
        for cache in [Cache::at(folder.path().join("file")), Cache { folder: None, warned: AtomicBool::new(false) }] {
            let warning = cache.write("spirv", &key, b"compiled").unwrap();
            assert!(warning.starts_with("nothing is kept for the next start: "), "{warning}");
            assert_eq!(cache.write("spirv", &key, b"compiled"), None);
            assert_eq!(cache.read("spirv", &key), None);
        }
    }

    #[test]
    fn threads_that_write_the_same_key_leave_it_whole() {
        let (_folder, cache, key) = cache();
        std::thread::scope(|scope| {
            for i in 0..4_u8 {
                let (cache, key) = (&cache, &key);
                scope.spawn(move || (0..50).for_each(|_| assert_eq!(cache.write("spirv", key, &[i; 10_000]), None)));
            }
            for _ in 0..200 {
                if let Some(content) = cache.read("spirv", &key) {
                    assert!(content.len() == 10_000 && content.iter().all(|&byte| byte == content[0]));
                }
            }
        });
        assert_eq!(fs::read_dir(cache.folder().unwrap().join("spirv")).unwrap().count(), 1);
    }
}
