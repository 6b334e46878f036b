//! The court's materials. Albedos of stone, plaster and cloth are between 0.2 and 0.75.

use super::super::materials::{adder, cloth, foliage, metallic, plain};
use super::super::texels::Fields;
use super::textures;
use crate::scene::{Map, Material, Scene};

/// Indices of the court's materials.
#[derive(Debug, Clone, Copy)]
pub struct Palette {
    pub stone: u32,
    pub ashlar: u32,
    pub plaster_cream: u32,
    pub plaster_ochre: u32,
    pub plaster_umber: u32,
    pub plaster_rose: u32,
    pub plaster_white: u32,
    pub paving: u32,
    pub border: u32,
    pub tiles: u32,
    pub roof: u32,
    pub lead: u32,
    pub wood: u32,
    pub boards: u32,
    pub cloth_red: u32,
    pub cloth_green: u32,
    pub cloth_blue: u32,
    pub banner_red: u32,
    pub banner_green: u32,
    pub banner_blue: u32,
    pub majolica: u32,
    pub terracotta: u32,
    pub soil: u32,
    pub bark: u32,
    pub leaves: u32,
    pub agave: u32,
    pub orange: u32,
    pub bronze: u32,
    pub brass: u32,
    pub glass: u32,
    pub water: u32,
}

/// Adds the court's textures and materials to a scene.
pub fn add(scene: &mut Scene, seed: u32) -> Palette {
    let fields = Fields::new(seed);
    let [
        limestone,
        ashlar,
        ashlar_normal,
        plaster,
        paving,
        paving_normal,
        paving_surface,
        tiles,
        roof,
        wood,
        weave,
        red,
        green,
        blue,
        leaf,
        metal,
        glow,
    ] = textures::all(&fields, seed).map(|texture| Map::new(scene.add_texture(texture)));

    let mut add = adder(scene);
    let paved = |m: &mut Material| {
        m.normal_map = Some(paving_normal);
        m.metallic_roughness_map = Some(paving_surface);
        m.roughness = 1.0;
    };
    Palette {
        stone: add("limestone", [0.70, 0.61, 0.47], Some(limestone), &|m| m.roughness = 0.7),
        ashlar: add("ashlar", [0.72, 0.58, 0.40], Some(ashlar), &|m| m.normal_map = Some(ashlar_normal)),
        plaster_cream: add("cream plaster", [0.75, 0.64, 0.44], Some(plaster), &plain),
        plaster_ochre: add("ochre plaster", [0.72, 0.46, 0.17], Some(plaster), &plain),
        plaster_umber: add("umber dado", [0.44, 0.15, 0.085], Some(plaster), &plain),
        plaster_rose: add("rose plaster", [0.66, 0.27, 0.17], Some(plaster), &plain),
        plaster_white: add("lime plaster", [0.77, 0.73, 0.65], Some(plaster), &plain),
        paving: add("paving", [0.56, 0.47, 0.37], Some(paving), &paved),
        border: add("paving border", [0.46, 0.25, 0.17], Some(paving), &paved),
        tiles: add("floor tiles", [1.0; 3], Some(tiles), &|m| m.roughness = 0.5),
        roof: add("roof tiles", [1.0; 3], Some(roof), &cloth),
        lead: add("lead", [0.34, 0.35, 0.37], None, &plain),
        wood: add("oak", [0.36, 0.20, 0.10], Some(wood), &|m| m.roughness = 0.6),
        boards: add("ceiling boards", [0.52, 0.33, 0.18], Some(wood), &|m| m.roughness = 0.7),
        cloth_red: add("red curtain", [0.68, 0.05, 0.04], Some(weave), &cloth),
        cloth_green: add("green curtain", [0.07, 0.38, 0.12], Some(weave), &cloth),
        cloth_blue: add("blue curtain", [0.05, 0.16, 0.58], Some(weave), &cloth),
        banner_red: add("red banner", [1.0; 3], Some(red), &cloth),
        banner_green: add("green banner", [1.0; 3], Some(green), &cloth),
        banner_blue: add("blue banner", [1.0; 3], Some(blue), &cloth),
        majolica: add("blue majolica", [0.07, 0.19, 0.50], None, &|m| m.roughness = 0.15),
        terracotta: add("terracotta", [0.62, 0.29, 0.16], Some(plaster), &|m| m.roughness = 0.8),
        soil: add("soil", [0.16, 0.10, 0.06], Some(plaster), &plain),
        bark: add("bark", [0.30, 0.21, 0.13], Some(wood), &plain),
        leaves: add("orange leaves", [1.0; 3], Some(leaf), &foliage),
        agave: add("agave", [0.22, 0.40, 0.24], Some(weave), &cloth),
        orange: add("oranges", [0.75, 0.30, 0.03], None, &|m| m.roughness = 0.5),
        bronze: add("bronze", [0.72, 0.45, 0.25], None, &metallic(metal, 0.9)),
        brass: add("brass", [0.86, 0.66, 0.32], None, &metallic(metal, 0.7)),
        glass: add("lantern glass", [0.75, 0.6, 0.35], None, &|m| {
            m.emission = [9.0, 5.2, 2.1];
            m.emission_map = Some(glow);
        }),
        water: add("water", [0.05, 0.22, 0.22], None, &|m| m.roughness = 0.05),
    }
}
