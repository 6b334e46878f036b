// Triangles of the window's widgets. Places are pixels of the window, from its upper left corner.
#version 460
#extension GL_EXT_scalar_block_layout : require

layout(location = 0) in vec2 position;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 color;
layout(location = 3) in vec2 clip_from;
layout(location = 4) in vec2 clip_to;

layout(location = 0) out vec2 out_uv;
layout(location = 1) out vec4 out_color;
layout(location = 2) flat out vec4 out_clip;

layout(scalar, push_constant) uniform Params { vec2 size; } params;

out gl_PerVertex { vec4 gl_Position; };

void main() {
    gl_Position = vec4(position / params.size * 2.0 - 1.0, 0.0, 1.0);
    out_uv = uv;
    out_color = color;
    out_clip = vec4(clip_from, clip_to);
}
