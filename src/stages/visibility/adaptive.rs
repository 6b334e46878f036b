//! Points drawn for each VPL in proportion to the solid angle that they subtend: the adaptivity that Linke 2016 asks for (section 5.4.6).
//! All points of the scene form a pool of clusters of neighbours. All maps together get as many points as the uniform set would draw.

use super::density::{self, goes_through, rows};
use super::masks::masked;
use super::points::{Point, Points, PointsParams, total};
use crate::graph::Graph;
use crate::shader_struct;
use crate::stages::surroundings::Surroundings;
use crate::stages::vpls::Vpls;

shader_struct! {
    /// `glsl/visibility/point-cluster.glsl`.
    struct PointCluster {
        center: [f32; 3],
        vector_area: [f32; 3],
        stray: f32,
        area: f32,
        extent: [f32; 3],
    }

    struct ScanParams {
        groups: u32,
    }

    struct ClustersParams {
        diagonal: f32,
        each: u32,
        clusters: u32,
        capacity: u32,
        groups: u32,
    }

    struct ViewsParams {
        clusters: u32,
    }

    struct SharesParams {
        count: u32,
        points: u32,
    }

    struct AdaptiveParams {
        diagonal: f32,
        each: u32,
        clusters: u32,
        groups: u32,
        seed: u32,
    }
}

/// `MOST_CLUSTERS` of `glsl/visibility/points-adaptive.comp`: the largest number whose sums fit into a workgroup's shared memory.
const MOST_CLUSTERS: u32 = 6144;

/// Draws `point_count * collected` points in all for the VPLs' maps, from a pool of about `point_count` different ones. `thin` thins out
/// the points of small triangles by Russian roulette.
pub(super) fn choose(g: &mut Graph, around: Surroundings<'_>, vpls: &Vpls, point_count: u32, collected: u32, thin: bool) -> Points {
    g.tell("visibility/asked-points", u64::from(point_count));
    let holes = around.scene.masks.map(|_| g.count("visibility/points-in-holes"));
    let made = g.count("visibility/made-points");
    let density = density::of(g, around, point_count, thin);
    let table = around.residents.triangles().table;
    // A triangle's points have slots in the pool even if they are thinned out.
    let most = if thin { table.slots(point_count) } else { density.points } as u32 + 1024;
    let each = most.div_ceil(MOST_CLUSTERS).max(64);
    let clusters = most.div_ceil(each);
    let diagonal = around.scene.bounds().size().length();
    let chunks = density.upload_chunks(g, around);
    let groups = chunks.count;
    let gaps = thin || holes.is_some();
    let counts = g.buffer::<u32>("visibility/pool-counts", groups);
    let chunk_begins = g.buffer::<u32>("visibility/pool-begins", groups + 1);
    let pool = if gaps { g.zeroed::<Point>("visibility/pool", most) } else { g.buffer::<Point>("visibility/pool", most) };
    let areas = g.buffer::<f32>("visibility/pool-areas", most);
    let cluster_table = g.buffer::<PointCluster>("visibility/pool-clusters", clusters);
    let params =
        PointsParams { diagonal, partitions: 1, first: 0, held: 1, capacity: most, seed: around.wants.seed, chunk: 0, end: groups };
    goes_through(g.compute("visibility/pool-count"), around, chunks.chunks)
        .reads("sizes", density.sizes)
        .writes("counts", counts)
        .constant("THIN", thin)
        .params(&params)
        .dispatch_groups(rows(groups));
    g.compute("visibility/pool-scan")
        .reads("counts", counts)
        .writes("begins", chunk_begins)
        .params(&ScanParams { groups })
        .dispatch_groups([1, 1, 1]);
    for (masked, [chunk, groups]) in chunks.parts() {
        let name = if masked { "visibility/pool-points-masked" } else { "visibility/pool-points" };
        let pass = goes_through(g.compute(name).shader("visibility/pool-points"), around, chunks.chunks);
        let pass = if masked { masked!(pass, around, holes) } else { pass };
        pass.reads("sizes", density.sizes)
            .reads("begins", chunk_begins)
            .writes("points", pool)
            .constant("THIN", thin)
            .params(&PointsParams { chunk, end: chunk + groups, ..params })
            .dispatch_groups(rows(groups));
    }
    g.compute("visibility/pool-clusters")
        .reads("points", pool)
        .reads("begins", chunk_begins)
        .writes("areas", areas)
        .writes("clusters", cluster_table)
        .updates("made", made)
        .params(&ClustersParams { diagonal, each, clusters, capacity: most, groups })
        .dispatch([clusters, 1, 1]);
    if let Some(holes) = holes {
        total(g, "visibility/points-total-of-holes", holes, made);
    }
    let all = u32::try_from(u64::from(point_count) * u64::from(collected)).unwrap_or(u32::MAX);
    let views = g.buffer::<f32>("visibility/vpl-views", vpls.count);
    let points = Points {
        points: g.buffer::<Point>("visibility/points", all),
        begins: g.buffer::<u32>("visibility/begins", vpls.count + 1),
        fill: g.buffer::<u32>("visibility/fill", vpls.count),
        partitions: vpls.count,
        first: 0,
        each: all / vpls.count,
        gaps: false,
    };
    g.compute("visibility/vpl-views")
        .reads("places", vpls.places)
        .reads("areas", vpls.areas)
        .reads("clusters", cluster_table)
        .writes("views", views)
        .params(&ViewsParams { clusters })
        .dispatch_groups([vpls.count, 1, 1]);
    g.compute("visibility/vpl-shares")
        .reads("views", views)
        .writes("begins", points.begins)
        .params(&SharesParams { count: vpls.count, points: all })
        .dispatch_groups([1, 1, 1]);
    g.compute("visibility/points-adaptive")
        .reads("places", vpls.places)
        .reads("pool", pool)
        .reads("areas", areas)
        .reads("clusters", cluster_table)
        .reads("chunk_begins", chunk_begins)
        .reads("begins", points.begins)
        .writes("points", points.points)
        .writes("fill", points.fill)
        .constant("GAPS", gaps)
        .params(&AdaptiveParams { diagonal, each, clusters, groups, seed: around.wants.seed })
        .dispatch_groups([vpls.count, 1, 1]);
    points
}
