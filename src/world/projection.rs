//! Cameras and lights in the layout of the shaders: `glsl/lib/view.glsl` and `glsl/lib/light.glsl`.

use crate::scene::{Aabb, Camera, Light, SpotFalloff};
use crate::shader_struct;
use glam::{DVec2, DVec3, Mat4, Vec2, Vec3, Vec4};

shader_struct! {
    /// A camera for one picture size.
    pub struct View {
        pub view_projection: [[f32; 4]; 4],
        pub position: [f32; 3],
        /// Distance of the near plane, metres.
        pub near: f32,
        /// Unit right vector times the tangent of half the horizontal field of view.
        pub right: [f32; 3],
        pub width: u32,
        /// Unit up vector times the tangent of half the vertical field of view.
        pub up: [f32; 3],
        pub height: u32,
        pub forward: [f32; 3],
        /// Diagonal of the scene's bounds, metres.
        pub diagonal: f32,
    }

    /// A layer of the reflective shadow map: a light, or one face of a point light.
    pub struct Projector {
        pub world_to_clip: [[f32; 4]; 4],
        pub origin: [f32; 3],
        /// 0 directional, 1 and 2 spot by angle and by cosine, 3 a point light's face.
        pub kind: u32,
        pub direction: [f32; 3],
        /// Distance of the near plane, or a directional light's depth range, metres.
        pub near: f32,
        /// Right vector, of half the map's width (metres) or of the half-angle's tangent.
        pub right: [f32; 3],
        pub inner: f32,
        /// Up vector, of half the map's height, in the same unit.
        pub up: [f32; 3],
        pub outer: f32,
        /// Irradiance, W/m^2, or radiant intensity, W/sr.
        pub power: [f32; 3],
        /// Area of a texel: m^2, or on the plane at distance 1.
        pub texel_area: f32,
    }
}

impl View {
    /// View of a camera for pictures of `size` pixels, in a scene with these bounds.
    pub fn new(camera: &Camera, size: [u32; 2], bounds: Aabb) -> Self {
        let diagonal = bounds.size().length().max(1e-6);
        let (forward, right, up) = frame(camera.target - camera.position, camera.up);
        let tangent = (camera.fov_y_deg.to_radians() * 0.5).tan();
        let aspect = size[0] as f32 / size[1] as f32;
        let (right, up) = (right * tangent * aspect, up * tangent);
        // Small against the scene; the reversed projection keeps its precision with any near plane.
        let near = diagonal * 1e-4;
        Self {
            view_projection: perspective(camera.position, forward, right, up, near).to_cols_array_2d(),
            position: camera.position.into(),
            near,
            right: right.into(),
            width: size[0],
            up: up.into(),
            height: size[1],
            forward: forward.into(),
            diagonal,
        }
    }

    /// Whether a part of a box may be in the picture (conservative).
    pub fn sees(&self, bounds: Aabb) -> bool {
        sees(&self.view_projection, bounds)
    }

    /// Distance to a box's centre.
    pub fn distance(&self, bounds: Aabb) -> f32 {
        bounds.center().distance(self.position.into())
    }

    /// World position of a pixel's centre, given its value in the depth image, which must not be 0.
    pub fn position_at(&self, x: u32, y: u32, depth: f32) -> Vec3 {
        let ndc = (Vec2::new(x as f32, y as f32) + 0.5) / Vec2::new(self.width as f32, self.height as f32) * 2.0 - 1.0;
        let ray = Vec3::from(self.forward) + ndc.x * Vec3::from(self.right) - ndc.y * Vec3::from(self.up);
        Vec3::from(self.position) + ray * (self.near / depth)
    }

    /// Projection of a world position: pixels from the picture's upper left corner (pixel centres at halves), and the distance along the
    /// view's axis, metres. `None` if it is not ahead of the camera; positions outside of the picture are projected, too.
    pub fn pixel_of(&self, position: Vec3) -> Option<(DVec2, f64)> {
        let vector = |v: [f32; 3]| Vec3::from(v).as_dvec3();
        let away: DVec3 = position.as_dvec3() - vector(self.position);
        let distance = away.dot(vector(self.forward));
        let [right, up] = [self.right, self.up].map(vector);
        let ndc = DVec2::new(away.dot(right) / right.length_squared(), -away.dot(up) / up.length_squared()) / distance;
        let size = DVec2::new(self.width.into(), self.height.into());
        (distance > f64::from(self.near) * 0.5).then(|| ((ndc * 0.5 + 0.5) * size, distance))
    }

    /// Width and height of a pixel's footprint on a plane that faces the view at a distance of 1 m, metres.
    pub fn pixel_size(&self) -> f64 {
        2.0 * f64::from(Vec3::from(self.up).length()) / f64::from(self.height)
    }
}

/// Orthonormal forward, right and up. An arbitrary up is taken if the given one is parallel to the view.
fn frame(forward: Vec3, up: Vec3) -> (Vec3, Vec3, Vec3) {
    let forward = forward.normalize_or(Vec3::NEG_Z);
    let right = forward.cross(up).try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
    (forward, right, right.cross(forward))
}

/// World to clip space: x right, y down, depth `near / distance` (reversed, infinite). `right` and `up` are half-extents on the
/// plane at distance 1.
fn perspective(position: Vec3, forward: Vec3, right: Vec3, up: Vec3, near: f32) -> Mat4 {
    let row = |axis: Vec3| axis.extend(-axis.dot(position));
    let (x, y) = (row(right / right.length_squared()), -row(up / up.length_squared()));
    Mat4::from_cols(x, y, Vec4::new(0.0, 0.0, 0.0, near), row(forward)).transpose()
}

/// Conservative test: false only if all corners of a box are outside the same side of the clip volume.
fn sees(matrix: &[[f32; 4]; 4], bounds: Aabb) -> bool {
    let corners = bounds.corners().map(|corner| Mat4::from_cols_array_2d(matrix) * corner.extend(1.0));
    let outside: [fn(Vec4) -> bool; 5] = [|c| c.x < -c.w, |c| c.x > c.w, |c| c.y < -c.w, |c| c.y > c.w, |c| c.z > c.w];
    !outside.iter().any(|side| corners.iter().all(|c| side(*c)))
}

impl Projector {
    /// Layers of the lights that have maps, of `size` texels each. A directional light is fitted to `target` across, and to `bounds` along
    /// its direction, so that occluders of the target are drawn, too.
    pub fn of_lights(lights: &[Light], size: [u32; 2], target: Aabb, bounds: Aabb) -> Vec<Self> {
        let mut projectors = Vec::new();
        for light in lights {
            match *light {
                Light::Directional { direction, irradiance } => {
                    projectors.push(Self::directional(direction, irradiance, size, target, bounds));
                }
                Light::Spot { position, direction, intensity, inner, outer, falloff } => {
                    let kind = match falloff {
                        SpotFalloff::Angle => 1,
                        SpotFalloff::CosineSquared => 2,
                    };
                    let tangent = outer.min(Self::WIDEST_SPOT).tan();
                    let spot = Self::frustum(position, direction, Vec3::Y, tangent, intensity, size, bounds);
                    projectors.push(Self { kind, inner, outer, ..spot });
                }
                Light::Point { position, intensity } => {
                    for (axis, up) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::Y)] {
                        for direction in [axis, -axis] {
                            projectors.push(Self::frustum(position, direction, up, 1.0, intensity, size, bounds));
                        }
                    }
                }
                Light::Environment { .. } => {}
            }
        }
        projectors
    }

    fn frustum(position: Vec3, direction: Vec3, up: Vec3, tangent: f32, intensity: Vec3, size: [u32; 2], bounds: Aabb) -> Self {
        let (direction, right, up) = frame(direction, up);
        let (right, up) = (right * tangent, up * tangent);
        // Relative to the farthest corner that it can light, wherever the light is.
        let near = bounds.corners().map(|corner| corner.distance(position)).into_iter().fold(1e-6, f32::max) * 1e-4;
        Self {
            world_to_clip: perspective(position, direction, right, up, near).to_cols_array_2d(),
            origin: position.into(),
            kind: 3,
            direction: direction.into(),
            near,
            right: right.into(),
            inner: 0.0,
            up: up.into(),
            outer: 0.0,
            power: intensity.into(),
            texel_area: (2.0 * tangent / size[0] as f32) * (2.0 * tangent / size[1] as f32),
        }
    }

    fn directional(direction: Vec3, irradiance: Vec3, size: [u32; 2], target: Aabb, bounds: Aabb) -> Self {
        let extent = |axis: Vec3, of: Aabb| {
            of.corners().iter().map(|c| c.dot(axis)).fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), d| (a.min(d), b.max(d)))
        };
        // Candidates aligned to the world's axes; the one with the smallest texels wins.
        let frames = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().filter(|axis| axis.cross(direction).length() > 1e-3).flat_map(|axis| {
            let (_, right, up) = frame(direction, axis);
            [(right, up), (up, -right)]
        });
        let texel_area = |(right, up): &(Vec3, Vec3)| {
            let ((x0, x1), (y0, y1)) = (extent(*right, target), extent(*up, target));
            (x1 - x0) / size[0] as f32 * ((y1 - y0) / size[1] as f32)
        };
        let shape = |frame: &(Vec3, Vec3)| {
            let ((x0, x1), (y0, y1)) = (extent(frame.0, target), extent(frame.1, target));
            let (a, b) = ((x1 - x0) / size[0] as f32, (y1 - y0) / size[1] as f32);
            // Smallest texels first, then the squarest.
            texel_area(frame) * (a / b).max(b / a).sqrt()
        };
        let best = frames.min_by(|a, b| shape(a).total_cmp(&shape(b)));
        let (right, up) = best.unwrap_or_else(|| unreachable!("a direction is not parallel to two axes"));
        // A margin of one texel keeps the outermost surfaces inside.
        let ((x0, x1), (y0, y1), (z0, z1)) = (extent(right, target), extent(up, target), extent(direction, bounds));
        let half_width = ((x1 - x0) * 0.5 * (1.0 + 2.0 / size[0] as f32)).max(1e-6);
        let half_height = ((y1 - y0) * 0.5 * (1.0 + 2.0 / size[1] as f32)).max(1e-6);
        // A minimum depth, so that floats separate a flat scene from the planes.
        let depth = (z1 - z0).max(bounds.size().length() * 1e-3).max(1e-6);
        let margin = depth * 1e-3;
        let range = depth + 2.0 * margin;
        let origin = right * (x0 + x1) * 0.5 + up * (y0 + y1) * 0.5 + direction * (z0 - margin);
        let row = |axis: Vec3| axis.extend(-axis.dot(origin));
        let nearness = Vec4::new(0.0, 0.0, 0.0, 1.0) - row(direction / range);
        let clip = Mat4::from_cols(row(right / half_width), -row(up / half_height), nearness, Vec4::W).transpose();
        Self {
            world_to_clip: clip.to_cols_array_2d(),
            origin: origin.into(),
            kind: 0,
            direction: direction.into(),
            near: range,
            right: (right * half_width).into(),
            inner: 0.0,
            up: (up * half_height).into(),
            outer: 0.0,
            power: irradiance.into(),
            texel_area: 4.0 * half_width * half_height / (size[0] as f32 * size[1] as f32),
        }
    }

    /// Half-angle of the widest map, radians. Towards 90 degrees nearly all texels would lie at the rim.
    pub const WIDEST_SPOT: f32 = 80.0 * std::f32::consts::PI / 180.0;

    /// Capacity of the shaders' uniform block.
    pub const MAX: usize = 64;

    /// Kind of a set of lights of several kinds.
    pub const MIXED: u32 = 4;

    /// Common kind of these lights, or [`Self::MIXED`].
    pub fn common_kind(lights: &[Self]) -> u32 {
        let first = lights.first().map_or(Self::MIXED, |light| light.kind);
        if lights.iter().all(|light| light.kind == first) { first } else { Self::MIXED }
    }

    /// Whether a part of a box may be in the map (conservative).
    pub fn sees(&self, bounds: Aabb) -> bool {
        sees(&self.world_to_clip, bounds)
    }

    /// Distance to a box's centre; of a directional light, along its direction.
    pub fn distance(&self, bounds: Aabb) -> f32 {
        let way = bounds.center() - Vec3::from(self.origin);
        if self.kind == 0 { way.dot(self.direction.into()) } else { way.length() }
    }

    /// World position of a point of the map, given by ndc in [-1, 1] with y down, and a depth that is not 0.
    pub fn position_at(&self, ndc: Vec2, depth: f32) -> Vec3 {
        let (origin, direction) = (Vec3::from(self.origin), Vec3::from(self.direction));
        let offset = ndc.x * Vec3::from(self.right) - ndc.y * Vec3::from(self.up);
        match self.kind {
            0 => origin + offset + direction * (self.near * (1.0 - depth)),
            _ => origin + (direction + offset) * (self.near / depth),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Aabb = Aabb { min: Vec3::new(-10.0, 0.0, -3.0), max: Vec3::new(10.0, 8.0, 3.0) };

    fn project(matrix: [[f32; 4]; 4], p: Vec3) -> Vec3 {
        let clip = Mat4::from_cols_array_2d(&matrix) * p.extend(1.0);
        clip.truncate() / clip.w
    }

    #[test]
    fn a_projected_point_comes_back_from_its_pixel_and_depth() {
        let camera = Camera { name: String::new(), position: Vec3::new(1.0, 2.0, 3.0), target: Vec3::ZERO, up: Vec3::Y, fov_y_deg: 50.0 };
        let view = View::new(&camera, [64, 48], BOUNDS);
        for (x, y, distance) in [(0, 0, 1.0f32), (63, 47, 5.0), (20, 30, 20.0)] {
            let p = view.position_at(x, y, view.near / distance);
            let ndc = project(view.view_projection, p);
            let pixel = (Vec2::new(ndc.x, ndc.y) * 0.5 + 0.5) * Vec2::new(64.0, 48.0) - 0.5;
            assert!(pixel.distance(Vec2::new(x as f32, y as f32)) < 1e-3, "{pixel}");
            assert!((view.near / ndc.z / distance - 1.0).abs() < 1e-4);
            let (pixel, ahead) = view.pixel_of(p).unwrap();
            assert!(pixel.distance(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)) < 1e-3, "{pixel}");
            assert!((ahead / f64::from(distance) - 1.0).abs() < 1e-5);
            let beside = view.position_at(x + 1, y, view.near / distance);
            assert!((f64::from(p.distance(beside)) / (view.pixel_size() * ahead) - 1.0).abs() < 1e-3);
        }
        assert_eq!(view.pixel_of(Vec3::new(2.0, 4.0, 6.0)), None, "behind the camera");
    }

    #[test]
    fn the_picture_is_upright_and_not_mirrored() {
        let camera = Camera { name: String::new(), position: Vec3::Z * 5.0, target: Vec3::ZERO, up: Vec3::Y, fov_y_deg: 60.0 };
        let view = View::new(&camera, [64, 64], BOUNDS);
        assert!(project(view.view_projection, Vec3::X).x > 0.0, "+X is on the right when looking along -Z");
        assert!(project(view.view_projection, Vec3::Y).y < 0.0, "+Y is above, where Vulkan's y is negative");
    }

    #[test]
    fn a_directional_map_holds_its_box_and_inverts() {
        for direction in [Vec3::NEG_Y, Vec3::new(0.3, -1.0, 0.2), Vec3::new(1.0, -0.2, 0.9), Vec3::X] {
            let light = Light::Directional { direction: direction.normalize(), irradiance: Vec3::ONE };
            let map = Projector::of_lights(&[light], [128, 32], BOUNDS, BOUNDS)[0];
            for corner in BOUNDS.corners() {
                let ndc = project(map.world_to_clip, corner);
                assert!(ndc.x.abs() <= 1.0 && ndc.y.abs() <= 1.0 && ndc.z > 0.0 && ndc.z < 1.0, "{corner} is at {ndc}");
                assert!(map.position_at(Vec2::new(ndc.x, ndc.y), ndc.z).distance(corner) < 1e-3);
            }
        }
    }

    #[test]
    fn a_wide_map_lies_along_the_long_side_of_the_box() {
        let light = Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ONE };
        let map = Projector::of_lights(&[light], [1024, 256], BOUNDS, BOUNDS)[0];
        assert!(Vec3::from(map.right).length() > 9.9 && Vec3::from(map.up).length() < 3.5);
    }

    #[test]
    fn the_texels_of_a_point_light_see_the_whole_sphere() {
        let light = Light::Point { position: Vec3::new(0.0, 4.0, 0.0), intensity: Vec3::ONE };
        let faces = Projector::of_lights(&[light], [64, 64], BOUNDS, BOUNDS);
        let mut sum = 0.0f64;
        for face in &faces {
            for y in 0..64 {
                for x in 0..64 {
                    let t = (Vec2::new(x as f32, y as f32) + 0.5) / 32.0 - 1.0;
                    sum += f64::from(face.texel_area) / f64::from(1.0 + t.length_squared()).powf(1.5);
                }
            }
        }
        assert_eq!(faces.len(), 6);
        assert!((sum / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-3, "{sum}");
    }
}
