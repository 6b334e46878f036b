// Planes in an orthographic map.
float depth_of_plane(vec4 plane, vec2 place) { return (plane.w - dot(plane.xy, place)) / plane.z; }
