// A surface that the camera sees, as a receiver for which virtual point lights are chosen.
struct ViewSample {
    vec3 position;
    float albedo; // luminance of what is reflected diffusely, or of the base colour with a lobe; -1 where the camera sees no surface
    vec3 normal;
};

// What its reflection needs besides, if it is not diffuse.
struct ViewSampleLobe {
    vec3 to_viewer;
    float roughness;
    float metallic;
};
