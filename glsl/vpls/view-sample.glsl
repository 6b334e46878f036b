// A surface that the camera sees, as a receiver for which virtual point lights are chosen.
struct ViewSample {
    vec3 position;
    float albedo; // luminance of the diffuse albedo, or of the base colour of a glossy receiver; -1 where the camera sees no surface
    vec3 normal;
};

// What the reflection of a glossy receiver needs besides.
struct ViewSampleLobe {
    vec3 to_viewer;
    float roughness;
    float metallic;
};

const ViewSampleLobe NO_LOBE = ViewSampleLobe(vec3(0.0), 1.0, 0.0);
