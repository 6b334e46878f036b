// Triangles of the window's widgets: colours are sRGB-encoded and multiplied by their alpha, as egui blends them.
#version 460
#extension GL_EXT_scalar_block_layout : require

layout(location = 0) in vec2 uv;
layout(location = 1) in vec4 color;
layout(location = 2) flat in vec4 clip;

layout(location = 0) out vec4 picture;

uniform sampler2DArray colors;

void main() {
    // Clipping here and not by the scissor lets triangles of many rectangles share a draw.
    if (any(lessThan(gl_FragCoord.xy, clip.xy)) || any(greaterThanEqual(gl_FragCoord.xy, clip.zw))) discard;
    picture = color * textureLod(colors, vec3(uv, 0.0), 0.0);
}
