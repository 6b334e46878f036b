//! A scene on the device for rays, which may hit any surface: the bounding volume hierarchy with its triangles' shading attributes, all
//! materials and all textures' texels in one image each, and the list of emitters.
//!
//! It is made from the same arrays as the rasterizer's scene. The rasterizer's buffers would do for small scenes. But a software driver
//! limits a storage buffer to 128 MiB, and loads it word by word where an image gives four words at once.

use super::bvh::Bvh;
use super::device_bvh::{BvhHandles, DeviceBvh};
use super::word_image::WordImage;
use crate::color::{luminance, srgb_to_linear};
use crate::fail;
use crate::gpu::{Format, Gpu, ImageId};
use crate::graph::{Buffer, ComputePass, Graph, Image};
use crate::scene::{Map, Material, Scene, Texture, Wrap};
use crate::shader_struct;
use crate::trace;
use anyhow::Result;
use glam::{DVec3, Vec3};
use std::time::Instant;

shader_struct! {
    /// An emitting triangle, as an entry of Walker's alias table: `glsl/reference/path.comp`.
    pub struct Emitter {
        /// Number of the triangle in the hierarchy.
        pub triangle: u32,
        /// Emitter that is taken instead with the remaining probability.
        pub other: u32,
        /// Probability that a sample which drew this entry keeps it.
        pub share: f32,
    }
}

/// Width of the image of all texels and, if it has several layers, its height; `glsl/bvh/hole.glsl` divides by it.
const SIDE: usize = 4096;

/// Features that any material of a scene has: specialization constants of `glsl/bvh/`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Traits {
    base_color_maps: bool,
    metallic_roughness_maps: bool,
    emission_maps: bool,
    normal_maps: bool,
    vertex_colors: bool,
    masks: bool,
    pub emission: bool,
    pub metals: bool,
    single_sides: bool,
}

/// A scene for rays. The device owns all of it.
pub struct TracedScene {
    bvh: DeviceBvh,
    texels: (ImageId, [u32; 3]),
    materials: WordImage,
    emitters: Vec<Emitter>,
    emitting_root: u32,
    /// Luminance of the emitted flux, W.
    pub emitted_power: f32,
    pub traits: Traits,
    /// Time of the hierarchy's last build, milliseconds.
    pub build_ms: u64,
}

/// A traced scene in one frame's graph.
#[derive(Debug, Clone, Copy)]
pub struct TracedHandles {
    bvh: BvhHandles,
    texels: Image,
    materials: Image,
    pub emitters: Buffer,
    pub emitter_count: u32,
    /// Root of the tree of emitting triangles.
    pub emitting_root: u32,
    pub traits: Traits,
}

impl TracedScene {
    /// Builds and uploads a scene for rays.
    ///
    /// # Errors
    /// `BadInput` if the scene is over a limit of the device; the error names the limit and the key.
    pub fn upload(gpu: &mut Gpu, scene: &Scene) -> Result<Self> {
        let texels = upload_texels(gpu, scene)?;
        Self::build(gpu, scene, texels)
    }

    /// Rebuilds all that depends on the draws' transforms in the host's scene, whose time was set ([`Scene::set_time`]).
    ///
    /// # Errors
    /// As [`Self::upload`]; the scene for rays is then unchanged.
    pub fn follow(&mut self, gpu: &mut Gpu, scene: &Scene) -> Result<()> {
        let now = Self::build(gpu, scene, self.texels)?;
        let before = std::mem::replace(self, now);
        before.bvh.free(gpu);
        before.materials.free(gpu);
        Ok(())
    }

    fn build(gpu: &mut Gpu, scene: &Scene, texels: (ImageId, [u32; 3])) -> Result<Self> {
        let start = Instant::now();
        let building = trace::span("building the hierarchy");
        let bvh = Bvh::build(scene);
        drop(building);
        let build_ms = start.elapsed().as_millis() as u64;
        let (emitters, emitted_power) = emitters(scene, &bvh);
        Ok(Self {
            emitting_root: bvh.emitting.root,
            bvh: DeviceBvh::upload(gpu, &scene.name, bvh)?,
            texels,
            materials: WordImage::upload(gpu, &scene.name, "scene/traced-materials", &material_words(scene))?,
            emitters,
            emitted_power,
            traits: traits(scene),
            build_ms,
        })
    }

    /// Imports the scene into a frame's graph.
    pub fn import(&self, g: &mut Graph) -> TracedHandles {
        let (texels, [width, height, layers]) = self.texels;
        // Buffers are never empty; this element is never sampled.
        let none = [Emitter { triangle: 0, other: 0, share: 1.0 }];
        TracedHandles {
            bvh: self.bvh.import(g),
            texels: g.import_image("scene/texels", texels, Format::Rgba8Unorm, [width, height], layers),
            materials: self.materials.import(g),
            emitters: g.upload("scene/emitters", if self.emitters.is_empty() { &none } else { &self.emitters }),
            emitter_count: self.emitters.len() as u32,
            emitting_root: self.emitting_root,
            traits: self.traits,
        }
    }
}

impl<'g> ComputePass<'g> {
    /// Binds all inputs of traversal: those of `glsl/bvh/hole.glsl` and its includes.
    pub fn traces(self, scene: &TracedHandles) -> Self {
        let has = scene.traits;
        self.reads("bvh", scene.bvh.data)
            .reads("bvh_nodes", scene.bvh.nodes)
            .reads("bvh_triangles", scene.bvh.triangles)
            .reads("bvh_masks", scene.bvh.masks)
            .reads("texels", scene.texels)
            .constant("BASE_COLOR_MAPS", has.base_color_maps)
            .constant("VERTEX_COLORS", has.vertex_colors)
            .constant("MASKS", has.masks)
            .constant("SINGLE_SIDES", has.single_sides)
    }

    /// Binds all inputs of hit surfaces, in addition to [`Self::traces`]: those of `glsl/bvh/surface.glsl`.
    pub fn shades(self, scene: &TracedHandles) -> Self {
        let has = scene.traits;
        self.reads("bvh_corners", scene.bvh.corners)
            .reads("bvh_colors", scene.bvh.colors)
            .reads("materials", scene.materials)
            .constant("METALLIC_ROUGHNESS_MAPS", has.metallic_roughness_maps)
            .constant("EMISSION_MAPS", has.emission_maps)
            .constant("NORMAL_MAPS", has.normal_maps)
            .constant("EMISSION", has.emission)
            .constant("METALS", has.metals)
    }
}

fn traits(scene: &Scene) -> Traits {
    let some = |has: fn(&Material) -> bool| scene.draws.iter().any(|draw| has(&scene.materials[draw.material as usize]));
    Traits {
        base_color_maps: some(|m| m.base_color_map.is_some()),
        metallic_roughness_maps: some(|m| m.metallic_roughness_map.is_some()),
        emission_maps: some(|m| m.emission_map.is_some()),
        normal_maps: some(|m| m.normal_map.is_some()),
        vertex_colors: scene.vertices.iter().any(|vertex| vertex.color != u32::MAX),
        masks: some(|m| m.alpha_cutoff.is_some()),
        emission: some(|m| m.emission != [0.0; 3]),
        metals: some(|m| m.metallic > 0.0),
        single_sides: some(|m| !m.double_sided),
    }
}

/// Offset of each texture in the image of all texels.
pub(super) fn first_texels(scene: &Scene) -> Vec<u32> {
    let begin = |first: &mut u64, texture: &Texture| {
        let here = *first;
        *first += u64::from(texture.width) * u64::from(texture.height);
        Some(here as u32)
    };
    scene.textures.iter().scan(0, begin).collect()
}

/// Location of a map's texels: offset, width and height, wrapping and filter; `TexelMap` of `glsl/bvh/hole.glsl`.
pub(super) fn texel_map(map: Option<Map>, scene: &Scene, first: &[u32]) -> [u32; 3] {
    let Some(map) = map else { return [0; 3] };
    let texture = &scene.textures[map.texture as usize];
    let wrap = |wrap: Wrap| match wrap {
        Wrap::Repeat => 0,
        Wrap::MirroredRepeat => 1,
        Wrap::ClampToEdge => 2,
    };
    let how = wrap(map.wrap_u)
        | wrap(map.wrap_v) << 2
        | u32::from(map.filter == crate::scene::Filter::Nearest) << 4
        | u32::from(texture.srgb) << 5;
    [first[map.texture as usize], texture.width | texture.height << 16, how]
}

/// All materials, 16 texels each; `glsl/bvh/surface.glsl` unpacks them.
fn material_words(scene: &Scene) -> Vec<u32> {
    let (first, densities) = (first_texels(scene), emitter_densities(scene));
    let mut words = Vec::with_capacity(scene.materials.len() * 64);
    for (material, density) in scene.materials.iter().zip(densities) {
        let [r, g, b, _] = material.base_color;
        let [er, eg, eb] = material.emission;
        let numbers = [r, g, b, material.metallic, er, eg, eb, density, material.roughness, material.normal_scale, 0.0, 0.0];
        words.extend(numbers.map(f32::to_bits));
        for map in [material.base_color_map, material.metallic_roughness_map, material.emission_map, material.normal_map] {
            let [texel, size, how] = texel_map(map, scene, &first);
            let place = map.unwrap_or_else(|| Map::new(0));
            words.extend(place.matrix.to_cols_array().map(f32::to_bits));
            words.extend([place.offset.x.to_bits(), place.offset.y.to_bits(), texel, size, how, 0, 0, 0]);
        }
        words.extend([0; 4]);
    }
    words
}

/// Uploads all textures' texels, one texture after the other, as an image.
fn upload_texels(gpu: &mut Gpu, scene: &Scene) -> Result<(ImageId, [u32; 3])> {
    let count: usize = scene.textures.iter().map(|texture| texture.texels.len() / 4).sum();
    let rows = count.div_ceil(SIDE).max(1);
    let layers = rows.div_ceil(SIDE);
    let limit = (gpu.adapter.limits.image_layers as usize).min(256);
    if layers > limit {
        return Err(fail!(
            BadInput,
            "{}: its textures' {} million texels are more than rays can see on {}; scale the textures down",
            scene.name,
            count / 1_000_000,
            gpu.adapter.name
        ));
    }
    let size = [SIDE as u32, rows.min(SIDE) as u32, layers as u32];
    let mut texels = Vec::with_capacity(count * 4);
    scene.textures.iter().for_each(|texture| texels.extend_from_slice(&texture.texels));
    Ok((gpu.create_filled_image("scene/texels", Format::Rgba8Unorm, size, &texels, false)?, size))
}

/// Unnormalized density by which a material's surface is sampled as a light: its mean luminance, both sides together.
fn emitter_weight(scene: &Scene, material: &Material) -> f64 {
    let mean = material.emission_map.map_or(DVec3::ONE, |map| {
        let texture = &scene.textures[map.texture as usize];
        let curve = |byte: u8| match f32::from(byte) / 255.0 {
            encoded if texture.srgb => f64::from(srgb_to_linear(encoded)),
            linear => f64::from(linear),
        };
        let table: Vec<f64> = (0..=255).map(curve).collect();
        let texels = texture.texels.chunks_exact(4);
        let count = texels.len().max(1) as f64;
        // A map that is dark on average may still shine somewhere.
        (texels.map(|t| DVec3::new(table[t[0] as usize], table[t[1] as usize], table[t[2] as usize])).sum::<DVec3>() / count)
            .max(DVec3::splat(1e-4))
    });
    luminance(&(Vec3::from(material.emission) * mean.as_vec3()).to_array())
}

fn corner(record: &super::bvh::Triangle, at: usize) -> DVec3 {
    Vec3::new(f32::from_bits(record[at]), f32::from_bits(record[at + 1]), f32::from_bits(record[at + 2])).as_dvec3()
}

/// Alias table of the emitting triangles in proportion to their emitted power, and the total power.
fn emitters(scene: &Scene, bvh: &Bvh) -> (Vec<Emitter>, f32) {
    let weights: Vec<f64> = scene.materials.iter().map(|material| emitter_weight(scene, material)).collect();
    if weights.iter().all(|weight| *weight == 0.0) {
        return (Vec::new(), 0.0);
    }
    let mut found = Vec::new();
    for (i, record) in bvh.triangles.iter().enumerate().skip(bvh.emitting.first) {
        let weight = weights[record[3] as usize];
        let area = (corner(record, 4) - corner(record, 0)).cross(corner(record, 8) - corner(record, 0)).length() * 0.5;
        if weight * area > 0.0 {
            found.push((i as u32, weight * area));
        }
    }
    let sum: f64 = found.iter().map(|(_, power)| power).sum();
    (aliases(&found, sum), (sum * std::f64::consts::PI) as f32)
}

/// Walker's alias table, built by Vose's method: entries are drawn uniformly, and each gives the part of its probability that it lacks to
/// another emitter.
fn aliases(powers: &[(u32, f64)], sum: f64) -> Vec<Emitter> {
    let mut shares: Vec<f64> = powers.iter().map(|(_, power)| power / sum * powers.len() as f64).collect();
    let mut emitters: Vec<Emitter> =
        (0..).zip(powers).map(|(i, (triangle, _))| Emitter { triangle: *triangle, other: i, share: 1.0 }).collect();
    let (mut little, mut much): (Vec<usize>, Vec<usize>) = (0..powers.len()).partition(|i| shares[*i] < 1.0);
    while let (Some(poor), Some(&rich)) = (little.pop(), much.last()) {
        emitters[poor].share = shares[poor] as f32;
        emitters[poor].other = rich as u32;
        shares[rich] -= 1.0 - shares[poor];
        if shares[rich] < 1.0 {
            little.extend(much.pop());
        }
    }
    emitters
}

/// Density of each material by which a point of its surface is sampled as a light, 1/m^2; 0 if it emits nothing.
fn emitter_densities(scene: &Scene) -> Vec<f32> {
    let weights: Vec<f64> = scene.materials.iter().map(|material| emitter_weight(scene, material)).collect();
    if weights.iter().all(|weight| *weight == 0.0) {
        return vec![0.0; weights.len()];
    }
    let area = |draw: &crate::scene::Draw| {
        let corners: Vec<DVec3> =
            scene.draw_vertices(draw).map(|v| draw.transform.transform_point3(v.position.into()).as_dvec3()).collect();
        corners.chunks_exact(3).map(|c| (c[1] - c[0]).cross(c[2] - c[0]).length() * 0.5).sum::<f64>()
    };
    let emitting = scene.draws.iter().filter(|draw| weights[draw.material as usize] > 0.0);
    let sum: f64 = emitting.map(|draw| weights[draw.material as usize] * area(draw)).sum();
    weights.iter().map(|weight| if sum > 0.0 { (weight / sum) as f32 } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_alias_table_draws_each_emitter_by_its_power() {
        for powers in [vec![3.0], vec![1.0, 1.0, 1.0], vec![0.1, 5.0, 0.4, 2.5, 1e-9, 8.0]] {
            let sum: f64 = powers.iter().sum();
            let table = aliases(&(7..).zip(powers.iter().copied()).collect::<Vec<_>>(), sum);
            let mut chances = vec![0.0; powers.len()];
            for (i, emitter) in table.iter().enumerate() {
                assert_eq!(emitter.triangle, 7 + i as u32);
                chances[i] += f64::from(emitter.share) / powers.len() as f64;
                chances[emitter.other as usize] += (1.0 - f64::from(emitter.share)) / powers.len() as f64;
            }
            for (chance, power) in chances.iter().zip(&powers) {
                assert!((chance - power / sum).abs() < 1e-7, "{powers:?}: {chances:?}");
            }
        }
    }
}
