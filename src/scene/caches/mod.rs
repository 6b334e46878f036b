//! Light caches: sparse places on the surfaces of models, at which light is gathered (Bischoff, Schwandt and Broll 2017, section 3, "Cache
//! Distribution", after Lensing and Broll 2013).
//!
//! A cache lies on a triangle and keeps its normal in the triangle's frame, so that caches move and bend with their meshes. Models that are
//! drawn several times have one set of caches.

mod models;
mod place;
mod samples;
#[cfg(test)]
mod tests;

use super::Scene;
use crate::cache::Cache;
use crate::fail;
use anyhow::Result;
use glam::Vec3;
use kd_tree::KdTree3;
use models::Model;
use rayon::prelude::*;
use samples::Sample;

/// Caches that a vertex knows, at most.
pub const NEIGHBOURS: usize = 16;

/// Entry of a list of neighbours that is empty.
pub const NONE: u32 = u32::MAX;

/// Places on a scene's surfaces, at most, from which caches are made.
const MOST_SAMPLES: f64 = 1.0e8;

/// Changes when the same scene gives other caches.
const VERSION: u32 = 4;

/// Spacing of caches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spacing {
    /// Distance d_eps between a cache and the surface that it stands for, at most, metres.
    pub distance: f32,
    /// Angle theta_eps between the normals of surface that is averaged for a cache and their middle, at most, radians.
    pub angle: f32,
    /// Whether a cache is put where little stands before it, and not at the middle of the surface that is averaged for it.
    pub open: bool,
}

/// A light cache of a model.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LightCache {
    /// Indices of the vertices of the triangle that it lies on.
    pub corners: [u32; 3],
    /// The triangle's draw, among those of its model.
    pub draw: u32,
    /// Weights of the triangle's second and third corner.
    pub weights: [f32; 2],
    /// Unit normal: its parts along the triangle's first edge, across it, and along the triangle's normal.
    pub normal: [f32; 3],
    /// Surface that it stands for, in areas of its triangle.
    pub share: f32,
    /// Area that this surface is spread over, seen along the normal, in areas of its triangle.
    pub silhouette: f32,
    /// Share of that area which the surface covers.
    pub opacity: f32,
    /// Whether it is on one side of a surface that has two: 1 or 0.
    pub one_of_two: u32,
}

/// Caches of a model, and what its vertices know of them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ModelCaches {
    pub caches: Vec<LightCache>,
    /// The first vertex that has a list.
    pub first_vertex: u32,
    /// The nearest caches of each vertex from the first one on, nearest first, then [`NONE`].
    pub neighbours: Vec<[u32; NEIGHBOURS]>,
    /// The scene's draws that each instance of the model has, in the same order.
    pub instances: Vec<Vec<u32>>,
}

/// Caches of all models of a scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LightCaches {
    pub models: Vec<ModelCaches>,
}

impl LightCaches {
    /// Caches of a scene, which stands at second 0 of its animation: kept ones, or new ones, which are kept then.
    ///
    /// # Errors
    /// `BadInput` if the spacing is too small for the scene.
    pub fn of(scene: &Scene, spacing: Spacing, kept: &Cache) -> Result<Self> {
        let models = models::models(scene);
        let key = models::key(scene, &models, spacing, VERSION);
        if let Some(caches) = kept.read("light-caches", &key).and_then(|bytes| Self::from_bytes(&bytes, &models)) {
            return Ok(caches);
        }
        let caches = Self::make(scene, models, spacing)?;
        // A failure is ignored: the next start makes the caches anew, and nothing else changes.
        let _ = kept.write("light-caches", &key, &caches.to_bytes());
        Ok(caches)
    }

    /// Estimate of a scene's caches before they are made: surface over a tenth of the square of the distance. Two streets have .97 and 1.03 of
    /// it at 30 to 60 degrees, Sponza .72. Smaller angles, which it does not know, make more.
    pub fn about(scene: &Scene, distance: f32) -> f64 {
        let area: f64 = models::models(scene).iter().map(|model| model.area() * model.instances.len() as f64).sum();
        area / (0.1 * f64::from(distance).powi(2))
    }

    /// Number of caches of all instances.
    pub fn count(&self) -> usize {
        self.models.iter().map(|model| model.caches.len() * model.instances.len()).sum()
    }

    fn make(scene: &Scene, models: Vec<Model>, spacing: Spacing) -> Result<Self> {
        let area: f64 = models.iter().map(|model| model.area()).sum();
        let most = area / f64::from(samples::edge(spacing)).powi(2) * 4.0;
        if most > MOST_SAMPLES {
            let least = f64::from(spacing.distance) * (most / MOST_SAMPLES).sqrt();
            return Err(fail!(
                BadInput,
                "gather.light_caches.distance: {} m is too small for the {area:.0} m^2 of {}; take {least:.2} or more",
                spacing.distance,
                scene.name
            ));
        }
        let models = models.into_par_iter().map(|model| of_model(model, spacing)).collect();
        Ok(Self { models })
    }

    /// Caches and lists; which draws there are is no part of it.
    fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for model in &self.models {
            let head = [model.caches.len() as u32, model.first_vertex, model.neighbours.len() as u32];
            bytes.extend_from_slice(bytemuck::cast_slice(&head));
            bytes.extend_from_slice(bytemuck::cast_slice(&model.caches));
            bytes.extend_from_slice(bytemuck::cast_slice(&model.neighbours));
        }
        bytes
    }

    /// The caches of these models; `None` if the bytes are not of them.
    fn from_bytes(mut bytes: &[u8], models: &[Model]) -> Option<Self> {
        fn take<T: bytemuck::Pod>(bytes: &mut &[u8], count: usize) -> Option<Vec<T>> {
            let (head, tail) = bytes.split_at_checked(count.checked_mul(size_of::<T>())?)?;
            *bytes = tail;
            Some(bytemuck::pod_collect_to_vec(head))
        }
        let models = models.iter().map(|model| {
            let head: Vec<u32> = take(&mut bytes, 3)?;
            Some(ModelCaches {
                caches: take(&mut bytes, head[0] as usize)?,
                first_vertex: head[1],
                neighbours: take(&mut bytes, head[2] as usize)?,
                instances: model.instances.clone(),
            })
        });
        let models = models.collect::<Option<Vec<_>>>()?;
        bytes.is_empty().then_some(Self { models })
    }
}

/// A tree of places with their numbers.
type Tree = KdTree3<([f32; 3], u32)>;

fn of_model(model: Model, spacing: Spacing) -> ModelCaches {
    let samples = samples::of(&model, spacing);
    let places = place::places(&samples, spacing);
    let tree: Tree = KdTree3::build_by_ordered_float((0..).zip(&places).map(|(i, place)| (place.position.to_array(), i)).collect());
    let surfaces = surfaces(&model, &samples, &places, &tree, spacing);
    let caches =
        places.iter().zip(&surfaces).map(|(place, surface)| fixed(&model, &samples[place.sample], place.normal, surface)).collect();
    let (first_vertex, neighbours) = neighbours(&model.positions(), &tree);
    ModelCaches { caches, first_vertex, neighbours, instances: model.instances }
}

/// Numbers of the nearest places, nearest first.
fn nearest(tree: &Tree, position: Vec3) -> Vec<u32> {
    let mut found: Vec<(f32, u32)> =
        tree.nearests(&position.to_array(), NEIGHBOURS).iter().map(|near| (near.squared_distance, near.item.1)).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    found.into_iter().take(NEIGHBOURS).map(|(_, number)| number).collect()
}

/// Surface that a place stands for.
#[derive(Debug, Clone, Copy, Default)]
struct Surface {
    /// m^2.
    area: f64,
    /// The same seen along the place's normal.
    seen: f64,
    /// Moments of what is seen, along two axes in the place's tangent plane: m^3, and m^4 of their products.
    first: [f64; 2],
    second: [f64; 3],
}

impl Surface {
    /// Adds a sample, at a place along two axes, and with edges along these.
    fn add(&mut self, sample: &Sample, cosine: f32, at: [f32; 2], edges: [[f32; 2]; 2]) {
        let [area, seen, u, v] = [sample.area, sample.area * cosine, at[0], at[1]].map(f64::from);
        let [[u0, v0], [u1, v1]] = edges.map(|edge| edge.map(f64::from));
        // Moments of a triangle about its middle.
        let own = |a: f64, b: f64, c: f64, d: f64| (a * b + c * d - 0.5 * (a * d + c * b)) / 18.0;
        self.area += area;
        self.seen += seen;
        self.first = [self.first[0] + seen * u, self.first[1] + seen * v];
        let second = [u * u + own(u0, u0, u1, u1), v * v + own(v0, v0, v1, v1), u * v + own(u0, v0, u1, v1)];
        self.second = std::array::from_fn(|k| self.second[k] + seen * second[k]);
    }

    /// Area of a rectangle with the second moments of what is seen, m^2: it is that of a flat surface without gaps or overlaps.
    fn silhouette(&self) -> f64 {
        if self.seen <= 0.0 {
            return self.area;
        }
        let mean = self.first.map(|sum| sum / self.seen);
        let [uu, vv, uv] = self.second.map(|sum| sum / self.seen);
        let (uu, vv, uv) = (uu - mean[0] * mean[0], vv - mean[1] * mean[1], uv - mean[0] * mean[1]);
        12.0 * (uu * vv - uv * uv).max(0.0).sqrt()
    }
}

/// Surface that each place stands for: a discrete Voronoi diagram, in which a difference of normals counts as a distance.
fn surfaces(model: &Model, samples: &[Sample], places: &[place::Place], tree: &Tree, spacing: Spacing) -> Vec<Surface> {
    let turned = 0.25 * spacing.distance * spacing.distance;
    let owner = |sample: &Sample| {
        let distance =
            |place: &place::Place| place.position.distance_squared(sample.position) + turned * place.normal.distance_squared(sample.normal);
        nearest(tree, sample.position).into_iter().min_by(|a, b| distance(&places[*a as usize]).total_cmp(&distance(&places[*b as usize])))
    };
    let owners: Vec<Option<u32>> = samples.par_iter().map(owner).collect();
    let mut surfaces = vec![Surface::default(); places.len()];
    for (owner, sample) in owners.iter().zip(samples) {
        if let Some(owner) = owner {
            let place = &places[*owner as usize];
            let (u, v) = place.normal.any_orthonormal_pair();
            let along = |way: Vec3| [way.dot(u), way.dot(v)];
            let [a, b, c] = model.triangles[sample.triangle as usize].positions;
            let edges = sample.edges.map(|edge| along(edge[0] * (b - a) + edge[1] * (c - a)));
            let cosine = place.normal.dot(sample.normal).max(0.0);
            surfaces[*owner as usize].add(sample, cosine, along(sample.position - place.position), edges);
        }
    }
    surfaces
}

/// A cache at a sample's place on its triangle.
fn fixed(model: &Model, sample: &Sample, normal: Vec3, surface: &Surface) -> LightCache {
    let triangle = &model.triangles[sample.triangle as usize];
    let [a, b, c] = triangle.positions;
    let along = (b - a).normalize_or_zero();
    let facing = (b - a).cross(c - a);
    let up = facing.normalize_or_zero();
    let (triangle_area, silhouette) = (0.5 * f64::from(facing.length()), surface.silhouette());
    LightCache {
        corners: triangle.corners,
        draw: triangle.draw,
        weights: sample.weights,
        normal: [normal.dot(along), normal.dot(up.cross(along)), normal.dot(up)],
        share: (surface.area / triangle_area) as f32,
        silhouette: (silhouette / triangle_area) as f32,
        opacity: (surface.seen / silhouette.max(1e-30)).min(1.0) as f32,
        one_of_two: u32::from(triangle.double_sided),
    }
}

/// Lists of the vertices from the first one on that the model has.
fn neighbours(positions: &[(u32, Vec3)], tree: &Tree) -> (u32, Vec<[u32; NEIGHBOURS]>) {
    let (Some(first), Some(last)) = (positions.first(), positions.last()) else { return (0, Vec::new()) };
    let mut lists = vec![[NONE; NEIGHBOURS]; (last.0 - first.0 + 1) as usize];
    let found: Vec<[u32; NEIGHBOURS]> = positions
        .par_iter()
        .map(|(_, position)| {
            let mut list = [NONE; NEIGHBOURS];
            list.iter_mut().zip(nearest(tree, *position)).for_each(|(entry, number)| *entry = number);
            list
        })
        .collect();
    positions.iter().zip(found).for_each(|((vertex, _), list)| lists[(vertex - first.0) as usize] = list);
    (first.0, lists)
}
