//! Vertices made by a pass and then drawn, as meshes that bend are.

use crate::common::*;
use manylight::gpu::{Accesses, Attachment, Barrier, Blend, Bound, Format, Gpu, ImageDesc, Load, RasterState, Stages};
use manylight::graph::{DrawList, Engine, Execution, Graph, Library, Timing, Variant};
use manylight::scene::Vertex;
use manylight::world::device::{DrawArguments, VERTEX};
use std::collections::{BTreeMap, BTreeSet};

/// A shader that makes one triangle over the whole picture.
const MAKE: &str = "#version 460\n#extension GL_EXT_scalar_block_layout : require\nlayout(local_size_x = 4) in;\n\
    struct Vertex { vec3 position; uint normal; vec2 uv; uint color; uint tangent; };\n\
    layout(scalar) writeonly buffer Vertices { Vertex at[]; } vertices;\n\
    void main() {\n\
        uint i = gl_GlobalInvocationID.x;\n\
        if (i >= 3u) return;\n\
        vec3 corner = vec3(i == 1u ? 3.0 : -1.0, i == 2u ? 3.0 : -1.0, 0.5);\n\
        vertices.at[i] = Vertex(corner, 0u, vec2(0.0), 0u, 0u);\n\
    }\n";
const VERT: &str = "#version 460\nlayout(location = 0) in vec3 position;\nvoid main() { gl_Position = vec4(position, 1.0); }\n";
const FRAG: &str = "#version 460\nlayout(location = 0) out vec4 covered;\nvoid main() { covered = vec4(1.0); }\n";

fn library() -> Library {
    let files = [("test/make.comp", MAKE), ("test/draw.vert", VERT), ("test/draw.frag", FRAG)];
    Library::from_sources(files.map(|(path, text)| (path.to_owned(), text.to_owned())).into_iter().collect::<BTreeMap<_, _>>())
}

const ONE_TRIANGLE: DrawArguments =
    DrawArguments { index_count: 3, instance_count: 1, first_index: 0, vertex_offset: 0, first_instance: 0 };

#[test]
fn a_draw_waits_for_the_pass_that_makes_its_vertices() {
    let mut engine = Engine::new(gpu(), library());
    for timing in [Timing::Isolated, Timing::Overlapped, Timing::Serial] {
        let mut g = Graph::new();
        let vertices = g.buffer::<Vertex>("made", 3);
        let target = g.image("target", Format::Rgba32Float, [16, 8]);
        let indices = g.upload("indices", &[0u32, 1, 2]);
        let arguments = g.upload("arguments", &[ONE_TRIANGLE]);
        g.compute("test/make").writes("vertices", vertices).dispatch([3, 1, 1]);
        let list = DrawList::new(VERTEX, [vertices, indices], arguments);
        g.raster("test/draw").color("covered", target, [0.0; 4]).draw(vec![list]);
        // The write to vertices that the draw has read must wait for it.
        g.compute("test/again").shader("test/make").writes("vertices", vertices).dispatch([3, 1, 1]);
        let read = g.read_back(target);
        let outcome = engine.execute(&g, &Execution { timing, ..Execution::default() }).unwrap_or_else(|error| panic!("{error:#}"));
        assert_eq!(outcome.bytes(read), bytemuck::cast_slice::<f32, u8>(&[1.0; 16 * 8 * 4]), "{timing:?}");
    }
    finish(&engine.gpu);
}

#[test]
fn vertices_that_no_pass_has_made_are_refused() {
    let mut engine = Engine::new(gpu(), library());
    let mut g = Graph::new();
    let vertices = g.buffer::<Vertex>("made", 3);
    let target = g.image("target", Format::Rgba32Float, [16, 8]);
    let indices = g.upload("indices", &[0u32, 1, 2]);
    let arguments = g.upload("arguments", &[ONE_TRIANGLE]);
    let list = DrawList::new(VERTEX, [vertices, indices], arguments);
    g.raster("test/draw").color("covered", target, [0.0; 4]).draw(vec![list]);
    let error = engine.execute(&g, &Execution::default()).unwrap_err().to_string();
    assert_eq!(error, "pass test/draw: its draw vertices are read before any pass writes them");
    finish(&engine.gpu);
}

/// A dispatch that makes vertices and a draw of them in one submission, with or without the barrier of a frame's plan.
fn make_then_draw(ordered: bool) -> Vec<String> {
    let mut gpu: Gpu = gpu();
    let mut library = library();
    let [make, vert, frag] =
        ["test/make.comp", "test/draw.vert", "test/draw.frag"].map(|path| Variant { path: path.to_owned(), parts: Vec::new() });
    library.prepare(&BTreeSet::from([make.clone(), vert.clone(), frag.clone()])).unwrap();
    let make = gpu.create_compute_pipeline("test/make", library.get(&make), &[]).unwrap();
    let state = RasterState {
        vertex: VERTEX,
        color: vec![Format::Rgba32Float],
        depth: None,
        points: false,
        cull_back: false,
        blend: Blend::Replace,
        conservative: false,
    };
    let stages = [vert, frag].map(|shader| (library.get(&shader), Vec::new()));
    let draw = gpu.create_raster_pipeline("test/draw", &stages, &state).unwrap();
    let vertices = gpu.create_buffer("made", 3 * size_of::<Vertex>() as u64).unwrap();
    let indices = gpu.create_upload_buffer("indices", bytemuck::cast_slice(&[0u32, 1, 2])).unwrap();
    let arguments = gpu.create_upload_buffer("arguments", bytemuck::bytes_of(&ONE_TRIANGLE)).unwrap();
    let desc = ImageDesc { format: Format::Rgba32Float, width: 16, height: 8, layers: 1, mips: 1, attachment: true, storage: false };
    let target = gpu.create_images(&[("target", desc)]).unwrap()[0];
    let bound = [(gpu.bindings(make)["vertices"].0, Bound::StorageBuffer(vertices))];
    gpu.submit("a dispatch and a draw", |commands| {
        commands.bind(make);
        commands.push_descriptors(make, &bound);
        commands.dispatch([1, 1, 1]);
        if ordered {
            commands.barrier(&Barrier {
                from: Stages::COMPUTE,
                written: Accesses::SHADER_WRITE,
                to: Stages::VERTEX_INPUT,
                needed: Accesses::VERTEX_READ,
            });
        }
        commands.begin_rendering([16, 8], &[Attachment { image: target, load: Load::Clear([0.0; 4]) }], None);
        commands.bind(draw);
        commands.bind_geometry(vertices, Some(indices));
        commands.draw_indexed_indirect(arguments, 0, 1);
        commands.end_rendering();
    })
    .unwrap();
    gpu.validation_messages()
}

#[test]
fn synchronization_validation_reports_a_draw_that_does_not_wait_for_its_vertices() {
    let messages = make_then_draw(false);
    assert!(messages.iter().any(|m| m.contains("SYNC-HAZARD-READ-AFTER-WRITE")), "{messages:?}");
    assert_eq!(make_then_draw(true), Vec::<String>::new());
}
