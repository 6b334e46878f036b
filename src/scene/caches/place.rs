//! Where caches are placed: surfaces of alike normal in each voxel, then joined across voxels.

use super::Spacing;
use super::samples::Sample;
use glam::{IVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Place of a cache.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// On the surface: that of a sample among those it was averaged from.
    pub position: Vec3,
    /// Mean of their normals.
    pub normal: Vec3,
    /// The sample that it is at.
    pub sample: usize,
    /// Surface that was averaged, m^2, and its distance, at most.
    area: f32,
    reach: f32,
}

/// Side of a voxel is this part of the spacing's distance.
const VOXEL: f32 = 0.5;

/// Offset of the voxels' grid, in voxels, so that walls at round coordinates do not lie between two.
const OFFSET: Vec3 = Vec3::new(0.31, 0.47, 0.23);

/// Samples of a place that are tried for it, at most.
const CANDIDATES: usize = 16;

/// Distance, in units of the spacing's, at which places of different voxels are joined.
const JOINED: f32 = 0.25;

/// Places of caches on a model, in the order of the voxels that they are from.
pub(super) fn places(samples: &[Sample], spacing: Spacing) -> Vec<Place> {
    let side = VOXEL * spacing.distance;
    let voxel = |sample: &Sample| (sample.position / side + OFFSET).floor().as_ivec3().to_array();
    let mut order: Vec<([i32; 3], u32)> = samples.par_iter().map(voxel).zip(0..samples.len() as u32).collect();
    order.par_sort_unstable();
    let voxels: Vec<&[([i32; 3], u32)]> = order.chunk_by(|a, b| a.0 == b.0).collect();
    let found: Vec<Place> = voxels.par_iter().flat_map_iter(|voxel| of_voxel(samples, voxel, spacing)).collect();
    joined(found, spacing)
}

/// Directions of the normals' bins: those from a cube's centre to the middles of its faces and edges, and to its corners.
fn bins() -> impl Iterator<Item = Vec3> {
    let all = (0..27).map(|i| Vec3::new((i % 3 - 1) as f32, (i / 3 % 3 - 1) as f32, (i / 9 - 1) as f32));
    all.filter_map(Vec3::try_normalize)
}

/// Places in one voxel. Each round takes the bin with the largest surface, and averages all surface whose normal is within the angle of the
/// bin's mean. It takes one sample of the bin at least, so that rounds end.
fn of_voxel(samples: &[Sample], voxel: &[([i32; 3], u32)], spacing: Spacing) -> Vec<Place> {
    let bins: Vec<Vec3> = bins().collect();
    let bin_of = |sample: &Sample| {
        let dots = bins.iter().map(|bin| bin.dot(sample.normal));
        dots.enumerate().fold((0, f32::NEG_INFINITY), |most, (i, dot)| if dot > most.1 { (i, dot) } else { most }).0
    };
    let mut left: Vec<(usize, usize)> = voxel.iter().map(|(_, number)| (*number as usize, bin_of(&samples[*number as usize]))).collect();
    let mut places = Vec::new();
    while !left.is_empty() {
        let mut sums = vec![(0.0f32, Vec3::ZERO); bins.len()];
        for (number, bin) in &left {
            let sample = &samples[*number];
            sums[*bin].0 += sample.area;
            sums[*bin].1 += sample.area * sample.normal;
        }
        let largest = (0..bins.len()).fold(0, |most, bin| if sums[bin].0 > sums[most].0 { bin } else { most });
        let centre = sums[largest].1.normalize_or(bins[largest]);
        let dot = |number: usize| samples[number].normal.dot(centre);
        let of_bin = left.iter().filter(|(_, bin)| *bin == largest).map(|(number, _)| *number);
        let Some(nearest) = of_bin.reduce(|a, b| if dot(b) > dot(a) { b } else { a }) else {
            unreachable!("the bin with the largest surface has some")
        };
        let least = spacing.angle.cos();
        let (taken, rest): (Vec<_>, Vec<_>) = left.into_iter().partition(|(number, _)| *number == nearest || dot(*number) >= least);
        left = rest;
        places.push(place(samples, voxel, &taken, spacing));
    }
    places
}

/// Place for the mean of samples of a voxel: at the nearest of them, or at one nearby that little stands before.
fn place(samples: &[Sample], voxel: &[([i32; 3], u32)], taken: &[(usize, usize)], spacing: Spacing) -> Place {
    let taken = || taken.iter().map(|(number, _)| (*number, &samples[*number]));
    let (mut area, mut position, mut normal) = (0.0, Vec3::ZERO, Vec3::ZERO);
    let origin = taken().next().map_or(Vec3::ZERO, |(_, sample)| sample.position);
    for (_, sample) in taken() {
        area += sample.area;
        position += sample.area * (sample.position - origin);
        normal += sample.area * sample.normal;
    }
    let position = origin + position / area;
    let mut by_distance: Vec<(f32, usize)> = taken().map(|(number, sample)| (sample.position.distance_squared(position), number)).collect();
    by_distance.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let stride = if spacing.open { by_distance.len().div_ceil(CANDIDATES) } else { by_distance.len() };
    // A place without anything before it is worth a way of a voxel's side.
    let side = VOXEL * spacing.distance;
    let cost = |(distance, number): (f32, usize)| {
        let covered = if spacing.open { covered(&samples[number], voxel.iter().map(|(_, other)| &samples[*other as usize])) } else { 0.0 };
        distance + side * side * covered
    };
    let candidates = by_distance.iter().step_by(stride);
    let least = candidates.map(|candidate| (cost(*candidate), candidate.1)).reduce(|a, b| if b.0 < a.0 { b } else { a });
    let Some((_, sample)) = least else { unreachable!("a place has samples") };
    let position = samples[sample].position;
    let reach = taken().map(|(_, sample)| sample.position.distance(position)).fold(0.0, f32::max);
    Place { position, normal: normal.normalize_or(samples[sample].normal), sample, area, reach }
}

/// Share of the light of an even sky that surface keeps from a sample: form factors, as if no surface were behind another.
fn covered<'s>(at: &Sample, surface: impl Iterator<Item = &'s Sample>) -> f32 {
    let form_factor = |other: &Sample| {
        let way = other.position - at.position;
        let (squared, up) = (way.length_squared(), at.normal.dot(way));
        if up > 0.0 {
            other.area * up * other.normal.dot(way).abs() / (squared * (other.area + std::f32::consts::PI * squared))
        } else {
            0.0
        }
    };
    surface.map(form_factor).sum::<f32>().min(1.0)
}

/// Joins places: those with less surface give way to a place nearby with an alike normal, if all of their surface is within the distance
/// of that.
fn joined(found: Vec<Place>, spacing: Spacing) -> Vec<Place> {
    let radius = JOINED * spacing.distance;
    let mut order: Vec<usize> = (0..found.len()).collect();
    order.sort_by(|a, b| found[*b].area.total_cmp(&found[*a].area).then(a.cmp(b)));
    let cell = |place: &Place| (place.position / radius).floor().as_ivec3();
    let mut kept: HashMap<IVec3, Vec<usize>> = HashMap::new();
    let mut stays = vec![true; found.len()];
    for number in order {
        let place = &found[number];
        let gives_way_to = |other: &usize| {
            let other = &found[*other];
            let distance = other.position.distance(place.position);
            distance <= radius && distance + place.reach <= spacing.distance && other.normal.dot(place.normal) >= spacing.angle.cos()
        };
        let around = (0..27).map(|i| cell(place) + IVec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
        if around.filter_map(|cell| kept.get(&cell)).flatten().any(gives_way_to) {
            stays[number] = false;
        } else {
            kept.entry(cell(place)).or_default().push(number);
        }
    }
    found.into_iter().zip(stays).filter_map(|(place, stays)| stays.then_some(place)).collect()
}
