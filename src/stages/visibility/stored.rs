//! Stored points (Ritschel et al. 2008; Barak et al. 2013, section 5.1): made once on the host, as a triangle and a place in it, 8 bytes each.
//!
//! Points are stratified over the running sum of what the triangles are due, their areas: every triangle has its share of them to within one
//! point. Unless small triangles are thinned out, each has one point at least. Points follow their triangles: a point stands for the same
//! share of its triangle's area in every pose.

use super::poses::Poses;
use crate::gpu::{BufferId, Gpu, VertexLayout};
use crate::graph::{Buffer, Graph};
use crate::scene::Scene;
use crate::{shader_struct, vertex_layout};
use anyhow::Result;
use rayon::prelude::*;

shader_struct! {
    /// A stored point: `glsl/visibility/points-stored.comp`.
    pub struct StoredPoint {
        /// Index in its segment's triangles.
        pub triangle: u32,
        /// Weights of the second and the third corner, 16 bits each; all three sum to 65535.
        pub weights: u32,
    }

    /// A triangle that has points: `glsl/visibility/stored.glsl`.
    pub struct StoredTriangle {
        /// Indices of its vertices.
        pub corners: [u32; 3],
        pub draw: u32,
        /// Share of the triangle's area that each of its points stands for. It is over 1 where points are fewer than triangles.
        pub share: f32,
    }
}

/// Vertex layout of a point that is drawn.
pub const RECORD: VertexLayout = vertex_layout!(StoredPoint { triangle: Uint, weights: Uint });

/// Points of a scene. The device owns the buffers.
pub struct Stored(Vec<Segment>);

/// Points that fit into one buffer, with the triangles that they lie on.
struct Segment {
    records: (BufferId, u32),
    triangles: (BufferId, u32),
}

/// A segment in one frame's graph.
#[derive(Debug, Clone, Copy)]
pub struct FrameSegment {
    /// [`StoredPoint`]s, in an order that spreads any range of them over all surfaces.
    pub records: Buffer,
    /// [`StoredTriangle`]s.
    pub triangles: Buffer,
}

impl Stored {
    /// Makes `count` points of a scene, which stands at second 0 of its animation; `thin` is as in [`make`]. No buffer is over `most_bytes`, here or where each point
    /// becomes one of 16 bytes.
    ///
    /// # Errors
    /// The device's own, when memory runs out.
    pub fn upload(gpu: &mut Gpu, scene: &Scene, count: u32, thin: bool, most_bytes: u64) -> Result<Self> {
        let segments = make(scene, count, thin, [most_bytes / 16, most_bytes / size_of::<StoredTriangle>() as u64]);
        let segments = segments.map(|(records, triangles)| {
            Ok(Segment {
                records: (gpu.create_filled_buffer("scene/stored-points", bytemuck::cast_slice(&records))?, records.len() as u32),
                triangles: (gpu.create_filled_buffer("scene/stored-triangles", bytemuck::cast_slice(&triangles))?, triangles.len() as u32),
            })
        });
        segments.collect::<Result<_>>().map(Self)
    }

    /// Imports the points into a frame's graph.
    pub fn import(&self, g: &mut Graph) -> Vec<FrameSegment> {
        let import = |(number, segment): (u32, &Segment)| {
            g.again(number, |g| FrameSegment {
                records: g.import_buffer::<StoredPoint>("scene/stored-points", segment.records.0, segment.records.1),
                triangles: g.import_buffer::<StoredTriangle>("scene/stored-triangles", segment.triangles.0, segment.triangles.1),
            })
        };
        (1..).zip(&self.0).map(import).collect()
    }
}

/// Points and triangles of a segment, as they are stored.
pub type HostSegment = (Vec<StoredPoint>, Vec<StoredTriangle>);

/// Makes `count` points of a scene in segments, of at most `most` points and triangles. Points are by area alone if `thin`, or if there are
/// fewer than triangles; otherwise every triangle has one at least. A scene without area has none.
pub fn make(scene: &Scene, count: u32, thin: bool, most: [u64; 2]) -> impl Iterator<Item = HostSegment> {
    let (triangles, ends) = dues(scene, count, thin);
    let owners = owners(&ends, count);
    let begins = cut(&owners, most.map(|most| most.max(1) as usize));
    let ranges: Vec<_> = begins.windows(2).map(|pair| pair[0]..pair[1]).collect();
    ranges.into_iter().map(move |range| segment(&triangles, &ends, &owners, range, count))
}

/// All triangles, and the running sum of what they are due, with 0 before it: areas as they are when they are largest, or whole points.
fn dues(scene: &Scene, count: u32, thin: bool) -> (Vec<StoredTriangle>, Vec<f64>) {
    let poses = Poses::of(scene);
    let (mut triangles, mut areas) = (Vec::new(), Vec::new());
    for (number, draw) in scene.draws.iter().enumerate() {
        let indices = &scene.indices[draw.first_index as usize..(draw.first_index + draw.index_count) as usize];
        for corners in indices.chunks_exact(3) {
            let corners = [0, 1, 2].map(|k| corners[k] + draw.vertex_offset);
            triangles.push(StoredTriangle { corners, draw: number as u32, share: 0.0 });
        }
        areas.extend(poses.areas(scene, number));
    }
    let numbers = if thin { None } else { numbers(&areas, count) };
    let dues = numbers.unwrap_or_else(|| areas.iter().map(|area| f64::from(*area)).collect());
    let mut end = 0.0;
    let ends: Vec<f64> = std::iter::once(0.0)
        .chain(dues.iter().map(|due| {
            end += due;
            end
        }))
        .collect();
    let each = end / f64::from(count);
    triangles.iter_mut().zip(&dues).for_each(|(triangle, due)| triangle.share = (each / due) as f32);
    (triangles, ends)
}

/// Number of points of each triangle, `count` in all: one for each small triangle, and the rest by area among the others. `None` if there
/// are fewer points than triangles.
fn numbers(areas: &[f32], count: u32) -> Option<Vec<f64>> {
    // Triangles whose share of the rest is less than one point are small. Taking them out leaves less to the others.
    let mut least = 0.0f32;
    let (rest, area) = loop {
        let small = areas.iter().filter(|area| **area > 0.0 && **area <= least).count();
        let rest = u64::from(count).checked_sub(small as u64)?;
        let area: f64 = areas.iter().filter(|area| **area > least).map(|area| f64::from(*area)).sum();
        let smaller = areas.iter().copied().filter(|each| *each > least && f64::from(*each) * rest as f64 <= area).fold(least, f32::max);
        if smaller == least {
            break (rest, area);
        }
        least = smaller;
    };
    let (mut sum, mut given) = (0.0, 0.0);
    let number = |each: &f32| {
        if *each <= least {
            return f64::from(u8::from(*each > 0.0));
        }
        sum += f64::from(*each);
        let before = std::mem::replace(&mut given, (sum / area * rest as f64 + 0.5).floor());
        given - before
    };
    Some(areas.iter().map(number).collect())
}

/// Place of point `i` of `count` in the running sum that ends at `end`: at random in its own stratum.
fn place(i: u32, count: u32, end: f64) -> f64 {
    (f64::from(i) + f64::from(hash(i, 0)) / 4_294_967_296.0) * (end / f64::from(count))
}

/// Triangle of each point.
fn owners(ends: &[f64], count: u32) -> Vec<u32> {
    let end = ends[ends.len() - 1];
    if end <= 0.0 {
        return Vec::new();
    }
    const RUN: usize = 1 << 14;
    let mut owners = vec![0u32; count as usize];
    owners.par_chunks_mut(RUN).enumerate().for_each(|(run, owners)| {
        let first = (run * RUN) as u32;
        // The last triangle with area whose begin is at or below the place; those without area are passed by.
        let mut triangle = ends.partition_point(|end| *end <= place(first, count, ends[ends.len() - 1])).clamp(1, ends.len() - 1) - 1;
        for (owner, i) in owners.iter_mut().zip(first..) {
            let at = place(i, count, end);
            while triangle + 2 < ends.len() && ends[triangle + 1] <= at {
                triangle += 1;
            }
            *owner = triangle as u32;
        }
    });
    owners
}

/// Begins of the segments, and the end of the last one: about equal, with at most so many points and triangles in each.
fn cut(owners: &[u32], most: [usize; 2]) -> Vec<usize> {
    let parts = owners.len().div_ceil(most[0]).max(1);
    let most = [owners.len().div_ceil(parts).max(1), most[1]];
    let mut begins = vec![0];
    let (mut begin, mut triangles) = (0, 0);
    for (i, owner) in owners.iter().enumerate() {
        let new = usize::from(i == begin || owners[i - 1] != *owner);
        if i - begin == most[0] || triangles + new > most[1] {
            begins.push(i);
            (begin, triangles) = (i, 1);
        } else {
            triangles += new;
        }
    }
    begins.extend((!owners.is_empty()).then_some(owners.len()));
    begins
}

/// Points of a range, with their own triangles.
fn segment(all: &[StoredTriangle], ends: &[f64], owners: &[u32], range: std::ops::Range<usize>, count: u32) -> HostSegment {
    let (owners, first) = (&owners[range.clone()], range.start as u32);
    let mut triangles = Vec::new();
    let mut local = Vec::with_capacity(owners.len());
    for (i, owner) in owners.iter().enumerate() {
        if i == 0 || owners[i - 1] != *owner {
            triangles.push(all[*owner as usize]);
        }
        local.push(triangles.len() as u32 - 1);
    }
    let end = ends[ends.len() - 1];
    let record = |at: u32| {
        let (i, at) = (first + at, at as usize);
        let [begin, close] = [0, 1].map(|next| ends[owners[at] as usize + next]);
        // The place within the triangle's stretch of the running sum is one of two coordinates: they are stratified within the triangle.
        let across = ((place(i, count, end) - begin) / (close - begin)).clamp(0.0, 1.0).sqrt();
        let along = f64::from(hash(i, 1)) / 4_294_967_296.0;
        let weight = |weight: f64| (weight * 65_535.0) as u32;
        StoredPoint { triangle: local[at], weights: weight(across * (1.0 - along)) | weight(across * along) << 16 }
    };
    (order(owners.len() as u32).map(record).collect(), triangles)
}

/// Order of `length` points: their radical inverse in base 2, scrambled (Owen 1995, by the hash of Burley 2020). Any run of it has a point in
/// each of as many equal strata, at random, and so has what one map gets. An order with an even step would beat with the rows of a mesh.
fn order(length: u32) -> impl ParallelIterator<Item = u32> {
    let bits = length.next_power_of_two().ilog2();
    let inverse = move |i: u32| {
        let mut x = i ^ i.wrapping_mul(0x3d20_adea);
        x = x.wrapping_add(0x68bc_21eb).wrapping_mul(0x02e5_be93);
        x ^= x.wrapping_mul(0x0552_6c56);
        x ^= x.wrapping_mul(0x53a2_2864);
        (u64::from(x.reverse_bits()) >> (32 - bits)) as u32
    };
    (0..1u32 << bits).into_par_iter().map(inverse).filter(move |at| *at < length)
}

/// Random bits of a point, in dimension 0 or 1 (Wellons' `lowbias32`).
fn hash(i: u32, dimension: u32) -> u32 {
    let mut x = i ^ dimension.wrapping_mul(0x9e37_79b9);
    x = (x ^ x >> 16).wrapping_mul(0x7feb_352d);
    x = (x ^ x >> 15).wrapping_mul(0x846c_a68b);
    x ^ x >> 16
}
