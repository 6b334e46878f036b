// Candidates without lobes. Each part for "gloss" defines
//     bool has_gloss();
//     struct Gloss;                              // what a candidate reflects glossily
//     Gloss no_gloss();
//     Gloss gloss_of(ivec3 texel, vec3 position);
//     float gloss_towards(Gloss gloss, vec3 way); // luminance of radiant intensity in a direction, W/sr
//     float gloss_power(Gloss gloss);             // its scale over all directions, W/sr; 0 only without a lobe
struct Gloss { float none; };

bool has_gloss() { return false; }
Gloss no_gloss() { return Gloss(0.0); }
Gloss gloss_of(ivec3 texel, vec3 position) { return no_gloss(); }
float gloss_towards(Gloss gloss, vec3 way) { return 0.0; }
float gloss_power(Gloss gloss) { return 0.0; }
