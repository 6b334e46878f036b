// Quads: 2 x 2 pixels of a sample set, a block apart. An invocation fetches a VPL once for all four. An includer defines
//     struct Pixel; // its Receiver is `at`
//     Pixel pixel_at(ivec2 place);
//     void store(Pixel p);
struct Quad {
    Pixel a;
    Pixel b; // to the right
    Pixel c; // below
    Pixel d;
};

Quad quad_at(ivec2 place) {
    ivec2 next = ivec2(block_size());
    return Quad(pixel_at(place), pixel_at(place + ivec2(next.x, 0)), pixel_at(place + ivec2(0, next.y)), pixel_at(place + next));
}

vec4 distances_of(Quad q) { return vec4(q.a.at.distance, q.b.at.distance, q.c.at.distance, q.d.at.distance); }

void store(Quad q) {
    store(q.a);
    store(q.b);
    store(q.c);
    store(q.d);
}
