//! Inverse transform method: running sums of the importance map, and searches in them (Barák, Bittner and Havran 2013, section 4.2).

use super::super::rsm::Rsm;
use super::importance::TexelImportance;
use crate::gpu::Format;
use crate::graph::{Buffer, ComputePass, Graph, Image};
use crate::shader_struct;

shader_struct! {
    struct RowsParams {
        size: [u32; 2],
    }

    struct ColumnsParams {
        rows: u32,
        maps: u32,
    }
}

/// Cumulative distribution of the importance over the texels of all maps.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cumulative {
    pub importance: Image,
    /// Running sums along each row: an image as the importance map.
    along_rows: Image,
    /// Running sums of the rows' importance in each map: floats.
    columns: Buffer,
    /// Running sums of the maps' importance: floats, one a map.
    pub maps: Buffer,
}

impl Cumulative {
    /// Sums up the importance map.
    pub(super) fn of(g: &mut Graph, importance: &TexelImportance, rsm: &Rsm) -> Self {
        let [width, height] = rsm.size;
        let map = importance.map(g, rsm);
        let rows = g.buffer::<f32>("vpls/rows", height * rsm.layers);
        let cumulative = Self {
            importance: map,
            along_rows: g.layered_image("vpls/along-rows", Format::R32Float, rsm.size, rsm.layers),
            columns: g.buffer::<f32>("vpls/columns", height * rsm.layers),
            maps: g.buffer::<f32>("vpls/maps", rsm.layers),
        };
        g.compute("vpls/rows")
            .reads("importance", map)
            .writes("along_rows", cumulative.along_rows)
            .writes("rows", rows)
            .params(&RowsParams { size: [width, height] })
            .dispatch_groups([height, rsm.layers, 1]);
        g.compute("vpls/columns")
            .reads("rows", rows)
            .writes("columns", cumulative.columns)
            .writes("maps", cumulative.maps)
            .params(&ColumnsParams { rows: height, maps: rsm.layers })
            .dispatch_groups([1, 1, 1]);
        cumulative
    }

    /// Binds what the searches read.
    pub(super) fn bind<'g>(&self, pass: ComputePass<'g>) -> ComputePass<'g> {
        pass.reads("maps", self.maps)
            .reads("columns", self.columns)
            .reads("along_rows", self.along_rows)
            .reads("importance", self.importance)
    }
}
