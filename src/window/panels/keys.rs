//! The keys of the config as widgets, made from the schema.

use super::Panels;
use crate::config::{self, Choice, KeyInfo, Kind, Range};
use egui::{CollapsingHeader, ComboBox, DragValue, Id, RichText, ScrollArea, TextEdit, Ui};
use toml::Value;

impl Panels {
    pub(super) fn keys(&mut self, ui: &mut Ui) {
        ui.add(TextEdit::singleline(&mut self.search).hint_text("search keys").desired_width(f32::INFINITY));
        let Some(shown) = &self.shown else { return };
        let (config, search) = (&shown.config, self.search.trim().to_lowercase());
        let values: Value = toml::from_str(&config::to_toml(config)).map_or(Value::Table(toml::Table::new()), Value::Table);
        let mut changes = Vec::new();
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for section in config::keys().iter().filter(|info| matches!(info.kind, Kind::Table | Kind::Tables) && !info.key.contains('.')) {
                let keys = leaves(&section.key, &values);
                let fitting: Vec<&(String, &KeyInfo)> = keys
                    .iter()
                    .filter(|(key, info)| {
                        let found = search.is_empty() || key.contains(&search) || info.what.to_lowercase().contains(&search);
                        found && !config::is_unused(config, key)
                    })
                    .collect();
                if fitting.is_empty() {
                    continue;
                }
                let changed = fitting.iter().any(|(key, _)| self.project.is_changed(key));
                let title = if changed { format!("{} *", section.key) } else { section.key.clone() };
                let open = (!search.is_empty()).then_some(true);
                let at_first = ["vpls", "visibility", "gather"].contains(&section.key.as_str());
                CollapsingHeader::new(title).id_salt(&section.key).default_open(at_first).open(open).show(ui, |ui| {
                    for (key, info) in fitting {
                        let is_changed = self.project.is_changed(key);
                        row(ui, key, &section.key, info, at(&values, key), is_changed, &mut changes);
                    }
                });
            }
        });
        for (key, value) in changes {
            match value {
                Some(value) => self.project.set(&key, value),
                None => self.project.reset(&key),
            }
        }
    }
}

/// Keys of a section that hold values, with the indices of lists in place.
fn leaves<'k>(section: &str, values: &Value) -> Vec<(String, &'k KeyInfo)> {
    let inside = |info: &&KeyInfo| info.key.strip_prefix(section).is_some_and(|rest| rest.starts_with('.'));
    let infos = config::keys().iter().filter(inside).filter(|info| !matches!(info.kind, Kind::Table | Kind::Tables));
    let mut keys = Vec::new();
    for info in infos {
        let mut found = Vec::new();
        expand(&info.key, values, &mut found);
        keys.extend(found.into_iter().filter(|key| is_of_its_light(key, info, values)).map(|key| (key, info)));
    }
    // The keys of one light, and of one keyframe, stand together.
    keys.sort_by_key(|(key, _)| key.split('.').filter_map(|part| part.parse().ok()).collect::<Vec<usize>>());
    keys
}

/// The keys of a pattern such as `light.N.position`, with an index for each item of its lists.
fn expand(pattern: &str, values: &Value, found: &mut Vec<String>) {
    let Some((list, rest)) = pattern.split_once(".N.") else {
        found.push(pattern.to_owned());
        return;
    };
    let count = at(values, list).and_then(Value::as_array).map_or(0, Vec::len);
    (0..count).for_each(|i| expand(&format!("{list}.{i}.{rest}"), values, found));
}

/// Whether a light of its kind has a key. The kind itself is not changed.
fn is_of_its_light(key: &str, info: &KeyInfo, values: &Value) -> bool {
    let mut parts = key.split('.');
    let (Some("light"), Some(index), Some(name)) = (parts.next(), parts.next(), parts.next()) else { return true };
    let kind = at(values, &format!("light.{index}.kind")).and_then(Value::as_str);
    name != "kind" && (info.lights.is_empty() || kind.is_some_and(|kind| info.lights.iter().any(|known| known == kind)))
}

fn at<'v>(values: &'v Value, key: &str) -> Option<&'v Value> {
    key.split('.').try_fold(values, |value, part| match value {
        Value::Array(items) => items.get(part.parse::<usize>().ok()?),
        other => other.get(part),
    })
}

/// A key's name, widget and reset. A change is a value as TOML, or `None` to take changes back.
fn row(
    ui: &mut Ui,
    key: &str,
    section: &str,
    info: &KeyInfo,
    value: Option<&Value>,
    is_changed: bool,
    changes: &mut Vec<(String, Option<String>)>,
) {
    ui.push_id(key, |ui| {
        ui.horizontal(|ui| {
            let name = key.strip_prefix(section).map_or(key, |rest| rest.trim_start_matches('.'));
            let name = if is_changed { RichText::new(name).strong() } else { RichText::new(name) };
            let default = info.default.as_deref().unwrap_or("must be given");
            let hint = format!("{}\n\n{key}: {}; default: {default}", info.what, info.kind.range());
            let (place, left) = (egui::vec2(170.0, 18.0), egui::Layout::left_to_right(egui::Align::Center));
            let label = ui.allocate_ui_with_layout(place, left, |ui| {
                ui.set_min_width(place.x);
                ui.add(egui::Label::new(name).truncate()).on_hover_text(hint)
            });
            if let Some(new) = widget(ui, &info.kind, value, default, label.inner.id) {
                changes.push((key.to_owned(), Some(new)));
            }
            if is_changed && ui.small_button("reset").on_hover_text("Take the change back").clicked() {
                changes.push((key.to_owned(), None));
            }
        });
    });
}

/// The widget of a kind of value, named by a label; a new value as TOML when it changes.
fn widget(ui: &mut Ui, kind: &Kind, value: Option<&Value>, default: &str, label: Id) -> Option<String> {
    let float = |value: Option<&Value>| value.and_then(|v| v.as_float().or(v.as_integer().map(|i| i as f64)));
    match kind {
        Kind::Flag => {
            let mut on = value.and_then(Value::as_bool).unwrap_or(default == "true");
            ui.checkbox(&mut on, "").labelled_by(label).changed().then(|| on.to_string())
        }
        Kind::Choice(choices) => choice(ui, choices, value.and_then(Value::as_str), label),
        Kind::Whole { min, max } => {
            let Some(mut number) = value.and_then(Value::as_integer) else { return give(ui, default, &min.to_string()) };
            let speed = (number.abs() as f64 / 100.0).max(0.05);
            ui.add(DragValue::new(&mut number).range(*min..=*max).speed(speed)).labelled_by(label).changed().then(|| number.to_string())
        }
        Kind::OneOf(numbers) => {
            let now = value.and_then(Value::as_integer);
            let mut new = None;
            let now_text = now.map_or_else(|| default.to_owned(), |now| now.to_string());
            let list = ComboBox::from_id_salt("value").selected_text(now_text).show_ui(ui, |ui| {
                for number in numbers {
                    if ui.selectable_label(now == Some(*number), number.to_string()).clicked() {
                        new = Some(number.to_string());
                    }
                }
            });
            list.response.labelled_by(label);
            new
        }
        Kind::Number(range) => {
            let Some(mut number) = float(value) else { return give(ui, default, &format!("{:?}", start(*range))) };
            ui.add(drag(&mut number, *range)).labelled_by(label).changed().then(|| toml_float(number))
        }
        Kind::Point(range) | Kind::Color(range) => three(ui, value, *range, default, label),
        Kind::Direction => three(ui, value, Range::FINITE, default, label),
        Kind::Size { max } => {
            let Some(Value::Array(sides)) = value else { return give(ui, default, "[512, 512]") };
            let mut sides: Vec<i64> = sides.iter().filter_map(Value::as_integer).collect();
            let mut changed = false;
            for side in &mut sides {
                changed |= ui.add(DragValue::new(side).range(1..=*max)).labelled_by(label).changed();
            }
            changed.then(|| format!("{sides:?}"))
        }
        Kind::Text | Kind::Choices(_) | Kind::IndexOrName | Kind::Block(_) | Kind::Table | Kind::Tables => text(ui, value, default, label),
    }
}

fn choice(ui: &mut Ui, choices: &[Choice], now: Option<&str>, label: Id) -> Option<String> {
    let mut new = None;
    let names = ComboBox::from_id_salt("value").selected_text(now.unwrap_or("default")).width(120.0).show_ui(ui, |ui| {
        for choice in choices {
            if ui.selectable_label(now == Some(choice.name.as_str()), &choice.name).on_hover_text(&choice.what).clicked() {
                new = Some(format!("{:?}", choice.name));
            }
        }
    });
    names.response.labelled_by(label);
    new
}

/// A key that has no value of its own: what stands for it, and a button that gives it one.
fn give(ui: &mut Ui, default: &str, value: &str) -> Option<String> {
    let given = ui.small_button("set").on_hover_text(format!("Give it a value, {value} at first")).clicked();
    ui.add(egui::Label::new(RichText::new(default).weak()).truncate());
    given.then(|| value.to_owned())
}

fn three(ui: &mut Ui, value: Option<&Value>, range: Range, default: &str, label: Id) -> Option<String> {
    let Some(Value::Array(parts)) = value else { return give(ui, default, "[0.0, 1.0, 0.0]") };
    let mut parts: Vec<f64> = parts.iter().filter_map(|part| part.as_float().or(part.as_integer().map(|i| i as f64))).collect();
    let mut changed = false;
    for part in &mut parts {
        changed |= ui.add(drag(part, range)).labelled_by(label).changed();
    }
    changed.then(|| format!("[{}]", parts.iter().map(|part| toml_float(*part)).collect::<Vec<_>>().join(", ")))
}

/// A value that is typed as TOML; it counts when the field is left.
fn text(ui: &mut Ui, value: Option<&Value>, default: &str, label: Id) -> Option<String> {
    let now = value.map(Value::to_string).unwrap_or_default();
    let id = ui.scope_id().with("text");
    let mut typed = ui.data_mut(|data| data.get_temp::<String>(id)).unwrap_or_else(|| now.clone());
    let field = ui.add(TextEdit::singleline(&mut typed).hint_text(default).desired_width(130.0)).labelled_by(label);
    if field.lost_focus() {
        ui.data_mut(|data| data.remove::<String>(id));
        return (typed != now && !typed.trim().is_empty()).then_some(typed);
    }
    if field.changed() {
        ui.data_mut(|data| data.insert_temp(id, typed));
    }
    None
}

fn drag(number: &mut f64, range: Range) -> DragValue<'_> {
    let speed = (number.abs() / 100.0).max(0.001);
    // The least float over an excluded bound.
    let least = if range.above { range.min.next_up() } else { range.min };
    DragValue::new(number).range(f64::from(least)..=f64::from(range.max)).speed(speed).max_decimals(5)
}

fn start(range: Range) -> f32 {
    if range.contains(1.0) { 1.0 } else { range.max }
}

/// A number of 32 bits as TOML.
fn toml_float(number: f64) -> String {
    format!("{:?}", number as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_keys_of_every_light_are_there_by_its_kind() {
        let values: Value =
            toml::from_str::<toml::Table>("[[light]]\nkind = \"point\"\n[[light]]\nkind = \"directional\"\n").map(Value::Table).unwrap();
        let keys: Vec<String> = leaves("light", &values).into_iter().map(|(key, _)| key).collect();
        let has = |key: &str| keys.iter().any(|known| known == key);
        assert!(has("light.0.intensity") && has("light.1.irradiance"), "{keys:?}");
        assert!(!has("light.1.intensity") && !has("light.0.irradiance"), "{keys:?}");
        assert!(keys.is_sorted_by_key(|key| key.split('.').nth(1).map(str::to_owned)), "{keys:?}");
    }

    #[test]
    fn keyframes_have_keys_of_their_own_beside_their_light() {
        let text = "[[light]]\nkind = \"point\"\nkeyframes = [{ time = 0.0 }, { time = 1.0 }]\n[camera]\nkeyframes = [{ time = 0.0 }]\n";
        let values = Value::Table(toml::from_str(text).unwrap());
        let keys: Vec<String> = leaves("light", &values).into_iter().map(|(key, _)| key).collect();
        assert!(
            keys.iter().any(|key| key == "light.0.keyframes.1.intensity") && !keys.iter().any(|key| key.ends_with("irradiance")),
            "{keys:?}"
        );
        assert!(leaves("camera", &values).iter().any(|(key, _)| key == "camera.keyframes.0.target"));
    }

    #[test]
    fn numbers_are_written_as_toml_reads_them() {
        for number in [1.0, 0.1, -3.25e-9, 16_777_216.0, 3.0e38] {
            let text = format!("x = {}", toml_float(number));
            let table: toml::Table = toml::from_str(&text).unwrap();
            assert_eq!(table["x"].as_float().map(|read| read as f32), Some(number as f32), "{text}");
        }
    }
}
