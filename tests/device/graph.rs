//! Refusals of the frame graph, and hazards that the validation layer sees without it.

use crate::common::*;
use manylight::gpu::{Accesses, Barrier, Bound, BufferId, Format, Stages, VertexLayout};
use manylight::graph::{Buffer, Engine, Execution, Graph, Image, Library};
use manylight::scene::Vertex;
use manylight::world::device::VERTEX;
use manylight::{shader_struct, vertex_layout};
use std::collections::{BTreeMap, BTreeSet};

const HEADER: &str = "#version 460\n#extension GL_EXT_scalar_block_layout : require\n\
    #extension GL_GOOGLE_include_directive : require\nlayout(local_size_x = 64) in;\n";
const FILL: &str = "layout(scalar) writeonly buffer To { uint at[]; } to;\nvoid main() { to.at[gl_GlobalInvocationID.x] = 7u; }\n";
const COPY: &str = "layout(scalar) readonly buffer From { uint at[]; } from;\nlayout(scalar) writeonly buffer To { uint at[]; } to;\n\
    void main() { to.at[gl_GlobalInvocationID.x] = from.at[gl_GlobalInvocationID.x] + 1u; }\n";

fn library(files: &[(&str, &str)]) -> Library {
    let compute = files.iter().map(|(path, text)| {
        let text = if path.ends_with(".glsl") { (*text).to_owned() } else { format!("{HEADER}{text}") };
        ((*path).to_owned(), text)
    });
    let raster = [
        ("test/raster.vert", "#version 460\nlayout(location = 0) in vec3 position;\nvoid main() { gl_Position = vec4(position, 1.0); }\n"),
        (
            "test/raster.frag",
            "#version 460\nlayout(location = 0) out vec4 first;\nlayout(location = 1) out vec4 second;\n\
             void main() { first = vec4(1.0); second = vec4(0.5); }\n",
        ),
    ];
    let all: BTreeMap<String, String> = compute.chain(raster.map(|(path, text)| (path.to_owned(), text.to_owned()))).collect();
    Library::from_sources(all)
}

/// Two dispatches in one submission, the second of which reads the first one's output.
fn write_then_read(ordered: bool) -> Vec<String> {
    let mut gpu = gpu();
    let mut library = library(&[("test/fill.comp", FILL), ("test/copy.comp", COPY)]);
    library.prepare(&BTreeSet::from(["test/fill.comp".into(), "test/copy.comp".into()])).unwrap();
    let fill = gpu.create_compute_pipeline("test/fill", library.get(&"test/fill.comp".into()), &[]).unwrap();
    let copy = gpu.create_compute_pipeline("test/copy", library.get(&"test/copy.comp".into()), &[]).unwrap();
    let (first, second) = (gpu.create_buffer("first", 256).unwrap(), gpu.create_buffer("second", 256).unwrap());
    let binding = |pipeline, name: &str| gpu.bindings(pipeline)[name].0;
    let filled = [(binding(fill, "to"), Bound::StorageBuffer(first))];
    let copied = [(binding(copy, "from"), Bound::StorageBuffer(first)), (binding(copy, "to"), Bound::StorageBuffer(second))];
    gpu.submit("two dispatches", |commands| {
        commands.bind(fill);
        commands.push_descriptors(fill, &filled);
        commands.dispatch([1, 1, 1]);
        if ordered {
            commands.barrier(&Barrier {
                from: Stages::COMPUTE,
                written: Accesses::SHADER_WRITE,
                to: Stages::COMPUTE,
                needed: Accesses::SHADER_READ,
            });
        }
        commands.bind(copy);
        commands.push_descriptors(copy, &copied);
        commands.dispatch([1, 1, 1]);
    })
    .unwrap();
    gpu.validation_messages()
}

#[test]
fn synchronization_validation_reports_a_read_that_does_not_wait_for_the_write() {
    let messages = write_then_read(false);
    assert!(messages.iter().any(|m| m.contains("SYNC-HAZARD-READ-AFTER-WRITE")), "{messages:?}");
    assert_eq!(write_then_read(true), Vec::<String>::new());
}

#[test]
fn the_barriers_of_a_frame_are_enough_for_synchronization_validation() {
    let mut engine = Engine::new(gpu(), library(&[("test/fill.comp", FILL), ("test/copy.comp", COPY)]));
    let mut g = Graph::new();
    let buffers: Vec<Buffer> = (0..4).map(|i| g.buffer::<u32>(&format!("buffer {i}"), 64)).collect();
    g.compute("test/fill").writes("to", buffers[0]).dispatch([64, 1, 1]);
    for (name, i) in [("first", 0), ("second", 1), ("third", 2)] {
        g.compute(name).shader("test/copy").reads("from", buffers[i]).writes("to", buffers[i + 1]).dispatch([64, 1, 1]);
    }
    // The write to a buffer that the chain has read must wait for its readers.
    g.compute("again").shader("test/fill").writes("to", buffers[0]).dispatch([64, 1, 1]);
    let (last, again) = (g.read_back(buffers[3]), g.read_back(buffers[0]));
    for timing in [manylight::graph::Timing::Isolated, manylight::graph::Timing::Overlapped, manylight::graph::Timing::Serial] {
        let outcome = engine.execute(&g, &Execution { timing, ..Execution::default() }).unwrap();
        assert_eq!(outcome.bytes(last), bytemuck::cast_slice::<u32, u8>(&[10; 64]), "{timing:?}");
        assert_eq!(outcome.bytes(again), bytemuck::cast_slice::<u32, u8>(&[7; 64]), "{timing:?}");
        assert_eq!(outcome.times.iter().map(|(pass, _)| *pass).collect::<Vec<_>>(), ["test/fill", "first", "second", "third", "again"]);
        // Passes are on one clock, one after the other.
        assert_eq!((outcome.begins.len(), outcome.begins[0] < 1.0), (5, true), "{:?}", outcome.begins);
        for (i, next) in outcome.begins.iter().enumerate().skip(1) {
            let end = outcome.begins[i - 1] + outcome.times[i - 1].1;
            assert!(outcome.times[i - 1].1 >= 0.0 && end <= next + 1e-6, "{timing:?}: {:?} {:?}", outcome.begins, outcome.times);
        }
    }
    finish(&engine.gpu);
}

const COUNT: &str = "layout(scalar) buffer Counted { uint count; } counted;\n\
    void main() { if (gl_GlobalInvocationID.x % 3u == 0u) atomicAdd(counted.count, 2u); }\n";

#[test]
fn a_count_starts_at_0_in_every_frame_and_sums_what_all_passes_add() {
    let mut engine = Engine::new(gpu(), library(&[("test/count.comp", COUNT)]));
    let mut g = Graph::new();
    let (both, second) = (g.count("test/both"), g.count("test/second"));
    let _never = g.count("test/never");
    g.compute("test/count").updates("counted", both).dispatch([640, 1, 1]);
    g.compute("test/again").shader("test/count").updates("counted", both).dispatch([64, 1, 1]);
    g.compute("test/other").shader("test/count").updates("counted", second).dispatch([64, 1, 1]);
    // 214 and 22 of the invocations are multiples of 3.
    let expected = [("test/both", 2 * (214 + 22)), ("test/second", 2 * 22), ("test/never", 0)];
    for timing in [manylight::graph::Timing::Isolated, manylight::graph::Timing::Overlapped, manylight::graph::Timing::Serial] {
        for _ in 0..2 {
            let outcome = engine.execute(&g, &Execution { timing, dump: vec!["test/count".into()], ..Execution::default() }).unwrap();
            assert_eq!(outcome.counts, expected.map(|(name, count)| (name.to_owned(), count)), "{timing:?}");
            assert!(outcome.dumps.is_empty(), "a count is no resource to dump");
        }
    }
    finish(&engine.gpu);
}

shader_struct! {
    struct Pair {
        number: u32,
        weight: f32,
    }

    struct Swapped {
        weight: f32,
        number: u32,
    }

    struct Longer {
        number: u32,
        weight: f32,
        rest: f32,
    }
}

const PAIRS: &str = "struct Pair { uint number; float weight; };\nlayout(scalar) readonly buffer Pairs { Pair at[]; } pairs;\n\
    layout(scalar) writeonly buffer To { uint at[]; } to;\nlayout(scalar, push_constant) uniform Params { uint number; float weight; } params;\n\
    void main() { to.at[gl_GlobalInvocationID.x] = pairs.at[gl_GlobalInvocationID.x].number + params.number; }\n";
const UPDATE: &str = "layout(scalar) buffer Data { uint at[]; } data;\nvoid main() { data.at[gl_GlobalInvocationID.x] += 1u; }\n";
const IMAGE: &str = "uniform sampler2D image;\nlayout(scalar) writeonly buffer To { uint at[]; } to;\n\
    void main() { to.at[gl_GlobalInvocationID.x] = uint(texelFetch(image, ivec2(0), 0).r); }\n";
const SIZED: &str = "layout(constant_id = 2) const uint SIZE = 1;\nlayout(scalar) writeonly buffer To { uint at[]; } to;\n\
    void main() { to.at[gl_GlobalInvocationID.x] = SIZE; }\n";

const SLOTTED: &str = "#include \"part/number=part-seven\"\n#include \"part/sign\"\n\
    layout(scalar) writeonly buffer To { uint at[]; } to;\nvoid main() { to.at[gl_GlobalInvocationID.x] = sign_of() * number(); }\n";
const SEVEN: &str = "uint number() { return 7u; }\n";
const GIVEN: &str =
    "layout(scalar) readonly buffer From { uint at[]; } from;\nuint number() { return from.at[gl_GlobalInvocationID.x]; }\n";
const SIGN: &str = "uint sign_of() { return 1u; }\n";
const PARTS: [(&str, &str); 3] = [("part-seven.glsl", SEVEN), ("part-given.glsl", GIVEN), ("part-sign.glsl", SIGN)];

#[test]
fn a_part_brings_bindings_that_the_pass_declares() {
    let mut engine = Engine::new(gpu(), library(&[&[("test/slotted.comp", SLOTTED)], &PARTS[..]].concat()));
    let mut g = Graph::new();
    let (from, to, other) = (g.upload("from", &[3u32; 64]), g.buffer::<u32>("to", 64), g.buffer::<u32>("other", 64));
    g.compute("test/slotted").part("sign", "part-sign").writes("to", to).dispatch([64, 1, 1]);
    let given = g.compute("given").shader("test/slotted").part("sign", "part-sign").part("number", "part-given");
    given.reads("from", from).writes("to", other).dispatch([64, 1, 1]);
    let read = [to, other].map(|buffer| g.read_back(buffer));
    let outcome = engine.execute(&g, &Execution::default()).unwrap_or_else(|error| panic!("{error:#}"));
    assert_eq!(read.map(|read| outcome.bytes(read).to_vec()), [7u32, 3].map(|n| bytemuck::cast_slice::<u32, u8>(&[n; 64]).to_vec()));
    assert_eq!(engine.pipelines_made(), 2);
    finish(&engine.gpu);
}

/// Runs a frame that must be refused. Returns the error.
fn refused(engine: &mut Engine, what: &str, describe: impl FnOnce(&mut Graph)) -> String {
    let mut g = Graph::new();
    describe(&mut g);
    match engine.execute(&g, &Execution::default()) {
        Ok(_) => panic!("{what}: the frame ran"),
        Err(error) => format!("{error:#}"),
    }
}

#[test]
fn a_pass_that_lies_about_itself_is_refused_by_name() {
    let mut engine = Engine::new(
        gpu(),
        library(
            &[
                &[
                    ("test/fill.comp", FILL),
                    ("test/copy.comp", COPY),
                    ("test/pairs.comp", PAIRS),
                    ("test/update.comp", UPDATE),
                    ("test/image.comp", IMAGE),
                    ("test/sized.comp", SIZED),
                    ("test/slotted.comp", SLOTTED),
                ],
                &PARTS[..],
            ]
            .concat(),
        ),
    );
    let nothing = engine.gpu.create_buffer("nothing", 64).unwrap();
    let to = |g: &mut Graph| g.buffer::<u32>("to", 64);
    let from = |g: &mut Graph| g.upload("from", &[0u32; 64]);
    let image = |g: &mut Graph| g.image("image", Format::Rgba16Float, [8, 8]);
    let pair = Pair { number: 1, weight: 2.0 };
    type Describe = Box<dyn FnOnce(&mut Graph)>;
    let cases: Vec<(&str, &str, Describe)> = vec![
        (
            "a write called a read",
            "pass test/fill: \"to\" declared Read, shader does Write",
            Box::new(move |g| {
                let from = from(g);
                g.compute("test/fill").reads("to", from).dispatch([64, 1, 1]);
            }),
        ),
        (
            "a read called a write",
            "pass test/copy: \"from\" declared Write, shader does Read",
            Box::new(move |g| {
                let (a, b) = (g.buffer::<u32>("a", 64), to(g));
                g.compute("test/copy").writes("from", a).writes("to", b).dispatch([64, 1, 1]);
            }),
        ),
        (
            "an update called a write",
            "pass test/update: \"data\" declared Write, shader does ReadWrite",
            Box::new(move |g| {
                let to = to(g);
                g.compute("test/update").writes("data", to).dispatch([64, 1, 1]);
            }),
        ),
        (
            "a binding that the shader lacks",
            "pass test/fill: \"other\" is declared Read, the shader does not use it",
            Box::new(move |g| {
                let (a, b) = (from(g), to(g));
                g.compute("test/fill").reads("other", a).writes("to", b).dispatch([64, 1, 1]);
            }),
        ),
        (
            "a binding that the pass keeps quiet about",
            "pass test/copy: the shader uses \"from\", the pass does not declare it",
            Box::new(move |g| {
                let to = to(g);
                g.compute("test/copy").writes("to", to).dispatch([64, 1, 1]);
            }),
        ),
        (
            "members in another order",
            "pass test/pairs: \"pairs\": member 0 of Swapped is weight at 0 (4 bytes) here and number at 0 (4 bytes) in the shader",
            Box::new(move |g| {
                let (a, b) = (g.upload("pairs", &[Swapped { weight: 1.0, number: 1 }; 64]), to(g));
                g.compute("test/pairs").reads("pairs", a).writes("to", b).params(&pair).dispatch([64, 1, 1]);
            }),
        ),
        (
            "elements of another size",
            "pass test/pairs: \"pairs\": an element of Longer takes 12 bytes here and 8 in the shader",
            Box::new(move |g| {
                let (a, b) = (g.upload("pairs", &[Longer { number: 1, weight: 1.0, rest: 1.0 }; 64]), to(g));
                g.compute("test/pairs").reads("pairs", a).writes("to", b).params(&pair).dispatch([64, 1, 1]);
            }),
        ),
        (
            "other push constants",
            "pass test/pairs: params: member 0 of Swapped is weight at 0 (4 bytes) here",
            Box::new(move |g| {
                let (a, b) = (g.upload("pairs", &[pair; 64]), to(g));
                g.compute("test/pairs").reads("pairs", a).writes("to", b).params(&Swapped { weight: 1.0, number: 1 }).dispatch([64, 1, 1]);
            }),
        ),
        (
            "push constants left out",
            "pass test/pairs: the shader has params, none are given",
            Box::new(move |g| {
                let (a, b) = (g.upload("pairs", &[pair; 64]), to(g));
                g.compute("test/pairs").reads("pairs", a).writes("to", b).dispatch([64, 1, 1]);
            }),
        ),
        (
            "push constants that nobody takes",
            "pass test/fill: params are given, the shader has none",
            Box::new(move |g| {
                let to = to(g);
                g.compute("test/fill").writes("to", to).params(&pair).dispatch([64, 1, 1]);
            }),
        ),
        (
            "an image for a buffer",
            "pass test/image: \"image\": from is a buffer, the shader has the other kind",
            Box::new(move |g| {
                let (a, b) = (from(g), to(g));
                g.compute("test/image").reads("image", a).writes("to", b).dispatch([64, 1, 1]);
            }),
        ),
        (
            "a constant that the shader lacks",
            "pass test/sized: the shader has no specialization constant LENGTH",
            Box::new(move |g| {
                let to = to(g);
                g.compute("test/sized").writes("to", to).constant("LENGTH", 3u32).dispatch([64, 1, 1]);
            }),
        ),
        (
            "a constant that the pass forgets",
            "pass test/sized: the shader has a specialization constant SIZE, the pass does not set it",
            Box::new(move |g| {
                let to = to(g);
                g.compute("test/sized").writes("to", to).dispatch([64, 1, 1]);
            }),
        ),
        (
            "a part for a slot that the shader lacks",
            "pass test/fill: part-seven is named for \"number\", the shader has no such slot",
            Box::new(move |g| {
                let to = to(g);
                g.compute("test/fill").part("number", "part-seven").writes("to", to).dispatch([64, 1, 1]);
            }),
        ),
        (
            "a slot that nothing fills",
            "pass test/slotted: glsl/test/slotted.comp: its slot \"sign\" has no default, and no part is named for it",
            Box::new(move |g| {
                let to = to(g);
                g.compute("test/slotted").writes("to", to).dispatch([64, 1, 1]);
            }),
        ),
        (
            "a part that there is not",
            "pass test/slotted: glsl/part-eight.glsl: there is no such part, for \"sign\"",
            Box::new(move |g| {
                let to = to(g);
                g.compute("test/slotted").part("sign", "part-eight").writes("to", to).dispatch([64, 1, 1]);
            }),
        ),
        (
            "two parts for a slot",
            "pass test/slotted: two parts are named for \"sign\"",
            Box::new(move |g| {
                let to = to(g);
                g.compute("test/slotted").part("sign", "part-sign").part("sign", "part-seven").writes("to", to).dispatch([64, 1, 1]);
            }),
        ),
        (
            "a part whose binding the pass keeps quiet about",
            "pass test/slotted: the shader uses \"from\", the pass does not declare it",
            Box::new(move |g| {
                let to = to(g);
                g.compute("test/slotted").part("sign", "part-sign").part("number", "part-given").writes("to", to).dispatch([64, 1, 1]);
            }),
        ),
        (
            "a shader that there is not",
            "glsl/test/missing.comp: there is no such shader",
            Box::new(move |g| {
                let to = to(g);
                g.compute("test/missing").writes("to", to).dispatch([64, 1, 1]);
            }),
        ),
        (
            "two passes of one name",
            "pass test/fill: two passes of a frame have this name",
            Box::new(move |g| {
                let (a, b) = (to(g), g.buffer::<u32>("b", 64));
                g.compute("test/fill").writes("to", a).dispatch([64, 1, 1]);
                g.compute("test/fill").writes("to", b).dispatch([64, 1, 1]);
            }),
        ),
        (
            "a read before any write",
            "pass test/copy: reads a before any pass writes it",
            Box::new(move |g| {
                let (a, b) = (g.buffer::<u32>("a", 64), to(g));
                g.compute("test/copy").reads("from", a).writes("to", b).dispatch([64, 1, 1]);
            }),
        ),
        (
            "one buffer read and written under two names",
            "pass test/copy: uses a in two ways at once",
            Box::new(move |g| {
                let a = g.buffer::<u32>("a", 64);
                g.compute("test/fill").writes("to", a).dispatch([64, 1, 1]);
                g.compute("test/copy").reads("from", a).writes("to", a).dispatch([64, 1, 1]);
            }),
        ),
        (
            "outputs in another order",
            "pass test/raster: renders to [\"second\", \"first\"], the shader's outputs are [\"first\", \"second\"]",
            Box::new(move |g| raster(g, ["second", "first"], VERTEX, image, nothing)),
        ),
        (
            "an output by another name",
            "pass test/raster: renders to [\"first\", \"other\"], the shader's outputs are [\"first\", \"second\"]",
            Box::new(move |g| raster(g, ["first", "other"], VERTEX, image, nothing)),
        ),
        (
            "a vertex without what the shader reads",
            "glsl/test/raster.vert: a vertex has no position",
            Box::new(move |g| raster(g, ["first", "second"], vertex_layout!(Skinned { joints: Uint, place: Float3 }), image, nothing)),
        ),
        (
            "a vertex that has it as another type",
            "glsl/test/raster.vert: position is a vec3, a vertex has it as a vec2",
            Box::new(move |g| raster(g, ["first", "second"], vertex_layout!(Flat { position: Float2 }), image, nothing)),
        ),
    ];
    for (what, expected, describe) in cases {
        let error = refused(&mut engine, what, describe);
        assert!(error.contains(expected), "{what}: {error}");
    }
    finish(&engine.gpu);
}

#[repr(C)]
struct Skinned {
    joints: u32,
    place: [f32; 3],
}

#[repr(C)]
struct Flat {
    position: [f32; 2],
}

#[test]
fn a_vertex_layout_says_where_its_fields_lie() {
    let places = |layout: VertexLayout| layout.attributes.iter().map(|a| (a.name, a.format.glsl(), a.offset)).collect::<Vec<_>>();
    assert_eq!(places(vertex_layout!(Skinned { place: Float3, joints: Uint })), [("place", "vec3", 4), ("joints", "uint", 0)]);
    let expected = [("position", "vec3", 0), ("normal", "vec2", 12), ("uv", "vec2", 16), ("color", "vec4", 24), ("tangent", "uint", 28)];
    assert_eq!((places(VERTEX), VERTEX.stride), (expected.to_vec(), 32));
}

fn raster(g: &mut Graph, outputs: [&'static str; 2], vertex: VertexLayout, image: impl Fn(&mut Graph) -> Image, nothing: BufferId) {
    let (a, b) = (image(g), g.image("other image", Format::Rgba16Float, [8, 8]));
    // Nothing is drawn: the refusal comes before any command, so the geometry only needs names.
    let arguments = g.upload("arguments", &[0u32; 5]);
    let vertices = g.import_buffer::<Vertex>("vertices", nothing, 1);
    let indices = g.import_buffer::<u32>("indices", nothing, 1);
    let list = manylight::graph::DrawList::new(vertex, [vertices, indices], arguments);
    g.raster("test/raster").color(outputs[0], a, [0.0; 4]).color(outputs[1], b, [0.0; 4]).draw(vec![list]);
}

#[test]
fn an_injected_loss_of_the_device_ends_in_its_exit_code_and_names_the_pass() {
    use manylight::error::{Exit, exit_code};
    use manylight::gpu::fault::Fault;
    let mut engine = Engine::new(gpu(), library(&[("test/fill.comp", FILL), ("test/copy.comp", COPY)]));
    let mut g = Graph::new();
    let (a, b) = (g.buffer::<u32>("a", 64), g.buffer::<u32>("b", 64));
    g.compute("test/fill").writes("to", a).dispatch([64, 1, 1]);
    g.compute("test/copy").reads("from", a).writes("to", b).dispatch([64, 1, 1]);
    engine.gpu.inject(Some(Fault::OutOfMemory { resource: "b".into() }));
    let error = engine.execute(&g, &Execution::default()).unwrap_err();
    assert_eq!(exit_code(&error), Exit::OutOfMemory, "{error:#}");
    assert!(format!("{error:#}").contains('b'), "{error:#}");
    for timing in [manylight::graph::Timing::Isolated, manylight::graph::Timing::Serial] {
        engine.gpu.inject(Some(Fault::DeviceLost { pass: "test/copy".into() }));
        let error = engine.execute(&g, &Execution { timing, ..Execution::default() }).unwrap_err();
        assert_eq!(exit_code(&error), Exit::DeviceLost, "{error:#}");
        assert!(format!("{error:#}").contains("test/copy"), "{timing:?}: {error:#}");
    }
    // The fault was only simulated: without it the same frame runs.
    engine.gpu.inject(None);
    engine.execute(&g, &Execution::default()).unwrap();
    finish(&engine.gpu);
}
