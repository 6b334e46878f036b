// All light of VPLs is taken to stay in the scene, and all VPLs weigh the same, as in the paper. Each part for "kept" defines these
// functions.

// Estimated share of VPL i's reflected light that stays in the scene.
float kept(uint i) { return 1.0; }

// Weight of VPL i in its cluster's mean.
float counts(uint i) { return 1.0; }
