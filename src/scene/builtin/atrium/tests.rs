use super::*;
use crate::scene::Light;
use crate::scene::builtin::probe::{check_normals, check_ranges, check_sight, hit};

#[test]
fn the_number_of_triangles_is_met_within_five_percent() {
    for triangles in
        [10_000, 14_000, 20_000, 30_000, 45_000, 60_000, 80_000, 100_000, 150_000, 180_000, 215_000, 260_000, 400_000, 1_000_000]
    {
        let parts = parts_of_size(&Atrium { triangles, seed: 1 }, materials::add(&mut Scene::default(), 1));
        let made: usize = parts.iter().map(Part::triangles).sum();
        let error = made as f64 / f64::from(triangles) - 1.0;
        assert!(error.abs() <= 0.05, "{triangles} asked for, {made} made: {:.1} %", 100.0 * error);
    }
}

#[test]
fn numbers_out_of_range_are_taken_to_the_nearer_end() {
    let palette = materials::add(&mut Scene::default(), 1);
    let made = |triangles| parts_of_size(&Atrium { triangles, seed: 1 }, palette).iter().map(Part::triangles).sum::<usize>();
    assert_eq!(made(0), made(10_000));
}

#[test]
fn the_same_seed_makes_the_same_bytes_and_another_one_others() {
    let make = |seed| atrium(&Atrium { triangles: 30_000, seed });
    let (a, b, other) = (make(7), make(7), make(8));
    assert_eq!(bytemuck::cast_slice::<_, u8>(&a.vertices), bytemuck::cast_slice::<_, u8>(&b.vertices));
    assert!(a.indices == b.indices && a.draws == b.draws && a.materials == b.materials && a.textures == b.textures);
    assert!(a.textures != other.textures && a.vertices != other.vertices);
}

#[test]
fn indices_materials_and_textures_are_in_range_and_all_numbers_finite() {
    let scene = atrium(&Atrium::default());
    check_ranges(&scene, 300);
    let count = |has: fn(&crate::scene::Material) -> bool| scene.materials.iter().filter(|m| has(m)).count();
    assert!(count(|m| m.alpha_cutoff.is_some()) > 0 && count(|m| m.normal_map.is_some()) > 0 && count(|m| m.metallic > 0.0) > 0);
    assert!(count(|m| m.emission != [0.0; 3]) > 0 && count(|m| m.double_sided) > 0);
}

#[test]
fn normals_agree_with_the_winding_and_no_triangle_is_degenerate() {
    for triangles in [10_000, 260_000] {
        check_normals(&atrium(&Atrium { triangles, seed: 1 }), 0.001);
    }
}

#[test]
fn a_courtyard_has_as_many_triangles_as_asked_for_each_with_its_front_outside() {
    for triangles in [100_000, 260_000, 2_000_000] {
        let scene = courtyard(&Courtyard { triangles, seed: 1 });
        let made: u32 = scene.draws.iter().map(|draw| draw.index_count / 3).sum();
        let error = f64::from(made) / f64::from(triangles) - 1.0;
        assert!(error.abs() <= 0.05, "{triangles} asked for, {made} made: {:.1} %", 100.0 * error);
        check_normals(&scene, 0.001);
        check_ranges(&scene, 600);
    }
}

#[test]
fn the_camera_sees_fronts_only_and_the_walls_keep_the_sky_out() {
    let scene = atrium(&Atrium { triangles: 60_000, seed: 1 });
    // Eyes in the court; in the lower and the upper gallery of a long side, of a short side, and in a corner.
    let eyes = [
        scene.cameras[0].position,
        Vec3::new(0.7, 1.7, 6.4),
        Vec3::new(2.2, 6.8, -6.3),
        Vec3::new(13.9, 1.7, 0.8),
        Vec3::new(-13.8, 6.9, -6.2),
    ];
    // A ray escapes only through the open roof: it crosses the eaves' height over the court.
    check_sight(&scene, &eyes, 160, |eye, direction| {
        let over = eye + direction * ((EAVES - eye.y) / direction.y);
        direction.y > 0.0 && over.x.abs() < HALF[0] && over.z.abs() < HALF[1]
    });
}

#[test]
fn the_sun_reaches_part_of_the_floor_and_one_wall() {
    let scene = atrium(&Atrium { triangles: 30_000, seed: 1 });
    let Light::Directional { direction, irradiance } = scene.lights[0] else { panic!("the first light is the sun") };
    assert!(irradiance.min_element() > 10.0);
    // The first hits of sun rays that start on a plane at the eaves' height.
    let (mut floor, mut side, mut other, mut all) = (0, 0, 0, 0);
    for i in 0..40 {
        for j in 0..24 {
            let start = Vec3::new(i as f32 * 0.6 - 11.7, EAVES + 0.5, j as f32 * 0.4 - 4.6);
            let Some((t, _, _)) = hit(&scene, start, direction) else { continue };
            let p = start + direction * t;
            all += usize::from(p.y < EAVES - 0.3);
            floor += usize::from(p.y < 0.01);
            side += usize::from(p.z > HALF[1] - 0.8 && p.y > 0.5 && p.y < EAVES - 0.3);
            other += usize::from(p.z < -HALF[1] + 0.8 && p.y > 0.5 && p.y < EAVES - 0.3);
        }
    }
    assert!(floor * 4 > all && floor * 20 < all * 19, "{floor} of {all} rays end on the floor");
    assert!(side > 40 && other * 10 < side, "{side} rays on one long side, {other} on the other");
}
