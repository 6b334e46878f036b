// Positions without other attributes, which the points of imperfect shadow maps are made from.
layout(scalar) writeonly buffer Positions { vec3 at[]; } positions;

void keep_position(uint i, vec3 position) { positions.at[i] = position; }
