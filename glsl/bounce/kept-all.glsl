// All light of VPLs may stay in the scene, and each VPL counts as much as any other, as in the paper. Each part for "kept" defines these.

// The share of what VPL i reflects that is thought to stay in the scene.
float kept(uint i) { return 1.0; }

// How much VPL i counts in its cluster's middle.
float counts(uint i) { return 1.0; }
