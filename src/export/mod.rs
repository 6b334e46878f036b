//! Scenes for other renderers: independent programs that our pictures can be checked against.

mod behind;
mod meshes;
pub mod mitsuba;
mod ply;
mod xml;

/// Warnings about an export, without repetitions.
#[derive(Debug, Default)]
pub struct Warnings(Vec<String>);

impl Warnings {
    fn add(&mut self, sentence: impl Into<String>) {
        let sentence = sentence.into();
        if !self.0.contains(&sentence) {
            self.0.push(sentence);
        }
    }

    pub fn sentences(self) -> Vec<String> {
        self.0
    }
}

/// Unique file names and ids from any text: ASCII letters, digits, `-` and `_`. No two names differ only in case, which some
/// file systems ignore.
#[derive(Debug, Default)]
struct Names(std::collections::BTreeSet<String>);

impl Names {
    /// Limit of a name's characters; longer ones are cut.
    const LONGEST: usize = 48;

    fn unique(&mut self, wish: &str) -> String {
        let safe = |c: char| if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c } else { '_' };
        let wish: String = wish.trim().chars().take(Self::LONGEST).map(safe).collect();
        let wish = if wish.is_empty() { "unnamed".to_owned() } else { wish };
        let mut name = wish.clone();
        let mut number = 1;
        while !self.0.insert(name.to_ascii_lowercase()) {
            number += 1;
            name = format!("{wish}-{number}");
        }
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_safe_and_no_two_are_alike() {
        let mut names = Names::default();
        let all = ["wall", "Wall", "wall", "../etc/passwd", "a b.<&>\"$x", "", "  ", "über", "wall-2"].map(|name| names.unique(name));
        assert_eq!(
            all,
            ["wall", "Wall-2", "wall-3", "___etc_passwd", "a_b______x", "unnamed", "unnamed-2", "_ber", "wall-2-2"].map(str::to_owned)
        );
        assert_eq!(names.unique(&"x".repeat(500)).len(), Names::LONGEST);
    }

    #[test]
    fn a_warning_is_said_once() {
        let mut warnings = Warnings::default();
        ["a", "b", "a"].into_iter().for_each(|sentence| warnings.add(sentence));
        assert_eq!(warnings.sentences(), ["a", "b"]);
    }
}
