// The scene for one cluster.
uint layer_of() { return params.layer; }
