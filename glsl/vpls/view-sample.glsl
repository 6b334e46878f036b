// A surface that the camera sees, as a receiver for which virtual point lights are chosen.
struct ViewSample {
    vec3 position;
    float albedo;    // luminance; -1 where the camera sees no surface
    vec3 normal;
    float metallic;
    vec3 to_viewer;
    float roughness;
};
