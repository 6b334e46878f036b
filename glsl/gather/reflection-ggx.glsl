// Receivers that reflect light of VPLs by GGX, if GLOSSY_RECEIVER says so.
layout(constant_id = 7) const bool GLOSSY_RECEIVER = false;
layout(constant_id = 8) const bool GLOSSY_DIELECTRIC = false;

uniform sampler2D albedo;
uniform sampler2D metallic_roughness;

// The surface is fetched for each light, since most lights do not need it.
float reflect_from(inout Pixel p, vec3 light, vec3 to_light) {
    float left = 1.0;
    if (GLOSSY_RECEIVER) {
        vec3 base = texelFetch(albedo, p.at.pixel, 0).rgb;
        vec2 mr = texelFetch(metallic_roughness, p.at.pixel, 0).rg;
        vec3 f0 = mr.x * base;
        float f90 = mr.x;
        if (GLOSSY_DIELECTRIC) {
            f0 += (1.0 - mr.x) * 0.04;
            f90 = 1.0;
        }
        if (f90 > 0.0) {
            vec3 v = normalize(view.it.position - p.at.position), h = normalize(to_light + v);
            float nv = max(dot(p.at.normal, v), 1e-4);
            if (GLOSSY_DIELECTRIC && mr.x < 1.0) left = 1.0 - coat_fresnel(dot(v, h));
            p.reflected += light * lobe_fresnel(f0, f90, dot(v, h)) *
                           ggx(max(mr.y * mr.y, 1e-3), max(dot(p.at.normal, h), 0.0), max(dot(p.at.normal, to_light), 0.0), nv);
        }
    }
    return left;
}
