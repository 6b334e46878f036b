//! The shaders: embedded in the program or read from a folder, compiled with shaderc, kept as SPIR-V in the user's cache.

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

/// Names a folder to read the shaders from instead of the embedded ones.
pub const VARIABLE: &str = "MANYLIGHT_GLSL";

/// How [`Library::compile`] compiles: part of the cache's keys, so it changes with that function.
const OPTIONS: &str = "vulkan1.3, auto-bound uniforms, unoptimised, 1";

/// All shader sources by their path below `glsl/`, and what has been compiled of them.
pub struct Library {
    sources: BTreeMap<String, String>,
    shaders: HashMap<String, Shader>,
}

impl Library {
    /// The embedded sources, or those of the folder that `MANYLIGHT_GLSL` names.
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

    /// The sources in a folder and below it.
    pub fn from_folder(folder: &Path) -> Result<Self> {
        let mut sources = BTreeMap::new();
        collect_folder(folder, folder, &mut sources)
            .map_err(|error| fail!(BadInput, "{VARIABLE}: {}: {error}; name the folder that holds the shaders", folder.display()))?;
        Ok(Self::from_sources(sources))
    }

    /// Sources given by path and text.
    pub fn from_sources(sources: BTreeMap<String, String>) -> Self {
        Self { sources, shaders: HashMap::new() }
    }

    /// Makes sure that these shaders (paths with their extensions) are there, compiling in parallel what is not cached.
    pub fn prepare(&mut self, paths: &BTreeSet<String>) -> Result<()> {
        let missing: Vec<&String> = paths.iter().filter(|path| !self.shaders.contains_key(*path)).collect();
        let made = missing.par_iter().map(|path| self.make(path)).collect::<Result<Vec<Shader>>>()?;
        self.shaders.extend(made.into_iter().map(|shader| (shader.name.clone(), shader)));
        Ok(())
    }

    /// The paths of a raster pass's shaders: a vertex shader, and what else there is of its name.
    pub fn raster_paths(&self, name: &str) -> Vec<String> {
        let path = |(extension, stage): (&str, ShaderStage)| {
            let path = format!("{name}.{extension}");
            let there = stage == ShaderStage::Vertex || (stage != ShaderStage::Compute && self.sources.contains_key(&path));
            there.then_some(path)
        };
        ShaderStage::ALL.into_iter().filter_map(path).collect()
    }

    /// A shader that has been prepared.
    pub fn get(&self, path: &str) -> &Shader {
        self.shaders.get(path).unwrap_or_else(|| unreachable!("glsl/{path} is used before it was prepared"))
    }

    fn make(&self, path: &str) -> Result<Shader> {
        let _span = trace::span(format_args!("shader {path}"));
        let extension = path.rsplit_once('.').map_or("", |(_, extension)| extension);
        let Some((_, stage)) = ShaderStage::ALL.into_iter().find(|(known, _)| *known == extension) else {
            return Err(anyhow!("glsl/{path}: its extension names no shader stage"));
        };
        let key = self.key(path)?;
        let words = match cache::user().read("spirv", &key) {
            Some(bytes) => bytes.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect(),
            None => {
                let _span = trace::span(format_args!("compiling {path}"));
                let words = self.compile(path, stage)?;
                let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
                // Without a cache every start compiles anew, and nothing else changes.
                let _ = cache::user().write("spirv", &key, &bytes);
                words
            }
        };
        Shader::new(path, stage, words)
    }

    fn source(&self, path: &str) -> Result<&String> {
        self.sources.get(path).ok_or_else(|| fail!(BadInput, "glsl/{path}: there is no such shader"))
    }

    /// A hash of all sources and of the compiler.
    pub fn key_of_all(&self) -> blake3::Hash {
        let mut hasher = Self::hasher("");
        for (path, source) in &self.sources {
            hasher.update(path.as_bytes()).update(&[0]).update(source.as_bytes()).update(&[0]);
        }
        hasher.finalize()
    }

    /// Of the compiler, and of what it is to compile.
    fn hasher(path: &str) -> blake3::Hasher {
        let mut hasher = blake3::Hasher::new();
        let (version, revision) = shaderc::get_spirv_version();
        hasher.update(format!("{OPTIONS} {version} {revision} {path}\0").as_bytes());
        hasher
    }

    /// Of everything that the compiler will read, and of the compiler.
    pub fn key(&self, path: &str) -> Result<blake3::Hash> {
        let mut hasher = Self::hasher(path);
        let mut open = vec![path.to_owned()];
        let mut seen = BTreeSet::new();
        while let Some(path) = open.pop() {
            if seen.insert(path.clone()) {
                let source = self.source(&path)?;
                hasher.update(path.as_bytes()).update(&[0]).update(source.as_bytes()).update(&[0]);
                open.extend(includes(source).map(str::to_owned));
            }
        }
        Ok(hasher.finalize())
    }

    fn compile(&self, path: &str, stage: ShaderStage) -> Result<Vec<u32>> {
        let compiler = shaderc::Compiler::new().context("the shader compiler does not start")?;
        let mut options = shaderc::CompileOptions::new().context("the shader compiler does not start")?;
        options.set_target_env(shaderc::TargetEnv::Vulkan, shaderc::EnvVersion::Vulkan1_3 as u32);
        options.set_auto_bind_uniforms(true);
        options.set_warnings_as_errors();
        options.set_include_callback(|name, _, _, _| {
            let content = self.sources.get(name).cloned().ok_or_else(|| format!("there is no glsl/{name}"))?;
            Ok(shaderc::ResolvedInclude { resolved_name: name.into(), content })
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
            Err(shaderc::Error::CompilationError(_, text)) => Err(fail!(BadInput, "a shader does not compile: glsl/{}", text.trim())),
            Err(error) => Err(fail!(BadInput, "glsl/{path}: {error}")),
        }
    }
}

fn includes(source: &str) -> impl Iterator<Item = &str> {
    source.lines().filter_map(|line| line.trim_start().strip_prefix("#include")?.trim().strip_prefix('"')?.split('"').next())
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
        library.prepare(&BTreeSet::from([path.into()]))
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
        let key = |x: &str, y: &str| library(&[main, ("lib/x.glsl", x), ("lib/y.glsl", y)]).key("a.comp").unwrap();
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
        let shader = library.get("t.comp");
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
}
