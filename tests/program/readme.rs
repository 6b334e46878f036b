//! The README tells the truth where a machine can tell.

use manylight::{config, presets};

const README: &str = include_str!("../../README.md");

#[test]
fn the_readme_lists_every_key_of_the_config_as_the_program_knows_it() {
    let table = config::markdown_table();
    assert!(README.contains(table.trim()), "README.md's table of keys is out of date; it should be\n\n{table}");
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
