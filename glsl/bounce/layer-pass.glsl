// Layer by pass: the scene is drawn for one cluster.
uint layer_of() { return params.layer; }
