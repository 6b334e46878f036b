//! `manylight list`: devices, stages with their methods, presets.

use crate::config::{Choice, KeyInfo, Kind, keys};
use crate::gpu::Gpu;
use crate::presets;
use crate::{reference, stages};
use anyhow::Result;

/// Prints the lists. Without Vulkan the list of devices is empty, the others are printed all the same.
pub fn run() -> Result<()> {
    println!("devices");
    match Gpu::adapters() {
        Ok(adapters) if adapters.is_empty() => println!("  none"),
        Ok(adapters) => {
            for (i, adapter) in adapters.iter().enumerate() {
                println!("  {i}: {} [{}], {}", adapter.name, adapter.kind(), adapter.driver);
            }
        }
        Err(error) => println!("  none: {error:#}"),
    }
    println!("\nstages and methods");
    let methods: Vec<_> = stages::methods().into_iter().chain([reference::method()]).collect();
    let mut slots: Vec<&str> = methods.iter().map(|method| method.slot).collect();
    slots.dedup();
    for slot in slots {
        let key = keys().iter().find(|info| info.key == slot);
        println!("  {}", key.map_or_else(|| slot.to_owned(), |key| format!("{slot}: {}", key.what)));
        let choices: &[Choice] = match key {
            Some(KeyInfo { kind: Kind::Choice(choices), .. }) => choices,
            _ => &[],
        };
        for method in methods.iter().filter(|method| method.slot == slot) {
            let what = choices.iter().find(|choice| choice.name == method.name).map_or("", |choice| &choice.what);
            println!("{}", format!("    {:<22} {what}", method.name).trim_end());
        }
    }
    println!("\npresets");
    for (name, text) in presets::all() {
        println!("  {name:<18} {}", presets::title(text));
    }
    println!("\ntables");
    for (name, text) in presets::tables() {
        println!("  {name:<18} {}", presets::title(text));
    }
    Ok(())
}
