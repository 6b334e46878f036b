//! Every command that a page, a preset or a table gives runs as it stands, on small pictures.

use crate::place::{BOX, Place};
use std::collections::BTreeSet;
use std::path::Path;

/// Texts that users read, with their paths.
fn texts() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = vec!["README.md".to_owned(), "src/stages/README.md".to_owned()];
    for folder in ["configs", "configs/tables", "configs/views"] {
        let files = std::fs::read_dir(root.join(folder)).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        paths.extend(files.filter(|name| name.ends_with(".toml") || name.ends_with(".md")).map(|name| format!("{folder}/{name}")));
    }
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), std::fs::read_to_string(root.join(&path)).unwrap())).collect()
}

/// Commands of a text: lines of their own, and those in backticks.
fn commands(text: &str) -> Vec<String> {
    // A line of a preset's header starts with a number sign, and goes on after a backslash.
    let joined = text.replace("\n#", "\n").replace("\\\n", " ");
    let mut found = Vec::new();
    for line in joined.lines() {
        let trimmed = line.trim_start_matches('#').trim();
        if let Some(rest) = trimmed.strip_prefix("manylight ") {
            // A remark stands apart, as does the way into a file.
            found.push(rest.split(" # ").next().unwrap().split(" > ").next().unwrap().split("   ").next().unwrap().to_owned());
        }
        found.extend(line.split("`manylight ").skip(1).map(|rest| rest.split('`').next().unwrap().to_owned()));
    }
    found.iter().map(|command| command.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
}

/// The same command for a small picture in a test's folder; `None` for a form such as `manylight COMMAND --help`, and for what needs the folders of
/// several machines.
fn small(command: &str) -> Option<String> {
    if ["COMMAND", "NAME", "part-"].iter().any(|form| command.contains(form)) {
        return None;
    }
    let first = command.split(' ').next().unwrap();
    // A word alone is a command's name, if the command wants more.
    if first == command && !first.contains(".toml") && !["schema", "doctor", "list"].contains(&first) {
        return None;
    }
    let mut small =
        command.replace("--spp 1024", "--spp 4").replace("--runs 30", "--runs 1").replace("--size 1920x1080", "").replace(" DIR", " dir");
    let no_frames = "--set frame.count=1 --set frame.warmup=0";
    match first {
        "compare" | "report" | "schema" | "doctor" | "list" | "export" => {}
        "reproduce" => {
            small = small.replace("--quick", "");
            small += " --quick --scale 0.02 --shard 1/1000 -o tables";
        }
        "reference" => small += " --size 32x18",
        "flicker" => small += " --size 32x18 --set frame.count=2",
        "bench" => small += " --size 32x18",
        "view" => {}
        _ => small = format!("{small} --size 32x18 {no_frames} --set rsm.size=[64,64]"),
    }
    Some(small)
}

#[test]
fn every_command_that_a_text_gives_runs() {
    let place = Place::new(&[("my.toml", BOX)]);
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for folder in ["configs", "scenes"] {
        for entry in std::fs::read_dir(root.join(folder)).unwrap().map(Result::unwrap).filter(|entry| entry.path().is_file()) {
            place.write(&format!("{folder}/{}", entry.file_name().to_str().unwrap()), std::fs::read(entry.path()).unwrap());
        }
    }
    place.write("sponza.glb", place.read("scenes/figure.glb"));
    let (mut seen, mut run) = (BTreeSet::new(), 0);
    for (path, text) in texts() {
        for command in commands(&text) {
            if !seen.insert(command.clone()) {
                continue;
            }
            let Some(line) = small(&command) else { continue };
            println!("{path}: manylight {line}");
            let no_device = ["schema", "doctor", "list"].iter().any(|command| line.starts_with(command));
            let mut command_line = if no_device { place.manylight() } else { place.command(&line) };
            if no_device {
                command_line.args(line.split(' '));
            }
            for display in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
                command_line.env_remove(display);
            }
            let output = command_line.output().unwrap();
            // A window has read its config before it misses a display.
            if line.starts_with("view") {
                crate::place::failed(&command, &output, 3, &["no window can be opened"]);
                continue;
            }
            // Comparisons may find a difference: that is what they are for.
            let fine = [Some(0), if line.starts_with("compare") { Some(1) } else { Some(0) }];
            assert!(fine.contains(&output.status.code()), "{path}: manylight {command}: {}", crate::place::text(&output.stderr));
            run += 1;
        }
    }
    assert!(run > 25, "{run} commands were found");
}
