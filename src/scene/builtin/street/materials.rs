//! The street's materials. Albedos of walls are between 0.25 and 0.75, and those of coloured panels and flags are of paint and dye: between
//! 0.04 and 0.8 in every channel.

use super::super::materials::{adder, cloth, foliage, metallic, plain};
use super::super::texels::Fields;
use super::textures;
use crate::scene::{Map, Material, Scene};

/// Indices of the street's materials.
#[derive(Debug, Clone, Copy)]
pub struct Palette {
    /// Walls, in the order of [`super::lots::Wall`].
    pub walls: [u32; 14],
    pub limestone: u32,
    pub lime: u32,
    pub glazing: u32,
    pub shop_glass: u32,
    pub frames: u32,
    pub iron: u32,
    pub steel: u32,
    pub shutters: [u32; 3],
    pub doors: [u32; 3],
    /// Signs over shops.
    pub signs: [u32; 5],
    pub awnings: [u32; 4],
    /// Flags, and the panels' colours: red, green, blue, yellow.
    pub flags: [u32; 4],
    pub panels: [u32; 4],
    pub clay: u32,
    pub slate: u32,
    pub gravel: u32,
    pub zinc: u32,
    pub pots: u32,
    pub asphalt: u32,
    pub lanes: u32,
    pub crossing: u32,
    pub slabs: u32,
    pub kerb: u32,
    pub posters: u32,
    pub bark: u32,
    pub leaves: u32,
    pub soil: u32,
    pub timber: u32,
    pub lamp_glass: u32,
    pub clock: u32,
    pub paints: [u32; 7],
    pub car_glass: u32,
    pub rubber: u32,
    pub hubs: u32,
    pub headlamps: u32,
    pub tail_lamps: u32,
}

/// Adds the street's textures and materials to a scene.
pub fn add(scene: &mut Scene, seed: u32) -> Palette {
    let fields = Fields::new(seed);
    let [
        limestone,
        ashlar,
        ashlar_normal,
        plaster,
        wood,
        weave,
        leaf,
        metal,
        brick,
        brick_normal,
        clay,
        clay_normal,
        slate,
        slate_normal,
        asphalt,
        lanes,
        crossing,
        slabs,
        slabs_normal,
        glazing,
        shops,
        posters,
        stripes @ ..,
    ] = textures::all(&fields, seed).map(|texture| Map::new(scene.add_texture(texture)));

    let mut add = adder(scene);
    let gloss = |m: &mut Material| m.roughness = 0.3;
    let bonded = |m: &mut Material| m.normal_map = Some(brick_normal);
    Palette {
        walls: [
            add("white plaster", [0.76, 0.74, 0.69], Some(plaster), &plain),
            add("cream plaster", [0.76, 0.68, 0.52], Some(plaster), &plain),
            add("grey plaster", [0.60, 0.61, 0.61], Some(plaster), &plain),
            add("sand plaster", [0.70, 0.58, 0.42], Some(plaster), &plain),
            add("blush plaster", [0.74, 0.56, 0.47], Some(plaster), &plain),
            add("pale blue plaster", [0.52, 0.61, 0.68], Some(plaster), &plain),
            add("coral plaster", [0.74, 0.24, 0.15], Some(plaster), &plain),
            add("ochre plaster", [0.78, 0.50, 0.14], Some(plaster), &plain),
            add("green plaster", [0.30, 0.50, 0.30], Some(plaster), &plain),
            add("blue plaster", [0.16, 0.33, 0.58], Some(plaster), &plain),
            add("turquoise plaster", [0.22, 0.54, 0.52], Some(plaster), &plain),
            add("red brick", [0.56, 0.24, 0.16], Some(brick), &bonded),
            add("yellow brick", [0.66, 0.51, 0.32], Some(brick), &bonded),
            add("ashlar", [0.74, 0.64, 0.49], Some(ashlar), &|m| m.normal_map = Some(ashlar_normal)),
        ],
        limestone: add("limestone", [0.72, 0.65, 0.53], Some(limestone), &|m| m.roughness = 0.7),
        lime: add("lime wash", [0.77, 0.74, 0.68], Some(plaster), &plain),
        glazing: add("glazing", [1.0; 3], Some(glazing), &gloss),
        shop_glass: add("shop windows", [1.0; 3], Some(shops), &gloss),
        frames: add("white frames", [0.72, 0.71, 0.67], None, &|m| m.roughness = 0.5),
        iron: add("wrought iron", [0.045, 0.047, 0.05], None, &|m| m.roughness = 0.5),
        steel: add("steel", [0.60, 0.60, 0.59], None, &metallic(metal, 0.9)),
        shutters: [
            add("green shutters", [0.10, 0.26, 0.15], Some(wood), &|m| m.roughness = 0.6),
            add("blue shutters", [0.15, 0.29, 0.45], Some(wood), &|m| m.roughness = 0.6),
            add("brown shutters", [0.34, 0.17, 0.09], Some(wood), &|m| m.roughness = 0.6),
        ],
        doors: [
            add("oak door", [0.40, 0.21, 0.10], Some(wood), &|m| m.roughness = 0.6),
            add("green door", [0.06, 0.22, 0.13], Some(wood), &|m| m.roughness = 0.5),
            add("red door", [0.45, 0.06, 0.05], Some(wood), &|m| m.roughness = 0.5),
        ],
        signs: [
            add("red sign", [0.50, 0.05, 0.05], None, &|m| m.roughness = 0.5),
            add("green sign", [0.05, 0.24, 0.13], None, &|m| m.roughness = 0.5),
            add("blue sign", [0.06, 0.15, 0.40], None, &|m| m.roughness = 0.5),
            add("black sign", [0.05, 0.05, 0.055], None, &|m| m.roughness = 0.5),
            add("cream sign", [0.74, 0.66, 0.50], None, &|m| m.roughness = 0.5),
        ],
        awnings: std::array::from_fn(|i| {
            let name = ["red awning", "green awning", "blue awning", "yellow awning"][i];
            add(name, [1.0; 3], Some(stripes[i]), &cloth)
        }),
        flags: [
            add("red flag", [0.70, 0.06, 0.055], Some(weave), &cloth),
            add("green flag", [0.07, 0.42, 0.14], Some(weave), &cloth),
            add("blue flag", [0.06, 0.17, 0.60], Some(weave), &cloth),
            add("yellow flag", [0.80, 0.55, 0.06], Some(weave), &cloth),
        ],
        panels: [
            add("red panel", [0.66, 0.07, 0.05], None, &plain),
            add("green panel", [0.07, 0.46, 0.12], None, &plain),
            add("blue panel", [0.06, 0.15, 0.58], None, &plain),
            add("yellow panel", [0.74, 0.54, 0.06], None, &plain),
        ],
        clay: add("clay tiles", [1.0; 3], Some(clay), &|m| m.normal_map = Some(clay_normal)),
        slate: add("slates", [1.0; 3], Some(slate), &|m| {
            m.normal_map = Some(slate_normal);
            m.roughness = 0.6;
        }),
        gravel: add("gravel", [0.75, 0.72, 0.68], Some(plaster), &plain),
        zinc: add("zinc", [0.42, 0.44, 0.46], None, &|m| m.roughness = 0.6),
        pots: add("chimney pots", [0.55, 0.26, 0.15], Some(plaster), &plain),
        asphalt: add("asphalt", [1.0; 3], Some(asphalt), &plain),
        lanes: add("lanes", [1.0; 3], Some(lanes), &plain),
        crossing: add("crossing", [1.0; 3], Some(crossing), &plain),
        slabs: add("slabs", [1.0; 3], Some(slabs), &|m| m.normal_map = Some(slabs_normal)),
        kerb: add("granite kerb", [0.56, 0.55, 0.54], Some(limestone), &|m| m.roughness = 0.7),
        posters: add("posters", [1.0; 3], Some(posters), &|m| m.roughness = 0.6),
        bark: add("bark", [0.27, 0.21, 0.15], Some(wood), &plain),
        leaves: add("leaves", [0.95, 1.0, 0.9], Some(leaf), &foliage),
        soil: add("soil", [0.16, 0.11, 0.07], Some(plaster), &plain),
        timber: add("bench slats", [0.44, 0.25, 0.12], Some(wood), &|m| m.roughness = 0.6),
        lamp_glass: add("lamp glass", [0.80, 0.78, 0.70], None, &gloss),
        clock: add("clock face", [0.80, 0.78, 0.72], None, &gloss),
        paints: [
            add("red car", [0.55, 0.03, 0.025], None, &gloss),
            add("white car", [0.74, 0.74, 0.72], None, &gloss),
            add("blue car", [0.04, 0.13, 0.38], None, &gloss),
            add("silver car", [0.48, 0.49, 0.50], None, &gloss),
            add("yellow car", [0.80, 0.52, 0.03], None, &gloss),
            add("black car", [0.035, 0.035, 0.04], None, &gloss),
            add("green car", [0.05, 0.21, 0.14], None, &gloss),
        ],
        car_glass: add("car glass", [0.035, 0.045, 0.05], None, &|m| m.roughness = 0.1),
        rubber: add("rubber", [0.035, 0.035, 0.036], None, &plain),
        hubs: add("hubs", [0.72, 0.72, 0.72], None, &metallic(metal, 0.9)),
        headlamps: add("headlamps", [0.78, 0.78, 0.75], None, &gloss),
        tail_lamps: add("tail lamps", [0.50, 0.02, 0.02], None, &gloss),
    }
}
