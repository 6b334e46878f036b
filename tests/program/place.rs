//! Running the program in a folder for one test.

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A small picture of the built-in box.
pub const BOX: &str =
    "[scene]\nbuiltin = \"cornell\"\n[frame]\nsize = [64, 48]\ncount = 2\nwarmup = 1\n[rsm]\nsize = [64, 64]\n[vpls]\ncount = 64\n";

/// Commands that use no device, and so have no `--device`.
const WITHOUT_DEVICE: [&str; 3] = ["compare", "export", "report"];

/// A temporary folder, removed when its test ends.
pub struct Place(tempfile::TempDir);

impl Place {
    /// A folder with these files.
    pub fn new(files: &[(&str, &str)]) -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        for (name, content) in files {
            place.write(name, content);
        }
        place
    }

    pub fn root(&self) -> &Path {
        self.0.path()
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.root().join(name)
    }

    /// Writes a file, whose folders are made.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, content).unwrap();
        path
    }

    #[track_caller]
    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    #[track_caller]
    pub fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&self.read(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// A copy of the shaders, for a test to edit.
    pub fn copy_shaders(&self, to: &str) {
        copy_folder(&Path::new(env!("CARGO_MANIFEST_DIR")).join("glsl"), &self.path(to));
    }

    /// The names of all files and folders in a folder.
    #[track_caller]
    pub fn names(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path(folder)).unwrap_or_else(|error| panic!("{folder}: {error}"));
        let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Files of a folder, with their content.
    #[track_caller]
    pub fn files(&self, folder: &str) -> BTreeMap<String, Vec<u8>> {
        let names = self.names(folder).into_iter().filter(|name| self.path(folder).join(name).is_file());
        names.map(|name| (name.clone(), self.read(&format!("{folder}/{name}")))).collect()
    }

    /// The program in this folder, without arguments.
    pub fn manylight(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_manylight"));
        command.current_dir(self.root());
        for variable in ["MANYLIGHT_FAULT", "MANYLIGHT_GLSL"] {
            command.env_remove(variable);
        }
        command
    }

    /// The program with the words of a line as arguments, on the software device if the line names none.
    pub fn command(&self, line: &str) -> Command {
        let mut command = self.manylight();
        command.args(line.split_whitespace());
        let mut words = line.split_whitespace();
        if !words.next().is_some_and(|command| WITHOUT_DEVICE.contains(&command)) && !words.any(|word| word == "--device") {
            command.args(["--device", "cpu"]);
        }
        command
    }

    pub fn run(&self, line: &str) -> Output {
        self.command(line).output().unwrap()
    }

    /// stdout and stderr of a run that must succeed.
    #[track_caller]
    pub fn says(&self, line: &str) -> [String; 2] {
        let output = self.run(line);
        assert_eq!(output.status.code(), Some(0), "{line}: {}", text(&output.stderr));
        [text(&output.stdout), text(&output.stderr)]
    }

    /// stdout of a run that must succeed.
    #[track_caller]
    pub fn succeeds(&self, line: &str) -> String {
        let [stdout, _] = self.says(line);
        stdout
    }

    /// Checks a run by [`failed`].
    #[track_caller]
    pub fn fails(&self, line: &str, code: i32, says: &[&str]) {
        failed(line, &self.run(line), code, says);
    }

    /// Checks that a run ends as bad input.
    #[track_caller]
    pub fn refuses(&self, line: &str, says: &[&str]) {
        self.fails(line, 2, says);
    }
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Checks the exit code and the one line on stderr, which must contain all of `says`. Returns stdout.
#[track_caller]
pub fn ended(what: &str, output: &Output, code: i32, says: &[&str]) -> String {
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{what}: {stderr}");
    assert_eq!(stderr.lines().count(), 1, "{what}: {stderr}");
    assert!(stderr.starts_with("manylight: "), "{what}: {stderr}");
    for part in says {
        assert!(stderr.contains(part), "{what}: {part:?} is not in {stderr}");
    }
    text(&output.stdout)
}

/// [`ended`] with an empty stdout.
#[track_caller]
pub fn failed(what: &str, output: &Output, code: i32, says: &[&str]) {
    assert_eq!(ended(what, output, code, says), "", "{what}");
}

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() { copy_folder(&path, &target) } else { fs::copy(&path, &target).map(|_| ()).unwrap() }
    }
}
