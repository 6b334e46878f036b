use super::*;
use crate::scene::builtin::probe::{check_normals, check_ranges, check_sight, hit, triangles};
use crate::scene::{Aabb, Light};

#[test]
fn the_number_of_triangles_is_met_within_five_percent() {
    let palette = materials::add(&mut Scene::default(), 1);
    for triangles in [
        20_000, 22_000, 25_000, 30_000, 40_000, 50_000, 75_000, 100_000, 140_000, 200_000, 260_000, 350_000, 500_000, 800_000, 1_300_000,
        2_000_000,
    ] {
        let made: usize = parts_of_size(&Street { triangles, seed: 1 }, palette).iter().map(Part::triangles).sum();
        let error = made as f64 / f64::from(triangles) - 1.0;
        assert!(error.abs() <= 0.05, "{triangles} asked for, {made} made: {:.1} %", 100.0 * error);
    }
}

#[test]
fn numbers_out_of_range_are_taken_to_the_nearer_end() {
    let palette = materials::add(&mut Scene::default(), 1);
    let made = |triangles| parts_of_size(&Street { triangles, seed: 1 }, palette).iter().map(Part::triangles).sum::<usize>();
    assert_eq!((made(0), made(u32::MAX)), (made(20_000), made(2_000_000)));
}

#[test]
fn the_same_seed_makes_the_same_bytes_and_another_one_others() {
    let make = |seed| street(&Street { triangles: 40_000, seed });
    let (a, b, other) = (make(7), make(7), make(8));
    assert_eq!(bytemuck::cast_slice::<_, u8>(&a.vertices), bytemuck::cast_slice::<_, u8>(&b.vertices));
    assert!(a.indices == b.indices && a.draws == b.draws && a.materials == b.materials && a.textures == b.textures);
    assert!(a.textures != other.textures && a.vertices != other.vertices && a.draws != other.draws);
}

#[test]
fn indices_materials_and_textures_are_in_range_and_all_numbers_finite() {
    check_ranges(&street(&Street::default()), 400);
}

#[test]
fn normals_agree_with_the_winding_and_no_triangle_is_degenerate() {
    for triangles in [20_000, 40_000, 75_000, 260_000] {
        check_normals(&street(&Street { triangles, seed: 1 }), 0.0);
    }
}

#[test]
fn the_street_has_a_surface_of_some_35_000_square_metres_and_no_edge_of_more_than_seven_metres() {
    let scene = street(&Street::default());
    let (mut area, mut longest) = (0.0f64, (0.0f32, ""));
    for draw in &scene.draws {
        for ([a, b, c], _) in triangles(&scene, draw) {
            area += 0.5 * f64::from((b - a).cross(c - a).length());
            let edge = a.distance(b).max(b.distance(c)).max(c.distance(a));
            if edge > longest.0 {
                longest = (edge, scene.materials[draw.material as usize].name.as_str());
            }
        }
    }
    let bounds = scene.draws.iter().fold(Aabb::EMPTY, |all, draw| all.union(scene.draw_bounds(draw)));
    assert!((30_000.0..40_000.0).contains(&area), "{area} m^2");
    assert!(longest.0 < 7.0, "{longest:?}");
    assert!(bounds.min.y > -0.2 && bounds.max.y < 40.0 && bounds.size().x < 160.0 && bounds.size().z < 70.0, "{bounds:?}");
}

#[test]
fn eyes_in_the_street_see_fronts_only_and_the_sky_alone_over_the_roofs() {
    for triangles in [20_000, 40_000] {
        let scene = street(&Street { triangles, seed: 1 });
        // Eyes at the camera, on both pavements, in both cross streets, and over the roofs.
        let eyes = [
            scene.cameras[0].position,
            Vec3::new(-20.3, 1.7, -6.9),
            Vec3::new(31.2, 1.7, 6.9),
            Vec3::new(61.3, 1.7, 13.2),
            Vec3::new(-60.8, 1.7, -12.7),
            Vec3::new(4.0, 40.0, 1.0),
        ];
        // The lowest eaves are over ten metres high, and the farthest ones seen along the street are 130 m away.
        check_sight(&scene, &eyes, 300, |eye, direction| eye.y > 20.0 || direction.y > 0.05);
    }
}

#[test]
fn the_sun_reaches_the_panels_and_one_side_and_leaves_the_other_in_shadow() {
    let scene = street(&Street { triangles: 20_000, seed: 1 });
    let Light::Directional { direction, irradiance } = scene.lights[0] else { panic!("the first light is the sun") };
    assert!(irradiance.min_element() > 10.0);
    let lit = |p: Vec3| hit(&scene, p - direction * 1e-3, -direction).is_none();
    // The middles of the standing panels.
    for (bay, _) in panels::STANDS {
        let p = Vec3::new(BAY * bay as f32, 2.4, -3.2);
        assert!(lit(p), "the panel in bay {bay} is in shadow");
    }
    // Points before the fronts of both sides, and on the carriageway.
    let part = |p: &dyn Fn(f32, f32) -> Vec3| {
        let points = (0..20).flat_map(|i| (0..5).map(move |j| (i as f32 * 5.0 - 47.3, j as f32 / 4.0)));
        points.filter(|(x, t)| lit(p(*x, *t))).count()
    };
    let sunny = part(&|x, t| Vec3::new(x, 2.0 + 7.0 * t, 0.4 - FRONT));
    let shady = part(&|x, t| Vec3::new(x, 2.0 + 7.0 * t, FRONT - 0.4));
    let road = part(&|x, t| Vec3::new(x, 0.02, (2.0 * t - 1.0) * 2.6));
    assert!(sunny > 60 && shady == 0 && (10..90).contains(&road), "{sunny}, {shady} and {road} of 100 points are in the sun");
}

#[test]
fn colours_of_panels_and_flags_are_strong_but_no_more_than_paint_has() {
    let mut scene = Scene::default();
    let palette = materials::add(&mut scene, 1);
    for index in palette.panels.into_iter().chain(palette.flags) {
        let material = &scene.materials[index as usize];
        let color = Vec3::from_slice(&material.base_color);
        assert!(color.min_element() >= 0.04 && color.max_element() <= 0.8, "{}: {color}", material.name);
        assert!(color.max_element() > 3.0 * color.min_element(), "{}: {color}", material.name);
    }
}

#[test]
fn rows_of_houses_fill_their_sides_and_neighbours_fronts_stand_apart() {
    let houses = lots::houses();
    let long = |from: usize, to: usize| houses[from..to].iter().map(|house| house.lot.width).sum::<f32>();
    assert!((long(0, 11) - 2.0 * HALF).abs() < 1e-3 && (long(11, 22) - 2.0 * HALF).abs() < 1e-3);
    assert!(long(22, 25) > 2.0 * END && long(25, 28) > 2.0 * END);
    for house in &houses {
        for beside in house.beside {
            if let lots::Beside::House { projection, .. } = beside {
                assert!((projection - house.projection()).abs() > 0.03, "house {}", house.number);
            }
        }
    }
}
