//! Link lines only. Debian's `libshaderc`, shared or static, leaves symbols of glslang and SPIRV-Tools undefined. If that
//! library is found, the archives with these symbols are added. Other systems' libraries are complete.

use std::path::Path;

/// Archives in link order: each needs those after it.
const ARCHIVES: [&str; 9] =
    ["glslang", "MachineIndependent", "GenericCodeGen", "OSDependent", "OGLCompiler", "HLSL", "SPIRV", "SPIRV-Tools-opt", "SPIRV-Tools"];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    for embedded in ["glsl", "configs"] {
        println!("cargo::rerun-if-changed={embedded}"); // a new file is noticed too
    }
    println!("cargo::rerun-if-env-changed=SHADERC_LIB_DIR");
    if std::env::var_os("SHADERC_LIB_DIR").is_some() {
        return;
    }
    let folders = ["/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu"];
    let found = folders.iter().map(Path::new).find(|folder| folder.join("libshaderc_combined.a").exists());
    let Some(folder) = found else { return };
    println!("cargo::rustc-link-search=native={}", folder.display());
    for archive in ARCHIVES.iter().filter(|name| folder.join(format!("lib{name}.a")).exists()) {
        println!("cargo::rustc-link-lib=static={archive}");
        // Repeated behind everything, for linkers that read archives once and in order.
        println!("cargo::rustc-link-arg=-l{archive}");
    }
    println!("cargo::rustc-link-arg=-lstdc++");
}
