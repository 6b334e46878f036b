//! Damaged and lying skins and morph targets; [`crate::hostile`] has the rest of a file.

use crate::hostile::{Case, check};
use crate::make::{F32, Make, U8, U32, bytes, push};
use serde_json::{Value, json};

fn skin(make: &mut Make) -> &mut Value {
    &mut make.json["skins"][0]
}

fn remove(make: &mut Make, attribute: &str) {
    make.primitive()["attributes"].as_object_mut().unwrap().remove(attribute);
}

/// Changes to [`Make::stretched`].
const SKINS: &[Case] = &[
    ("a skin that is not there", |m| m.node()["skin"] = json!(3), "node 0: skin 3 does not exist, the file has 1"),
    ("a skin of nothing", |m| skin(m)["joints"] = json!([]), "skin 0: it has no joints"),
    ("a joint that is not there", |m| skin(m)["joints"] = json!([1, 9]), "skin 0: joint 1: node 9 does not exist, the file has 3"),
    (
        "a joint of another scene",
        |m| {
            push(&mut m.json["nodes"], json!({}));
            skin(m)["joints"] = json!([1, 3]);
        },
        "skin 0: its joint 1 is node 3, which is not in the scene",
    ),
    ("a skeleton that is not there", |m| skin(m)["skeleton"] = json!(8), "skin 0: its skeleton: node 8 does not exist"),
    ("joints in a circle", |m| m.json["nodes"][2]["children"] = json!([1]), "node 1 is reached twice"),
    ("matrices that are not there", |m| skin(m)["inverseBindMatrices"] = json!(99), "skin 0: inverseBindMatrices, accessor 99"),
    ("positions as matrices", |m| skin(m)["inverseBindMatrices"] = json!(0), "its type is Vec3, which inverseBindMatrices cannot be"),
    ("too few matrices", |m| skin(m)["joints"] = json!([1, 2, 2]), "skin 0: its 3 joints have only 2 inverseBindMatrices"),
    (
        "a projective matrix",
        |m| {
            let matrix = m.floats("MAT4", &[1.0; 32]);
            skin(m)["inverseBindMatrices"] = json!(matrix);
        },
        "skin 0: the last row of the inverseBindMatrices' element 0 is [1, 1, 1, 1], it must be 0 0 0 1",
    ),
    (
        "a matrix of no numbers",
        |m| {
            let matrix = m.floats("MAT4", &[f32::NAN; 32]);
            skin(m)["inverseBindMatrices"] = json!(matrix);
        },
        "element 0 is not finite",
    ),
    (
        "a matrix that throws things far",
        |m| {
            let row = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 1e12, 0., 0., 1.];
            let matrix = m.floats("MAT4", &[row, row].concat());
            skin(m)["inverseBindMatrices"] = json!(matrix);
        },
        "a bent mesh of material \"default\" reaches farther than 1e9 m from the origin",
    ),
    ("a joint that goes far", |m| m.animate(1, "translation", "LINEAR", &[0.0, 1.0], &[0., 0., 0., 0., 1e12, 0.]), "gets farther than"),
    ("no joints", |m| remove(m, "JOINTS_0"), "mesh 0: primitive 0: it has no JOINTS_0, which its node's skin needs"),
    ("no weights", |m| remove(m, "WEIGHTS_0"), "mesh 0: primitive 0: it has no WEIGHTS_0, which its node's skin needs"),
    (
        "half a second set",
        |m| {
            m.attribute("JOINTS_1", U8, "VEC4", &[0; 16]);
        },
        "it has no WEIGHTS_1, which its node's skin needs",
    ),
    (
        "a joint past the skin's",
        |m| m.influences(0, [[0, 0, 0, 0], [0, 5, 0, 0], [0; 4], [0; 4]], [[0.5; 4]; 4]),
        "mesh 0: primitive 0: its vertex 1 follows joint 5, skin 0 of node 0 has 2",
    ),
    (
        "joints that are floats",
        |m| {
            m.attribute("JOINTS_0", F32, "VEC4", &[0; 64]);
        },
        "its components are F32, which JOINTS_0 cannot be",
    ),
    (
        "joints of four bytes",
        |m| {
            m.attribute("JOINTS_0", U32, "VEC4", &[0; 64]);
        },
        "its components are U32, which JOINTS_0 cannot be",
    ),
    (
        "weights that are not normalized",
        |m| {
            m.attribute("WEIGHTS_0", U8, "VEC4", &[0; 16]);
        },
        "its components are U8, which WEIGHTS_0 cannot be",
    ),
    (
        "weights below nothing",
        |m| m.influences(0, [[0; 4]; 4], [[1.5, -0.5, 0.0, 0.0]; 4]),
        "WEIGHTS_0 of vertex 0 are [1.5, -0.5, 0.0, 0.0]",
    ),
    ("weights of no numbers", |m| m.influences(0, [[0; 4]; 4], [[f32::NAN; 4]; 4]), "WEIGHTS_0, accessor"),
    (
        "three weights for four corners",
        |m| {
            let weights = m.accessor(F32, "VEC4", 3, &bytes(&[0.25f32; 12]));
            m.primitive()["attributes"]["WEIGHTS_0"] = json!(weights);
        },
        "its WEIGHTS_0 has 3 elements, its POSITION 4",
    ),
];

/// The square with a target that is used.
fn morphed() -> Make {
    let mut make = Make::square();
    make.target([[0.0; 3]; 4], Some([[0.0; 3]; 4]));
    make.animate(0, "weights", "LINEAR", &[0.0, 1.0], &[0.0, 1.0]);
    make
}

/// Changes to [`morphed`].
const MORPHS: &[Case] = &[
    ("a target that is not there", |m| m.primitive()["targets"][0]["POSITION"] = json!(77), "target 0: POSITION, accessor 77"),
    ("indices as displacements", |m| m.primitive()["targets"][0]["NORMAL"] = json!(2), "target 0: NORMAL, accessor 2: its type is Scalar"),
    (
        "displacements of three corners",
        |m| {
            let three = m.floats("VEC3", &[0.0; 9]);
            m.primitive()["targets"][0]["POSITION"] = json!(three);
        },
        "target 0: its POSITION has 3 elements, its POSITION 4",
    ),
    (
        "displacements of no numbers",
        |m| {
            let none = m.floats("VEC3", &[f32::INFINITY; 12]);
            m.primitive()["targets"][0]["POSITION"] = json!(none);
        },
        "is not finite",
    ),
    (
        "targets of one primitive alone",
        |m| {
            let mut second = m.primitive().clone();
            second.as_object_mut().unwrap().remove("targets");
            push(&mut m.json["meshes"][0]["primitives"], second);
        },
        "primitive 1: it has 0 morph targets, the mesh's first primitive 1",
    ),
    (
        "weights of more targets",
        |m| {
            m.json.as_object_mut().unwrap().remove("animations");
            m.json["meshes"][0]["weights"] = json!([1, 2]);
        },
        "mesh 0: primitive 0: its weights are 2, it has 1 morph targets",
    ),
    (
        "weights of a node of more targets",
        |m| {
            m.json.as_object_mut().unwrap().remove("animations");
            m.node()["weights"] = json!([]);
        },
        "its node's weights are 0, it has 1 morph targets",
    ),
    (
        "a weight past what is finite",
        |m| {
            m.json.as_object_mut().unwrap().remove("animations");
            m.node()["weights"] = json!([1e39]);
        },
        "one of its node's weights is inf",
    ),
    (
        "weights of too few keys",
        |m| m.json["animations"][0]["samplers"][0]["interpolation"] = json!("CUBICSPLINE"),
        "animation 0: channel 0: sampler 0: its 2 keys of 1 targets need 6 values, its output (accessor 6) has 2",
    ),
    (
        "two channels of weights",
        |m| m.animate(0, "weights", "LINEAR", &[0.0, 1.0], &[0.0, 1.0]),
        "the weights of node 0 are those of another channel already",
    ),
    (
        "a displacement too far",
        |m| {
            let far = m.floats("VEC3", &[1e12; 12]);
            m.primitive()["targets"][0]["POSITION"] = json!(far);
        },
        "gets farther than 1e9 m from the origin",
    ),
];

#[test]
fn every_lie_of_a_skin_is_named() {
    for (name, bend, expected) in SKINS {
        let mut make = Make::stretched();
        bend(&mut make);
        check(name, &make.glb(), expected);
    }
}

#[test]
fn every_lie_of_a_morph_target_is_named() {
    for (name, bend, expected) in MORPHS {
        let mut make = morphed();
        bend(&mut make);
        check(name, &make.glb(), expected);
    }
}

#[test]
fn no_flipped_byte_of_a_mesh_that_bends_makes_it_panic() {
    let mut make = Make::stretched();
    make.target([[0.0, 0.0, 1.0]; 4], None);
    make.animate(0, "weights", "CUBICSPLINE", &[0.0, 1.0], &[0.5; 6]);
    make.influences(1, [[1; 4]; 4], [[0.5; 4]; 4]);
    crate::hostile::flip_bytes(&make.glb());
}

#[test]
fn a_small_file_cannot_ask_for_many_joints_or_displacements() {
    let mut make = Make::stretched();
    let joints: Vec<usize> = vec![1; 40_000];
    make.json["skins"][0] = json!({"joints": joints});
    make.json["skins"] = json!([make.json["skins"][0], make.json["skins"][0]]);
    make.json["nodes"] = json!([{"mesh": 0, "skin": 0}, {"children": [2]}, {}, {"mesh": 0, "skin": 1}]);
    make.json["scenes"][0]["nodes"] = json!([0, 1, 3]);
    check("joints", &make.glb(), "skin 1: with it, the scene's skins have more than 65536 joints");

    // Many targets share one accessor of many zeros.
    let mut make = Make::square();
    let zeros = push(&mut make.json["accessors"], json!({"componentType": F32, "type": "VEC3", "count": 1 << 20}));
    make.primitive()["attributes"] = json!({"POSITION": zeros, "NORMAL": zeros});
    make.primitive()["targets"] = json!(vec![json!({"POSITION": zeros}); 100]);
    make.json["meshes"][0]["weights"] = json!(vec![1; 100]);
    check("displacements", &make.glb(), "with it, the morph targets displace more than 16777216 vertices");
}
