//! Repeatability: the same run gives the same picture, in any timing mode and with any checks.

use crate::common::*;
use glam::Vec3;
use manylight::config::{Builtin, Config, SceneConfig};
use manylight::gpu::{DeviceChoice, Options};
use manylight::graph::{DumpData, Execution, Timing};
use manylight::output::Picture;
use manylight::output::exr::Precision;
use manylight::output::{ExrLayer, write_exr, write_png};
use manylight::renderer::Renderer;
use manylight::scene::source::load_scene;
use manylight::world::Needs;

fn config() -> Config {
    let mut config = Config { scene: SceneConfig { builtin: Some(Builtin::Cornell), ..SceneConfig::default() }, ..Config::default() };
    config.frame.size = [160, 120];
    config.rsm.size = [128, 128];
    config.vpls.count = 512;
    config
}

fn cornell() -> Renderer {
    renderer(load_scene(&config().scene).unwrap().0)
}

/// Bytes of the files that a picture is written to.
fn files(picture: &Picture) -> [Vec<u8>; 2] {
    let folder = tempfile::tempdir().unwrap();
    let (png, exr) = (folder.path().join("image.png"), folder.path().join("image.exr"));
    let [width, height] = picture.size;
    write_png(&png, width, height, &picture.image).unwrap();
    let planes = [
        ("", &picture.radiance),
        ("direct", &picture.direct),
        ("indirect", &picture.indirect),
        ("irradiance", &picture.irradiance),
        ("albedo", &picture.albedo),
    ];
    let mut layers: Vec<ExrLayer> =
        planes.iter().map(|(name, plane)| ExrLayer::interleaved(name, "RGB", plane.channels, &plane.values, Precision::Half)).collect();
    let vectors = |v: Vec<Vec3>| v.iter().flat_map(|v| v.to_array()).collect::<Vec<f32>>();
    layers.push(ExrLayer::interleaved("N", "XYZ", 3, &vectors(picture.normals()), Precision::Float));
    layers.push(ExrLayer::interleaved("P", "XYZ", 3, &vectors(picture.positions()), Precision::Float));
    layers.push(ExrLayer::interleaved("", "Z", 1, &picture.distances(), Precision::Float));
    write_exr(&exr, width, height, layers, &[]).unwrap();
    [png, exr].map(|path| std::fs::read(path).unwrap())
}

fn run(renderer: &mut Renderer, execution: &Execution) -> manylight::renderer::Rendered {
    renderer.render(&config(), 0, true, execution).unwrap_or_else(|error| panic!("{error:#}"))
}

#[test]
fn the_same_run_on_a_fresh_device_gives_the_same_bytes() {
    let [first, second] = [(), ()].map(|()| {
        let mut renderer = cornell();
        let rendered = run(&mut renderer, &Execution::default());
        finish(renderer.gpu());
        files(&rendered.picture.unwrap())
    });
    assert_eq!(first[0].len(), second[0].len());
    assert!(first[0] == second[0], "the PNGs differ");
    assert!(first[1] == second[1], "the EXRs differ");
}

#[test]
fn neither_timing_nor_dumps_nor_checks_change_the_picture() {
    let mut renderer = cornell();
    let plain = files(&run(&mut renderer, &Execution::default()).picture.unwrap());
    let watched = Execution {
        dump: ["rsm/draw", "vpls/regular", "gather/tiled", "compose/sum"].map(String::from).to_vec(),
        check_nan: true,
        ..Execution::default()
    };
    let executions = [
        Execution { timing: Timing::Overlapped, ..Execution::default() },
        Execution { timing: Timing::Serial, ..Execution::default() },
        Execution { timing: Timing::Overlapped, ..watched.clone() },
        Execution { timing: Timing::Serial, ..watched.clone() },
        watched,
    ];
    for execution in executions {
        let rendered = run(&mut renderer, &execution);
        assert!(files(&rendered.picture.unwrap()) == plain, "{execution:?} changes the picture");
        assert_eq!(rendered.non_finite, Vec::new());
        let dumped: Vec<(&str, &str)> = rendered.dumps.iter().map(|dump| (dump.pass, dump.resource.as_str())).collect();
        if execution.dump.is_empty() {
            assert!(dumped.is_empty());
            continue;
        }
        let expected = [
            ("rsm/draw", "rsm/normal"),
            ("rsm/draw", "rsm/albedo"),
            ("rsm/draw", "rsm/depth"),
            ("vpls/regular", "vpls/places"),
            ("vpls/regular", "vpls/intensities"),
            ("vpls/regular", "vpls/areas"),
            ("gather/tiled", "gather/irradiance"),
            ("compose/sum", "compose/indirect"),
            ("compose/sum", "compose/radiance"),
            ("compose/sum", "compose/image"),
        ];
        assert_eq!(dumped, expected);
        for dump in &rendered.dumps {
            let bytes = match &dump.data {
                DumpData::Image { format, size, layers, texels } => {
                    assert_eq!(texels.len(), format.texel_bytes() * (size[0] * size[1] * layers) as usize, "{}", dump.resource);
                    texels
                }
                DumpData::Buffer { element_bytes, bytes, .. } => {
                    assert_eq!(bytes.len(), element_bytes * 512, "{}", dump.resource);
                    bytes
                }
            };
            assert!(bytes.iter().any(|byte| *byte != 0), "{} is empty", dump.resource);
        }
    }
    finish(renderer.gpu());
}

#[test]
fn a_number_that_is_not_finite_is_found_in_the_first_pass_that_makes_it() {
    let mut scene = load_scene(&config().scene).unwrap().0;
    scene.materials.iter_mut().for_each(|material| material.emission[1] = f32::INFINITY);
    let mut renderer = renderer(scene);
    let rendered = run(&mut renderer, &Execution { check_nan: true, ..Execution::default() });
    let first = rendered.non_finite.first().unwrap_or_else(|| panic!("nothing was found"));
    assert_eq!((first.0, first.1.as_str()), ("gbuffer/draw", "gbuffer/emission"));
    let covered = rendered.picture.unwrap().depth.values.iter().filter(|depth| **depth > 0.0).count();
    assert_eq!(first.2 as usize, covered);
    // Values too bright for an image's format are stored as its largest number, so that infinities do not spread.
    assert!(rendered.non_finite.iter().all(|(pass, ..)| *pass == "gbuffer/draw"), "{:?}", rendered.non_finite);
    finish(renderer.gpu());
}

/// Timestamps on the device must agree, pass by pass, with the host's clock around single submissions. A timestamp that takes
/// effect late charges a pass's work to the next one.
#[test]
fn isolated_and_serial_timing_agree_pass_by_pass() {
    // The validation layer is off, since its work would be in the host's times. Other tests validate these frames.
    let options = Options { device: DeviceChoice::Cpu, validate: false, ..Options::default() };
    let mut renderer = Renderer::open(&options, load_scene(&config().scene).unwrap().0, Needs::default()).unwrap();
    let mut config = config();
    config.frame.size = [256, 192];
    config.gather.interleave = 1.into();
    // Other tests may load the machine in one mode and not in the other. A fault of the timestamps shows in every attempt.
    let found: Vec<String> = (0..4).map_while(|_| disagreement(&mut renderer, &config)).collect();
    assert!(found.len() < 4, "{}", found.join("; "));
}

/// The first pass whose medians over some frames differ between the modes; `None` if all agree.
fn disagreement(renderer: &mut Renderer, config: &Config) -> Option<String> {
    let mut samples: [Vec<Vec<f64>>; 2] = Default::default();
    let mut names = Vec::new();
    // Modes alternate, so that other load on the machine affects both.
    for round in 0..6 {
        for (timing, samples) in [Timing::Isolated, Timing::Serial].into_iter().zip(&mut samples) {
            let times = renderer.render(config, 0, false, &Execution { timing, ..Execution::default() }).unwrap().times;
            names = times.iter().map(|(name, _)| *name).collect();
            // The first round makes pipelines and lets the driver compile.
            if round > 0 {
                samples.push(times.iter().map(|(_, ms)| *ms).collect());
            }
        }
    }
    let compare = |what: &str, value: &dyn Fn(&[f64]) -> f64| {
        let [isolated, serial] = samples.each_ref().map(|samples| {
            let mut values: Vec<f64> = samples.iter().map(|times| value(times)).collect();
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        });
        println!("{what}: {isolated:.2} ms isolated, {serial:.2} ms serial");
        let slack = (0.25 * isolated.max(serial)).max(10.0);
        ((isolated - serial).abs() > slack).then(|| format!("{what}: {isolated:.2} ms isolated, {serial:.2} ms serial"))
    };
    let passes = names.iter().enumerate().filter_map(|(i, name)| compare(name, &|times| times[i])).next();
    passes.or_else(|| compare("all passes", &|times| times.iter().sum()))
}
