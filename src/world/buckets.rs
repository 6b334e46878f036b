//! Draws of a scene by material, in parts small enough for culling, and the textures that they use.

use super::device::{DrawArguments, MaterialData};
use super::mips::{Texels, with_mips};
use crate::fail;
use crate::gpu::{Format, Gpu, ImageId};
use crate::scene::bend::Reach;
use crate::scene::{Aabb, Draw, Filter, Map, Material, Scene, Wrap};
use anyhow::Result;
use glam::Affine3A;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Properties shared by the draws of a bucket. Pipelines depend on all but the material's number.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct BucketKey {
    /// Sorts solid surfaces first, which saves the shading of hidden surfaces.
    pub masked: bool,
    pub double_sided: bool,
    pub colored: bool,
    /// Number of the material, which is bound as a uniform block.
    pub material: u32,
    /// Image array and sampler state of each map.
    pub maps: [Option<MapKey>; 4],
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct MapKey {
    pub array: usize,
    pub u: Wrap,
    pub v: Wrap,
    pub filter: Filter,
}

pub(super) struct Bucket {
    pub key: BucketKey,
    pub draws: Vec<PlacedDraw>,
}

/// A range of triangles to draw, with its world-space bounds.
pub(super) struct PlacedDraw {
    pub arguments: DrawArguments,
    pub bounds: Aabb,
    pub motion: Motion,
}

/// How a part's bounds follow the scene.
pub(super) enum Motion {
    Still,
    /// Object-space bounds; the part's bounds are the box around the transformed one.
    Moves(Aabb),
    Bends(Reach),
}

/// A texture on the device.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct PlacedTexture {
    array: usize,
    layer: u32,
    /// Mean of its texels: its last mip.
    mean: [u8; 4],
}

pub(super) fn upload_textures(gpu: &mut Gpu, scene: &Scene) -> Result<(Vec<ImageId>, Vec<PlacedTexture>)> {
    let limits = gpu.adapter.limits;
    let mut groups: BTreeMap<(u32, u32, Texels), Vec<usize>> = BTreeMap::new();
    let masks = scene.materials.iter().filter(|material| material.alpha_cutoff.is_some()).filter_map(|material| material.base_color_map);
    let masks: BTreeSet<usize> = masks.map(|map| map.texture as usize).collect();
    for (i, texture) in scene.textures.iter().enumerate() {
        if texture.width.max(texture.height) > limits.image_size {
            return Err(fail!(
                BadInput,
                "{}: texture {} has {}x{} texels, over the {} that {} allows; scale it down",
                scene.name,
                texture.name,
                texture.width,
                texture.height,
                limits.image_size,
                gpu.adapter.name
            ));
        }
        let texels = Texels { srgb: texture.srgb, holes: masks.contains(&i) };
        groups.entry((texture.width, texture.height, texels)).or_default().push(i);
    }
    let mut arrays = Vec::new();
    let mut placed = vec![PlacedTexture::default(); scene.textures.len()];
    for ((width, height, of), members) in groups {
        for members in members.chunks(limits.image_layers.max(1) as usize) {
            let size = [width, height];
            let format = if of.srgb { Format::Rgba8Srgb } else { Format::Rgba8Unorm };
            let array = arrays.len();
            let layers = members.iter().enumerate().map(|(layer, i)| {
                let texels = with_mips(&scene.textures[*i].texels, size, of);
                placed[*i] = PlacedTexture { array, layer: layer as u32, mean: texels.last_chunk().copied().unwrap_or_default() };
                texels
            });
            arrays.push(gpu.create_texture_array("scene/textures", format, size, layers)?);
        }
    }
    Ok((arrays, placed))
}

fn maps(material: &Material) -> [Option<Map>; 4] {
    [material.base_color_map, material.metallic_roughness_map, material.emission_map, material.normal_map]
}

pub(super) fn material_data(material: &Material, placed: &[PlacedTexture]) -> MaterialData {
    let [base_color_map, metallic_roughness_map, emission_map, normal_map] = maps(material).map(|map| {
        map.map_or([0.0; 7], |map| {
            let [a, b, c, d] = map.matrix.to_cols_array();
            [a, b, c, d, map.offset.x, map.offset.y, placed[map.texture as usize].layer as f32]
        })
    });
    MaterialData {
        base_color: material.base_color,
        emission: material.emission,
        metallic: material.metallic,
        roughness: material.roughness,
        alpha_cutoff: material.alpha_cutoff.unwrap_or(0.0),
        normal_scale: material.normal_scale,
        double_sided: u32::from(material.double_sided),
        base_color_map,
        metallic_roughness_map,
        emission_map,
        normal_map,
        mean_roughness: material.roughness
            * material.metallic_roughness_map.map_or(1.0, |map| f32::from(placed[map.texture as usize].mean[1]) / 255.0),
        padding: [0; 23],
    }
}

pub(super) fn fill_buckets(scene: &Scene, placed: &[PlacedTexture]) -> (Vec<Bucket>, Aabb) {
    let colored = |draw: &Draw| scene.draw_vertices(draw).any(|vertex| vertex.color != u32::MAX);
    let facts: Vec<(Vec<Draw>, Vec<PartBounds>, bool)> = scene
        .draws
        .par_iter()
        .zip(scene.moving_draws())
        .map(|(draw, moves)| {
            let parts = parts(draw);
            let bounds = parts.iter().map(|part| part_bounds(scene, part, moves)).collect();
            (parts, bounds, colored(draw))
        })
        .collect();
    let all = facts.iter().flat_map(|(_, bounds, _)| bounds).fold(Aabb::EMPTY, |all, (bounds, _)| all.union(*bounds));
    let mut buckets: BTreeMap<BucketKey, Vec<PlacedDraw>> = BTreeMap::new();
    for (number, (draw, (parts, bounds, colored))) in scene.draws.iter().zip(facts).enumerate() {
        let material = &scene.materials[draw.material as usize];
        let key = BucketKey {
            material: draw.material,
            masked: material.alpha_cutoff.is_some(),
            double_sided: material.double_sided,
            colored,
            maps: maps(material).map(|map| {
                map.map(|map| MapKey { array: placed[map.texture as usize].array, u: map.wrap_u, v: map.wrap_v, filter: map.filter })
            }),
        };
        let place = |(part, (bounds, motion)): (&Draw, PartBounds)| {
            let arguments = DrawArguments {
                index_count: part.index_count,
                instance_count: 1,
                first_index: part.first_index,
                vertex_offset: part.vertex_offset as i32,
                first_instance: number as u32,
            };
            PlacedDraw { arguments, bounds, motion }
        };
        buckets.entry(key).or_default().extend(parts.iter().zip(bounds).map(place));
    }
    (buckets.into_iter().map(|(key, draws)| Bucket { key, draws }).collect(), all)
}

/// World-space bounds of a part, and how they follow the scene.
type PartBounds = (Aabb, Motion);

fn part_bounds(scene: &Scene, part: &Draw, moves: bool) -> PartBounds {
    if !moves {
        return (scene.draw_bounds(part), Motion::Still);
    }
    if let (Some(reach), Some(bending)) = (scene.reach(part), &scene.bending) {
        return (reach.bounds(&bending.pose, &part.transform), Motion::Bends(reach));
    }
    let own = scene.draw_bounds(&Draw { transform: Affine3A::IDENTITY, ..part.clone() });
    (own.transformed(&part.transform), Motion::Moves(own))
}

/// Splits a draw into pieces small enough for culling and sorting. Files mostly list neighbours together.
fn parts(draw: &Draw) -> Vec<Draw> {
    const INDICES: u32 = 3 * 1024;
    let piece =
        |first: u32| Draw { first_index: draw.first_index + first, index_count: (draw.index_count - first).min(INDICES), ..draw.clone() };
    (0..draw.index_count).step_by(INDICES as usize).map(piece).collect()
}
