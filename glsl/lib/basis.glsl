#ifndef BASIS_GLSL
#define BASIS_GLSL
// Orthonormal basis with n as its last axis (Duff et al. 2017).
mat3 basis_of(vec3 n) {
    float s = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + n.z), b = n.x * n.y * a;
    return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}
#endif
