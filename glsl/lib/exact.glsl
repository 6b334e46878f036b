#ifndef EXACT_GLSL
#define EXACT_GLSL
// Functions whose results must have the same bits in several shaders. Such shaders define EXACT as `precise` ahead of their includes, and
// no compiler contracts the functions in one of them alone.
#ifndef EXACT
#define EXACT
#endif

// Dot product. glslang lets compilers contract that of the language even where it is `precise`.
EXACT float exact_dot(vec3 a, vec3 b) {
    vec3 products = a * b;
    return products.x + products.y + products.z;
}
#endif
