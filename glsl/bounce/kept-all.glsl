// VPLs count equally in k-means, as in the paper, and all their light may stay in the scene. Each part for "kept" defines these functions.

// Share of VPL i's light that is thought to stay in the scene.
float kept(uint i) { return 1.0; }

// Weight of VPL i in its cluster's mean.
float counts(uint i) { return 1.0; }
