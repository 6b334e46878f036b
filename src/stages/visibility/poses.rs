//! Poses in which a scene's triangles are largest. What is laid out once, the number of points above all, is laid out for these: a mesh that
//! starts at 2 % of its size would otherwise go without points for ever.

use crate::scene::animation::single;
use crate::scene::{Draw, Scene, Vertex};
use glam::{Affine3A, Vec3};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Poses of all draws.
pub(super) struct Poses {
    /// Transforms of each draw: the present one and, if its areas change, those in which they are largest.
    of_draws: Vec<Vec<Affine3A>>,
    /// Areas of the triangles of draws that bend, the largest of all times, m^2.
    of_bent: BTreeMap<usize, Vec<f32>>,
    /// Whether the area of any triangle changes with time.
    pub grows: bool,
}

/// Times at which meshes that bend are measured, about.
const TIMES: usize = 16;

/// Relative change of area under which a transform counts as rigid.
const RIGID: f32 = 1e-4;

impl Poses {
    /// Poses of a scene's draws over the whole animation.
    pub fn of(scene: &Scene) -> Self {
        let mut of_draws: Vec<Vec<Affine3A>> = scene.draws.iter().map(|draw| vec![draw.transform]).collect();
        let of_bent = BTreeMap::new();
        let Some(animation) = &scene.animation else { return Self { of_draws, of_bent, grows: false } };
        // For each of the three planes of a draw's space: the least and the greatest growth of an area in it, and the pose of the latter.
        let mut spans = vec![[(f32::INFINITY, 0.0f32, Affine3A::IDENTITY); 3]; animation.draws.len()];
        for seconds in animation.samples() {
            let worlds = animation.worlds(seconds);
            for (hung, planes) in animation.draws.iter().zip(&mut spans) {
                let pose = single(worlds[hung.node]);
                for (plane, growth) in planes.iter_mut().zip(growths(&pose)) {
                    plane.0 = plane.0.min(growth);
                    if growth > plane.1 {
                        (plane.1, plane.2) = (growth, pose);
                    }
                }
            }
        }
        let mut grows = false;
        for (hung, planes) in animation.draws.iter().zip(spans) {
            if planes.iter().any(|(least, most, _)| *most > least * (1.0 + RIGID)) {
                grows = true;
                of_draws[hung.index].extend(planes.map(|(_, _, pose)| pose));
            }
        }
        let of_bent = bent_areas(scene, &animation.samples());
        grows |= !of_bent.is_empty();
        Self { of_draws, of_bent, grows }
    }

    /// Areas of a draw's triangles in the pose in which each is largest, m^2.
    pub fn areas(&self, scene: &Scene, number: usize) -> Vec<f32> {
        let draw = &scene.draws[number];
        let mut areas = self.of_bent.get(&number).cloned().unwrap_or_else(|| vec![0.0f32; draw.index_count as usize / 3]);
        for pose in &self.of_draws[number] {
            enlarge(&mut areas, &scene.vertices, &scene.indices, draw, pose);
        }
        areas
    }
}

/// Areas of the triangles of all draws that bend, the largest of about [`TIMES`] times.
fn bent_areas(scene: &Scene, times: &[f64]) -> BTreeMap<usize, Vec<f32>> {
    let mut of_bent = BTreeMap::new();
    let Some(bending) = &scene.bending else { return of_bent };
    let bent: Vec<usize> = (0..scene.draws.len()).filter(|number| bending.mesh_of(&scene.draws[*number]).is_some()).collect();
    let (vertices, draws, animation) = (scene.vertices.clone(), scene.draws.clone(), scene.animation.clone());
    let mut moved = Scene { vertices, draws, animation, bending: Some(bending.clone()), ..Scene::default() };
    let mut times = times.to_vec();
    times.sort_by(f64::total_cmp);
    for seconds in times.iter().step_by(times.len().div_ceil(TIMES).max(1)) {
        moved.set_time(*seconds);
        for number in &bent {
            let draw = &moved.draws[*number];
            let areas: &mut Vec<f32> = of_bent.entry(*number).or_insert_with(|| vec![0.0; draw.index_count as usize / 3]);
            enlarge(areas, &moved.vertices, &scene.indices, draw, &draw.transform);
        }
    }
    of_bent
}

/// Enlarges areas to those of a draw's triangles in a pose.
fn enlarge(areas: &mut [f32], vertices: &[Vertex], indices: &[u32], draw: &Draw, pose: &Affine3A) {
    areas.par_iter_mut().enumerate().with_min_len(4096).for_each(|(i, most)| *most = most.max(area(vertices, indices, draw, pose, i)));
}

/// Growth of areas in the planes y z, z x and x y.
fn growths(pose: &Affine3A) -> [f32; 3] {
    let [x, y, z] = [pose.matrix3.x_axis, pose.matrix3.y_axis, pose.matrix3.z_axis];
    [y.cross(z).length(), z.cross(x).length(), x.cross(y).length()]
}

/// Area of triangle `i` of a draw in a pose, m^2.
fn area(vertices: &[Vertex], indices: &[u32], draw: &Draw, pose: &Affine3A, i: usize) -> f32 {
    let corner = |k: usize| -> Vec3 {
        let index = indices[draw.first_index as usize + 3 * i + k];
        pose.transform_point3(vertices[(draw.vertex_offset + index) as usize].position.into())
    };
    let [a, b, c] = [corner(0), corner(1), corner(2)];
    0.5 * (b - a).cross(c - a).length()
}
