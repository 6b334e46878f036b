// Weights that are each chain's own. Each part for "weight" defines
//     float common_weight(); // of all chains
float common_weight() { return 0.0; }
