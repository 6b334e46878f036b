//! Old names of keys, which are refused with the new name.

use super::tree::Value;

/// A section, the section that keys of it have moved to, and these keys.
const MOVED: [(&str, &str, &[&str]); 5] = [
    ("gather", "gather.stochastic", &["bounds", "delta", "roulette", "statistics", "receiver"]),
    ("gather", "gather.conservative_clusters", &["rasterization", "nodes"]),
    ("gather", "gather.per_pixel", &["culling", "emitters"]),
    (
        "visibility",
        "visibility.ism",
        &[
            "renderer",
            "collect",
            "points",
            "point_count",
            "thin",
            "capacity",
            "map_size",
            "considered",
            "collected",
            "distortion",
            "clamp",
            "enlarge",
            "normals",
            "shared_maps",
        ],
    ),
    ("bounce", "bounce.clusters", &["representative", "centers", "rounds", "position_weight", "normal_weight", "map_size", "layers"]),
];

/// New name of an old key; `None` for any other key.
pub fn now(key: &str, value: &Value) -> Option<String> {
    match (key, value) {
        ("gather.culling", Value::Text(name)) if matches!(name.as_str(), "stochastic-tiled" | "splatting" | "conservative-clusters") => {
            let culling = name.strip_prefix("stochastic-").unwrap_or(name);
            Some(format!("gather.method = \"stochastic\" with gather.stochastic.culling = \"{culling}\""))
        }
        ("bounce.clusters", Value::Table(_)) => None,
        ("bounce.clusters", _) => Some("bounce.clusters.count".to_owned()),
        _ => {
            let (section, name) = key.rsplit_once('.')?;
            let (_, to, _) = MOVED.iter().find(|(from, _, keys)| *from == section && keys.contains(&name))?;
            Some(format!("{to}.{name}"))
        }
    }
}
