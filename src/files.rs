//! Writing files whole or not at all.

use crate::fail;
use anyhow::Result;
use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use tempfile::NamedTempFile;

/// Writes a file atomically: a reader of `path` sees the old content or all of `bytes`, never a part.
///
/// # Errors
/// `OutputNotWritten` with the path and the reason; nothing is left beside `path` then.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    replace(path, |file| file.write_all(bytes)).map_err(|error| not_written(path, &error))
}

/// Makes a folder and its parents, and checks that a file can be written there. Commands call this before they render, so that
/// no hours of work are lost to a read-only folder.
///
/// # Errors
/// `OutputNotWritten` with the path and the reason.
pub fn prepare_folder(path: &Path) -> Result<()> {
    fs::create_dir_all(path)
        .and_then(|()| temporary(path))
        .and_then(|mut file| {
            file.write_all(&[0])?;
            file.close()
        })
        .map_err(|error| not_written(path, &error))
}

/// Lets `fill` write a temporary file in the folder of `path`, then renames it to `path`. The temporary file is removed on
/// failure.
pub(crate) fn replace(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    // A rename would replace a device or a pipe by a plain file.
    if fs::metadata(path).is_ok_and(|old| !old.is_file()) {
        return Err(io::Error::new(ErrorKind::AlreadyExists, "something that is no plain file has that name"));
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut file = temporary(folder)?;
    fill(&mut file)?;
    file.flush()?;
    file.persist(path)?;
    Ok(())
}

fn temporary(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".manylight-").suffix(".part");
    #[cfg(unix)]
    {
        // Permissions of any new file, by the user's umask; tempfile's default lets only the owner read.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// The error for a path that could not be written, with a remedy.
pub(crate) fn not_written(path: &Path, error: &io::Error) -> anyhow::Error {
    // tempfile adds the temporary file's name to the system's message, of no use to the user.
    let error_text = error.to_string();
    let reason = error_text.split_once(" at path ").map_or(error_text.as_str(), |(reason, _)| reason);
    let remedy = match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "make room there or choose another place",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => "choose a place where you may write",
        _ => "choose another place",
    };
    fail!(OutputNotWritten, "{}: cannot be written ({reason}); {remedy}", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::{Exit, exit_code};

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_written_file_replaces_the_old_one_and_leaves_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        write_file(&path, b"first").unwrap();
        write_file(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(names(folder.path()), ["a.bin"]);
    }

    #[test]
    fn a_full_disk_keeps_the_old_file_and_leaves_no_half_written_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.exr");
        write_file(&path, b"old").unwrap();
        let error = replace(&path, |file| {
            file.write_all(b"half of the ne")?;
            Err(io::Error::from(ErrorKind::StorageFull))
        })
        .unwrap_err();
        let error = not_written(&path, &error);
        assert_eq!(exit_code(&error), Exit::OutputNotWritten);
        assert!(
            error.to_string().ends_with("image.exr: cannot be written (no storage space); make room there or choose another place"),
            "{error}"
        );
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["image.exr"]);
    }

    #[test]
    fn a_folder_below_a_plain_file_is_refused_before_and_while_writing() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "in the way").unwrap();
        for error in [
            prepare_folder(&file).unwrap_err(),
            prepare_folder(&file.join("out")).unwrap_err(),
            write_file(&file.join("a"), b"").unwrap_err(),
        ] {
            assert_eq!(exit_code(&error), Exit::OutputNotWritten);
            let message = error.to_string();
            assert!(message.starts_with(file.to_str().unwrap()) && message.contains("cannot be written ("), "{message}");
            assert!(!message.contains(".part"), "names the temporary file: {message}");
        }
        assert_eq!(fs::read_to_string(&file).unwrap(), "in the way");
        assert_eq!(names(folder.path()), ["file"]);
    }

    #[test]
    fn a_missing_folder_is_made_with_those_above_it_and_left_empty() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b");
        prepare_folder(&path).unwrap();
        assert!(names(&path).is_empty());
        prepare_folder(&path).unwrap();
    }

    #[test]
    fn a_folder_in_the_place_of_a_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let error = write_file(folder.path(), b"x").unwrap_err();
        assert_eq!(exit_code(&error), Exit::OutputNotWritten);
        assert!(error.to_string().contains("no plain file"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_never_replaced() {
        use std::os::unix::fs::FileTypeExt;
        write_file(Path::new("/dev/null"), b"x").unwrap_err();
        assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    }

    #[cfg(unix)]
    #[test]
    fn a_read_only_folder_is_refused_before_rendering() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o555)).unwrap();
        if fs::write(folder.path().join("probe"), "").is_ok() {
            // Written directly, since the test harness hides the printed output of passing tests.
            writeln!(io::stderr(), "SKIPPED: a read-only folder: this user may write there").unwrap();
            return;
        }
        let error = prepare_folder(folder.path()).unwrap_err();
        assert_eq!(exit_code(&error), Exit::OutputNotWritten);
        assert!(error.to_string().contains("choose a place where you may write"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_written_file_has_the_rights_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let mode = |name: &str| fs::metadata(folder.path().join(name)).unwrap().permissions().mode();
        fs::write(folder.path().join("plain"), "").unwrap();
        write_file(&folder.path().join("ours"), b"").unwrap();
        assert_eq!(mode("ours"), mode("plain"));
    }
}
