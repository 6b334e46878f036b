//! Interleaved sampling (Keller and Heidrich 2001): the pixels of a block take turns with the VPLs.

use crate::config::Block;

/// A block of pixels, across and down. Each of its pixels sums another sample set of the VPLs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interleave([u32; 2]);

impl Interleave {
    /// The block of a config.
    pub fn of(block: Block) -> Self {
        Self(block.0)
    }

    /// Width of the block, pixels: `BLOCK_ACROSS` of the shaders.
    pub fn across(self) -> u32 {
        self.0[0]
    }

    /// Height of the block, pixels: `BLOCK_DOWN` of the shaders.
    pub fn down(self) -> u32 {
        self.0[1]
    }

    /// Number of sample sets: one a pixel of the block.
    pub fn sets(self) -> u32 {
        self.0[0] * self.0[1]
    }

    /// VPLs of a sample set, at most.
    pub fn per_pixel(self, vpls: u32) -> u32 {
        vpls.div_ceil(self.sets())
    }

    /// Pixels of one sample set in a picture, across and down, at most.
    pub fn pixels_of_set(self, size: [u32; 2]) -> [u32; 2] {
        [0, 1].map(|axis| size[axis].div_ceil(self.0[axis]))
    }

    /// Size of the sets' pictures side by side, each of `size`.
    pub fn of_all_sets(self, size: [u32; 2]) -> [u32; 2] {
        [0, 1].map(|axis| size[axis] * self.0[axis])
    }

    /// Workgroups that cover a picture, across and down. Each works on one sample set and takes `pixels` of its pixels.
    pub fn groups(self, size: [u32; 2], pixels: [u32; 2]) -> [u32; 2] {
        [0, 1].map(|axis| size[axis].div_ceil(pixels[axis] * self.0[axis]) * self.0[axis])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_share_out_all_vpls_and_groups_cover_all_pixels() {
        let four = Interleave::of(4.into());
        assert_eq!((four.sets(), four.per_pixel(1024), four.per_pixel(1025)), (16, 64, 65));
        assert_eq!(four.pixels_of_set([10, 8]), [3, 2]);
        // 8 x 4 pixels of a set reach over 32 x 16 of the picture.
        assert_eq!(four.groups([64, 16], [8, 4]), [8, 4]);
        assert_eq!(four.groups([65, 17], [8, 4]), [12, 8]);
        let eight = Interleave::of(Block([4, 2]));
        assert_eq!((eight.sets(), eight.per_pixel(1024), eight.pixels_of_set([10, 8])), (8, 128, [3, 4]));
        assert_eq!((eight.groups([64, 16], [8, 4]), eight.of_all_sets([3, 4])), ([8, 4], [12, 8]));
    }
}
