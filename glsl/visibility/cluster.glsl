// Points that are neighbours, as one.
struct Cluster {
    vec3 center;
    float squared_radius;
    vec3 vector_area; // sum of normals times areas, of the single-sided, m^2
    float stray;      // what the others, and those whose normals cancel out, show to any side on the average, m^2
    float area;       // m^2
};
