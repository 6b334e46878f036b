// The mean importance of all texels as every chain's weight.
layout(scalar) readonly buffer Maps { float at[]; } maps; // running sums of the maps' importance

float common_weight() { return maps.at[params.lights - 1u] / (float(params.lights) * float(params.size.x) * float(params.size.y)); }
