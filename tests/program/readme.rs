//! Checks of the README against the program.

use manylight::{config, presets};

const README: &str = include_str!("../../README.md");

const KEYS: &str = include_str!("../../configs/README.md");

#[test]
fn the_page_of_configs_lists_every_key_as_the_program_knows_it() {
    let page = config::markdown();
    assert!(KEYS.ends_with(&page), "the keys in configs/README.md are out of date; its end should be\n\n{page}");
}

#[test]
fn the_readme_names_every_preset() {
    for (name, _) in presets::all() {
        assert!(README.contains(&format!("configs/{name}.toml")), "README.md does not mention configs/{name}.toml");
    }
}

#[test]
fn the_readme_begins_with_the_two_commands() {
    let demo = README.find("tools/demo");
    let test = README.find("tools/test");
    assert!(demo.is_some() && test > demo && test < README.find("](.github/first-light.png)"));
}
