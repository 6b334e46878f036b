// Rays against boxes and triangles.

// A ray with precomputed numbers for box and triangle tests.
struct Ray {
    vec3 origin;
    vec3 direction; // of any length, which is the unit of distances
    vec3 inverse;
    // Frame of the watertight triangle test (Woop et al. 2013): the dominant axis of the direction, and the shear.
    uint axis;
    vec3 shear;
};

// Components along the two axes after `axis`, and along it.
vec3 turned(vec3 v, uint axis) { return axis == 0u ? v.yzx : axis == 1u ? v.zxy : v; }

Ray make_ray(vec3 origin, vec3 direction) {
    vec3 a = abs(direction);
    uint axis = a.x > a.y ? (a.x > a.z ? 0u : 2u) : (a.y > a.z ? 1u : 2u);
    vec3 d = turned(direction, axis);
    // Finite even where a component is 0, so that no product is a NaN.
    vec3 divisor = mix(direction, vec3(1e-24), lessThan(a, vec3(1e-24)));
    return Ray(origin, direction, 1.0 / divisor, axis, vec3(d.x / d.z, d.y / d.z, 1.0 / d.z));
}

// Distance along the ray to a triangle, and barycentric weights of the second and the third corner; the distance is negative if the ray
// misses. The test is watertight: triangles that share an edge leave no gap. `front`: the ray sees the corners counter-clockwise.
vec3 hit_triangle(Ray ray, vec3 corner0, vec3 corner1, vec3 corner2, out bool front) {
    vec3 a = turned(corner0 - ray.origin, ray.axis);
    vec3 b = turned(corner1 - ray.origin, ray.axis);
    vec3 c = turned(corner2 - ray.origin, ray.axis);
    // Precise: a fused product would round differently for the two triangles of an edge.
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
