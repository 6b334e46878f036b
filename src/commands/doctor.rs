//! `manylight doctor`: the devices, the methods that run on each, and the features that others lack.

use crate::fail;
use crate::gpu::{Adapter, Feature, Gpu, Options};
use crate::{reference, stages};
use anyhow::Result;

/// Prints a page per device. Fails if no device can render.
pub fn run() -> Result<()> {
    println!("manylight {}", env!("CARGO_PKG_VERSION"));
    let adapters = Gpu::adapters()?;
    for (i, adapter) in adapters.iter().enumerate() {
        describe(i, adapter);
    }
    match Gpu::new(&Options { validate: true, ..Options::default() }) {
        Ok(_) => println!("\nvalidation layer: found"),
        Err(error) => println!("\nvalidation layer: {error:#}"),
    }
    println!("shader cache: {}", crate::cache::user().folder().map_or("none".into(), |folder| folder.display().to_string()));
    if adapters.iter().any(|adapter| adapter.missing(&Feature::ESSENTIAL).is_empty()) {
        Ok(())
    } else if adapters.is_empty() {
        Err(fail!(NoDevice, "no Vulkan device was found; on Debian or Ubuntu, `apt install mesa-vulkan-drivers` brings a software driver"))
    } else {
        Err(fail!(NoDevice, "no device can render; a newer driver may help, or on Debian or Ubuntu `apt install mesa-vulkan-drivers`"))
    }
}

fn describe(index: usize, adapter: &Adapter) {
    let [major, minor, patch] = adapter.version;
    println!("\n{index}: {} [{}]", adapter.name, adapter.kind());
    println!("   driver  {}, Vulkan {major}.{minor}.{patch}", adapter.driver);
    let limits = &adapter.limits;
    println!(
        "   limits  images {0} x {0} x {1} layers, storage buffers {2} MB, memory {3} MB",
        limits.image_size,
        limits.image_layers,
        limits.storage_buffer_bytes >> 20,
        limits.heap_bytes >> 20
    );
    let essential = adapter.missing(&Feature::ESSENTIAL);
    if !essential.is_empty() {
        let names = essential.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        println!("   cannot render: it lacks {names}");
        return;
    }
    if !adapter.has(Feature::Timestamps) {
        println!("   timing  by the host's clock alone: it lacks {}", Feature::Timestamps);
    }
    for method in stages::methods().into_iter().chain([reference::method()]) {
        let missing = method.missing(adapter);
        let verdict = if missing.is_empty() {
            "runs".to_owned()
        } else {
            format!("lacks {}", missing.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "))
        };
        println!("   {:<20} {:<21} {verdict}", method.slot, method.name);
    }
}
