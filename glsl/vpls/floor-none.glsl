// Importance without a share by power. Each part for "floor" defines
//     float least_importance(); // importance that a candidate has for each unit of its power, seen or not
float least_importance() { return 0.0; }
