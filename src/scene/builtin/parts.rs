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

/// The parts at the level of detail whose triangle count is nearest to `target`. Detail 1 has about `full` triangles, and their number
/// grows about as this power of the detail.
pub fn of_size(target: u32, full: f32, power: f32, parts: impl Fn(Detail) -> Vec<Part>) -> Vec<Part> {
    let target = target as f32;
    // Levels by their logarithms, between which the number is, and its logarithm over the target's there, once known.
    let (mut low, mut high) = ((-4.0f32, None), (3.0f32, None));
    let mut log = (target / full).ln() / power;
    let mut best: Option<(f32, Vec<Part>)> = None;
    for step in 0..18 {
        let parts = parts(Detail(log.exp()));
        let error = parts.iter().map(Part::triangles).sum::<usize>() as f32 / target - 1.0;
        if best.as_ref().is_none_or(|b| error.abs() < b.0.abs()) {
            best = Some((error, parts));
        }
        if error.abs() < 0.01 {
            break;
        }
        *(if error > 0.0 { &mut high } else { &mut low }) = (log, Some(error.ln_1p()));
        // A few Newton steps; then a line between the two levels and, as the number grows in steps at low levels, their middle by turns.
        let newton = log - error.ln_1p() / power;
        log = match (low.1, high.1) {
            _ if step < 4 && low.0 < newton && newton < high.0 => newton,
            (Some(below), Some(above)) if step % 2 == 0 => low.0 + (high.0 - low.0) * below / (below - above),
            _ => 0.5 * (low.0 + high.0),
        };
    }
    best.map_or_else(Vec::new, |b| b.1)
}
