//! Light caches on the device: made once, and kept over frames.

use super::light_caches::bytes_of_vertex;
use super::limits::MOST_CACHES;
use super::needs_rays;
use crate::config::{Config, GatherMethod, Snapping};
use crate::gpu::{Adapter, BufferId, Gpu};
use crate::graph::{Buffer, Graph, Member, ShaderStruct};
use crate::scene::Scene;
use crate::scene::caches::{LightCache, LightCaches, NEIGHBOURS, NONE, Spacing};
use crate::{cache, fail, shader_struct, trace};
use anyhow::Result;

shader_struct! {
    /// A cache of an instance.
    pub struct PlacedCache {
        pub model_cache: u32,
        /// [`NONE`] of the one cache of a scene without surfaces.
        pub draw: u32,
    }

    /// A vertex of an instance: `glsl/gather/cache-vertices.comp`.
    pub struct ListedVertex {
        pub vertex: u32,
        pub list: u32,
        /// [`NONE`] if no triangle has the vertex.
        pub draw: u32,
        /// Of the instance.
        pub first_cache: u32,
        /// Lit sides: 2 if a surface with two has the vertex.
        pub sides: u32,
    }
}

/// Layout for passes that place caches; the host's own type is plain data.
impl ShaderStruct for LightCache {
    const NAME: &'static str = "ModelCache";
    const MEMBERS: &'static [Member] = {
        use std::mem::offset_of;
        &[
            Member { name: "corners", kind: "[u32; 3]", offset: offset_of!(LightCache, corners), bytes: 12 },
            Member { name: "draw", kind: "u32", offset: offset_of!(LightCache, draw), bytes: 4 },
            Member { name: "weights", kind: "[f32; 2]", offset: offset_of!(LightCache, weights), bytes: 8 },
            Member { name: "normal", kind: "[f32; 3]", offset: offset_of!(LightCache, normal), bytes: 12 },
            Member { name: "share", kind: "f32", offset: offset_of!(LightCache, share), bytes: 4 },
            Member { name: "silhouette", kind: "f32", offset: offset_of!(LightCache, silhouette), bytes: 4 },
            Member { name: "opacity", kind: "f32", offset: offset_of!(LightCache, opacity), bytes: 4 },
            Member { name: "one_of_two", kind: "u32", offset: offset_of!(LightCache, one_of_two), bytes: 4 },
        ]
    };
}

/// Caches of a scene. The device owns the buffers.
pub struct Caches {
    spacing: Spacing,
    model_caches: (BufferId, u32),
    placed: (BufferId, u32),
    lists: (BufferId, u32),
    listed: (BufferId, u32),
    firsts: (BufferId, u32),
    two_sided: bool,
}

/// The caches in one frame's graph.
#[derive(Debug, Clone, Copy)]
pub struct FrameCaches {
    /// [`LightCache`]s.
    pub model_caches: Buffer,
    /// [`PlacedCache`] of each cache in the world.
    pub placed: Buffer,
    /// Numbers of caches, within their instance: [`NEIGHBOURS`] a list.
    pub lists: Buffer,
    /// [`ListedVertex`]s.
    pub listed: Buffer,
    /// Listed vertex of each draw's vertex 0, modulo 2^32.
    pub firsts: Buffer,
    /// Whether the scene has surfaces with two sides.
    pub two_sided: bool,
}

/// Spacing of the caches that a config needs; `None` if it needs none.
pub fn needs_caches(config: &Config) -> Option<Spacing> {
    let caches = &config.gather.light_caches;
    (config.gather.method == GatherMethod::LightCaches).then(|| Spacing {
        distance: caches.distance,
        angle: caches.angle_deg.to_radians(),
        open: caches.snapping == Snapping::Open,
    })
}

impl Caches {
    /// Makes the caches of a scene, which stands at second 0 of its animation, or takes those that an earlier run kept.
    ///
    /// # Errors
    /// `BadInput` if there are more than the device can see.
    pub fn upload(gpu: &mut Gpu, scene: &Scene, spacing: Spacing) -> Result<Self> {
        let _span = trace::span("light caches");
        let caches = LightCaches::of(scene, spacing, cache::user())?;
        let host = Host::of(scene, &caches);
        let limit = gpu.adapter.limits.storage_buffer_bytes;
        let bytes = size_of_val(host.lists.as_slice()).max(size_of_val(scene.vertices.as_slice())) as u64;
        if bytes > limit {
            return Err(fail!(
                BadInput,
                "{}: light caches of its {} triangles need {} MB in a buffer, over the {} MB that {} lets a shader see; take another gather.method or lower scene.triangles",
                scene.name,
                scene.triangle_count(),
                bytes >> 20,
                limit >> 20,
                gpu.adapter.name
            ));
        }
        let mut fill =
            |name: &str, bytes: &[u8], count: usize| Ok::<_, anyhow::Error>((gpu.create_filled_buffer(name, bytes)?, count as u32));
        Ok(Self {
            spacing,
            model_caches: fill("light-caches/of-models", bytemuck::cast_slice(&host.model_caches), host.model_caches.len())?,
            placed: fill("light-caches/placed", bytemuck::cast_slice(&host.placed), host.placed.len())?,
            lists: fill("light-caches/lists", bytemuck::cast_slice(&host.lists), host.lists.len() * NEIGHBOURS)?,
            listed: fill("light-caches/listed", bytemuck::cast_slice(&host.listed), host.listed.len())?,
            firsts: fill("light-caches/firsts", bytemuck::cast_slice(&host.firsts), host.firsts.len())?,
            two_sided: caches.models.iter().flat_map(|model| &model.caches).any(|cache| cache.one_of_two != 0),
        })
    }

    /// Frees the buffers.
    pub fn free(self, gpu: &mut Gpu) {
        for (id, _) in [self.model_caches, self.placed, self.lists, self.listed, self.firsts] {
            gpu.free_buffer(id);
        }
    }

    /// Refuses more vertices than a buffer has lights for, and more rays than it has bits for: one for each pair of a cache and a VPL.
    ///
    /// # Errors
    /// `BadInput`, with the key.
    pub fn check(&self, adapter: &Adapter, vpls: u32, config: &Config) -> Result<()> {
        let limit = adapter.limits.storage_buffer_bytes.min(4 * u64::from(u32::MAX));
        if u64::from(self.placed.1) > MOST_CACHES {
            return Err(fail!(
                BadInput,
                "gather.light_caches.distance: {} caches are over the {MOST_CACHES} that every driver goes through; raise it",
                self.placed.1
            ));
        }
        let bytes = u64::from(self.listed.1) * bytes_of_vertex(self.two_sided, &config.gather.light_caches);
        if bytes > limit {
            return Err(fail!(
                BadInput,
                "gather.method: the lights of {} vertices need {} MB, over the {} MB that {} lets a shader see; take another, or lower scene.triangles or raise scene.split",
                self.listed.1,
                bytes >> 20,
                limit >> 20,
                adapter.name
            ));
        }
        let bytes = if needs_rays(config) { 4 * u64::from(self.placed.1) * u64::from(vpls.div_ceil(32)) } else { 0 };
        if bytes > limit {
            return Err(fail!(
                BadInput,
                "gather.light_caches.occlusion: rays between {} caches and {vpls} VPLs need {} MB, over the {} MB that {} lets a shader see; lower vpls.count or raise gather.light_caches.distance",
                self.placed.1,
                bytes >> 20,
                limit >> 20,
                adapter.name
            ));
        }
        Ok(())
    }

    /// Number of caches of all instances.
    pub fn count(&self) -> u64 {
        u64::from(self.placed.1)
    }

    /// Whether these are the caches of a spacing.
    pub fn are_of(&self, spacing: Spacing) -> bool {
        self.spacing == spacing
    }

    /// Imports the caches into a frame's graph.
    pub fn import(&self, g: &mut Graph) -> FrameCaches {
        FrameCaches {
            model_caches: g.import_buffer::<LightCache>("light-caches/of-models", self.model_caches.0, self.model_caches.1),
            placed: g.import_buffer::<PlacedCache>("light-caches/placed", self.placed.0, self.placed.1),
            lists: g.import_buffer::<u32>("light-caches/lists", self.lists.0, self.lists.1),
            listed: g.import_buffer::<ListedVertex>("light-caches/listed", self.listed.0, self.listed.1),
            firsts: g.import_buffer::<u32>("light-caches/firsts", self.firsts.0, self.firsts.1),
            two_sided: self.two_sided,
        }
    }
}

/// Contents of the buffers, none of which is empty.
struct Host {
    model_caches: Vec<LightCache>,
    placed: Vec<PlacedCache>,
    lists: Vec<[u32; NEIGHBOURS]>,
    listed: Vec<ListedVertex>,
    firsts: Vec<u32>,
}

impl Host {
    fn of(scene: &Scene, caches: &LightCaches) -> Self {
        let mut host = Self {
            model_caches: Vec::new(),
            placed: Vec::new(),
            lists: Vec::new(),
            listed: Vec::new(),
            firsts: vec![0; scene.draws.len()],
        };
        for model in &caches.models {
            let (first_model_cache, first_list) = (host.model_caches.len() as u32, host.lists.len() as u32);
            host.model_caches.extend(&model.caches);
            host.lists.extend(&model.neighbours);
            for draws in &model.instances {
                let first_cache = host.placed.len() as u32;
                let placed = |(number, cache): (u32, &LightCache)| PlacedCache { model_cache: number, draw: draws[cache.draw as usize] };
                host.placed.extend((first_model_cache..).zip(&model.caches).map(placed));
                let first_listed = host.listed.len() as u32;
                let unused = |(list, _)| ListedVertex { vertex: 0, list, draw: NONE, first_cache, sides: 0 };
                host.listed.extend((first_list..).zip(&model.neighbours).map(unused));
                for number in draws {
                    let draw = &scene.draws[*number as usize];
                    let sides = if scene.materials[draw.material as usize].double_sided { 2 } else { 1 };
                    host.firsts[*number as usize] = first_listed.wrapping_sub(model.first_vertex);
                    for index in &scene.indices[draw.first_index as usize..(draw.first_index + draw.index_count) as usize] {
                        let vertex = draw.vertex_offset + index;
                        let listed = &mut host.listed[(first_listed + vertex - model.first_vertex) as usize];
                        (listed.vertex, listed.draw, listed.sides) = (vertex, *number, listed.sides.max(sides));
                    }
                }
            }
        }
        if host.placed.is_empty() {
            host.model_caches.push(bytemuck::Zeroable::zeroed());
            host.placed.push(PlacedCache { model_cache: 0, draw: NONE });
        }
        if host.listed.is_empty() {
            host.lists.push([NONE; NEIGHBOURS]);
            host.listed.push(ListedVertex { vertex: 0, list: 0, draw: NONE, first_cache: 0, sides: 0 });
            host.firsts.push(0);
        }
        host
    }
}
