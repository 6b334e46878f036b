// One layer a pass.
uint layer_of() { return params.layer; }
