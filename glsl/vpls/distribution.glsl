// Cells of importance along each side of a layer of the reflective shadow map.
const uint CELLS = 64u;
