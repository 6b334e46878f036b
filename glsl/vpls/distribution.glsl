// Cells of the reflective shadow maps, so many along each side of a layer, that samples are drawn from by their importance.
const uint CELLS = 64u;
