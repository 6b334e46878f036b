//! What the window shows: a config, and the keys that were changed over it, each as `--set` would.

use crate::config::{Config, to_toml};
use std::path::{Path, PathBuf};

/// Sections that are of the scene and not of a method.
const OF_SCENE: [&str; 7] = ["scene", "camera", "light", "frame", "materials", "sky", "compose"];

/// A config and the changes over it. Changes of a key take each other's place.
#[derive(Debug, Clone, PartialEq)]
pub struct Project {
    /// A config file, or the name of a preset.
    pub config: PathBuf,
    /// Changes of the command line.
    given: Vec<String>,
    /// Key and value as TOML, in the order in which they were made.
    changes: Vec<(String, String)>,
}

impl Project {
    pub fn new(config: &Path, given: Vec<String>) -> Self {
        Self { config: config.to_owned(), given, changes: Vec::new() }
    }

    /// Sets a key to a value, written as TOML.
    pub fn set(&mut self, key: &str, value: impl Into<String>) {
        let value = value.into();
        match self.changes.iter_mut().find(|(known, _)| known == key) {
            Some((_, old)) => *old = value,
            None => self.changes.push((key.to_owned(), value)),
        }
    }

    /// Takes back the changes of a key; the config's own value stands again.
    pub fn reset(&mut self, key: &str) {
        self.changes.retain(|(known, _)| known != key);
    }

    /// Takes back all changes that were made in the window.
    pub fn reset_all(&mut self) {
        self.changes.clear();
    }

    pub fn is_changed(&self, key: &str) -> bool {
        self.changes.iter().any(|(known, _)| known == key)
    }

    pub fn has_changes(&self) -> bool {
        !self.changes.is_empty()
    }

    /// The same scene by another preset: camera, lights, frames and sky are those of `config`, which is the project's own.
    pub fn by_preset(&self, preset: &str, config: &Config) -> Self {
        let table: toml::Table = toml::from_str(&to_toml(config)).unwrap_or_default();
        let mut leaves = Vec::new();
        for section in OF_SCENE {
            table.get(section).iter().for_each(|value| flatten(section, value, &mut leaves));
        }
        let is_of_scene = |key: &str| key.split('.').next().is_some_and(|section| OF_SCENE.contains(&section.trim()));
        let mut other = self.clone();
        other.config = PathBuf::from(preset);
        other.changes.retain(|(key, _)| is_of_scene(key));
        other.given.retain(|given| given.split_once('=').is_some_and(|(key, _)| is_of_scene(key)));
        leaves.into_iter().for_each(|(key, value)| other.set(&key, value));
        other
    }

    /// All changes, for [`crate::config::load`].
    pub fn overrides(&self) -> Vec<String> {
        let changes = self.changes.iter().map(|(key, value)| format!("{key}={value}"));
        self.given.iter().cloned().chain(changes).collect()
    }

    /// The command line that makes frame `frame` of what is shown.
    pub fn command(&self, frame: u32) -> String {
        let sets = self.overrides().into_iter().map(|change| format!(" --set {}", quoted(&change)));
        format!("manylight render {}{} --frames {}", quoted(&self.config.to_string_lossy()), sets.collect::<String>(), frame + 1)
    }
}

/// Keys and values of a table, as `--set` has them.
fn flatten(path: &str, value: &toml::Value, leaves: &mut Vec<(String, String)>) {
    match value {
        toml::Value::Table(table) => table.iter().for_each(|(key, value)| flatten(&format!("{path}.{key}"), value, leaves)),
        value => leaves.push((path.to_owned(), value.to_string())),
    }
}

/// A word as a shell takes it, whatever it contains.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:".contains(c);
    if !word.is_empty() && word.chars().all(plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_takes_the_place_of_an_older_one_and_can_be_taken_back() {
        let mut project = Project::new(Path::new("linke"), vec!["vpls.count=64".to_owned()]);
        project.set("gather.interleave", "2");
        project.set("camera.position", "[0.0, 1.0, 2.0]");
        project.set("gather.interleave", "4");
        assert_eq!(project.overrides(), ["vpls.count=64", "gather.interleave=4", "camera.position=[0.0, 1.0, 2.0]"]);
        project.reset("gather.interleave");
        assert!(!project.is_changed("gather.interleave") && project.is_changed("camera.position"));
    }

    #[test]
    fn another_preset_shows_the_same_scene() {
        let text = "[scene]\nbuiltin = \"cornell\"\n[gather]\ninterleave = 2\n[[light]]\nkind = \"point\"\nposition = [0, 1, 0]\nintensity = [1, 2, 3]\n";
        let config = crate::config::parse(text, Path::new("c.toml"), &[]).unwrap().config;
        let mut project = Project::new(Path::new("c.toml"), vec!["vpls.count=64".to_owned()]);
        project.set("compose.exposure", "2.0");
        let other = project.by_preset("ssvp", &config);
        let preset = crate::presets::find("ssvp").unwrap();
        let shown = crate::config::parse_preset(preset, Path::new("ssvp.toml"), &other.overrides()).unwrap().config;
        // The method of the preset wants short edges.
        let scene = crate::config::SceneConfig { split: shown.scene.split, ..config.scene.clone() };
        assert_eq!((&shown.scene, &shown.light, &shown.frame), (&scene, &config.light, &config.frame));
        assert_ne!((shown.gather.interleave, shown.vpls.count), (config.gather.interleave, 64));
    }

    #[test]
    fn the_command_is_quoted_for_a_shell() {
        let mut project = Project::new(Path::new("my scene.toml"), Vec::new());
        project.set("scene.file", r#""it's.glb""#);
        assert_eq!(project.command(0), r#"manylight render 'my scene.toml' --set 'scene.file="it'\''s.glb"' --frames 1"#);
    }
}
