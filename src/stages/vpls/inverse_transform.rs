//! Inverse transform method: running sums of the importance map, and searches in them (Barák, Bittner and Havran 2013, section 4.2).

use super::super::rsm::Rsm;
use super::importance::TexelImportance;
use crate::config::Scan;
use crate::gpu::Format;
use crate::graph::{Buffer, ComputePass, Graph, Image};
use crate::shader_struct;

shader_struct! {
    struct RowsParams {
        size: [u32; 2],
    }

    struct DoubledParams {
        size: [i32; 2],
        back: [i32; 2],
        column: i32,
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
    pub(super) fn of(g: &mut Graph, importance: &TexelImportance, rsm: &Rsm, scan: Scan) -> Self {
        let importance = importance.map(g, rsm);
        match scan {
            Scan::Blocked => Self::blocked(g, importance, rsm),
            Scan::Doubling => Self::doubled(g, importance, rsm),
        }
    }

    /// Sums by blocks, a workgroup a row: monotone to the last bit.
    fn blocked(g: &mut Graph, importance: Image, rsm: &Rsm) -> Self {
        let [width, height] = rsm.size;
        let rows = g.buffer::<f32>("vpls/rows", height * rsm.layers);
        let along_rows = g.layered_image("vpls/along-rows", Format::R32Float, rsm.size, rsm.layers);
        let (columns, maps) = (g.buffer::<f32>("vpls/columns", height * rsm.layers), g.buffer::<f32>("vpls/maps", rsm.layers));
        g.compute("vpls/rows")
            .reads("importance", importance)
            .writes("along_rows", along_rows)
            .writes("rows", rows)
            .params(&RowsParams { size: [width, height] })
            .dispatch_groups([height, rsm.layers, 1]);
        g.compute("vpls/columns")
            .reads("rows", rows)
            .writes("columns", columns)
            .writes("maps", maps)
            .params(&ColumnsParams { rows: height, maps: rsm.layers })
            .dispatch_groups([1, 1, 1]);
        Self { importance, along_rows, columns, maps }
    }

    /// Sums by doubling, a pass a step. Rounding makes some sums smaller than those before them, so that texels without importance are found
    /// too, whose VPLs are dark.
    fn doubled(g: &mut Graph, importance: Image, rsm: &Rsm) -> Self {
        let [width, height] = rsm.size;
        let along_rows = Self::doublings(g, 0, importance, rsm.size, rsm.layers, 0);
        let column = Self::doublings(g, 1, along_rows, [1, height], rsm.layers, width as i32 - 1);
        let (columns, maps) = (g.buffer::<f32>("vpls/columns", height * rsm.layers), g.buffer::<f32>("vpls/maps", rsm.layers));
        g.compute("vpls/doubled-columns")
            .reads("sums", column)
            .writes("columns", columns)
            .writes("maps", maps)
            .params(&ColumnsParams { rows: height, maps: rsm.layers })
            .dispatch_groups([1, 1, 1]);
        Self { importance, along_rows, columns, maps }
    }

    /// Running sums of an image along an axis, from a column of it on; two images take turns.
    fn doublings(g: &mut Graph, axis: usize, first: Image, size: [u32; 2], layers: u32, column: i32) -> Image {
        let names = [["vpls/along-rows", "vpls/along-rows-too"], ["vpls/along-columns", "vpls/along-columns-too"]][axis];
        let turns = names.map(|name| g.layered_image(name, Format::R32Float, size, layers));
        let steps = size[axis].next_power_of_two().ilog2().max(1);
        (0..steps).fold(first, |sums, step| {
            let doubled = turns[step as usize % 2];
            let mut back = [0; 2];
            back[axis] = 1 << step;
            g.again(axis as u32 * u32::BITS + step + 1, |g| {
                g.compute("vpls/doubled")
                    .reads("sums", sums)
                    .writes("doubled", doubled)
                    .params(&DoubledParams { size: size.map(|n| n as i32), back, column: if step == 0 { column } else { 0 } })
                    .dispatch([size[0], size[1], layers]);
            });
            doubled
        })
    }

    /// Binds what the searches read.
    pub(super) fn bind<'g>(&self, pass: ComputePass<'g>) -> ComputePass<'g> {
        pass.reads("maps", self.maps)
            .reads("columns", self.columns)
            .reads("along_rows", self.along_rows)
            .reads("importance", self.importance)
    }
}
