//! Binary PLY meshes with normals, texture coordinates and optional vertex colours.

use super::meshes::Mesh;

/// A mesh as the bytes of a PLY file. `colored` adds vertex colours, which Mitsuba names `vertex_color`.
pub fn encode(mesh: &Mesh, colored: bool) -> Vec<u8> {
    let mut properties = vec!["x", "y", "z", "nx", "ny", "nz", "u", "v"];
    if colored {
        properties.extend(["r", "g", "b"]);
    }
    let list: String = properties.iter().map(|property| format!("property float {property}\n")).collect();
    let (vertices, triangles) = (mesh.vertices.len(), mesh.triangles.len());
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n{list}element face {triangles}\nproperty list uchar int vertex_indices\nend_header\n"
    );
    let mut bytes = Vec::with_capacity(header.len() + vertices * properties.len() * 4 + triangles * 13);
    bytes.extend_from_slice(header.as_bytes());
    for corner in &mesh.vertices {
        let numbers = [corner.position.to_array(), corner.normal.to_array()].concat().into_iter().chain(corner.uv.to_array());
        let color = corner.color.into_iter().take(if colored { 3 } else { 0 });
        numbers.chain(color).for_each(|number| bytes.extend_from_slice(&number.to_le_bytes()));
    }
    for triangle in &mesh.triangles {
        bytes.push(3);
        triangle.iter().for_each(|index| bytes.extend_from_slice(&index.to_le_bytes()));
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::super::meshes::Corner;
    use super::*;
    use glam::{Vec2, Vec3};

    #[test]
    fn a_mesh_is_a_header_and_its_numbers() {
        let corner = |x: f32| Corner { position: Vec3::new(x, 2.0, 3.0), normal: Vec3::Z, uv: Vec2::new(0.25, 0.75), color: [0.5; 4] };
        let mesh = Mesh { vertices: vec![corner(0.0), corner(1.0), corner(2.0)], triangles: vec![[0, 1, 2]] };
        for (colored, numbers) in [(false, 8), (true, 11)] {
            let bytes = encode(&mesh, colored);
            let end = b"end_header\n";
            let start = bytes.windows(end.len()).position(|window| window == end).unwrap() + end.len();
            assert_eq!(bytes.len() - start, 3 * numbers * 4 + 13);
            let second = start + numbers * 4;
            assert_eq!(bytes[second..second + 8], [1.0f32.to_le_bytes(), 2.0f32.to_le_bytes()].concat());
            assert_eq!(bytes[bytes.len() - 13..], [3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
            assert_eq!(String::from_utf8_lossy(&bytes[..start]).contains("property float r\n"), colored);
        }
    }
}
