// Points with normals: tilted disks, which project to ellipses and have their plane's depth.
#include "visibility/pulled.glsl"
#include "visibility/tilt.glsl"

layout(constant_id = 5) const float GROWN = 0.75; // radius added to a point's, texels of the finest level

#define PULLED_FORMAT rgba32ui
uvec4 pulled_words(Pulled p) { return uvec4(pack_pulled(p), pack_tilt(p.tilt), 0u); }

Pulled pulled_from(uvec4 words) {
    Pulled p = unpack_pulled(words.xy);
    p.tilt = unpack_tilt(words.z);
    return p;
}

bool reaches(Pulled p, vec2 way, ivec2 texel, int tile, float scale, out float depth) {
    float facing = facing_of(p.tilt);
    // Foreshortened by the cosine along the tilt, and grown since its place within its texel is not known.
    float along = dot(way, p.tilt) * inversesqrt(max(dot(p.tilt, p.tilt), 1e-6));
    float across = max(dot(way, way) - along * along, 0.0);
    float grown = GROWN * scale;
    float wide = p.radius * p.radius + grown * grown, narrow = p.radius * p.radius * facing * facing + grown * grown;
    // Step in texels, as an angle.
    vec2 place = (vec2(texel & (tile - 1)) + 0.5) * (2.0 / float(tile)) - 1.0;
    vec2 turned = way * (4.0 / (float(tile) * (1.0 + dot(place, place))));
    depth = p.depth * clamp(facing / max(facing - dot(p.tilt, turned), 1e-3), 0.5, 2.0);
    return along * along * wide + across * narrow <= wide * narrow;
}
