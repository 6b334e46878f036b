//! Scenes exported for Mitsuba, checked by their files without Mitsuba. `tools/check-with-mitsuba` compares pictures.

use crate::place::{Place, text};
use glam::{Affine3A, Vec2, Vec3};
use manylight::config::Dielectric;
use manylight::export::mitsuba::{Shot, write};
use manylight::output::exr::Precision;
use manylight::output::{ExrLayer, read_exr, write_exr};
use manylight::scene::builder::Mesh;
use manylight::scene::{Camera, Light, Map, Material, Scene, SpotFalloff, Texture, Wrap, builtin};
use roxmltree::{Document, Node};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Output;

/// An exported scene on the disk.
struct Exported {
    folder: tempfile::TempDir,
    xml: String,
    warnings: Vec<String>,
}

const CAMERA: Camera = Camera { name: String::new(), position: Vec3::new(0.0, 0.0, 5.0), target: Vec3::ZERO, up: Vec3::Y, fov_y_deg: 40.0 };

impl Exported {
    fn of(scene: &Scene, lights: &[Light], dielectric: Dielectric) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let shot = Shot { scene, camera: &CAMERA, lights, size: [64, 48], dielectric };
        let (path, warnings) = write(folder.path(), &shot).unwrap();
        Self { xml: fs::read_to_string(path).unwrap(), folder, warnings }
    }

    /// Exports a scene of one quad of this material, without lights.
    fn material(scene: &Scene, material: Material) -> Self {
        Self::of(&quad(scene, material), &[], Dielectric::Lambert)
    }

    fn parse(&self) -> Document<'_> {
        Document::parse(&self.xml).unwrap()
    }

    fn path(&self, file: &str) -> std::path::PathBuf {
        self.folder.path().join(file)
    }

    fn warns(&self, of: &str) -> bool {
        self.warnings.iter().any(|warning| warning.contains(of))
    }
}

/// A copy of a scene with an added quad of this material, seen from its front.
fn quad(scene: &Scene, material: Material) -> Scene {
    let mut scene = scene.clone();
    let material = scene.add_material(material);
    let mut mesh = Mesh::default();
    let [a, b] = [Vec3::NEG_ONE, Vec3::ONE].map(|corner| corner.with_z(0.0));
    mesh.quad([a, a.with_x(1.0), b, b.with_x(-1.0)], [Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO]);
    scene.add_mesh(&mesh, material, &[Affine3A::IDENTITY]);
    scene
}

/// A scene with one named texture of 2x1 texels.
fn textured(name: &str, texels: [[u8; 4]; 2]) -> Scene {
    let mut scene = Scene::default();
    scene.add_texture(Texture { name: name.into(), width: 2, height: 1, srgb: true, texels: texels.concat() });
    scene
}

const TEXELS: [[u8; 4]; 2] = [[200, 100, 50, 255], [20, 10, 5, 0]];

/// The only descendant with this type or name.
#[track_caller]
fn find<'a>(node: Node<'a, 'a>, what: &str) -> Node<'a, 'a> {
    let is = |node: &Node<'_, '_>| node.attribute("type") == Some(what) || node.attribute("name") == Some(what);
    let found: Vec<_> = node.descendants().filter(is).collect();
    assert_eq!(found.len(), 1, "{what} in {}", node.document().input_text());
    found[0]
}

fn count(node: Node<'_, '_>, kind: &str) -> usize {
    node.descendants().filter(|node| node.attribute("type") == Some(kind)).count()
}

#[track_caller]
fn numbers(node: Node<'_, '_>, name: &str) -> Vec<f32> {
    let node = find(node.document().root(), node.attribute("type").unwrap()).children().find(|child| child.attribute("name") == Some(name));
    let node = node.unwrap_or_else(|| panic!("{name} is missing"));
    match node.attribute("value") {
        Some(value) => value.split([' ', ',']).filter(|word| !word.is_empty()).map(|word| word.parse().unwrap()).collect(),
        None => ["x", "y", "z"].map(|axis| node.attribute(axis).unwrap().parse().unwrap()).to_vec(),
    }
}

/// Numbers of vertices and triangles of a PLY file, checked against its bytes.
#[track_caller]
fn ply(bytes: &[u8]) -> (usize, usize) {
    let end = b"end_header\n";
    let start = bytes.windows(end.len()).position(|window| window == end).unwrap() + end.len();
    let header = std::str::from_utf8(&bytes[..start]).unwrap();
    assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"), "{header}");
    let count = |what: &str| header.lines().find_map(|line| line.strip_prefix(what)).unwrap().parse::<usize>().unwrap();
    let (vertices, triangles) = (count("element vertex "), count("element face "));
    let stride = 4 * header.lines().filter(|line| line.starts_with("property float ")).count();
    assert_eq!(bytes.len() - start, vertices * stride + triangles * 13);
    for face in bytes[start + vertices * stride..].chunks_exact(13) {
        assert_eq!(face[0], 3);
        let index = |i: usize| u32::from_le_bytes(face[1 + 4 * i..][..4].try_into().unwrap()) as usize;
        assert!((0..3).all(|i| index(i) < vertices));
    }
    (vertices, triangles)
}

/// Checks that the scene's files are exactly those in the folder, and that every reference has its target. Returns the
/// triangles of all meshes.
#[track_caller]
fn whole(folder: &Path, xml: &str) -> u64 {
    let document = Document::parse(xml).unwrap();
    let nodes = || document.root().descendants();
    let ids: Vec<&str> = nodes().filter_map(|node| node.attribute("id").filter(|_| !node.has_tag_name("ref"))).collect();
    assert!((1..ids.len()).all(|i| !ids[i..].contains(&ids[i - 1])), "{ids:?}");
    assert!(nodes().filter(|node| node.has_tag_name("ref")).all(|node| ids.contains(&node.attribute("id").unwrap())));
    let named: Vec<&str> = nodes().filter(|n| n.attribute("name") == Some("filename")).map(|n| n.attribute("value").unwrap()).collect();
    let mut triangles = 0;
    for file in &named {
        let bytes = fs::read(folder.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
        if file.ends_with(".ply") {
            triangles += ply(&bytes).1 as u64;
        }
    }
    for part in ["meshes", "textures"] {
        for entry in fs::read_dir(folder.join(part)).unwrap() {
            let file = format!("{part}/{}", entry.unwrap().file_name().into_string().unwrap());
            assert!(named.contains(&file.as_str()), "{file} is of no use");
        }
    }
    triangles
}

fn manylight(place: &Place, arguments: &[&str]) -> Output {
    place.manylight().args(arguments).output().unwrap()
}

#[test]
fn the_built_in_scenes_are_written_whole_and_the_same_twice() {
    let place = Place::new(&[("atrium.toml", "[scene]\ntriangles = 10000\n[frame]\nsize = [80, 40]\n")]);
    let atrium = builtin::atrium(&builtin::Atrium { triangles: 10_000, seed: 0 });
    for (config, scene) in [("cornell", builtin::cornell()), ("atrium.toml", atrium)] {
        let files = ["first", "second"].map(|folder| {
            let output = manylight(&place, &["export", "mitsuba", config, "-o", folder]);
            assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
            let printed = text(&output.stdout);
            assert_eq!(Path::new(printed.trim_end()), Path::new(folder).join("scene.xml"));
            let folder = place.path(folder);
            let xml = fs::read_to_string(folder.join("scene.xml")).unwrap();
            assert_eq!(whole(&folder, &xml), scene.triangle_count(), "{config}");
            let mut files = BTreeMap::from([("scene.xml".to_owned(), xml.into_bytes())]);
            for entry in ["meshes", "textures"].iter().flat_map(|part| fs::read_dir(folder.join(part)).unwrap()) {
                let path = entry.unwrap().path();
                files.insert(path.file_name().unwrap().to_str().unwrap().to_owned(), fs::read(&path).unwrap());
            }
            fs::remove_dir_all(folder).unwrap();
            files
        });
        assert!(files[0] == files[1], "{config}: the bytes differ");
    }
}

#[test]
fn the_camera_and_the_picture_are_the_configs_at_the_frame_that_is_asked_for() {
    let config = "[scene]\nbuiltin = \"cornell\"\n[frame]\nsize = [96, 64]\ncount = 31\n[camera]\nfov_y_deg = 50\nup = [0, 3, 4]\n\
                  [[camera.keyframes]]\ntime = 0\nposition = [0, 1, 9]\ntarget = [0, 1, 0]\n\
                  [[camera.keyframes]]\ntime = 1\nposition = [4, 1, 9]\ntarget = [0, 3, 0]\n";
    let place = Place::new(&[("path.toml", config)]);
    for (arguments, origin, target, size) in [
        (&["--frame", "0"][..], "0, 1, 9", "0, 1, 0", ["96", "64"]),
        (&["--frame", "15", "--size", "10x20"], "2, 1, 9", "0, 2, 0", ["10", "20"]),
        // The default is the last frame, as in a render.
        (&["--set", "frame.size=[8, 4]"], "4, 1, 9", "0, 3, 0", ["8", "4"]),
    ] {
        let output = manylight(&place, &[&["export", "mitsuba", "path.toml"], arguments].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let xml = fs::read_to_string(place.path("out/path/mitsuba/scene.xml")).unwrap();
        let document = Document::parse(&xml).unwrap();
        let sensor = find(document.root(), "perspective");
        let look = sensor.descendants().find(|node| node.has_tag_name("lookat")).unwrap();
        assert_eq!(["origin", "target", "up"].map(|name| look.attribute(name).unwrap()), [origin, target, "0, 0.6, 0.8"]);
        assert_eq!(["width", "height"].map(|name| find(sensor, name).attribute("value").unwrap()), size);
        assert_eq!((find(sensor, "fov_axis").attribute("value"), numbers(sensor, "fov")), (Some("y"), vec![50.0]));
        assert_eq!((count(sensor, "box"), count(sensor, "hdrfilm")), (1, 1));
        let parameters = ["spp", "max_depth", "integrator"].map(|name| {
            let is = |node: &Node<'_, '_>| node.has_tag_name("default") && node.attribute("name") == Some(name);
            document.root().descendants().filter(is).count()
        });
        assert_eq!(parameters, [1; 3]);
    }
}

#[test]
fn every_kind_of_light_keeps_its_numbers() {
    let (position, direction, intensity) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.6, -0.8, 0.0), Vec3::new(1e3, 0.5, 0.0));
    let spot = |falloff, outer: f32| Light::Spot { position, direction, intensity, inner: 0.3, outer, falloff };
    let lights = [
        Light::Directional { direction, irradiance: intensity },
        spot(SpotFalloff::Angle, 0.5),
        Light::Point { position, intensity },
        Light::Environment { radiance: Vec3::splat(0.25), map: None, rotation: 0.0 },
    ];
    let exported = Exported::of(&builtin::cornell(), &lights, Dielectric::Lambert);
    let document = exported.parse();
    let light = |kind| find(document.root(), kind);
    assert_eq!(numbers(light("directional"), "direction"), direction.to_array());
    assert_eq!(numbers(light("directional"), "irradiance"), intensity.to_array());
    assert_eq!(numbers(light("point"), "position"), position.to_array());
    assert_eq!(numbers(light("point"), "intensity"), intensity.to_array());
    assert_eq!(numbers(light("constant"), "radiance"), [0.25; 3]);
    let spot_node = light("spot");
    assert_eq!(numbers(spot_node, "intensity"), intensity.to_array());
    assert_eq!(
        (numbers(spot_node, "cutoff_angle"), numbers(spot_node, "beam_width")),
        (vec![0.5f32.to_degrees()], vec![0.3f32.to_degrees()])
    );
    let look = spot_node.descendants().find(|node| node.has_tag_name("lookat")).unwrap();
    assert_eq!(["origin", "target"].map(|name| look.attribute(name).unwrap()), ["1, 2, 3", "1.6, 1.2, 3"]);
    assert!(exported.warns("environment"));

    // A map is written beside, with its factor.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sky.exr");
    let layer = ExrLayer::interleaved("", "RGB", 3, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], Precision::Float);
    write_exr(&path, 2, 1, vec![layer], &[]).unwrap();
    let sky = Light::Environment { radiance: Vec3::new(2.0, 1.0, 0.5), map: Some(path), rotation: 0.5 };
    let exported = Exported::of(&builtin::cornell(), &[sky], Dielectric::Lambert);
    let document = exported.parse();
    let sky = find(document.root(), "envmap");
    let turn = sky.descendants().find(|node| node.has_tag_name("rotate")).unwrap();
    assert_eq!(["y", "angle"].map(|name| turn.attribute(name).unwrap()), ["1", &0.5f32.to_degrees().to_string()]);
    let file = sky.descendants().find(|node| node.attribute("name") == Some("filename")).unwrap().attribute("value").unwrap();
    let picture = read_exr(&exported.path(file)).unwrap();
    assert_eq!(["R", "G", "B"].map(|name| picture.channels[name].clone()), [[2.0, 8.0], [2.0, 5.0], [1.5, 3.0]]);

    // glTF's falloff is a texture in a beam of full width: black at the rim, white within the inner angle.
    let exported = Exported::of(&builtin::cornell(), &[spot(SpotFalloff::CosineSquared, 0.5)], Dielectric::Lambert);
    let document = exported.parse();
    let spot_node = find(document.root(), "spot");
    assert_eq!(numbers(spot_node, "cutoff_angle"), numbers(spot_node, "beam_width"));
    let file = exported.folder.path().join(find(spot_node, "filename").attribute("value").unwrap());
    let falloff = manylight::output::read_exr(&file).unwrap();
    let row = &falloff.channels["G"][(falloff.height / 2 * falloff.width) as usize..][..falloff.width as usize];
    for (x, value) in row.iter().enumerate() {
        let angle = (((x as f32 + 0.5) / row.len() as f32 * 2.0 - 1.0) * 0.5f32.tan()).abs().atan();
        let expected = ((angle.cos() - 0.5f32.cos()) / (0.3f32.cos() - 0.5f32.cos())).clamp(0.0, 1.0).powi(2);
        assert!((value - expected).abs() < 2e-3, "{x}: {value}, not {expected}");
    }
    assert!(exported.warnings.is_empty(), "{:?}", exported.warnings);
    assert!(Exported::of(&builtin::cornell(), &[spot(SpotFalloff::CosineSquared, 1.5)], Dielectric::Lambert).warns("80 degrees"));
    assert!(Exported::of(&builtin::cornell(), &[], Dielectric::Lambert).warns("light"), "a black picture is told of");
}

#[test]
fn materials_become_what_reflects_alike() {
    let none = Scene::default();
    let lambert = Material { base_color: [0.2, 0.4, 0.6, 1.0], ..Material::default() };
    let kinds = |exported: &Exported| -> Vec<String> {
        let document = exported.parse();
        let bsdfs = document.root().descendants().filter(|node| node.has_tag_name("bsdf"));
        bsdfs.map(|node| node.attribute("type").unwrap().to_owned()).collect()
    };
    let exported = Exported::material(&none, lambert.clone());
    assert_eq!(kinds(&exported), ["diffuse"]);
    assert_eq!(numbers(find(exported.parse().root(), "diffuse"), "reflectance"), [0.2, 0.4, 0.6]);

    let exported = Exported::material(&none, Material { metallic: 1.0, roughness: 0.3, double_sided: true, ..lambert.clone() });
    assert_eq!(kinds(&exported), ["twosided", "principled"]);
    let document = exported.parse();
    let metal = find(document.root(), "principled");
    assert_eq!(
        (numbers(metal, "base_color"), numbers(metal, "metallic"), numbers(metal, "roughness")),
        (vec![0.2, 0.4, 0.6], vec![1.0], vec![0.3])
    );

    let exported = Exported::material(&none, Material { metallic: 0.25, ..lambert.clone() });
    assert_eq!(kinds(&exported), ["blendbsdf", "diffuse", "principled"]);
    assert_eq!(numbers(find(exported.parse().root(), "blendbsdf"), "weight"), [0.25]);

    for (roughness, expected) in [(0.3, &["principled"][..]), (1.0, &["blendbsdf", "diffuse", "principled"])] {
        let exported = Exported::of(&quad(&none, Material { roughness, ..lambert.clone() }), &[], Dielectric::Ggx);
        assert_eq!(kinds(&exported), expected);
        assert!(exported.warns("materials.dielectric"));
    }

    let glowing = Material { emission: [3.0, 2.0, 1.0], ..lambert.clone() };
    for (double_sided, emitters) in [(false, 1), (true, 2)] {
        let exported = Exported::material(&none, Material { double_sided, ..glowing.clone() });
        assert_eq!(count(exported.parse().root(), "area"), emitters, "an area light shines from its front alone");
        assert_eq!(whole(exported.folder.path(), &exported.xml), 2 * emitters as u64);
        assert!(exported.warns("glows"));
    }
}

#[test]
fn textures_are_written_once_in_each_form_that_is_needed() {
    let scene = textured("wall", TEXELS);
    let mapped = Material { base_color_map: Some(Map::new(0)), ..Material::default() };
    let moved = Map { matrix: glam::Mat2::from_cols_array(&[1.0, 2.0, 3.0, 4.0]), offset: Vec2::new(5.0, 6.0), ..Map::new(0) };
    let masked = Material { alpha_cutoff: Some(0.5), double_sided: true, ..mapped.clone() };
    let tinted = Material { base_color: [0.5, 1.0, 1.0, 1.0], ..mapped.clone() };
    let data = Material { metallic: 1.0, metallic_roughness_map: Some(Map::new(0)), ..mapped.clone() };
    let bumpy = Material { normal_map: Some(Map::new(0)), normal_scale: 2.0, ..Material::default() };
    let all = [mapped.clone(), Material { base_color_map: Some(moved), ..mapped.clone() }, masked, tinted, data, bumpy];
    let exported = Exported::of(&all.into_iter().fold(scene, |scene, material| quad(&scene, material)), &[], Dielectric::Lambert);
    whole(exported.folder.path(), &exported.xml);
    let mut files: Vec<String> = fs::read_dir(exported.folder.path().join("textures"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    files.sort();
    assert_eq!(files, ["wall-2.exr", "wall-data-2.png", "wall-data.png", "wall-normals.exr", "wall-opacity.png", "wall.png"]);
    let picture = |file: &str| image::open(exported.folder.path().join("textures").join(file)).unwrap().into_rgb8();
    assert_eq!(picture("wall.png").into_raw(), [200, 100, 50, 20, 10, 5]);
    let opacity = picture("wall-opacity.png");
    assert_eq!((opacity.get_pixel(1, 0).0, opacity.get_pixel(6, 0).0), ([255; 3], [0; 3]));
    let floats = manylight::output::read_exr(&exported.folder.path().join("textures/wall-2.exr")).unwrap();
    let linear = ((200.0f32 / 255.0 + 0.055) / 1.055).powf(2.4);
    assert!((floats.channels["R"][0] - 0.5 * linear).abs() < 1e-3);

    let document = exported.parse();
    let matrix = find(document.root(), "to_uv").first_element_child().unwrap();
    assert_eq!(matrix.attribute("value"), Some("1 3 0 5 2 4 0 6 0 0 1 0 0 0 0 1"));
    let mask = find(document.root(), "mask");
    assert_eq!(count(mask, "twosided"), 1);
    let integrator = document.root().descendants().find(|node| node.attribute("name") == Some("integrator")).unwrap();
    assert_eq!(integrator.attribute("value"), Some("volpath"), "light passes through holes");
    assert!(exported.warnings.iter().all(|warning| warning.starts_with("light")), "{:?}", exported.warnings);
}

#[test]
fn what_is_solid_has_no_mask_and_what_is_a_hole_no_mesh() {
    let cases = [([255, 255], 1.0, 1, 0), ([0, 0], 1.0, 0, 0), ([255, 255], 0.25, 0, 0), ([255, 0], 1.0, 1, 1)];
    for (alphas, factor, meshes, masks) in cases {
        let scene = textured("t", alphas.map(|alpha| [9, 9, 9, alpha]));
        let base_color = [1.0, 1.0, 1.0, factor];
        let material = Material { base_color, base_color_map: Some(Map::new(0)), alpha_cutoff: Some(0.5), ..Material::default() };
        let exported = Exported::material(&scene, material);
        let document = exported.parse();
        assert_eq!((count(document.root(), "ply"), count(document.root(), "mask")), (meshes, masks), "{alphas:?}, {factor}");
    }
}

#[test]
fn what_mitsuba_cannot_do_is_told() {
    let scene = textured("odd", TEXELS);
    let mixed = Map { wrap_u: Wrap::ClampToEdge, ..Map::new(0) };
    assert!(Exported::material(&scene, Material { base_color_map: Some(mixed), ..Material::default() }).warns("wraps"));

    let mut colored = quad(&scene, Material { base_color: [0.5, 1.0, 1.0, 1.0], ..Material::default() });
    colored.vertices[0].color = 0xff00_00ff;
    let exported = Exported::of(&colored, &[], Dielectric::Lambert);
    assert_eq!(count(exported.parse().root(), "mesh_attribute"), 1);
    assert!(!exported.warns("vertex colours"));
    let mesh = fs::read(exported.folder.path().join("meshes/unnamed.ply")).unwrap();
    let color: Vec<u8> = [0.5f32, 0.0, 0.0].iter().flat_map(|number| number.to_le_bytes()).collect();
    assert!(mesh.windows(12).any(|bytes| bytes == color), "the factor is in the colours");
    colored.materials[0].base_color_map = Some(Map::new(0));
    assert!(Exported::of(&colored, &[], Dielectric::Lambert).warns("vertex colours"));

    // The camera looks through the quad's back.
    let mut turned = quad(&scene, Material::default());
    turned.draws[0].transform = Affine3A::from_rotation_y(std::f32::consts::PI);
    assert!(Exported::of(&turned, &[], Dielectric::Lambert).warns("back of single-sided"));
    assert!(!Exported::material(&scene, Material::default()).warns("back of single-sided"));
}

#[test]
fn odd_names_become_safe_ones() {
    let names = ["", "../up", "a\"<&>'$b", "Wall", "wall", "ünï\n\0"];
    let mut scene = Scene::default();
    for name in names {
        let texture = Texture { name: name.into(), width: 1, height: 1, srgb: true, texels: vec![255; 4] };
        let map = Map::new(scene.add_texture(texture));
        scene = quad(&scene, Material { name: name.into(), base_color_map: Some(map), ..Material::default() });
    }
    let exported = Exported::of(&scene, &[], Dielectric::Lambert);
    assert_eq!(whole(exported.folder.path(), &exported.xml), 2 * names.len() as u64);
    assert!(!exported.xml.contains("$b") && exported.xml.is_ascii());
    assert_eq!(fs::read_dir(exported.folder.path().join("textures")).unwrap().count(), names.len());
}

#[test]
fn mistakes_end_with_their_code_and_one_sentence() {
    let place = Place::new(&[("in-the-way", "a file where a folder should be"), ("typo.toml", "[gather]\ninterlaeve = 2\n")]);
    let cases: [(&[&str], i32, &str); 4] = [
        (&["cornell", "-o", "in-the-way/out"], 6, "in-the-way"),
        (&["typo.toml", "-o", "out"], 2, "interleave"),
        (&["nowhere.toml", "-o", "out"], 2, "nowhere.toml"),
        (&["cornell", "-o", "out", "--set", "camera.node=nobody"], 2, "nobody"),
    ];
    for (arguments, code, says) in cases {
        let output = manylight(&place, &[&["export", "mitsuba"], arguments].concat());
        let stderr = text(&output.stderr);
        assert_eq!((output.status.code(), stderr.lines().count()), (Some(code), 1), "{arguments:?}: {stderr}");
        assert!(stderr.contains(says) && output.stdout.is_empty(), "{arguments:?}: {stderr}");
        assert!(!place.path("out/scene.xml").exists());
    }
}
