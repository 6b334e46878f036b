#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Inverse transform method (Barak et al. 2013, section 4.2): three searches, for the light, the row and the column. Texels that are as
// important as others are drawn as often.
#include "vpls/texel.glsl"
#include "part/points=vpls/points-halton"
#include "vpls/place.glsl"

// Whether the number that selects the light, stretched to the unit interval again, selects the row too (Shirley and Wang 1991).
layout(constant_id = 0) const bool ROW_BY_LIGHT = false;

layout(scalar) readonly buffer Maps { float at[]; } maps;       // running sums of the maps' importance
layout(scalar) readonly buffer Columns { float at[]; } columns; // of the rows' importance in each map
uniform sampler2DArray along_rows;                              // of the importance in each row
uniform sampler2DArray importance;

// Part of a running sum's step at which a number lies.
float within(float wanted, float before, float after) { return after > before ? clamp((wanted - before) / (after - before), 0.0, 16777215.0 / 16777216.0) : 0.5; }

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    vec4 u = point(index, 0u);
    float texels = float(params.lights) * float(params.size.x) * float(params.size.y);
    float total = maps.at[params.lights - 1u];
    if (!(total > 0.0)) {
        // Nothing is important: all texels are drawn as often.
        if (ROW_BY_LIGHT) u = vec4(u.x, u.y, fract(u.x * float(params.lights)), 0.0);
        else u = u.xzyw;
        put(index, place_of(u), texels * share(index));
        return;
    }

    float wanted = u.x * total;
    uint low = 0u, high = params.lights - 1u;
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (maps.at[middle] > wanted) high = middle;
        else low = middle + 1u;
    }
    uint map = low;
    float along = ROW_BY_LIGHT ? within(wanted, map > 0u ? maps.at[map - 1u] : 0.0, maps.at[map]) : u.y;

    uint first = map * params.size.y;
    low = first;
    high = first + params.size.y - 1u;
    wanted = along * columns.at[high];
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (columns.at[middle] > wanted) high = middle;
        else low = middle + 1u;
    }
    int row = int(low - first);

    low = 0u;
    high = params.size.x - 1u;
    wanted = (ROW_BY_LIGHT ? u.y : u.z) * texelFetch(along_rows, ivec3(high, row, map), 0).r;
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (texelFetch(along_rows, ivec3(middle, row, map), 0).r > wanted) high = middle;
        else low = middle + 1u;
    }
    ivec3 at = ivec3(low, row, map);
    // The density is that of the map, since a difference of running sums has lost digits.
    float found = texelFetch(importance, at, 0).r;
    put(index, at, found > 0.0 ? total / found * share(index) : 0.0);
}
