#ifndef EXACT_GLSL
#define EXACT_GLSL
// Functions whose bits must agree between shaders. A shader that needs it defines EXACT as `precise` ahead of its includes, so that no
// compiler contracts them here and not there.
#ifndef EXACT
#define EXACT
#endif

// Dot product. glslang lets compilers contract its own, also in what is `precise`.
EXACT float exact_dot(vec3 a, vec3 b) {
    vec3 products = a * b;
    return products.x + products.y + products.z;
}
#endif
