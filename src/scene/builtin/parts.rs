//! Parts of a built-in scene, and the search for the level of detail that has as many triangles as were asked for.

use super::Detail;
use crate::scene::Scene;
use crate::scene::builder::Mesh;
use glam::Affine3A;
use rayon::prelude::*;

/// A mesh with its instances.
pub struct Part {
    pub mesh: Mesh,
    /// Material of all instances, unless `materials` has one for each.
    material: u32,
    materials: Vec<u32>,
    transforms: Vec<Affine3A>,
}

impl Part {
    pub fn once(mesh: Mesh, material: u32) -> Self {
        Self::at(mesh, material, vec![Affine3A::IDENTITY])
    }

    pub fn at(mesh: Mesh, material: u32, transforms: Vec<Affine3A>) -> Self {
        Self { mesh, material, materials: Vec::new(), transforms }
    }

    /// Instances of a material each. The materials have normal maps all, or none of them has.
    pub fn painted(mesh: Mesh, instances: &[(Affine3A, u32)]) -> Self {
        let (transforms, materials): (Vec<_>, Vec<_>) = instances.iter().copied().unzip();
        Self { mesh, material: materials.first().copied().unwrap_or(0), materials, transforms }
    }

    /// Copies of a small mesh in one draw, cheaper than a draw per copy.
    pub fn merged(mesh: &Mesh, material: u32, places: &[Affine3A]) -> Self {
        let mut all = Mesh::default();
        places.iter().for_each(|&place| all.append(mesh, place));
        Self::once(all, material)
    }

    pub fn triangles(&self) -> usize {
        self.mesh.triangle_count() * self.transforms.len()
    }

    pub fn add_to(&self, scene: &mut Scene) {
        let first = scene.draws.len();
        scene.add_mesh(&self.mesh, self.material, &self.transforms);
        for (draw, material) in scene.draws[first..].iter_mut().zip(&self.materials) {
            draw.material = *material;
        }
    }
}

/// All parts of these makers, in their order, made at the same time.
pub fn of_all<P: Sync>(makers: &[fn(&P) -> Vec<Part>], plan: &P) -> Vec<Part> {
    makers.par_iter().flat_map(|make| make(plan)).collect()
}

/// The parts at the level of detail whose triangle count is nearest to `target`. Detail 1 has about `full` triangles.
pub fn of_size(target: u32, full: f32, parts: impl Fn(Detail) -> Vec<Part>) -> Vec<Part> {
    let target = target as f32;
    let build = |log: f32| parts(Detail(log.exp()));

    // The count grows nearly as the square of the detail at high levels, and in steps at low levels: a few Newton steps, then
    // bisection.
    let mut log = 0.5 * (target / full).ln();
    let (mut low, mut high) = (-4.0f32, 3.0f32);
    let mut best: Option<(f32, Vec<Part>)> = None;
    for step in 0..18 {
        let parts = build(log);
        let error = parts.iter().map(Part::triangles).sum::<usize>() as f32 / target - 1.0;
        if best.as_ref().is_none_or(|b| error.abs() < b.0.abs()) {
            best = Some((error, parts));
        }
        if error.abs() < 0.01 {
            break;
        }
        if error > 0.0 {
            high = log;
        } else {
            low = log;
        }
        let newton = log - 0.5 * error.ln_1p();
        log = if step < 4 && newton > low && newton < high { newton } else { 0.5 * (low + high) };
    }
    best.map_or_else(Vec::new, |b| b.1)
}
