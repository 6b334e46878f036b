//! Tests of configs from the outside: what loads, and the words of each refusal.

use manylight::config::{self, *};
use manylight::error::{Exit, exit_code};
use std::fs;
use std::path::{Path, PathBuf};

/// A folder for one test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, files: &[(&str, &str)]) -> Self {
        let path = std::env::temp_dir().join(format!("manylight-config-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        for (file, text) in files {
            let file = path.join(file);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, text).unwrap();
        }
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn load(&self, file: &str, sets: &[&str]) -> Result<Config, String> {
        self.loaded(file, sets).map(|loaded| loaded.config)
    }

    fn loaded(&self, file: &str, sets: &[&str]) -> Result<Loaded, String> {
        let without_folder = |text: String| text.replace(&format!("{}/", self.0.display()), "");
        let loaded = sentence(config::load(&self.0.join(file), &owned(sets))).map_err(without_folder)?;
        Ok(Loaded { warnings: loaded.warnings.into_iter().map(without_folder).collect(), ..loaded })
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn owned(sets: &[&str]) -> Vec<String> {
    sets.iter().map(|set| (*set).to_owned()).collect()
}

fn parse(text: &str, sets: &[&str]) -> Result<Config, String> {
    sentence(config::parse(text, Path::new("x.toml"), &owned(sets))).map(|loaded| loaded.config)
}

fn warnings(text: &str, sets: &[&str]) -> Vec<String> {
    sentence(config::parse(text, Path::new("x.toml"), &owned(sets))).unwrap().warnings
}

/// Checks that an error is one line and that its exit code is bad input.
fn sentence(result: anyhow::Result<Loaded>) -> Result<Loaded, String> {
    result.map_err(|error| {
        assert_eq!(exit_code(&error), Exit::BadInput);
        let text = format!("{error:#}");
        assert!(!text.contains('\n'), "more than one line: {text}");
        text
    })
}

const SPOT: &str = "[[light]]\nkind = \"spot\"\nposition = [0, 3, 0]\ntarget = [0, 0, 0]\nintensity = [1, 1, 1]\n";
const SUN: &str = "[[light]]\nkind = \"directional\"\ndirection = [0, -1, 0]\nirradiance = [1, 1, 1]\n";

#[test]
fn an_empty_file_is_the_default_config() {
    assert_eq!(parse("", &[]).unwrap(), Config::default());
}

#[test]
fn every_mistake_gets_a_sentence_with_file_line_and_key() {
    let deep = format!("a = {}1{}", "[".repeat(200), "]".repeat(200));
    let spot = |more: &str| format!("{SPOT}{more}");
    let sun = |more: &str| format!("{SUN}{more}");
    let sky = |more: &str| format!("[[light]]\nkind = \"environment\"\nradiance = [1, 1, 1]\n{more}");
    let cases: &[(&str, &str)] = &[
        // Unknown keys.
        ("[gather]\ninterleve = 2", "x.toml:2: gather.interleve: unknown key; did you mean \"interleave\"?"),
        ("[gahter]\ninterleave = 2", "x.toml:1: gahter: unknown key; did you mean \"gather\"?"),
        ("\n\ngather.interleve = 2", "x.toml:3: gather.interleve: unknown key; did you mean \"interleave\"?"),
        (
            "gather = { method = \"per-pixel\", min-distance = 1 }",
            "x.toml:1: gather.min-distance: unknown key; did you mean \"min_distance\"?",
        ),
        (
            "visibility.ism.points = \"adaptive\"\nvisibility.ism.renderer = \"splat\"",
            "x.toml:1: visibility.ism.points: \"adaptive\" chooses from",
        ),
        (
            "visibility.ism.points = \"adaptive\"\nvisibility.ism.collect = \"tessellation\"",
            "x.toml:1: visibility.ism.points: \"adaptive\" needs",
        ),
        ("visibility.ism.renderer = \"splat\"\nvisibility.ism.normals = true", "x.toml:2: visibility.ism.normals: are kept for"),
        ("[visibility.ism]\nconsidered = 2\ncollected = 3", "x.toml:3: visibility.ism.collected: 3 is over visibility.ism.considered, 2"),
        ("visibility.ism.thin = 1", "x.toml:1: visibility.ism.thin: expects true or false"),
        ("[gather]\ndleta = 2", "x.toml:2: gather.dleta: unknown key; did you mean \"stochastic.delta\"?"),
        ("[vpls]\ndelta = 2", "x.toml:2: vpls.delta: unknown key; did you mean \"gather.stochastic.delta\"?"),
        ("[gather]\nstochastic = \"tiled\"", "x.toml:2: gather.stochastic: expects a table, found a string \"tiled\""),
        ("[vpls]\ninterleave = 2", "x.toml:2: vpls.interleave: unknown key; did you mean \"gather.interleave\"?"),
        ("[vpls]\nwhatever = 2", "x.toml:2: vpls.whatever: unknown key; known here are sampler, count"),
        ("\"gather.interleave\" = 2", "x.toml:1: \"gather.interleave\": unknown key"),
        ("\"\" = 2", "x.toml:1: \"\": unknown key"),
        ("\"a\\nb\" = 2", "x.toml:1: \"a\\nb\": unknown key"),
        (&spot("intensty = [1, 1, 1]"), "x.toml:6: light.0.intensty: unknown key; did you mean \"intensity\"?"),
        (&format!("{SUN}{SPOT}postion = [1, 1, 1]"), "x.toml:10: light.1.postion: unknown key; did you mean \"position\"?"),
        ("[rsm.box]\nmin = [0, 0, 0]\nmx = [1, 1, 1]", "x.toml:3: rsm.box.mx: unknown key; did you mean \"max\"?"),
        // Wrong types.
        ("[vpls]\ncount = \"abc\"", "x.toml:2: vpls.count: expects a whole number, found a string \"abc\""),
        ("[vpls]\ncount = 1.5", "x.toml:2: vpls.count: expects a whole number, found the number 1.5"),
        ("gather = 3", "x.toml:1: gather: expects a table, found the whole number 3"),
        ("[[gather]]", "x.toml:1: gather: expects a table, found a list of 1"),
        ("[light]\nkind = \"spot\"", "x.toml:1: light: expects a list of tables, found a table; each begins with [[light]]"),
        ("light = [3]", "x.toml:1: light.0: expects a table, found the whole number 3"),
        ("[frame]\nsize = 512", "x.toml:2: frame.size: expects [width, height], two whole numbers, found the whole number 512"),
        ("[frame]\nsize = [1, 2, 3]", "x.toml:2: frame.size: expects [width, height], two whole numbers, found a list of 3"),
        ("[frame]\nsize = [1, 2.5]", "x.toml:2: frame.size: expects [width, height], two whole numbers, found the number 2.5 in it"),
        ("[compose]\nexposure = true", "x.toml:2: compose.exposure: expects a number, found the boolean true"),
        ("[compose]\nexposure = 1979-05-27", "x.toml:2: compose.exposure: expects a number, found a date or time"),
        ("[gather]\nmethod = 1", "x.toml:2: gather.method: expects a name, found the whole number 1"),
        ("[output]\nlayers = \"depth\"", "x.toml:2: output.layers: expects a list of names, found a string \"depth\""),
        (
            "[camera]\nposition = [0, 1]\ntarget = [0, 0, 0]",
            "x.toml:2: camera.position: expects [x, y, z], three numbers, found a list of 2",
        ),
        ("[scene]\nfile = \"a.glb\"\nscene = 1.5", "x.toml:3: scene.scene: expects an index or a name, found the number 1.5"),
        ("[scene]\nfile = \"\"", "x.toml:2: scene.file: is empty"),
        ("base = 3", "x.toml:1: base: expects the path of a config, found the whole number 3"),
        // Out of range.
        ("[frame]\nsize = [0, 5]", "x.toml:2: frame.size: 0 is out of range, expected 1 to 16384"),
        ("[frame]\nsize = [\n  640,\n  99999\n]", "x.toml:4: frame.size: 99999 is out of range, expected 1 to 16384"),
        ("[frame]\ncount = 0", "x.toml:2: frame.count: 0 is out of range, expected 1 to 1000000"),
        ("[frame]\nseed = -1", "x.toml:2: frame.seed: -1 is out of range, expected 0 to 4294967295"),
        ("[frame]\nseed = 9223372036854775807", "x.toml:2: frame.seed: 9223372036854775807 is out of range"),
        ("[frame]\nseed = 92233720368547758079", "x.toml:2: frame.seed: expects a whole number, found a whole number beyond 64 bits"),
        ("[frame]\nfps = 0", "x.toml:2: frame.fps: 0 is out of range, expected over 0"),
        ("[gather]\ninterleave = 3", "x.toml:2: gather.interleave: 3 is out of range, expected 1, 2, 4, 8"),
        ("[gather]\nmin_distance = nan", "x.toml:2: gather.min_distance: NaN is out of range, expected 0 to 1e6"),
        ("[gather]\nmin_distance = -0.1", "x.toml:2: gather.min_distance: -0.1 is out of range"),
        ("[compose]\nexposure = inf", "x.toml:2: compose.exposure: inf is out of range, expected over 0 to 1e9"),
        ("[compose]\nexposure = 1e-60", "x.toml:2: compose.exposure: 1e-60 is out of range, expected over 0 to 1e9"),
        ("[filter]\nnormal_threshold_deg = 0", "x.toml:2: filter.normal_threshold_deg: 0 is out of range, expected over 0 to 90"),
        ("[filter]\nradius = 33", "x.toml:2: filter.radius: 33 is out of range, expected 1 to 32"),
        ("[direct]\nblur = 9", "x.toml:2: direct.blur: 9 is out of range, expected 0 to 8"),
        ("[rsm]\nsize = [8193, 1]", "x.toml:2: rsm.size: 8193 is out of range, expected 1 to 8192"),
        ("[vpls]\ncount = 1048577", "x.toml:2: vpls.count: 1048577 is out of range, expected 1 to 1048576"),
        ("[scene]\ntriangles = 7_999", "x.toml:2: scene.triangles: 7999 is out of range, expected 8000 to 10000000"),
        ("[scene]\nfile = \"a.glb\"\nscene = -1", "x.toml:3: scene.scene: -1 is out of range, expected 0 and more, or text"),
        ("[camera]\nfov_y_deg = 171", "x.toml:2: camera.fov_y_deg: 171 is out of range, expected 1 to 170"),
        ("[camera]\nposition = [0, inf, 0]\ntarget = [0, 0, 0]", "x.toml:2: camera.position: inf is out of range, expected -1e7 to 1e7"),
        ("[camera]\nup = [0, 0, 0]", "x.toml:2: camera.up: [0, 0, 0] has no direction"),
        ("[camera]\nup = [0, 1e-300, 0]", "x.toml:2: camera.up: [0, 0, 0] has no direction"),
        (&spot("outer_deg = 0.1"), "x.toml:6: light.0.outer_deg: 0.1 is out of range, expected over 0.1 to 80"),
        (&SUN.replace("[1, 1, 1]", "[1, -1, 1]"), "x.toml:4: light.0.irradiance: -1 is out of range, expected 0 to 1e9"),
        (&SUN.replace("[0, -1, 0]", "[0, 0, 0]"), "x.toml:3: light.0.direction: [0, 0, 0] has no direction"),
        // Unknown names.
        (
            "[compose]\ntonemap = \"rheinhard\"",
            "x.toml:2: compose.tonemap: unknown value \"rheinhard\", expected one of \"reinhard\", \"none\"; did you mean \"reinhard\"?",
        ),
        ("[direct]\nshadows = \"percentage_closer\"", "did you mean \"percentage-closer\"?"),
        ("[gather]\nmethod = \"splat\"", "x.toml:2: gather.method: unknown value \"splat\", expected one of \"per-pixel\", \"stochastic\""),
        ("[output]\nlayers = [\"depth\", \"norml\"]", "x.toml:2: output.layers.1: unknown value \"norml\", expected one of \"direct\""),
        ("[output]\nlayers = [\"depth\", \"depth\"]", "x.toml:2: output.layers.1: \"depth\" is there twice"),
        (
            "[[light]]\nkind = \"sun\"",
            "x.toml:2: light.0.kind: unknown value \"sun\", expected one of \"directional\", \"spot\", \"point\", \"environment\"",
        ),
        ("[[light]]\nkind = 3", "x.toml:2: light.0.kind: expects a name, found the whole number 3"),
        // Invalid TOML.
        ("\u{feff}\r\n[gather]\r\ninterleave = 3\r\n", "x.toml:3: gather.interleave: 3 is out of range"),
        ("[gather]\ninterleave = = 2", "x.toml:2, column 14: not valid TOML: "),
        ("[gather\n", "x.toml:1, column 8: not valid TOML: "),
        ("[gather]\ninterleave = 2\ninterleave = 4", "x.toml:3, column 1: not valid TOML: duplicate key"),
        (&deep, "x.toml:1, column"),
        // Keys that exclude or require each other.
        ("[scene]\nfile = \"a.glb\"\nbuiltin = \"atrium\"", "x.toml:2: scene.file: excludes scene.builtin; give one of them"),
        ("[scene]\nanimation = 1", "x.toml:2: scene.animation: only a glTF file has animations to choose from; give scene.file"),
        ("[scene]\nscene = 1", "x.toml:2: scene.scene: only a glTF file has scenes to choose from; give scene.file"),
        (
            "[scene]\nbuiltin = \"cornell\"\ntriangles = 20000",
            "x.toml:3: scene.triangles: of the built-in scenes only atrium, caustics, courtyard and street have this knob",
        ),
        (
            "[scene]\nfile = \"a.glb\"\nseed = 1",
            "x.toml:3: scene.seed: of the built-in scenes only atrium, courtyard and street have this knob",
        ),
        ("[scene]\nroughness = 0.1", "x.toml:2: scene.roughness: of the built-in scenes only caustics has this knob"),
        ("[scene]\ntriangles = 9000", "x.toml:2: scene.triangles: 9000 is too few for the atrium"),
        ("[scene]\nbuiltin = \"street\"\ntriangles = 19999", "x.toml:3: scene.triangles: 19999 is too few for the street"),
        (
            "[scene]\nbuiltin = \"street\"\ntriangles = 2000001",
            "x.toml:3: scene.triangles: 2000001 is too many for the street, expected 20000 to 2000000",
        ),
        ("[scene]\nbuiltin = \"street\"\nroughness = 0.2", "x.toml:3: scene.roughness: of the built-in scenes only caustics has this knob"),
        ("[vpls]\nimportance = \"passed-flux\"", "x.toml:2: vpls.importance: \"passed-flux\" goes with Hammersley's points alone"),
        ("[vpls]\nsampler = \"uniform\"\nimportance = \"view\"", "x.toml:3: vpls.importance: this sampler draws all texels alike"),
        ("[gather]\ninterleave = [4, 3]", "x.toml:2: gather.interleave: 3 is out of range, expected 1, 2, 4, 8, or two of them"),
        ("[gather]\ninterleave = [4]", "x.toml:2: gather.interleave: expects a whole number, or [width, height], found "),
        ("[vpls]\nreflection = \"both\"", "x.toml:2: vpls.reflection: glossy virtual point lights are summed by stochastic culling alone"),
        (
            "[gather.stochastic]\nreceiver = \"ggx\"",
            "x.toml:2: gather.stochastic.receiver: receivers are glossy with stochastic tiles alone",
        ),
        (
            "[gather]\nmethod = \"stochastic\"\nper_pixel.emitters = \"disks\"",
            "x.toml:3: gather.per_pixel.emitters: stochastic culling bounds the range of points, not of disks",
        ),
        (
            "visibility.method = \"ray-traced\"\n[gather]\nmethod = \"stochastic\"\nstochastic.culling = \"splatting\"",
            "x.toml:4: gather.stochastic.culling: splats and conservative clusters are there to be timed, and have no shadows",
        ),
        (
            "gather.method = \"stochastic\"\n[gather.stochastic]\nculling = \"splatting\"\nstatistics = true",
            "x.toml:4: gather.stochastic.statistics: splats are on no list to be counted",
        ),
        (
            "gather.method = \"stochastic\"\n[gather.stochastic]\nculling = \"splatting\"\nbounds = \"none\"",
            "x.toml:4: gather.stochastic.bounds: \"none\" leaves nothing to draw",
        ),
        (
            "vpls.sampler = \"every-texel\"\nvisibility.method = \"imperfect-shadow-maps\"",
            "x.toml:2: visibility.method: imperfect shadow maps are shared with stochastic tiles alone",
        ),
        ("[camera]\nnode = \"a\"", "x.toml:2: camera.node: only a glTF file has named cameras"),
        ("scene.file = \"a.glb\"\n[camera]\nnode = \"a\"\nup = [0, 1, 0]", "x.toml:4: camera.up: excludes camera.node"),
        ("[camera]\nposition = [0, 0, 0]", "x.toml:2: camera.position: needs camera.target"),
        ("[camera]\nposition = [1, 2, 3]\ntarget = [1, 2, 3]", "x.toml:3: camera.target: is the camera's own position"),
        ("[camera]\nposition = [1, 2, 3]\ntarget = [1, 0, 3]", "x.toml:3: camera.target: lies straight along camera.up"),
        (
            "[camera]\nkeyframes = [\n  { time = 1, position = [0, 0, 0], target = [0, 0, 1] },\n  { time = 1, position = [0, 0, 0], target = [0, 0, 1] },\n]",
            "x.toml:4: camera.keyframes.1.time: 1 is not after the keyframe before it, at 1",
        ),
        ("[[camera.keyframes]]\ntime = 1\ntarget = [0, 0, 0]", "x.toml:1: camera.keyframes.0: needs position"),
        (
            "[camera]\nposition = [0, 0, 0]\ntarget = [0, 0, 1]\n[[camera.keyframes]]\ntime = 0\nposition = [0, 0, 0]\ntarget = [0, 0, 1]",
            "camera.keyframes: excludes camera.position",
        ),
        ("\n[[light]]\nposition = [0, 0, 0]", "x.toml:2: light.0: needs kind, one of \"directional\""),
        ("\n[[light]]\nkind = \"spot\"", "x.toml:2: light.0: a spot light needs position"),
        ("[[light]]\nkind = \"environment\"", "x.toml:1: light.0: an environment light needs radiance"),
        (&sky("rotation_deg = 20"), "x.toml:4: light.0.rotation_deg: turns a map; give map too"),
        (&sky("map = \"\""), "x.toml:4: light.0.map: "),
        (&sky("map = \"sky.exr\"\nrotation_deg = 400"), "x.toml:5: light.0.rotation_deg: 400 is out of range"),
        (
            &sky("[[light]]\nkind = \"environment\"\nradiance = [1, 1, 1]\nmap = \"sky.exr\""),
            "x.toml:7: light.1.map: a map is the only environment; remove the other lights of this kind",
        ),
        ("[sky]\ncount = 5000", "x.toml:2: sky.count: 5000 is out of range, expected 1 to 4096"),
        ("[[light]]\nkind = \"directional\"\nirradiance = [1, 1, 1]", "x.toml:1: light.0: needs direction or target"),
        (&spot("direction = [0, -1, 0]"), "x.toml:4: light.0.target: excludes direction; give one of them"),
        (&spot("irradiance = [1, 1, 1]"), "x.toml:6: light.0.irradiance: a spot light has no irradiance; give intensity"),
        (&sun("intensity = [1, 1, 1]"), "x.toml:5: light.0.intensity: a directional light has no intensity; give irradiance"),
        (&sun("outer_deg = 20"), "x.toml:5: light.0.outer_deg: a directional light has no outer_deg"),
        (&sun("position = [0, 1, 0]"), "x.toml:5: light.0.position: a directional light has a position only together with target"),
        (&spot("inner_deg = 20\nouter_deg = 10"), "x.toml:6: light.0.inner_deg: 20 is more than outer_deg, 10"),
        (&SPOT.replace("[0, 0, 0]", "[0, 3, 0]"), "x.toml:4: light.0.target: is the light's own position"),
        (
            &spot("keyframes = [{ time = 0, direction = [0, 0, 1] }]"),
            "x.toml:6: light.0.keyframes.0.direction: the light is aimed by target",
        ),
        (
            &spot("keyframes = [{ time = 0, irradiance = [0, 0, 1] }]"),
            "x.toml:6: light.0.keyframes.0.irradiance: a spot light has no irradiance; give intensity",
        ),
        (&spot("[[light.keyframes]]\nposition = [0, 0, 0]"), "x.toml:6: light.0.keyframes.0: needs time"),
        (
            &sun("keyframes = [{ time = 0, position = [0, 0, 1] }]"),
            "x.toml:5: light.0.keyframes.0.position: a directional light has a position only",
        ),
        ("[rsm.box]\nmin = [0, 0, 0]", "x.toml:1: rsm.box: needs max"),
        ("[rsm.box]\nmin = [0, 1, 0]\nmax = [1, 1, 1]", "x.toml:1: rsm.box: min must be less than max on every axis"),
    ];
    for (text, expected) in cases {
        match parse(text, &[]) {
            Ok(_) => panic!("accepted:\n{text}"),
            Err(error) => assert!(error.contains(expected), "for\n{text}\nexpected {expected}\nfound    {error}"),
        }
    }
}

#[test]
fn overrides_are_refused_with_the_option_as_their_place() {
    let cases: &[(&str, &str, &str)] = &[
        ("", "gather.interleve=2", "--set gather.interleve=2: gather.interleve: unknown key; did you mean \"interleave\"?"),
        ("", "gather.interleave=3", "--set gather.interleave=3: gather.interleave: 3 is out of range"),
        ("", "gather.method=splat", "--set gather.method=splat: gather.method: unknown value \"splat\""),
        ("", "gather.method", "--set \"gather.method\": expects key=value"),
        ("", "=2", "--set =2: expects a dotted key"),
        ("", "gather..interleave=2", "--set gather..interleave=2: expects a dotted key"),
        ("gather.interleave = 2", "gather.interleave.x=2", "gather.interleave: is no table, it has no key \"x\""),
        ("", "base=x.toml", "--set base=x.toml: base: only a file has a base"),
        (SPOT, "light.1.intensity=[1, 1, 1]", "light: has one entry, 0, and none called \"1\""),
        ("", "light.0.intensity=[1, 1, 1]", "--set light.0.intensity=[1, 1, 1]: light: expects a list of tables"),
        (SPOT, "light.0.intensity=[1, 1", "light.0.intensity: expects [red, green, blue], three numbers, found a string \"[1, 1\""),
        (SPOT, "light.0.kind=point", "x.toml:4: light.0.target: a point light has no target"),
        ("", "a\nb=1", "--set a\\nb=1: \"a\\nb\": unknown key"),
    ];
    for (text, set, expected) in cases {
        let error = parse(text, &[set]).expect_err(set);
        assert!(error.contains(expected), "for {set}\nexpected {expected}\nfound    {error}");
    }
}

#[test]
fn overrides_are_toml_or_bare_strings_and_the_last_one_wins() {
    let config = parse(
        SPOT,
        &[
            "gather.method=per-pixel",
            "gather.interleave = 2",
            "gather.interleave=8",
            "frame.size=[64, 32]",
            "light.0.intensity=[1, 2, 3]",
            "light.0.intensity.1=5",
            "light.0.direction=[0, -1, 0]",
            "compose.tonemap=\"none\"",
            "output.layers=[]",
            "filter={ kind = \"none\" }",
            "camera.fov_y_deg=40",
        ],
    )
    .unwrap();
    assert_eq!(config.gather.interleave, 8.into());
    assert_eq!(config.frame.size, [64, 32]);
    assert_eq!(config.compose.tonemap, Tonemap::None);
    assert_eq!(config.output.layers, []);
    assert_eq!(config.filter, FilterConfig { kind: FilterKind::None, ..Default::default() });
    assert_eq!(config.camera.unwrap().fov_y_deg, Some(40.0));
    let LightConfig::Spot { direction, target, intensity, .. } = &config.light[0] else { panic!("a spot light") };
    assert_eq!((*direction, *target, *intensity), (Some([0.0, -1.0, 0.0]), None, [1.0, 5.0, 3.0]));
    assert_eq!(parse(SPOT, &["light=[]"]).unwrap().light, []);
}

#[test]
fn a_config_lies_over_its_base_key_by_key_and_a_list_replaces_a_list() {
    let folder = Folder::new(
        "base",
        &[
            ("presets/far.toml", "[scene]\nbuiltin = \"atrium\"\ntriangles = 50000\n[gather]\ninterleave = 8\nmin_distance = 0.1\n"),
            ("presets/near.toml", &format!("base = \"far.toml\"\n[gather]\nmin_distance = 0.2\n{SUN}{SPOT}")),
            ("top.toml", "base = \"presets/near.toml\"\n[vpls]\ncount = 64\n[[light]]\nkind = \"environment\"\nradiance = [1, 1, 1]\n"),
        ],
    );
    let config = folder.load("top.toml", &[]).unwrap();
    assert_eq!((config.gather.interleave, config.gather.min_distance, config.vpls.count), (8.into(), 0.2, 64));
    assert_eq!(config.scene.triangles, 50_000);
    assert_eq!(config.light, [LightConfig::Environment { radiance: [1.0; 3], map: None, rotation_deg: 0.0 }]);
    assert_eq!(folder.load("top.toml", &["scene.builtin=cornell"]).unwrap().scene.builtin, Some(Builtin::Cornell));
}

#[test]
fn a_base_is_a_preset_by_its_name_in_every_folder_and_a_file_goes_first() {
    let folder = Folder::new(
        "base-preset",
        &[
            ("name.toml", "base = \"barak\""),
            ("file.toml", "base = \"barak.toml\""),
            ("own/barak.toml", "vpls.count = 7"),
            ("own/top.toml", "base = \"barak.toml\""),
        ],
    );
    for file in ["name.toml", "file.toml"] {
        assert_eq!(folder.load(file, &[]).unwrap().vpls.sampler, manylight::config::VplSampler::MetropolisHastings, "{file}");
    }
    assert_eq!(folder.load("own/top.toml", &[]).unwrap().vpls.count, 7);
}

#[test]
fn a_preset_starts_from_presets_whatever_is_called_like_them() {
    // "lightskin" starts from "street".
    let folder = Folder::new(
        "preset-base",
        &[("street.toml", "base = \"lightskin\""), ("linke/a.toml", "vpls.count = 7"), ("folder.toml", "base = \"linke\"")],
    );
    let config = folder.load("street.toml", &[]).unwrap();
    assert_eq!((config.scene.builtin, config.gather.method), (Some(Builtin::Street), manylight::config::GatherMethod::LightCaches));
    assert_ne!(folder.load("folder.toml", &[]).unwrap().vpls.count, 7);
}

#[test]
fn a_preset_by_its_name_starts_from_presets_as_well() {
    // "linke" starts from "first-light", and a folder hides no preset.
    let place = crate::place::Place::new(&[("first-light.toml", "vpls.count = 7\n[nonsense]"), ("linke/a.toml", "")]);
    place.succeeds("render linke --size 16x9 --set frame.count=1 --set frame.warmup=0 --set visibility.method=none -o out");
}

#[test]
fn keys_of_pull_and_push_and_of_the_shadow_map_are_told_where_nothing_takes_them() {
    let warnings = |text: &str| manylight::config::parse(text, "c.toml".as_ref(), &[]).unwrap().warnings.join("\n");
    let ism = "base = \"linke\"\n[visibility.ism]\n";
    for (text, says) in [
        (format!("{ism}renderer = \"splat\"\npull_push.grow = 0.5"), Some("visibility.ism.pull_push")),
        (format!("{ism}normals = true\npull_push.spread = 0.5"), Some("visibility.ism.pull_push.spread")),
        (format!("{ism}normals = true\npull_push.interval = 1"), Some("visibility.ism.pull_push.interval")),
        (format!("{ism}distortion = false\npull_push.interval = 1"), Some("visibility.ism.pull_push.interval")),
        (format!("{ism}pull_push = {{ grow = 0.0, interval = 1, spread = 0.0 }}"), None),
        ("direct = { shadows = \"ray-traced\", map_size = [64, 64] }".to_owned(), Some("direct.map_size")),
        ("direct = { shadows = \"variance\", map_size = [64, 64] }".to_owned(), None),
    ] {
        let said = warnings(&text);
        assert_eq!(said.is_empty(), says.is_none(), "{text}: {said}");
        assert!(says.is_none_or(|key| said.contains(key)), "{text}: {said}");
    }
}

#[test]
fn a_key_displaces_what_it_excludes_in_a_base() {
    let camera = "[camera]\nposition = [0, 0, 0]\ntarget = [0, 0, 1]\nup = [0, 1, 0]\n";
    let path = "[[camera.keyframes]]\ntime = 0\nposition = [0, 0, 0]\ntarget = [0, 0, 2]\n";
    let folder = Folder::new(
        "displaced",
        &[
            ("built.toml", "[scene]\nbuiltin = \"atrium\"\ntriangles = 20000\n"),
            ("box.glb", ""),
            ("file.toml", "base = \"built.toml\"\n[scene]\nfile = \"box.glb\"\n[camera]\nnode = \"eye\"\n"),
            ("back.toml", "base = \"file.toml\"\n[scene]\nbuiltin = \"cornell\"\n[camera]\nposition = [0, 0, 0]\ntarget = [0, 0, 1]\n"),
            ("camera.toml", camera),
            ("node.toml", "base = \"camera.toml\"\nscene.file = \"box.glb\"\ncamera.node = \"eye\"\n"),
            ("path.toml", &format!("base = \"camera.toml\"\n{path}")),
            ("still.toml", &format!("base = \"path.toml\"\n{camera}")),
        ],
    );
    let file = folder.load("file.toml", &[]).unwrap();
    assert_eq!((file.scene.file.clone(), file.scene.builtin), (Some(folder.0.join("box.glb")), None));
    let back = folder.load("back.toml", &[]).unwrap();
    assert_eq!((back.scene.file, back.scene.builtin), (None, Some(Builtin::Cornell)));
    assert_eq!(back.camera.unwrap().node, None);
    let node = folder.load("node.toml", &[]).unwrap().camera.unwrap();
    assert_eq!((node.node.as_deref(), node.position, node.up), (Some("eye"), None, None));
    let path = folder.load("path.toml", &[]).unwrap().camera.unwrap();
    assert_eq!((path.keyframes.len(), path.position), (1, None));
    assert_eq!(folder.load("still.toml", &[]).unwrap().camera.unwrap().keyframes, []);
    let caustics = Folder::new(
        "caustics",
        &[
            ("caustics.toml", "[scene]\nbuiltin = \"caustics\"\nroughness = 0.1\n"),
            ("box.glb", ""),
            ("file.toml", "base = \"caustics.toml\"\n[scene]\nfile = \"box.glb\"\nanimation = 0\n"),
            ("cornell.toml", "base = \"file.toml\"\n[scene]\nbuiltin = \"cornell\"\n"),
        ],
    );
    assert_eq!(caustics.load("file.toml", &[]).unwrap().scene.builtin, None);
    assert_eq!(caustics.load("cornell.toml", &[]).unwrap().scene.builtin, Some(Builtin::Cornell));
    let both = folder.load("file.toml", &["scene.file=box.glb", "scene.builtin=cornell"]).unwrap_err();
    assert!(both.contains("--set scene.file=box.glb: scene.file: excludes scene.builtin"), "{both}");
}

#[test]
fn mistakes_in_a_base_are_found_in_the_base() {
    let folder = Folder::new(
        "mistakes",
        &[
            ("presets/bad.toml", "# A comment.\n[gather]\ninterleve = 4\n"),
            ("top.toml", "\n[vpls]\ncount = 4\n"),
            ("over-bad.toml", "base = \"presets/bad.toml\"\n[gather]\ninterleave = 2\n"),
            ("range.toml", "base = \"range-base.toml\"\n[filter]\nkind = \"none\"\n"),
            ("range-base.toml", "[filter]\nradius = 0\n"),
            ("a.toml", "base = \"b.toml\""),
            ("b.toml", "\nbase = \"a.toml\""),
            ("self.toml", "base = \"./self.toml\""),
            ("lost.toml", "\nbase = \"nowhere.toml\""),
            ("folder.toml", "base = \"presets\""),
            ("control.toml", "base = \"a\\nb\\u0000\""),
            ("syntax.toml", "base = \"broken.toml\""),
            ("broken.toml", "[gather]\n=\n"),
            ("scene.toml", "[scene]\nfile = \"nowhere.glb\"\n"),
            ("huge.toml", &"#".repeat((1 << 20) + 1)),
        ],
    );
    fs::write(folder.0.join("latin.toml"), b"# caf\n[gather] # caf\xe9\n").unwrap();
    for (index, next) in (0..20).zip(1..) {
        fs::write(folder.0.join(format!("chain{index}.toml")), format!("base = \"chain{next}.toml\"")).unwrap();
    }
    let cases = [
        ("over-bad.toml", "presets/bad.toml:3: gather.interleve: unknown key; did you mean \"interleave\"?"),
        ("range.toml", "range-base.toml:2: filter.radius: 0 is out of range"),
        ("a.toml", "b.toml:2: base: the chain of bases is a circle: a.toml -> b.toml -> a.toml"),
        ("self.toml", "self.toml:1: base: the chain of bases is a circle: self.toml -> ./self.toml"),
        ("lost.toml", "lost.toml:2: base: nowhere.toml: there is no such file"),
        ("folder.toml", "folder.toml:1: base: presets: is not a file"),
        ("control.toml", "control.toml:1: base: a\\nb\\0: cannot be read"),
        ("syntax.toml", "broken.toml:2, column 1: not valid TOML"),
        ("missing.toml", "missing.toml: there is no such file"),
        ("presets", "presets: is not a file"),
        ("scene.toml", "scene.toml:2: scene.file: nowhere.glb does not exist"),
        ("huge.toml", "huge.toml: is larger than 1 MiB"),
        ("latin.toml", "latin.toml:2: is not UTF-8 text"),
        ("chain0.toml", "chain15.toml:1: base: the chain of bases is longer than 16 files"),
    ];
    for (file, expected) in cases {
        let error = folder.load(file, &[]).expect_err(file);
        assert!(error.starts_with(expected), "for {file}\nexpected {expected}\nfound    {error}");
    }
}

#[test]
fn paths_start_from_the_file_that_says_them_and_from_the_current_folder_for_set() {
    let folder = Folder::new(
        "paths",
        &[("models/box.glb", ""), ("models/base.toml", "scene.file = \"box.glb\""), ("runs/top.toml", "base = \"../models/base.toml\"")],
    );
    let file = folder.load("runs/top.toml", &[]).unwrap().scene.file.unwrap();
    let skies = [
        ("models/sky.exr", ""),
        ("models/sky.toml", "[[light]]\nkind = \"environment\"\nradiance = [1, 1, 1]\nmap = \"sky.exr\""),
        ("runs/sky.toml", "base = \"../models/sky.toml\""),
        ("runs/none.toml", "[[light]]\nkind = \"environment\"\nradiance = [1, 1, 1]\nmap = \"sky.exr\""),
    ];
    let skies = Folder::new("skies", &skies);
    let config = skies.load("runs/sky.toml", &[]).unwrap();
    let (key, map) = config.sky_map().unwrap();
    assert!(key == "light.0.map" && map.is_absolute() && map.ends_with("sky.exr") && map.is_file(), "{key}: {}", map.display());
    let error = skies.load("runs/none.toml", &[]).unwrap_err();
    assert!(error.contains("none.toml:4: light.0.map: ") && error.ends_with("sky.exr does not exist"), "{error}");
    assert!(file.is_absolute() && file.ends_with("box.glb") && file.is_file(), "{}", file.display());
    let here = parse("", &["scene.file=box.glb"]).unwrap().scene.file.unwrap();
    assert_eq!(here, std::env::current_dir().unwrap().join("box.glb"));
}

/// A config that sets every key allowed with the atrium to a value other than its default.
const FULL: &str = include_str!("../fuzz/seeds/config/full.toml");

#[test]
fn a_resolved_config_is_written_as_toml_that_loads_to_the_same_value() {
    let texts = [
        "",
        FULL,
        "scene.builtin = \"cornell\"",
        "scene.builtin = \"street\"\nscene.seed = 3\nscene.triangles = 20000",
        "scene.builtin = \"caustics\"\nscene.roughness = 0.3\nscene.triangles = 8190",
        "scene.file = \"a b.glb\"\nscene.scene = 2\ncamera.node = \"eye\\n\\\"\"",
        "scene.file = \"a.glb\"\nscene.scene = \"main\"\nscene.animation = \"none\"\n[camera]\nposition = [0, 0, 0]\ntarget = [0, 0, 1]",
        "[camera]\nfov_y_deg = 20",
        "[output]\nlayers = []",
    ];
    for text in texts {
        let config = parse(text, &[]).unwrap();
        let saved = to_toml(&config);
        let again = config::parse(&saved, Path::new("elsewhere/run.toml"), &[]).unwrap_or_else(|error| panic!("{error:#}\n{saved}"));
        assert_eq!(again.config, config, "\n{saved}");
        let warns = again.warnings.len();
        assert!(warns <= warnings(text, &[]).len(), "{:?}\n{saved}", again.warnings);
    }
}

#[test]
fn the_list_of_keys_is_what_the_types_take() {
    let file = parse("scene.file = \"a.glb\"\nscene.scene = 2\nscene.animation = 1\n[camera]\nnode = \"eye\"", &[]).unwrap();
    let still = parse("[camera]\nposition = [0, 0, 0]\ntarget = [0, 0, 1]", &[]).unwrap();
    let mut found: Vec<String> = vec!["base".to_owned()];
    let metal = parse("scene.builtin = \"caustics\"", &[]).unwrap();
    for config in [&parse(FULL, &[]).unwrap(), &file, &still, &metal] {
        leaves(&toml::Value::try_from(config).unwrap(), String::new(), &mut found);
    }
    found.sort();
    found.dedup();
    let mut listed: Vec<_> = keys().iter().filter(|key| key.kind != Kind::Table).map(|key| key.key.clone()).collect();
    listed.sort();
    listed.dedup();
    assert_eq!(found, listed);
}

/// Dotted keys of a value; indices in lists of tables become `N`.
fn leaves(value: &toml::Value, path: String, found: &mut Vec<String>) {
    match value {
        toml::Value::Table(table) => {
            for (key, value) in table {
                leaves(value, if path.is_empty() { key.clone() } else { format!("{path}.{key}") }, found);
            }
        }
        toml::Value::Array(items) if items.iter().any(toml::Value::is_table) => {
            items.iter().for_each(|item| leaves(item, format!("{path}.N"), found));
            found.push(path);
        }
        _ => found.push(path),
    }
}

#[test]
fn every_default_in_the_list_of_keys_is_accepted_and_changes_nothing() {
    for key in keys().iter().filter(|key| !key.key.contains(".N.")) {
        let Some(default) = key.default.as_deref().filter(|text| text.parse::<toml::Value>().is_ok()) else { continue };
        let config = parse("", &[&format!("{}={default}", key.key)]).unwrap();
        assert_eq!(Config { camera: None, ..config }, Config::default(), "{} = {default}", key.key);
    }
}

#[test]
fn every_name_in_the_list_of_keys_is_accepted() {
    let mut names = 0;
    for key in keys() {
        let (Kind::Choice(choices) | Kind::Choices(choices)) = &key.kind else { continue };
        assert!(!choices.is_empty(), "{}", key.key);
        for Choice { name, what } in choices.iter() {
            assert!(what.ends_with('.'), "{} = {name:?} is not explained: {what}", key.key);
            if key.key.contains(".N.") {
                continue;
            }
            let value = if matches!(key.kind, Kind::Choices(_)) { format!("[\"{name}\"]") } else { name.clone() };
            // Settings that some choices require.
            let base = match key.key.as_str() {
                "vpls.reflection" | "gather.stochastic.receiver" => "gather.method = \"stochastic\"",
                "vpls.importance" => "vpls.sampler = \"hammersley\"",
                _ => "",
            };
            parse(base, &[&format!("{}={value}", key.key)]).unwrap();
            names += 1;
        }
    }
    assert!(names >= 20, "{names}");
}

#[test]
fn the_page_of_keys_has_a_row_for_every_key_and_four_columns() {
    let page = markdown();
    let rows: Vec<&str> = page.lines().filter(|line| line.starts_with("| `")).collect();
    let sections = keys().iter().filter(|key| key.kind == Kind::Table).count();
    assert_eq!(rows.len() + sections, keys().len());
    for line in rows {
        assert_eq!(line.matches('|').count(), 5, "{line}");
    }
    assert!(page.contains("| `gather.min_distance` | `0.3` | 0 to 1e6 |"), "{page}");
}

#[test]
fn every_key_and_section_is_explained_in_sentences() {
    for key in keys() {
        assert!(key.what.ends_with('.') && !key.what.contains('\n'), "{}: {}", key.key, key.what);
    }
}

#[test]
fn the_configs_that_come_with_the_program_load_and_use_all_that_they_say() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs");
    let mut count = 0;
    for file in fs::read_dir(&folder).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let loaded = config::load(&path, &[]).unwrap_or_else(|error| panic!("{error:#}"));
            assert_eq!(loaded.warnings, Vec::<String>::new());
            count += 1;
        }
    }
    assert!(count >= 2, "{count}");
    for (name, text) in manylight::presets::views() {
        // A view may have the spacing of its scene's light caches, which other methods do not use.
        let method = text.contains("[gather.light_caches]").then_some("gather.method=\"light-caches\"");
        assert_eq!(warnings(text, method.as_slice()), Vec::<String>::new(), "{name}");
    }
    let first = config::load(&folder.join("first-light.toml"), &[]).unwrap().config;
    assert_eq!((first.scene.builtin, first.frame.size), (Some(Builtin::Atrium), [960, 540]));
}

#[test]
fn an_old_name_of_a_key_is_refused_with_the_new_one() {
    let moved = [
        ("gather", "stochastic", "bounds delta roulette statistics receiver"),
        ("gather", "conservative_clusters", "rasterization nodes"),
        ("gather", "per_pixel", "culling emitters"),
        (
            "visibility",
            "ism",
            "renderer collect points point_count thin capacity map_size considered collected distortion clamp enlarge normals shared_maps",
        ),
        ("bounce", "clusters", "representative centers rounds position_weight normal_weight map_size layers"),
    ];
    for (section, part, names) in moved {
        for name in names.split(' ') {
            let (old, new) = (format!("{section}.{name}"), format!("{section}.{part}.{name}"));
            assert!(keys().iter().any(|key| key.key == new), "{new}");
            assert_eq!(parse(&format!("\n[{section}]\n{name} = 1"), &[]), Err(format!("x.toml:3: {old}: is now {new}")));
            assert_eq!(parse("", &[&format!("{old}=tiled")]), Err(format!("--set {old}=tiled: {old}: is now {new}")));
        }
    }
    for (old, culling) in [("stochastic-tiled", "tiled"), ("splatting", "splatting"), ("conservative-clusters", "conservative-clusters")] {
        let expected =
            format!("x.toml:1: gather.culling: is now gather.method = \"stochastic\" with gather.stochastic.culling = \"{culling}\"");
        assert_eq!(parse(&format!("gather = {{ culling = \"{old}\" }}"), &[]), Err(expected));
    }
    let clusters = "x.toml:1: bounce.clusters: is now bounce.clusters.count";
    assert_eq!(parse("bounce.clusters = 8", &[]).as_ref().map_err(String::as_str), Err(clusters));
    assert_eq!(parse("bounce.clusters = 8", &["bounce.clusters.rounds=2"]).as_ref().map_err(String::as_str), Err(clusters));
    let folder = Folder::new("moved", &[("old.toml", "\n[bounce]\nlayers = \"instanced\""), ("new.toml", "base = \"old.toml\"")]);
    let error = folder.load("new.toml", &[]).unwrap_err();
    assert_eq!(error, "old.toml:3: bounce.layers: is now bounce.clusters.layers");
}

#[test]
fn a_key_that_is_not_used_is_warned_of_with_file_line_and_reason() {
    let is = |path: &str, since: &str| format!("{path}: is not used, since {since}");
    let cases: &[(&str, &[&str], &[String])] = &[
        ("gather.interleave = 2", &[], &[]),
        ("[gather.stochastic]\n\ndelta = 0.1", &[], &[is("x.toml:3: gather.stochastic.delta", "gather.method is \"per-pixel\"")]),
        ("[gather]\nmethod = \"stochastic\"\n[gather.stochastic]\ndelta = 0.1", &[], &[]),
        (
            "[gather]\nmethod = \"stochastic\"\nper_pixel.culling = \"none\"\nconservative_clusters.nodes = 5",
            &[],
            &[
                is("x.toml:3: gather.per_pixel.culling", "gather.method is \"stochastic\""),
                is("x.toml:4: gather.conservative_clusters.nodes", "gather.stochastic.culling is \"tiled\""),
            ],
        ),
        (
            "",
            &["gather.stochastic.delta=0.1"],
            &[is("--set gather.stochastic.delta=0.1: gather.stochastic.delta", "gather.method is \"per-pixel\"")],
        ),
        // Whoever changes the method above need not take the keys away, but what is said there too is a mistake.
        ("[gather]\nmethod = \"stochastic\"\n[gather.stochastic]\ndelta = 0.1", &["gather.method=per-pixel"], &[]),
        (
            "[gather]\nmethod = \"stochastic\"",
            &["gather.method=per-pixel", "gather.stochastic.bounds=none"],
            &[is("--set gather.stochastic.bounds=none: gather.stochastic.bounds", "gather.method is \"per-pixel\"")],
        ),
        ("visibility.ism.thin = true", &[], &[is("x.toml:1: visibility.ism.thin", "visibility.method is \"none\" and bounce.count is 1")]),
        (
            "bounce.count = 2\nvisibility.bias = 1",
            &[],
            &[is("x.toml:2: visibility.bias", "visibility.method is \"none\" and bounce.visibility is \"none\"")],
        ),
        ("bounce.count = 2\nbounce.visibility = \"imperfect-shadow-maps\"\nvisibility.ism.thin = true", &[], &[]),
        ("visibility.method = \"clusters\"\nvisibility.bias = 1\nbounce.clusters.count = 4", &[], &[]),
        (
            "visibility.method = \"imperfect-shadow-maps\"\nvisibility.ism.shared_maps = 9",
            &[],
            &[is("x.toml:2: visibility.ism.shared_maps", "vpls.sampler is \"regular\"")],
        ),
        (
            "[bounce]\nvpls = 9\nclusters.count = 4",
            &[],
            &[
                is("x.toml:2: bounce.vpls", "bounce.count is 1"),
                is("x.toml:3: bounce.clusters.count", "bounce.count is 1 and visibility.method is \"none\""),
            ],
        ),
        ("vpls.count = 9\nvpls.sampler = \"every-texel\"", &[], &[is("x.toml:1: vpls.count", "vpls.sampler is \"every-texel\"")]),
        ("[filter]\nkind = \"none\"\nradius = 2", &[], &[is("x.toml:3: filter.radius", "filter.kind is \"none\"")]),
        ("[direct]\nshadows = \"ray-traced\"\nblur = 2", &[], &[is("x.toml:3: direct.blur", "direct.shadows is \"ray-traced\"")]),
        ("ssao.samples = 9", &[], &[is("x.toml:1: ssao.samples", "ssao.method is \"none\"")]),
        ("ssao.samples = 9\nssao.method = \"horizons\"", &[], &[]),
    ];
    for (text, sets, expected) in cases {
        assert_eq!(warnings(text, sets), *expected, "{text} {sets:?}");
    }
}

#[test]
fn a_key_of_a_base_is_warned_of_unless_its_method_was_changed_above_it() {
    let folder = Folder::new(
        "unused",
        &[
            ("base.toml", "[ssao]\nmethod = \"horizons\"\nsamples = 9"),
            ("off.toml", "base = \"base.toml\"\nssao.method = \"none\""),
            ("both.toml", "base = \"base.toml\"\n[ssao]\nmethod = \"none\"\nradius = 1"),
            ("later.toml", "base = \"off.toml\"\nssao.radius = 1"),
            ("never.toml", "ssao.samples = 9"),
            ("over-never.toml", "base = \"never.toml\""),
        ],
    );
    let warned = |file: &str| folder.loaded(file, &[]).unwrap().warnings;
    let is = |place: &str| vec![format!("{place}: is not used, since ssao.method is \"none\"")];
    assert_eq!((warned("base.toml"), warned("off.toml")), (vec![], vec![]));
    assert_eq!(warned("both.toml"), is("both.toml:4: ssao.radius"));
    assert_eq!(warned("later.toml"), is("later.toml:2: ssao.radius"));
    assert_eq!(warned("over-never.toml"), is("never.toml:1: ssao.samples"));
}
