//! Adding materials to built-in scenes.

use crate::scene::{Map, Material, Scene};

/// A change to a material.
type Change<'a> = dyn Fn(&mut Material) + 'a;

/// A function that adds a rough material of a name, a colour and its map, changed by the last argument, and returns its index.
pub fn adder(scene: &mut Scene) -> impl FnMut(&str, [f32; 3], Option<Map>, &Change) -> u32 {
    |name, [r, g, b], map, more| {
        let mut material =
            Material { name: name.into(), base_color: [r, g, b, 1.0], base_color_map: map, roughness: 0.9, ..Material::default() };
        more(&mut material);
        scene.add_material(material)
    }
}

/// A material as it is.
pub fn plain(_: &mut Material) {}

/// A sheet that is seen from both sides.
pub fn cloth(material: &mut Material) {
    material.double_sided = true;
}

/// Cut-out leaves.
pub fn foliage(material: &mut Material) {
    material.double_sided = true;
    material.alpha_cutoff = Some(0.5);
    material.roughness = 0.5;
}

/// Scuffed metal, whose map this is.
pub fn metallic(map: Map, roughness: f32) -> impl Fn(&mut Material) {
    move |material| {
        material.metallic = 1.0;
        material.roughness = roughness;
        material.metallic_roughness_map = Some(map);
    }
}
