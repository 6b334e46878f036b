//! Numbers that stages check their limits against.

use super::interleave::Interleave;
use crate::config::{Config, VisibilityMethod};
use crate::gpu::Adapter;

/// Loop turns of one shader invocation, all loops together: llvmpipe silently ends the loops after this many.
pub const LOOP_TURNS: u64 = 65_535;

/// Checks a shader's planned loop turns against [`LOOP_TURNS`]; the difference is room for loops that its limit does not count.
pub const fn planned_turns(turns: u64) -> u64 {
    assert!(turns < LOOP_TURNS);
    turns
}

/// Numbers of a config on a device.
#[derive(Debug)]
pub struct Facts<'f> {
    pub adapter: &'f Adapter,
    /// Layers of the RSM: one a shadow map, of all lights.
    pub maps: u32,
    /// Texels of all layers.
    pub texels: u64,
    /// VPLs of the first bounce.
    pub vpls: u32,
    pub interleave: Interleave,
    /// VPLs of the first bounce and, if there are further ones, of each of these.
    pub lists: Vec<VplList>,
}

/// VPLs of a bounce.
#[derive(Debug, Clone, Copy)]
pub struct VplList {
    /// Key of the config that gives `count`.
    pub key: &'static str,
    pub count: u32,
    /// VPLs that a pixel sums, at most.
    pub each: u64,
    pub visibility: VisibilityMethod,
}

impl<'f> Facts<'f> {
    /// Numbers of a config whose lights have `maps` shadow maps.
    pub fn of(config: &Config, adapter: &'f Adapter, maps: u32) -> Self {
        let interleave = Interleave::of(config.gather.interleave);
        let vpls = config.vpl_count(maps);
        let counts = [("vpls.count", vpls), ("bounce.vpls", config.bounce.vpls)];
        let lists = counts.into_iter().zip(config.visibility_of_bounces()).take(if config.bounce.count > 1 { 2 } else { 1 });
        let list = |((key, count), visibility)| VplList { key, count, each: u64::from(interleave.per_pixel(count)), visibility };
        let [width, height] = config.rsm.size.map(u64::from);
        Self { adapter, maps, texels: u64::from(maps) * width * height, vpls, interleave, lists: lists.map(list).collect() }
    }
}
