use super::*;
use crate::scene::animation::{Animation, Hung, Local, MovingNode, Parent};
use crate::scene::builder::Mesh;
use crate::scene::{Material, builtin};
use glam::{Affine3A, DAffine3, Vec2};

fn spacing(distance: f32) -> Spacing {
    Spacing { distance, angle: 30f32.to_radians(), open: true }
}

/// Caches without a file.
fn made(scene: &Scene, distance: f32) -> LightCaches {
    LightCaches::make(scene, models::models(scene), spacing(distance)).unwrap()
}

/// A square of a side, facing up at a height, made of two triangles.
fn square(side: f32, height: f32, up: bool) -> Mesh {
    let mut mesh = Mesh::default();
    let mut corners = [[0.0, 0.0], [0.0, side], [side, side], [side, 0.0]].map(|[x, z]| Vec3::new(x, height, z));
    if !up {
        corners.reverse();
    }
    mesh.quad(corners, [Vec2::ZERO; 4]);
    mesh
}

fn scene(meshes: &[(Mesh, bool, Vec<Affine3A>)]) -> Scene {
    let mut scene = Scene { name: "squares".to_owned(), ..Scene::default() };
    for (mesh, double_sided, transforms) in meshes {
        let material = scene.add_material(Material { double_sided: *double_sided, ..Material::default() });
        scene.add_mesh(mesh, material, transforms);
    }
    scene
}

/// Position and normal of a cache of a model whose draws have no transform.
fn standing(scene: &Scene, cache: &LightCache) -> (Vec3, Vec3) {
    let [a, b, c] = cache.corners.map(|corner| Vec3::from(scene.vertices[corner as usize].position));
    let (along, up) = ((b - a).normalize(), (b - a).cross(c - a).normalize());
    let [x, y, z] = cache.normal;
    (a + cache.weights[0] * (b - a) + cache.weights[1] * (c - a), x * along + y * up.cross(along) + z * up)
}

/// Surface that a cache stands for, m^2.
fn area(scene: &Scene, cache: &LightCache) -> f64 {
    let [a, b, c] = cache.corners.map(|corner| Vec3::from(scene.vertices[corner as usize].position));
    f64::from(cache.share) * 0.5 * f64::from((b - a).cross(c - a).length())
}

#[test]
fn areas_of_all_caches_are_the_surface_and_two_sides_count_twice() {
    for (name, scene, expected) in [
        ("Cornell box", builtin::cornell(), None),
        ("square", scene(&[(square(7.0, 0.0, true), false, vec![Affine3A::IDENTITY])]), Some(49.0)),
        ("sheet", scene(&[(square(7.0, 0.0, true), true, vec![Affine3A::IDENTITY])]), Some(98.0)),
    ] {
        let of_models: f64 = models::models(&scene).iter().map(Model::area).sum();
        let caches = made(&scene, 0.5);
        let found: f64 = caches.models.iter().flat_map(|model| &model.caches).map(|cache| area(&scene, cache)).sum();
        assert!((found / of_models - 1.0).abs() < 1e-4, "{name}: {found} m^2 of {of_models}");
        assert!(expected.is_none_or(|expected| (found / expected - 1.0).abs() < 1e-4), "{name}: {found} m^2");
    }
}

/// Silhouette of a cache, m^2.
fn silhouette(scene: &Scene, cache: &LightCache) -> f64 {
    area(scene, cache) / f64::from(cache.share) * f64::from(cache.silhouette)
}

/// Squares of a side that face up, with their corners at these places.
fn squares(side: f32, corners: impl IntoIterator<Item = Vec3>) -> Scene {
    let places: Vec<Affine3A> = corners.into_iter().map(Affine3A::from_translation).collect();
    // A mesh of its own for each, since instances would have caches of their own.
    let each: Vec<_> = places.into_iter().map(|place| (square(side, 0.0, true), false, vec![place])).collect();
    scene(&each)
}

#[test]
fn the_silhouettes_of_a_wall_are_its_surface_without_gaps() {
    for (name, scene) in
        [("square", scene(&[(square(7.0, 0.0, true), false, vec![Affine3A::IDENTITY])])), ("Cornell box", builtin::cornell())]
    {
        let made = made(&scene, 0.5);
        let caches: Vec<&LightCache> = made.models.iter().flat_map(|model| &model.caches).collect();
        let all: f64 = caches.iter().map(|cache| area(&scene, cache)).sum();
        let solid: f64 = caches.iter().map(|cache| silhouette(&scene, cache) * f64::from(cache.opacity)).sum();
        let spread: f64 = caches.iter().map(|cache| silhouette(&scene, cache)).sum();
        println!("{name}: {all} m^2, silhouettes of {spread}, of which {solid} are covered");
        assert!(solid / all > 0.97 && solid / all <= 1.0 + 1e-6, "{name}: {solid} of {all} m^2 are covered");
        assert!(spread / all < 1.1, "{name}: {all} m^2 are spread over {spread}");
    }
}

#[test]
fn surfaces_behind_each_other_have_one_silhouette_and_ones_that_stand_apart_are_not_solid() {
    // Four leaves of .1 m: at one place, one over the other, and a metre apart.
    let leaf = 0.01;
    for (name, corners, expected, opacity) in [
        ("one leaf", vec![Vec3::ZERO], leaf, 1.0),
        ("leaves over each other", (0..4).map(|i| Vec3::new(0.0, 0.05 * i as f32, 0.0)).collect(), leaf, 1.0),
        // Corners of a square of 1 m: their moments are 3 times those of its surface, and a leaf's own.
        ("leaves apart", (0..4).map(|i| Vec3::new((i % 2) as f32, 0.0, (i / 2) as f32)).collect(), 3.0 + leaf, 4.0 * leaf / (3.0 + leaf)),
    ] {
        let scene = squares(0.1, corners);
        let made = LightCaches::make(&scene, models::models(&scene), Spacing { distance: 16.0, angle: 0.5, open: true }).unwrap();
        let caches: Vec<&LightCache> = made.models.iter().flat_map(|model| &model.caches).collect();
        assert_eq!(caches.len(), 1, "{name}");
        let found = silhouette(&scene, caches[0]);
        assert!((found / expected - 1.0).abs() < 0.02, "{name}: a silhouette of {found} m^2 instead of {expected}");
        assert!((f64::from(caches[0].opacity) / opacity - 1.0).abs() < 0.02, "{name}: {} opaque instead of {opacity}", caches[0].opacity);
    }
}

#[test]
fn no_surface_is_farther_from_a_cache_of_its_normal_than_the_spacing() {
    for (scene, distance) in [(builtin::cornell(), 0.5), (builtin::cornell(), 1.7), (ball(24), 0.7), (ball(24), 3.0)] {
        let caches = made(&scene, distance);
        let all: Vec<(Vec3, Vec3)> = caches.models.iter().flat_map(|model| &model.caches).map(|cache| standing(&scene, cache)).collect();
        for model in models::models(&scene) {
            for sample in samples::of(&model, spacing(distance)) {
                let near = |(position, _): &&(Vec3, Vec3)| position.distance(sample.position) <= distance * 1.0001;
                // A joined place's normal is within the angle of its own mean, and that within the angle of the place that it joined.
                let most = all.iter().filter(near).map(|(_, normal)| normal.dot(sample.normal)).fold(-1.0, f32::max);
                assert!(most >= 60f32.to_radians().cos() - 1e-3, "at {distance} m: {} has no cache of its normal", sample.position);
            }
        }
    }
}

/// A sphere of radius 1 m with smooth normals, `n` rings.
fn ball(n: u32) -> Scene {
    let mut mesh = Mesh::default();
    let at = |i: u32, j: u32| {
        let (theta, phi) = (std::f32::consts::PI * i as f32 / n as f32, std::f32::consts::TAU * j as f32 / (2 * n) as f32);
        Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin())
    };
    for i in 0..n {
        for j in 0..2 * n {
            let corners = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)].map(|p| mesh.vertex(p, p, Vec2::ZERO));
            mesh.indices.extend([corners[0], corners[1], corners[2], corners[0], corners[2], corners[3]]);
        }
    }
    scene(&[(mesh, false, vec![Affine3A::IDENTITY])])
}

#[test]
fn a_voxel_with_all_normals_ends_and_has_a_cache_for_each_cone() {
    // All of the ball is in few voxels.
    let caches = made(&ball(32), 100.0);
    let count = caches.count();
    // A sphere is 15 cones of 30 degrees at least; greedy ones overlap.
    assert!((15..=120).contains(&count), "{count} caches");
}

#[test]
fn both_sides_of_a_thin_wall_keep_their_caches() {
    let place = vec![Affine3A::IDENTITY];
    let scene = scene(&[(square(2.0, 0.0, true), false, place.clone()), (square(2.0, -0.01, false), false, place)]);
    let caches = made(&scene, 1.0);
    assert_eq!(caches.models.len(), 1, "what stands still is one model");
    let normals: Vec<f32> = caches.models[0].caches.iter().map(|cache| standing(&scene, cache).1.y).collect();
    let (up, down) = (normals.iter().filter(|y| **y > 0.999).count(), normals.iter().filter(|y| **y < -0.999).count());
    assert!(up >= 4 && down >= 4 && up + down == normals.len(), "{normals:?}");
}

#[test]
fn a_cache_of_several_layers_is_on_the_open_one_and_on_a_wall_in_its_middle() {
    let spacing = |open: bool| Spacing { distance: 3.0, angle: 0.5, open };
    let place = |scene: &Scene, open: bool| {
        let made = LightCaches::make(scene, models::models(scene), spacing(open)).unwrap();
        assert_eq!(made.count(), 1, "all of the squares are in one voxel");
        standing(scene, &made.models[0].caches[0]).0
    };
    let stack = |count: u32| {
        let square = |i: u32| (square(1.0, 0.1 * i as f32, true), false, vec![Affine3A::IDENTITY]);
        scene(&(0..count).map(square).collect::<Vec<_>>())
    };
    let layers = stack(5);
    for (open, expected) in [(true, 0.4), (false, 0.2)] {
        let found = place(&layers, open);
        assert!((found.y - expected).abs() < 1e-3, "open {open}: at {found}");
    }
    let wall = stack(1);
    assert_eq!(place(&wall, true), place(&wall, false));
}

#[test]
fn instances_and_moving_draws_share_caches_and_the_rest_is_one_model() {
    let shift = |x: f32| Affine3A::from_translation(Vec3::new(x, 0.0, 0.0));
    let twice = vec![shift(0.0), shift(10.0)];
    let mut scene = scene(&[
        (square(2.0, 0.0, true), false, vec![shift(0.0)]),
        (square(2.0, 1.0, true), false, vec![shift(0.0)]),
        (square(2.0, 2.0, true), false, twice.clone()),
        (square(2.0, 3.0, true), false, twice),
        (square(2.0, 4.0, true), false, vec![shift(0.0)]),
    ]);
    let still = MovingNode { parent: Parent::Still(DAffine3::IDENTITY), local: Local::Still(DAffine3::IDENTITY) };
    scene.animation = Some(Animation {
        name: String::new(),
        duration: 1.0,
        tracks: Vec::new(),
        nodes: vec![still],
        draws: vec![Hung { index: 6, node: 0 }],
        lights: Vec::new(),
        cameras: Vec::new(),
    });
    let caches = made(&scene, 1.0);
    let instances: Vec<_> = caches.models.iter().map(|model| model.instances.clone()).collect();
    assert_eq!(instances, [vec![vec![0, 1]], vec![vec![2, 4], vec![3, 5]], vec![vec![6]]]);
    let numbers: Vec<usize> = caches.models.iter().map(|model| model.caches.len()).collect();
    assert_eq!(caches.count(), numbers[0] + 2 * numbers[1] + numbers[2]);
}

#[test]
fn the_same_triangles_with_one_side_and_with_two_are_two_models() {
    let shift = |x: f32| Affine3A::from_translation(Vec3::new(x, 0.0, 0.0));
    let mut scene = scene(&[(square(2.0, 0.0, true), false, vec![shift(0.0), shift(10.0)])]);
    scene.draws[1].material = scene.add_material(Material { double_sided: true, ..Material::default() });
    let caches = made(&scene, 1.0);
    let sides: Vec<(Vec<Vec<u32>>, bool)> =
        caches.models.iter().map(|model| (model.instances.clone(), model.caches.iter().any(|cache| cache.one_of_two != 0))).collect();
    assert_eq!(sides, [(vec![vec![0]], false), (vec![vec![1]], true)]);
}

#[test]
fn caches_are_made_where_coordinates_are_coarser_than_they() {
    let far = Affine3A::from_translation(Vec3::new(500_000.0, 0.0, 4_000_000.0));
    let caches = made(&scene(&[(square(3.0, 0.0, true), false, vec![far])]), 0.2);
    assert!((1..1000).contains(&caches.count()), "{} caches", caches.count());
}

#[test]
fn lists_name_the_nearest_caches() {
    let scene = ball(16);
    let caches = made(&scene, 0.4);
    let model = &caches.models[0];
    assert!(model.caches.len() > NEIGHBOURS);
    let positions: Vec<Vec3> = model.caches.iter().map(|cache| standing(&scene, cache).0).collect();
    for (vertex, list) in (model.first_vertex..).zip(&model.neighbours) {
        let at = Vec3::from(scene.vertices[vertex as usize].position);
        let mut distances: Vec<f32> = positions.iter().map(|position| position.distance(at)).collect();
        let listed: Vec<f32> = list.iter().map(|number| distances[*number as usize]).collect();
        distances.sort_by(f32::total_cmp);
        for (listed, nearest) in listed.iter().zip(&distances) {
            assert!((listed - nearest).abs() < 1e-5, "vertex {vertex}: {listed:?} instead of {nearest:?}");
        }
    }
    let few = made(&ball(16), 100.0);
    assert!(few.models[0].neighbours.iter().flatten().all(|number| *number == NONE || (*number as usize) < few.count()));
}

#[test]
fn caches_come_back_from_their_file_and_a_damaged_file_is_made_anew() {
    let folder = tempfile::tempdir().unwrap();
    let kept = Cache::at(folder.path());
    let scene = builtin::cornell();
    let first = LightCaches::of(&scene, spacing(1.0), &kept).unwrap();
    let files = || -> Vec<_> { std::fs::read_dir(folder.path().join("light-caches")).unwrap().map(|file| file.unwrap().path()).collect() };
    assert_eq!(files().len(), 1);
    assert_eq!(LightCaches::of(&scene, spacing(1.0), &kept).unwrap(), first);
    assert_eq!(files().len(), 1);
    // Another spacing and another scene have files of their own.
    assert_ne!(LightCaches::of(&scene, spacing(2.0), &kept).unwrap(), first);
    let mut moved = scene.clone();
    moved.vertices[0].position[0] += 0.1;
    LightCaches::of(&moved, spacing(1.0), &kept).unwrap();
    assert_eq!(files().len(), 3);
    // What was kept is read, whatever it is.
    let key = models::key(&scene, &models::models(&scene), spacing(1.0), VERSION);
    let other = made(&scene, 2.0);
    assert_eq!(kept.write("light-caches", &key, &other.to_bytes()), None);
    assert_eq!(LightCaches::of(&scene, spacing(1.0), &kept).unwrap(), other);
    for file in files() {
        std::fs::write(file, b"cut").unwrap();
    }
    assert_eq!(LightCaches::of(&scene, spacing(1.0), &kept).unwrap(), first);
}

#[test]
fn a_spacing_that_is_too_small_is_refused_with_one_that_is_not() {
    let error = LightCaches::of(&builtin::cornell(), spacing(0.001), &Cache::at("/nowhere")).unwrap_err().to_string();
    assert!(error.starts_with("gather.light_caches.distance: 0.001 m is too small"), "{error}");
    let least: f32 = error.split("take ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap().parse().unwrap();
    assert!((0.001..0.1).contains(&least), "{error}");
}

#[test]
fn the_preset_has_the_papers_number_of_caches() {
    let text = crate::presets::find("lightskin").unwrap_or_else(|| panic!("there is a preset lightskin"));
    let config = crate::config::parse(text, std::path::Path::new("lightskin.toml"), &[]).unwrap().config;
    let caches = &config.gather.light_caches;
    let spacing = Spacing { distance: caches.distance, angle: caches.angle_deg.to_radians(), open: true };
    let scene = builtin::street(&builtin::Street { triangles: config.scene.triangles, seed: config.scene.seed });
    let found = LightCaches::make(&scene, models::models(&scene), spacing).unwrap().count();
    println!("{found} caches");
    assert!((4950..=6050).contains(&found), "{found} caches instead of about 5,500");
}
