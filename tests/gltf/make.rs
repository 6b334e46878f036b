//! Small glTF files made by code, for tests to modify.

use glam::{Vec2, Vec3};
use manylight::scene::gltf::{self, AnimationChoice, Choice, Loaded, SceneChoice};
use manylight::scene::{Draw, Scene, Vertex, pack};
use serde_json::{Value, json};

pub const I8: u32 = 5120;
pub const U8: u32 = 5121;
pub const I16: u32 = 5122;
pub const U16: u32 = 5123;
pub const U32: u32 = 5125;
pub const F32: u32 = 5126;

/// A glTF file: its JSON and its one buffer.
#[derive(Clone)]
pub struct Make {
    pub json: Value,
    pub bin: Vec<u8>,
}

/// Corners of [`Make::square`], counter-clockwise seen from +Z.
pub const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// Texture coordinates of the corners, for an upright image.
pub const UVS: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];

impl Make {
    /// A scene with one node, one mesh and no attributes yet.
    pub fn empty() -> Self {
        let json = json!({
            "asset": {"version": "2.0"},
            "scene": 0, "scenes": [{"name": "only", "nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {}}]}],
            "accessors": [], "bufferViews": [],
        });
        Self { json, bin: Vec::new() }
    }

    /// A square of two triangles at z = 0 that faces +Z: positions, normals, indices.
    pub fn square() -> Self {
        let mut make = Self::empty();
        let positions = make.floats("VEC3", CORNERS.as_flattened());
        let normals = make.floats("VEC3", [[0.0f32, 0.0, 1.0]; 4].as_flattened());
        let indices = make.accessor(U8, "SCALAR", 6, &[0, 1, 2, 0, 2, 3]);
        *make.primitive() = json!({"attributes": {"POSITION": positions, "NORMAL": normals}, "indices": indices});
        make
    }

    /// The square with texture coordinates and a material.
    pub fn textured(material: Value) -> Self {
        let mut make = Self::square();
        make.attribute("TEXCOORD_0", F32, "VEC2", &bytes(UVS.as_flattened()));
        make.json["materials"] = json!([material]);
        make.primitive()["material"] = json!(0);
        make
    }

    pub fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    pub fn node(&mut self) -> &mut Value {
        &mut self.json["nodes"][0]
    }

    /// Adds bytes, aligned, as a buffer view.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let view = json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()});
        self.bin.extend_from_slice(bytes);
        push(&mut self.json["bufferViews"], view)
    }

    pub fn accessor(&mut self, component: u32, kind: &str, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        push(&mut self.json["accessors"], json!({"bufferView": view, "componentType": component, "type": kind, "count": count}))
    }

    pub fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        self.accessor(F32, kind, values.len() / dimensions(kind), &bytes(values))
    }

    /// Sets an attribute of the first primitive to new data, one element for each corner of the square.
    pub fn attribute(&mut self, name: &str, component: u32, kind: &str, bytes: &[u8]) -> usize {
        let accessor = self.accessor(component, kind, 4, bytes);
        self.primitive()["attributes"][name] = json!(accessor);
        accessor
    }

    /// Adds an image, and a texture of it with the default sampler.
    pub fn texture(&mut self, encoded: &[u8]) -> usize {
        let view = self.view(encoded);
        let images = self.json.as_object_mut().unwrap().entry("images").or_insert(json!([]));
        let image = push(images, json!({"bufferView": view, "mimeType": "image/png"}));
        let textures = self.json.as_object_mut().unwrap().entry("textures").or_insert(json!([]));
        push(textures, json!({"source": image}))
    }

    /// Animates a property of a node through keys: adds a channel to the file's first animation, which is made if missing.
    pub fn animate(&mut self, node: usize, property: &str, interpolation: &str, times: &[f32], values: &[f32]) {
        let kind = match property {
            "rotation" => "VEC4",
            "weights" => "SCALAR",
            _ => "VEC3",
        };
        let (input, output) = (self.floats("SCALAR", times), self.floats(kind, values));
        let animations = self.json.as_object_mut().unwrap().entry("animations").or_insert(json!([{"channels": [], "samplers": []}]));
        let sampler = json!({"input": input, "output": output, "interpolation": interpolation});
        let sampler = push(&mut animations[0]["samplers"], sampler);
        push(&mut animations[0]["channels"], json!({"sampler": sampler, "target": {"node": node, "path": property}}));
    }

    /// Adds a morph target to the first primitive, with displacements of the square's corners.
    pub fn target(&mut self, positions: [[f32; 3]; 4], normals: Option<[[f32; 3]; 4]>) {
        let mut target = json!({"POSITION": self.floats("VEC3", positions.as_flattened())});
        if let Some(normals) = normals {
            target["NORMAL"] = json!(self.floats("VEC3", normals.as_flattened()));
        }
        let primitive = self.primitive().as_object_mut().unwrap();
        push(primitive.entry("targets").or_insert(json!([])), target);
    }

    /// Gives the square's corners four joints with weights each, in set `set` of the attributes.
    pub fn influences(&mut self, set: u32, joints: [[u8; 4]; 4], weights: [[f32; 4]; 4]) {
        self.attribute(&format!("JOINTS_{set}"), U8, "VEC4", joints.as_flattened());
        self.attribute(&format!("WEIGHTS_{set}"), F32, "VEC4", &bytes(weights.as_flattened()));
    }

    /// Adds a skin of these nodes; `binds` are where each stood when the mesh was modelled.
    pub fn skin(&mut self, joints: &[usize], binds: &[[f32; 3]]) -> usize {
        let inverse = binds.iter().flat_map(|[x, y, z]| [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., -x, -y, -z, 1.]);
        let inverse = self.floats("MAT4", &inverse.collect::<Vec<f32>>());
        let skins = self.json.as_object_mut().unwrap().entry("skins").or_insert(json!([]));
        push(skins, json!({"joints": joints, "inverseBindMatrices": inverse}))
    }

    /// The square on two joints at its lower corners, nodes 1 and 2, of which the first holds its left side and the second its right. The
    /// second slides to the right by four, in two seconds. The square's own node stands far away, which must not matter.
    pub fn stretched() -> Self {
        let mut make = Self::square();
        make.influences(0, [[0; 4], [1, 0, 0, 0], [1, 0, 0, 0], [0; 4]], [[1.0, 0.0, 0.0, 0.0]; 4]);
        make.skin(&[1, 2], &[[0.0; 3], [1.0, 0.0, 0.0]]);
        make.json["nodes"] = json!([
            {"mesh": 0, "skin": 0, "translation": [70, 80, 90], "scale": [0, 1, 1]},
            {"children": [2]},
            {"translation": [1, 0, 0]},
        ]);
        make.json["scenes"][0]["nodes"] = json!([0, 1]);
        make.animate(2, "translation", "LINEAR", &[0.0, 2.0], &[1., 0., 0., 5., 0., 0.]);
        make
    }

    /// The JSON with a buffer of this URI, or with a .glb's binary chunk.
    pub fn document(&self, uri: Option<&str>) -> Value {
        let mut json = self.json.clone();
        if json.get("buffers").is_none() {
            json["buffers"] = json!([{"byteLength": self.bin.len()}]);
            if let Some(uri) = uri {
                json["buffers"][0]["uri"] = json!(uri);
            }
        }
        json
    }

    pub fn gltf(&self, uri: &str) -> Vec<u8> {
        serde_json::to_vec(&self.document(Some(uri))).unwrap()
    }

    pub fn glb(&self) -> Vec<u8> {
        glb(&serde_json::to_vec(&self.document(None)).unwrap(), &self.bin)
    }

    pub fn load(&self) -> anyhow::Result<Loaded> {
        gltf::load_slice(&self.glb(), None, "made.glb", None)
    }

    pub fn load_scene(&self, choice: SceneChoice) -> anyhow::Result<Loaded> {
        self.load_choice(&Choice { scene: Some(choice), ..Choice::default() })
    }

    pub fn load_animation(&self, animation: AnimationChoice) -> anyhow::Result<Loaded> {
        self.load_choice(&Choice { animation, ..Choice::default() })
    }

    fn load_choice(&self, choice: &Choice) -> anyhow::Result<Loaded> {
        gltf::load_slice(&self.glb(), None, "made.glb", Some(choice))
    }

    /// The scene, which must load without a warning.
    pub fn scene(&self) -> Scene {
        let loaded = self.load().unwrap_or_else(|error| panic!("{error:#}"));
        assert_eq!(loaded.warnings, Vec::<String>::new());
        loaded.scene
    }
}

pub fn push(list: &mut Value, value: Value) -> usize {
    let list = list.as_array_mut().unwrap();
    list.push(value);
    list.len() - 1
}

fn dimensions(kind: &str) -> usize {
    match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        "MAT4" => 16,
        other => panic!("{other}"),
    }
}

/// A .glb of a JSON text and a buffer.
pub fn glb(json: &[u8], bin: &[u8]) -> Vec<u8> {
    let chunk = |kind: &[u8; 4], data: &[u8], pad: u8| {
        let mut padded = data.to_vec();
        padded.resize(data.len().next_multiple_of(4), pad);
        [&(padded.len() as u32).to_le_bytes()[..], kind, &padded].concat()
    };
    let body = [chunk(b"JSON", json, b' '), chunk(b"BIN\0", bin, 0)].concat();
    [&b"glTF"[..], &2u32.to_le_bytes(), &(12 + body.len() as u32).to_le_bytes(), &body].concat()
}

pub fn bytes<T: bytemuck::NoUninit>(values: &[T]) -> Vec<u8> {
    bytemuck::cast_slice(values).to_vec()
}

/// A PNG of RGBA texels.
pub fn png(width: u32, height: u32, rgba: &[u8]) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_raw(width, height, rgba.to_vec()).unwrap();
    image.write_to(&mut file, image::ImageFormat::Png).unwrap();
    file.into_inner()
}

/// Vertices of a draw's triangles, in order.
pub fn corners(scene: &Scene, draw: &Draw) -> Vec<Vertex> {
    let indices = &scene.indices[draw.first_index as usize..][..draw.index_count as usize];
    indices.iter().map(|&i| scene.vertices[(draw.vertex_offset + i) as usize]).collect()
}

/// World positions of [`corners`].
pub fn positions(scene: &Scene, draw: &Draw) -> Vec<Vec3> {
    corners(scene, draw).iter().map(|vertex| draw.transform.transform_point3(vertex.position.into())).collect()
}

/// Unpacked normals of [`corners`], in the draw's own space.
pub fn normals(scene: &Scene, draw: &Draw) -> Vec<Vec3> {
    corners(scene, draw).iter().map(|vertex| pack::octahedral_snorm16_inverse(vertex.normal)).collect()
}

pub fn uvs(scene: &Scene, draw: &Draw) -> Vec<Vec2> {
    corners(scene, draw).iter().map(|vertex| vertex.uv.into()).collect()
}
