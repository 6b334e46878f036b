//! What no single key can say: keys that exclude or need each other, keyframes in order, lights and cameras that look somewhere.

use super::check::error;
use super::tree::{Node, Origin, Table, Value};
use super::{
    Bounds, Builtin, CameraConfig, Collect, Config, Culling, Emitters, Importance, IsmRenderer, LightConfig, LightKeyframe, PointSet,
    Receiver, Reflection, VisibilityConfig, VisibilityMethod, VplSampler,
};
use anyhow::Result;
use glam::DVec3;

/// Rules on keys that are there or not, before defaults fill them in.
pub fn given(root: &Table) -> Result<()> {
    let section = |name| match root.get(name) {
        Some(Node { value: Value::Table(table), .. }) => Some(table),
        _ => None,
    };
    if let Some(scene) = section("scene") {
        if let (Some(file), Some(_)) = (scene.get("file"), scene.get("builtin")) {
            return Err(error(&file.origin, "scene.file", "excludes scene.builtin; give one of them"));
        }
        if let (None, Some(node)) = (scene.get("file"), scene.get("scene")) {
            return Err(error(&node.origin, "scene.scene", "only a glTF file has scenes to choose from; give scene.file"));
        }
        if let (None, Some(node)) = (scene.get("file"), scene.get("animation")) {
            return Err(error(&node.origin, "scene.animation", "only a glTF file has animations to choose from; give scene.file"));
        }
        let builtin = match scene.get("builtin") {
            _ if scene.contains_key("file") => "",
            Some(Node { value: Value::Text(name), .. }) => name.as_str(),
            _ => "atrium",
        };
        let knobs: [(&str, &[&str]); 3] = [("triangles", &["atrium", "caustics"]), ("seed", &["atrium"]), ("roughness", &["caustics"])];
        for (knob, scenes) in knobs {
            if let (false, Some(node)) = (scenes.contains(&builtin), scene.get(knob)) {
                let scenes = scenes.join(" and ");
                return Err(error(
                    &node.origin,
                    &format!("scene.{knob}"),
                    format_args!("of the built-in scenes only {scenes} has this knob; remove it"),
                ));
            }
        }
    }
    if let Some(rsm) = section("rsm")
        && let Some(Node { value: Value::Table(bounds), origin }) = rsm.get("box")
        && let Some(missing) = ["min", "max"].into_iter().find(|corner| !bounds.contains_key(*corner))
    {
        return Err(error(origin, "rsm.box", format_args!("needs {missing}")));
    }
    Ok(())
}

/// Rules on the values, with the tree that they came from to say where.
pub fn values(config: &Config, root: &Node) -> Result<()> {
    let fail = |path: String, message: String| Err(error_at(root, &path, message));
    if let Err((key, message)) = visibility(&config.visibility) {
        return fail(format!("visibility{key}"), message);
    }
    if let Some(bounds) = config.rsm.bounds
        && (0..3).any(|axis| bounds.min[axis] >= bounds.max[axis])
    {
        return fail("rsm.box".to_owned(), "min must be less than max on every axis".to_owned());
    }
    if config.scene.builtin == Some(Builtin::Atrium) && config.scene.triangles < 10_000 {
        return fail(
            "scene.triangles".to_owned(),
            format!("{} is too few for the atrium, expected 10000 to 8000000", config.scene.triangles),
        );
    }
    if config.vpls.importance != Importance::None && config.vpls.sampler != VplSampler::Hammersley {
        let message = "only Hammersley's points are drawn by importance; take vpls.sampler = \"hammersley\"";
        return fail("vpls.importance".to_owned(), message.to_owned());
    }
    if config.vpls.reflection != Reflection::Diffuse && !config.gather.culling.is_stochastic() {
        let message = "glossy virtual point lights are summed by stochastic culling alone; take gather.culling = \"stochastic-tiled\"";
        return fail("vpls.reflection".to_owned(), message.to_owned());
    }
    if matches!(config.gather.culling, Culling::Splatting | Culling::ConservativeClusters) {
        if config.visibility_methods().any(|method| method != VisibilityMethod::None) {
            let message = "splats and conservative clusters are there to be timed, and have no shadows; take visibility.method = \"none\"";
            return fail("gather.culling".to_owned(), message.to_owned());
        }
        if config.gather.statistics && config.gather.culling == Culling::Splatting {
            let message = "splats are on no list to be counted; take another gather.culling";
            return fail("gather.statistics".to_owned(), message.to_owned());
        }
        if config.gather.bounds == Bounds::None {
            let message = "\"none\" leaves nothing to draw; take another, or gather.culling = \"stochastic-tiled\"";
            return fail("gather.bounds".to_owned(), message.to_owned());
        }
    }
    if config.shared_maps().is_some() && config.gather.culling != Culling::StochasticTiled {
        let message = "imperfect shadow maps are shared with stochastic tiles alone; take gather.culling = \"stochastic-tiled\" or another vpls.sampler";
        return fail("visibility.method".to_owned(), message.to_owned());
    }
    if config.gather.receiver == Receiver::Ggx && config.gather.culling != Culling::StochasticTiled {
        let message = "receivers are glossy with stochastic tiles alone; take gather.culling = \"stochastic-tiled\"";
        return fail("gather.receiver".to_owned(), message.to_owned());
    }
    if config.gather.culling.is_stochastic() && config.gather.emitters == Emitters::Disks {
        let message = "stochastic culling bounds the range of points, not of disks; take emitters = \"points\"";
        return fail("gather.emitters".to_owned(), message.to_owned());
    }
    if config.camera.as_ref().is_some_and(|camera| camera.node.is_some()) && config.scene.file.is_none() {
        let builtin = match config.scene.builtin {
            Some(Builtin::Cornell) => "cornell",
            Some(Builtin::Caustics) => "caustics",
            Some(Builtin::Atrium) | None => "atrium",
        };
        let message = format!("only a glTF file has named cameras, and the scene is the built-in {builtin}; give position and target");
        return fail("camera.node".to_owned(), message);
    }
    if let Some(camera) = &config.camera
        && let Err((key, message)) = self::camera(camera)
    {
        return fail(format!("camera{key}"), message);
    }
    for (index, light) in config.light.iter().enumerate() {
        if let Err((key, message)) = self::light(light) {
            return fail(format!("light.{index}{key}"), message);
        }
    }
    Ok(())
}

/// Which ways of making imperfect shadow maps go together.
fn visibility(config: &VisibilityConfig) -> Result<(), Broken> {
    let splat = config.renderer == IsmRenderer::Splat;
    if config.points == PointSet::Adaptive {
        if splat {
            return broken(
                ".points",
                "\"adaptive\" chooses from points that a buffer holds, and splats come from no buffer; take renderer = \"single-pixel\"",
            );
        }
        if config.collect == Collect::Tessellation {
            return broken(
                ".points",
                "\"adaptive\" needs its points in an order that the tessellator does not keep; take collect = \"compute\"",
            );
        }
    }
    if config.normals && splat {
        return broken(
            ".normals",
            "are kept for what fills the holes between single pixels, and splats have none of it; take renderer = \"single-pixel\"",
        );
    }
    if let (Some(considered), Some(collected)) = (config.considered, config.collected)
        && collected > considered
    {
        return broken(
            ".collected",
            format!("{collected} is over visibility.considered, {considered}: a point is drawn into maps that it was considered for"),
        );
    }
    Ok(())
}

/// An error at a key of the merged config.
pub fn error_at(root: &Node, path: &str, message: impl std::fmt::Display) -> anyhow::Error {
    error(locate(root, path), path, message)
}

/// Where a key is said, or else the nearest table around it.
fn locate<'r>(root: &'r Node, path: &str) -> &'r Origin {
    let mut node = root;
    for part in path.split('.') {
        let inner = match &node.value {
            Value::Table(table) => table.get(part),
            Value::List(items) => part.parse::<usize>().ok().and_then(|index| items.get(index)),
            _ => None,
        };
        match inner {
            Some(inner) => node = inner,
            None => break,
        }
    }
    &node.origin
}

/// A key below the section, with its dot, and what is wrong.
type Broken = (String, String);

fn broken<T>(key: impl Into<String>, message: impl Into<String>) -> Result<T, Broken> {
    Err((key.into(), message.into()))
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

fn camera(camera: &CameraConfig) -> Result<(), Broken> {
    let placed = camera.position.is_some() || camera.target.is_some();
    if camera.node.is_some() {
        let rivals = [
            (".position", camera.position.is_some()),
            (".target", camera.target.is_some()),
            (".up", camera.up.is_some()),
            (".keyframes", !camera.keyframes.is_empty()),
        ];
        if let Some((key, _)) = rivals.iter().find(|(_, is_given)| *is_given) {
            return broken(*key, "excludes camera.node; give one of them");
        }
    }
    if placed && !camera.keyframes.is_empty() {
        return broken(".keyframes", "excludes camera.position and camera.target; make them the first keyframe");
    }
    let up = camera.up.unwrap_or([0.0, 1.0, 0.0]);
    match (camera.position, camera.target) {
        (Some(position), Some(target)) => view(position, target, up, "")?,
        (Some(_), None) => return broken(".position", "needs camera.target"),
        (None, Some(_)) => return broken(".target", "needs camera.position"),
        (None, None) => {}
    }
    rising(camera.keyframes.iter().map(|key| key.time))?;
    for (index, key) in camera.keyframes.iter().enumerate() {
        view(key.position, key.target, up, &format!(".keyframes.{index}"))?;
    }
    Ok(())
}

fn view(position: [f32; 3], target: [f32; 3], up: [f32; 3], key: &str) -> Result<(), Broken> {
    let ahead = vector(target) - vector(position);
    if ahead == DVec3::ZERO {
        return broken(format!("{key}.target"), "is the camera's own position; give a point ahead of it");
    }
    if ahead.normalize().cross(vector(up).normalize()).length() < 1e-4 {
        return broken(format!("{key}.target"), "lies straight along camera.up; give another camera.up");
    }
    Ok(())
}

fn rising(times: impl Iterator<Item = f32>) -> Result<(), Broken> {
    let mut last = None;
    for (index, time) in times.enumerate() {
        if let Some(before) = last.filter(|&before| before >= time) {
            return broken(format!(".keyframes.{index}.time"), format!("{time} is not after the keyframe before it, at {before}"));
        }
        last = Some(time);
    }
    Ok(())
}

fn light(light: &LightConfig) -> Result<(), Broken> {
    match light {
        LightConfig::Directional { direction, position, target, keyframes, .. } => {
            aimed(*direction, *target, keyframes)?;
            if target.is_some() && position.is_none() {
                return broken(".target", "needs position, where the light comes from; or give direction");
            }
            if target.is_none() && position.is_some() {
                return broken(".position", "a directional light has a position only together with target; remove it");
            }
            if let (None, Some(index)) = (target, keyframes.iter().position(|key| key.position.is_some())) {
                let message = "a directional light has a position only together with target; remove it";
                return broken(format!(".keyframes.{index}.position"), message);
            }
            apart(*position, *target, keyframes)
        }
        LightConfig::Spot { position, direction, target, inner_deg, outer_deg, keyframes, .. } => {
            if let Some(inner) = inner_deg.filter(|inner| inner > outer_deg) {
                return broken(".inner_deg", format!("{inner} is more than outer_deg, {outer_deg}"));
            }
            aimed(*direction, *target, keyframes)?;
            apart(Some(*position), *target, keyframes)
        }
        LightConfig::Point { keyframes, .. } => rising(keyframes.iter().map(|key| key.time)),
        LightConfig::Environment { .. } => Ok(()),
    }
}

/// A light is aimed one way, in its keyframes too.
fn aimed(direction: Option<[f32; 3]>, target: Option<[f32; 3]>, keyframes: &[LightKeyframe]) -> Result<(), Broken> {
    match (direction, target) {
        (Some(_), Some(_)) => return broken(".target", "excludes direction; give one of them"),
        (None, None) => return broken("", "needs direction or target"),
        _ => {}
    }
    rising(keyframes.iter().map(|key| key.time))?;
    for (index, key) in keyframes.iter().enumerate() {
        if direction.is_some() && key.target.is_some() {
            return broken(format!(".keyframes.{index}.target"), "the light is aimed by direction; give direction here too");
        }
        if target.is_some() && key.direction.is_some() {
            return broken(format!(".keyframes.{index}.direction"), "the light is aimed by target; give target here too");
        }
    }
    Ok(())
}

/// A light that is aimed at a point is not there itself.
fn apart(position: Option<[f32; 3]>, target: Option<[f32; 3]>, keyframes: &[LightKeyframe]) -> Result<(), Broken> {
    let own = "is the light's own position; give a point ahead of it";
    if target.is_some() && target == position {
        return broken(".target", own);
    }
    match keyframes.iter().position(|key| key.target.is_some() && key.target == key.position) {
        Some(index) => broken(format!(".keyframes.{index}.target"), own),
        None => Ok(()),
    }
}
