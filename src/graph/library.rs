//! Library of shaders: sources embedded in the program or read from a folder, compiled with shaderc, and cached as SPIR-V for the user.

use super::parts::{Part, Variant, included, includes, slot_of};
use crate::cache;
use crate::fail;
use crate::gpu::{Shader, ShaderStage};
use crate::trace;
use anyhow::{Context, Result, anyhow};
use include_dir::{Dir, include_dir};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

static EMBEDDED: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/glsl");

/// Environment variable that names a folder of shaders, in place of the embedded ones.
pub const VARIABLE: &str = "MANYLIGHT_GLSL";

/// Options of [`Library::compile`] as a part of the cache's keys; it changes with that function.
const OPTIONS: &str = "vulkan1.3, auto-bound uniforms, unoptimised, 1";

/// All shader sources by their path below `glsl/`, and the shaders compiled so far.
pub struct Library {
    sources: BTreeMap<String, String>,
    shaders: HashMap<Variant, Shader>,
}

impl Library {
    /// Library of the embedded sources, or of the folder that `MANYLIGHT_GLSL` names.
    pub fn new() -> Result<Self> {
        match std::env::var_os(VARIABLE) {
            Some(folder) => Self::from_folder(Path::new(&folder)),
            None => {
                let mut sources = BTreeMap::new();
                collect_embedded(&EMBEDDED, &mut sources);
                Ok(Self::from_sources(sources))
            }
        }
    }

    /// Library of the sources in a folder and its subfolders.
    pub fn from_folder(folder: &Path) -> Result<Self> {
        let mut sources = BTreeMap::new();
        collect_folder(folder, folder, &mut sources)
            .map_err(|error| fail!(BadInput, "{VARIABLE}: {}: {error}; name the folder that holds the shaders", folder.display()))?;
        Ok(Self::from_sources(sources))
    }

    /// Library of sources given by path and text.
    pub fn from_sources(sources: BTreeMap<String, String>) -> Self {
        Self { sources, shaders: HashMap::new() }
    }

    /// Prepares these shaders; those that are not cached are compiled in parallel.
    pub fn prepare(&mut self, variants: &BTreeSet<Variant>) -> Result<()> {
        let missing: Vec<&Variant> = variants.iter().filter(|variant| !self.is_prepared(variant)).collect();
        let made = missing.par_iter().map(|variant| Ok(((*variant).clone(), self.make(variant)?)));
        let made = made.collect::<Result<Vec<(Variant, Shader)>>>()?;
        self.shaders.extend(made);
        Ok(())
    }

    pub(super) fn is_prepared(&self, variant: &Variant) -> bool {
        self.shaders.contains_key(variant)
    }

    /// Paths of a raster pass's shaders: the vertex shader, and those of other stages that exist under its name.
    pub fn raster_paths(&self, name: &str) -> Vec<String> {
        let path = |(extension, stage): (&str, ShaderStage)| {
            let path = format!("{name}.{extension}");
            let there = stage == ShaderStage::Vertex || (stage != ShaderStage::Compute && self.sources.contains_key(&path));
            there.then_some(path)
        };
        ShaderStage::ALL.into_iter().filter_map(path).collect()
    }

    /// A prepared shader.
    pub fn get(&self, variant: &Variant) -> &Shader {
        self.shaders.get(variant).unwrap_or_else(|| unreachable!("glsl/{variant} is used before it was prepared"))
    }

    fn make(&self, variant: &Variant) -> Result<Shader> {
        let Variant { path, parts } = variant;
        let _span = trace::span(format_args!("shader {variant}"));
        let extension = path.rsplit_once('.').map_or("", |(_, extension)| extension);
        let Some((_, stage)) = ShaderStage::ALL.into_iter().find(|(known, _)| *known == extension) else {
            return Err(anyhow!("glsl/{path}: its extension names no shader stage"));
        };
        let key = self.key(path, parts)?;
        let words = match cache::user().read("spirv", &key) {
            Some(bytes) => bytes.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect(),
            None => {
                let _span = trace::span(format_args!("compiling {variant}"));
                let words = self.compile(variant, stage)?;
                let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
                // A failure is ignored: without a cache every start compiles anew, and nothing else changes.
                let _ = cache::user().write("spirv", &key, &bytes);
                words
            }
        };
        Shader::new(&variant.to_string(), stage, words)
    }

    fn source(&self, path: &str) -> Result<&String> {
        self.sources.get(path).ok_or_else(|| fail!(BadInput, "glsl/{path}: there is no such shader"))
    }

    /// Hash of all sources and of the compiler.
    pub fn key_of_all(&self) -> blake3::Hash {
        let mut hasher = Self::hasher("");
        for (path, source) in &self.sources {
            hasher.update(path.as_bytes()).update(&[0]).update(source.as_bytes()).update(&[0]);
        }
        hasher.finalize()
    }

    /// Hasher fed with the compiler's version and options, and a path.
    fn hasher(path: &str) -> blake3::Hasher {
        let mut hasher = blake3::Hasher::new();
        let (version, revision) = shaderc::get_spirv_version();
        hasher.update(format!("{OPTIONS} {version} {revision} {path}\0").as_bytes());
        hasher
    }

    /// Files that the compiler reads for a shader, the shader itself first.
    fn files(&self, path: &str, parts: &[Part]) -> Result<Vec<File<'_>>> {
        let mut files: Vec<File<'_>> = Vec::new();
        let mut open = vec![(path.to_owned(), None)];
        while let Some((path, slot)) = open.pop() {
            let source = match slot {
                // The error names the slot: the file that includes it says nothing about the part.
                Some(slot) => self.sources.get(&path).ok_or_else(|| fail!(BadInput, "glsl/{path}: there is no such part, for {slot:?}"))?,
                None => self.source(&path)?,
            };
            if files.iter().any(|file| file.path == path && file.slot == slot) {
                continue;
            }
            for name in includes(source) {
                let (included, slot) = (included(name, parts).map_err(|why| fail!(BadInput, "glsl/{path}: {why}"))?, slot_of(name));
                open.push((included, slot.map(|(slot, _)| slot)));
            }
            files.push(File { path, slot, source });
        }
        Ok(files)
    }

    /// Names of a shader's slots, given the parts that fill them.
    pub(super) fn slots(&self, variant: &Variant) -> Result<BTreeSet<&str>> {
        Ok(self.files(&variant.path, &variant.parts)?.into_iter().filter_map(|file| file.slot).collect())
    }

    /// Hash of all files that the compiler reads, and of the compiler.
    pub fn key(&self, path: &str, parts: &[Part]) -> Result<blake3::Hash> {
        let mut hasher = Self::hasher(path);
        for File { path, slot, source } in self.files(path, parts)? {
            hasher.update(slot.unwrap_or_default().as_bytes()).update(path.as_bytes()).update(&[0]).update(source.as_bytes()).update(&[0]);
        }
        Ok(hasher.finalize())
    }

    fn compile(&self, variant: &Variant, stage: ShaderStage) -> Result<Vec<u32>> {
        let Variant { path, parts } = variant;
        let compiler = shaderc::Compiler::new().context("the shader compiler does not start")?;
        let mut options = shaderc::CompileOptions::new().context("the shader compiler does not start")?;
        options.set_target_env(shaderc::TargetEnv::Vulkan, shaderc::EnvVersion::Vulkan1_3 as u32);
        options.set_auto_bind_uniforms(true);
        options.set_warnings_as_errors();
        options.set_include_callback(|name, _, _, _| {
            let resolved_name = included(name, parts)?;
            let content = self.sources.get(&resolved_name).cloned().ok_or_else(|| format!("there is no glsl/{resolved_name}"))?;
            Ok(shaderc::ResolvedInclude { resolved_name, content })
        });
        let kind = match stage {
            ShaderStage::Vertex => shaderc::ShaderKind::Vertex,
            ShaderStage::TessellationControl => shaderc::ShaderKind::TessControl,
            ShaderStage::TessellationEvaluation => shaderc::ShaderKind::TessEvaluation,
            ShaderStage::Geometry => shaderc::ShaderKind::Geometry,
            ShaderStage::Fragment => shaderc::ShaderKind::Fragment,
            ShaderStage::Compute => shaderc::ShaderKind::Compute,
        };
        let compiled = compiler.compile_into_spirv(self.source(path)?, kind, path, "main", Some(&options));
        match compiled {
            Ok(artifact) => Ok(artifact.as_binary().to_vec()),
            Err(shaderc::Error::CompilationError(_, text)) => {
                // The error's line may be in a part, or may miss something that a part left out, so all parts are named.
                let whole = if parts.is_empty() { String::new() } else { format!("glsl/{variant}: ") };
                Err(fail!(BadInput, "a shader does not compile: {whole}glsl/{}", text.trim()))
            }
            Err(error) => Err(fail!(BadInput, "glsl/{variant}: {error}")),
        }
    }
}

/// A file that the compiler reads, and the slot that it fills if it is a part.
struct File<'s> {
    path: String,
    slot: Option<&'s str>,
    source: &'s str,
}

fn collect_embedded(folder: &Dir<'_>, sources: &mut BTreeMap<String, String>) {
    for file in folder.files() {
        if let (Some(path), Some(text)) = (file.path().to_str(), file.contents_utf8()) {
            sources.insert(path.replace('\\', "/"), text.to_owned());
        }
    }
    folder.dirs().for_each(|dir| collect_embedded(dir, sources));
}

fn collect_folder(root: &Path, folder: &Path, sources: &mut BTreeMap<String, String>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect_folder(root, &path, sources)?;
        } else if let Ok(text) = std::fs::read_to_string(&path) {
            let below = path.strip_prefix(root).unwrap_or(&path).to_string_lossy().replace('\\', "/");
            sources.insert(below, text);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn library(files: &[(&str, &str)]) -> Library {
        Library::from_sources(files.iter().map(|(path, text)| ((*path).into(), (*text).into())).collect())
    }

    fn prepare(library: &mut Library, path: &str) -> Result<()> {
        library.prepare(&BTreeSet::from([Variant::from(path)]))
    }

    #[test]
    fn a_shader_that_does_not_compile_is_reported_with_file_line_and_the_compilers_words() {
        let source = "#version 460\nlayout(local_size_x = 1) in;\nvoid main() {\n    nonsense = 1;\n}\n";
        let error = prepare(&mut library(&[("a/b.comp", source)]), "a/b.comp").unwrap_err().to_string();
        assert!(error.contains("glsl/a/b.comp:4:") && error.contains("nonsense"), "{error}");
    }

    #[test]
    fn an_error_in_an_included_file_names_that_file() {
        let main = "#version 460\n#extension GL_GOOGLE_include_directive : require\n#include \"lib/x.glsl\"\nlayout(local_size_x = 1) in;\nvoid main() {}\n";
        let error = prepare(&mut library(&[("a/b.comp", main), ("lib/x.glsl", "float f() {\n  return oops;\n}\n")]), "a/b.comp");
        let error = error.unwrap_err().to_string();
        assert!(error.contains("lib/x.glsl:2:"), "{error}");
    }

    #[test]
    fn the_cache_key_changes_with_an_included_file_and_not_with_others() {
        let main = ("a.comp", "#include \"lib/x.glsl\"\n");
        let key = |x: &str, y: &str| library(&[main, ("lib/x.glsl", x), ("lib/y.glsl", y)]).key("a.comp", &[]).unwrap();
        assert_eq!(key("1", "1"), key("1", "2"));
        assert_ne!(key("1", "1"), key("2", "1"));
    }

    #[test]
    fn the_key_of_all_changes_with_any_file_its_name_and_its_text() {
        let key = |files: &[(&str, &str)]| library(files).key_of_all();
        let known = key(&[("a.comp", "1"), ("lib/x.glsl", "2")]);
        assert_eq!(key(&[("lib/x.glsl", "2"), ("a.comp", "1")]), known);
        for other in [&[("a.comp", "1")][..], &[("a.comp", "1"), ("lib/x.glsl", "3")], &[("a.comp", "1"), ("lib/y.glsl", "2")]] {
            assert_ne!(key(other), known);
        }
    }

    #[test]
    fn resources_are_reflected_by_name_with_access_and_layout() {
        let source = "#version 460\n#extension GL_EXT_scalar_block_layout : require\nlayout(local_size_x = 8, local_size_y = 4) in;\n\
            layout(constant_id = 3) const uint COUNT = 1;\nstruct Item { vec3 position; uint packed; };\n\
            layout(scalar) readonly buffer Items { Item items[]; } list;\nlayout(rgba16f) writeonly uniform image2D target;\n\
            layout(r32ui) uniform uimage2D counter;\nuniform sampler2DArray maps;\nuniform sampler2D unused;\n\
            layout(scalar, push_constant) uniform Params { uint n; vec3 p; } params;\n\
            void main() { imageStore(target, ivec2(0), texelFetch(maps, ivec3(0), 0) * list.items[params.n].position.x * COUNT);\n\
            imageAtomicMin(counter, ivec2(0), 1u); }\n";
        let mut library = library(&[("t.comp", source)]);
        prepare(&mut library, "t.comp").unwrap();
        let shader = library.get(&"t.comp".into());
        use crate::gpu::{BindingKind as Kind, ShaderAccess as Access};
        let found: Vec<_> = shader.bindings.iter().map(|b| (b.name.as_str(), b.access)).collect();
        let expected = [("counter", Access::ReadWrite), ("list", Access::Read), ("maps", Access::Read), ("target", Access::Write)];
        assert_eq!(found, expected);
        assert_eq!(shader.bindings[2].kind, Kind::Sampled { array: true });
        let Kind::StorageBlock(block) = &shader.bindings[1].kind else { panic!("{:?}", shader.bindings[1]) };
        assert_eq!((block.stride, block.members[1].offset, block.members[1].name.as_str()), (Some(16), 12, "packed"));
        assert_eq!(shader.constants, [("COUNT".to_owned(), 3)]);
        assert_eq!(shader.local_size(&[]), [8, 4, 1]);
    }

    const SLOTTED: &str = "#version 460\n#extension GL_GOOGLE_include_directive : require\n#include \"part/light=lib/light-none\"\n\
        layout(local_size_x = 1) in;\nvoid main() { light(); }\n";
    const NONE: (&str, &str) = ("lib/light-none.glsl", "void light() {}\n");
    const READ: (&str, &str) = ("lib/light-read.glsl", "buffer Light { float at; } lights;\nvoid light() { lights.at = 1.0; }\n");
    const BROKEN: (&str, &str) = ("lib/light-broken.glsl", "\nvoid light() { oops; }\n");

    fn with(part: &'static str) -> Variant {
        Variant { path: "a/b.comp".into(), parts: vec![("light", part)] }
    }

    #[test]
    fn a_slot_takes_the_part_that_is_named_for_it_and_else_its_default() {
        let mut library = library(&[("a/b.comp", SLOTTED), NONE, READ]);
        let bindings = |shader: &Shader| shader.bindings.iter().map(|binding| binding.name.clone()).collect::<Vec<_>>();
        library.prepare(&BTreeSet::from(["a/b.comp".into(), with("lib/light-read")])).unwrap();
        assert_eq!(bindings(library.get(&"a/b.comp".into())), Vec::<String>::new());
        assert_eq!(bindings(library.get(&with("lib/light-read"))), ["lights"]);
        assert_eq!(library.slots(&with("lib/light-read")).unwrap(), BTreeSet::from(["light"]));
        assert_eq!(library.get(&with("lib/light-read")).name, "a/b.comp with lib/light-read as light");
    }

    #[test]
    fn an_error_in_a_part_names_its_file_and_line_and_the_shader_that_has_it() {
        let mut library = library(&[("a/b.comp", SLOTTED), NONE, BROKEN]);
        let error = library.prepare(&BTreeSet::from([with("lib/light-broken")])).unwrap_err().to_string();
        assert!(error.contains("glsl/lib/light-broken.glsl:2:") && error.contains("oops"), "{error}");
        assert!(error.contains("glsl/a/b.comp with lib/light-broken as light"), "{error}");
    }

    #[test]
    fn the_cache_key_changes_with_the_part_in_a_slot_and_not_with_others() {
        let key = |files: &[(&str, &str)], parts: &[Part]| library(files).key("a/b.comp", parts).unwrap();
        let files = [("a/b.comp", SLOTTED), NONE, READ];
        let default = key(&files, &[]);
        assert_eq!(default, key(&files, &[("light", "lib/light-none")]));
        assert_eq!(default, key(&files, &[("shadow", "lib/light-read")]));
        assert_eq!(default, key(&[files[0], NONE, (READ.0, "")], &[]));
        assert_ne!(default, key(&files, &[("light", "lib/light-read")]));
        assert_ne!(key(&files, &[("light", "lib/light-read")]), key(&[files[0], NONE, (READ.0, "")], &[("light", "lib/light-read")]));
        // The same files in each other's place.
        let two = [("a/b.comp", "#include \"part/one\"\n#include \"part/two\"\n"), NONE, READ];
        let parts = ["lib/light-none", "lib/light-read"];
        assert_ne!(key(&two, &[("one", parts[0]), ("two", parts[1])]), key(&two, &[("one", parts[1]), ("two", parts[0])]));
    }

    #[test]
    fn a_specialization_constant_is_reflected_whether_it_is_used_or_not() {
        let source = "#version 460\nlayout(local_size_x = 1) in;\nlayout(constant_id = 0) const bool NEVER = false;\n\
            layout(constant_id = 1) const bool DEAD = false;\nvoid dead() { if (DEAD) return; }\nvoid main() {}\n";
        let mut library = library(&[("t.comp", source)]);
        prepare(&mut library, "t.comp").unwrap();
        assert_eq!(library.get(&"t.comp".into()).constants, [("NEVER".to_owned(), 0), ("DEAD".to_owned(), 1)]);
    }

    #[test]
    fn every_shader_compiles_with_each_part_of_each_slot_and_keeps_all_its_constants() {
        let mut library = Library::new().unwrap();
        let entry = |path: &str| ShaderStage::ALL.iter().any(|(extension, _)| path.ends_with(&format!(".{extension}")));
        let mut variants: BTreeSet<Variant> = library.sources.keys().filter(|path| entry(path)).map(|path| path.as_str().into()).collect();
        let mut slots = BTreeSet::new();
        for variant in variants.clone() {
            for file in library.files(&variant.path, &[]).unwrap() {
                let Some(slot) = file.slot else { continue };
                // Parts for a slot lie beside its default: `gather/shadow-ism` beside `gather/shadow-none`.
                let folder = file.path.split('/').next().unwrap();
                let beside = format!("{folder}/{slot}-");
                let parts: Vec<&str> =
                    library.sources.keys().filter_map(|path| path.strip_suffix(".glsl").filter(|part| part.starts_with(&beside))).collect();
                assert!(parts.len() > 1, "glsl/{}: no part fills {slot:?} but its default", variant.path);
                for part in parts {
                    let named = (&*slot.to_owned().leak(), &*part.to_owned().leak());
                    variants.insert(Variant { path: variant.path.clone(), parts: vec![named] });
                    slots.insert(named);
                }
            }
        }
        library.prepare(&variants).unwrap();
        for variant in &variants {
            let files = library.files(&variant.path, &variant.parts).unwrap();
            let lines = files.iter().flat_map(|file| file.source.lines()).filter(|line| line.starts_with("layout(constant_id"));
            let declared: BTreeSet<&str> = lines.map(|line| line.split_whitespace().nth(5).unwrap()).collect();
            let kept: BTreeSet<&str> = library.get(variant).constants.iter().map(|(name, _)| name.as_str()).collect();
            assert_eq!(kept, declared, "glsl/{variant}");
        }
        println!("{} shaders, {} parts", variants.len(), slots.len());
    }
}
