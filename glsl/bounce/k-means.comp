#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// k-means over the VPLs' positions and normals (Aranha et al., section III-B). The distance is that of Dong et al., with the sign that its
// purpose asks for. There is one workgroup: for distances, an invocation takes a share of the VPLs; for sums, a cluster and a part of the
// VPLs, so that the order of sums is fixed.
#include "bounce/vpl-cluster.glsl"
#include "lib/packing.glsl"
#include "lib/pi.glsl"
#include "lib/random.glsl"
#include "lib/vpl.glsl"

const uint INVOCATIONS = 256u;
layout(local_size_x = 256) in;
layout(constant_id = 0) const bool RESEED = false;       // every frame starts from new centres
layout(constant_id = 1) const bool NEAREST_MEMBER = true; // the representative is a member, not the mean

layout(scalar, push_constant) uniform Params {
    uint count;     // VPLs
    uint clusters;
    uint rounds;    // rounds of a frame, at most
    uint first_rounds; // rounds of the first frame, at most
    float place_weight; // w1 over the scene's diagonal
    float normal_weight; // w2
    uint seed;
} params;

// State of a cluster that is kept from frame to frame; all zeros at first.
struct Centre {
    vec3 position;
    vec3 normal;
};

layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Intensities { vec3 at[]; } intensities;
layout(scalar) buffer Centres { Centre at[]; } centres;
layout(scalar) buffer Frames { uint at[]; } frames; // number of frames that had centres, in the first element
layout(scalar) coherent buffer Labels { uint at[]; } labels;
layout(scalar) writeonly buffer Clusters { VplCluster at[]; } clusters;
layout(scalar) buffer Rounds { uint count; } rounds;
layout(scalar) buffer Unsettled { uint count; } unsettled; // 1 if the last round still moved a VPL

shared vec3 place[MOST_CLUSTERS];
shared vec3 facing[MOST_CLUSTERS];
shared float weights[MOST_CLUSTERS];
shared vec4 sums[INVOCATIONS];
shared vec3 more_sums[INVOCATIONS];
shared uint numbers[INVOCATIONS];
shared bool moved;

#include "part/kept=bounce/kept-all"

bool is_lit(uint i) { return any(greaterThan(intensities.at[i], vec3(0.0))); }

vec3 normal_of(uint i) { return octahedral_snorm16_inverse(places.at[i].normal); }

float distance_to(uint cluster, vec3 position, vec3 normal) {
    return params.place_weight * distance(position, place[cluster]) + params.normal_weight * (1.0 - clamp(dot(normal, facing[cluster]), 0.0, 1.0));
}

// Number of parts that the VPLs are divided into; invocations beyond the last part have no VPLs.
uint parts() { return INVOCATIONS / params.clusters; }

void main() {
    uint me = gl_LocalInvocationIndex, k = params.clusters;
    uint mine = me % k, part = me / k, length = (params.count + parts() - 1u) / parts();
    uint begin = min(part * length, params.count), end = part < parts() ? min(begin + length, params.count) : begin;

    bool fresh = RESEED || frames.at[0] == 0u;
    if (fresh) {
        // Initial centres by k-means++: lit VPLs, the first chosen by weight alone, each further one with a probability in proportion to
        // weight times squared distance from the centres before it. The draw is the least of exponential variates at that rate. Labels hold
        // these distances until they hold labels.
        uint frame = RESEED ? frames.at[0] : 0u;
        for (uint j = 0u; j < k; j++) {
            float least = 0.0;
            uint chosen = NO_CLUSTER;
            for (uint i = me; i < params.count; i += INVOCATIONS) {
                float weight = is_lit(i) ? counts(i) : 0.0;
                if (weight == 0.0) continue;
                float nearest = 1.0;
                if (j > 0u) {
                    nearest = distance_to(j - 1u, places.at[i].position, normal_of(i));
                    if (j > 1u) nearest = min(nearest, uintBitsToFloat(labels.at[i]));
                    labels.at[i] = floatBitsToUint(nearest);
                }
                float variate = -log(1.0 - random(i, j, frame, params.seed).x) / (weight * nearest * nearest);
                if (nearest > 0.0 && (chosen == NO_CLUSTER || variate < least)) {
                    least = variate;
                    chosen = i;
                }
            }
            numbers[me] = chosen;
            sums[me].x = least;
            barrier();
            if (me == 0u) {
                for (uint i = 0u; i < INVOCATIONS; i++) {
                    if (numbers[i] == NO_CLUSTER) continue;
                    if (chosen == NO_CLUSTER || sums[i].x < least || (sums[i].x == least && numbers[i] < chosen)) {
                        least = sums[i].x;
                        chosen = numbers[i];
                    }
                }
                // With fewer distinct VPLs than clusters, the other clusters stay empty.
                place[j] = chosen != NO_CLUSTER ? places.at[chosen].position : j > 0u ? place[0] : vec3(0.0);
                facing[j] = chosen != NO_CLUSTER ? normal_of(chosen) : j > 0u ? facing[0] : vec3(0.0, 1.0, 0.0);
            }
            barrier();
        }
    } else if (me < k) {
        place[me] = centres.at[me].position;
        facing[me] = centres.at[me].normal;
    }
    barrier();

    uint most = frames.at[0] == 0u ? params.first_rounds : params.rounds;
    if (RESEED) most = params.rounds;
    uint round = 0u;
    for (; round < most; round++) {
        if (me == 0u) moved = round == 0u;
        barrier();
        float farthest = 0.0;
        uint far = NO_CLUSTER;
        for (uint i = me; i < params.count; i += INVOCATIONS) {
            uint nearest = NO_CLUSTER;
            float least = 0.0;
            if (is_lit(i)) {
                vec3 position = places.at[i].position, normal = normal_of(i);
                for (uint j = 0u; j < k; j++) {
                    float d = distance_to(j, position, normal);
                    if (nearest == NO_CLUSTER || d < least) {
                        least = d;
                        nearest = j;
                    }
                }
            }
            if (labels.at[i] != nearest) moved = true;
            labels.at[i] = nearest;
            if (least > farthest && kept(i) > 0.0) {
                farthest = least;
                far = i;
            }
        }
        memoryBarrierBuffer();
        barrier();
        if (!moved) break;

        vec4 sum = vec4(0.0);
        vec3 more = vec3(0.0);
        for (uint i = begin; i < end; i++) {
            if (labels.at[i] == mine) {
                sum += counts(i) * vec4(places.at[i].position, 1.0);
                more += counts(i) * normal_of(i);
            }
        }
        sums[me] = sum;
        more_sums[me] = more;
        barrier();
        if (me < k) {
            sum = vec4(0.0);
            more = vec3(0.0);
            for (uint p = 0u; p < parts(); p++) {
                sum += sums[p * k + me];
                more += more_sums[p * k + me];
            }
            weights[me] = sum.w;
            if (sum.w > 0.0) {
                place[me] = sum.xyz / sum.w;
                // Normals that cancel out keep the previous one.
                if (dot(more, more) > 1e-12 * sum.w * sum.w) facing[me] = normalize(more);
            }
        }
        barrier();
        numbers[me] = far;
        sums[me].x = farthest;
        barrier();
        // An empty cluster is moved to the VPL that is farthest from its own centre; one cluster a round.
        if (me == 0u) {
            uint empty = NO_CLUSTER;
            for (uint j = 0u; j < k; j++) {
                if (empty == NO_CLUSTER && weights[j] == 0.0) empty = j;
            }
            if (empty != NO_CLUSTER) {
                farthest = 0.0;
                far = NO_CLUSTER;
                for (uint i = 0u; i < INVOCATIONS; i++) {
                    if (sums[i].x > farthest || (sums[i].x == farthest && far != NO_CLUSTER && numbers[i] < far)) {
                        farthest = sums[i].x;
                        far = numbers[i];
                    }
                }
                // A smaller distance is rounding: there are no more distinct VPLs than clusters.
                if (farthest > 1e-5) {
                    place[empty] = places.at[far].position;
                    facing[empty] = normal_of(far);
                }
            }
        }
        barrier();
    }
    if (me == 0u) {
        atomicAdd(rounds.count, round);
        if (moved) atomicAdd(unsettled.count, 1u);
    }

    // The representative of each cluster, and the cluster's flux. Fluxes are weighted by the share kept in the scene, since the
    // representative's map finds only the representative's share of directions to hit something.
    vec4 weighed = vec4(0.0);
    vec3 more = vec3(0.0);
    for (uint i = begin; i < end; i++) {
        float weight = labels.at[i] == mine ? kept(i) : 0.0;
        if (weight == 0.0) continue;
        vec3 from_mean = places.at[i].position - place[mine];
        weighed += weight * vec4(PI * intensities.at[i], 1.0);
        more += vec3(1.0, weight * dot(from_mean, from_mean), 0.0);
    }
    barrier();
    sums[me] = weighed;
    more_sums[me] = more;
    barrier();
    VplCluster cluster = VplCluster(vec3(0.0), 0u, vec3(0.0), 0u, 0.0);
    float usual = 0.0;
    if (me < k) {
        weighed = vec4(0.0);
        more = vec3(0.0);
        for (uint p = 0u; p < parts(); p++) {
            weighed += sums[p * k + me];
            more += more_sums[p * k + me];
        }
        usual = weighed.w / max(more.x, 1.0);
        cluster.members = uint(more.x);
        if (cluster.members > 0u) {
            cluster.flux = weighed.rgb / usual;
            cluster.spread = more.y / weighed.w;
            cluster.position = place[me];
            cluster.normal = octahedral_snorm16(facing[me]);
        }
        weights[me] = usual;
    }
    barrier();
    // The representative keeps at least half of the cluster's usual share in the scene.
    float least = 0.0;
    uint chosen = NO_CLUSTER;
    for (uint i = begin; i < end; i++) {
        float weight = labels.at[i] == mine ? kept(i) : 0.0;
        if (weight == 0.0 || weight < 0.5 * weights[mine]) continue;
        float d = distance_to(mine, places.at[i].position, normal_of(i));
        if (chosen == NO_CLUSTER || d < least) {
            least = d;
            chosen = i;
        }
    }
    sums[me].x = least;
    numbers[me] = chosen;
    barrier();
    if (me >= k) return;
    chosen = NO_CLUSTER;
    for (uint p = 0u; p < parts(); p++) {
        uint other = p * k + me;
        if (numbers[other] != NO_CLUSTER && (chosen == NO_CLUSTER || sums[other].x < least)) {
            least = sums[other].x;
            chosen = numbers[other];
        }
    }
    if (NEAREST_MEMBER && chosen != NO_CLUSTER) {
        cluster.position = places.at[chosen].position;
        cluster.normal = places.at[chosen].normal;
        cluster.flux *= usual / kept(chosen);
    }
    clusters.at[me] = cluster;
    centres.at[me] = Centre(place[me], facing[me]);
    // Without any light there is no state to continue from.
    if (me == 0u) {
        bool any_lit = false;
        for (uint p = 0u; p < parts(); p++) {
            for (uint j = 0u; j < k; j++) any_lit = any_lit || numbers[p * k + j] != NO_CLUSTER;
        }
        if (any_lit) frames.at[0] = max(frames.at[0] + 1u, 1u);
    }
}
