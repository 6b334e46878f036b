// Rays against boxes and triangles.

// Numbers of a ray that every test needs.
struct Ray {
    vec3 origin;
    vec3 direction; // of any length; distances are in units of it
    vec3 inverse;
    // The watertight triangle test's frame (Woop et al. 2013): the axis along which the direction is longest, and its shear.
    uint axis;
    vec3 shear;
};

// The components on the two axes after `axis`, and on it.
vec3 turned(vec3 v, uint axis) { return axis == 0u ? v.yzx : axis == 1u ? v.zxy : v; }

Ray make_ray(vec3 origin, vec3 direction) {
    vec3 a = abs(direction);
    uint axis = a.x > a.y ? (a.x > a.z ? 0u : 2u) : (a.y > a.z ? 1u : 2u);
    vec3 d = turned(direction, axis);
    // Far from infinite where a component is 0, so that no product is a NaN.
    vec3 divisor = mix(direction, vec3(1e-24), lessThan(a, vec3(1e-24)));
    return Ray(origin, direction, 1.0 / divisor, axis, vec3(d.x / d.z, d.y / d.z, 1.0 / d.z));
}

// Distance along the ray to a triangle of these corners, and the barycentric weights of the second and the third; the distance is
// negative where the ray misses. Two triangles that share an edge leave no gap between them. The ray meets the front where it sees
// the corners counter-clockwise.
vec3 hit_triangle(Ray ray, vec3 corner0, vec3 corner1, vec3 corner2, out bool front) {
    vec3 a = turned(corner0 - ray.origin, ray.axis);
    vec3 b = turned(corner1 - ray.origin, ray.axis);
    vec3 c = turned(corner2 - ray.origin, ray.axis);
    // Precise: a fused product would round the two triangles of an edge differently.
    precise vec2 pa = a.xy - ray.shear.xy * a.z;
    precise vec2 pb = b.xy - ray.shear.xy * b.z;
    precise vec2 pc = c.xy - ray.shear.xy * c.z;
    precise float u = pc.x * pb.y - pc.y * pb.x;
    precise float v = pa.x * pc.y - pa.y * pc.x;
    precise float w = pb.x * pa.y - pb.y * pa.x;
    float sum = u + v + w;
    front = sum * ray.shear.z > 0.0;
    bool outside = min(u, min(v, w)) < 0.0 && max(u, max(v, w)) > 0.0;
    if (outside || sum == 0.0) return vec3(-1.0);
    float t = (u * a.z + v * b.z + w * c.z) * ray.shear.z;
    return vec3(t, v, w) / sum;
}
