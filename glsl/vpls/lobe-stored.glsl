// VPLs with lobes.
#include "lib/lobe.glsl"

uniform sampler2DArray rsm_specular;
uniform sampler2DArray rsm_lobe;
layout(scalar) writeonly buffer Lobes { Lobe at[]; } lobes;

bool put_lobe(uint index, ivec3 at, float texels, vec3 position) {
    Lobe lobe = Lobe(vec3(0.0), 0u, vec3(0.0), 0u, 1.0, 0.0);
    vec4 specular = vec4(0.0);
    if (at.z >= 0) specular = texelFetch(rsm_specular, at, 0);
    if (specular.a > 0.0) {
        vec4 shape = texelFetch(rsm_lobe, at, 0);
        Light light = lights.at[at.z];
        vec3 incoming = light.kind == DIRECTIONAL ? -light.direction : normalize(light.origin - position);
        lobe = Lobe(texelFetch(rsm_flux, at, 0).rgb * texels, octahedral_snorm16(octahedral_inverse(shape.xy)), specular.rgb,
                    octahedral_snorm16(incoming), shape.z, specular.a);
    }
    lobes.at[index] = lobe;
    return any(greaterThan(lobe.flux, vec3(0.0)));
}
