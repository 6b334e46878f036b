#version 460
#extension GL_GOOGLE_include_directive : require
#include "visibility/splat-fragment.glsl"
