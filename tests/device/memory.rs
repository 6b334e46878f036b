//! Device memory: allocated, freed, and reused.

use crate::common::*;
use manylight::gpu::{Format, ImageDesc};

#[test]
fn a_thousand_resizes_leave_nothing_behind() {
    let mut gpu = gpu();
    let kept = gpu.create_read_back_buffer("kept", 64).unwrap();
    let before = gpu.memory_in_use();
    for i in 0..1000 {
        let side = 1 + i % 32;
        let desc =
            ImageDesc { format: Format::Rgba16Float, width: side, height: side, layers: 1, mips: 1, attachment: true, storage: true };
        let image = gpu.create_images(&[("resized", desc)]).unwrap()[0];
        let buffer = gpu.create_buffer("resized", 4 * u64::from(side)).unwrap();
        assert!(gpu.memory_in_use() > before);
        gpu.free_image(image);
        gpu.free_buffer(buffer);
        assert_eq!(gpu.memory_in_use(), before);
    }
    assert_eq!(gpu.read_buffer(kept).len(), 64);
    finish(&gpu);
}

#[test]
#[should_panic(expected = "is used after it was freed")]
fn the_id_of_a_freed_buffer_means_no_other_buffer() {
    let mut gpu = gpu();
    let freed = gpu.create_read_back_buffer("freed", 64).unwrap();
    gpu.free_buffer(freed);
    gpu.create_read_back_buffer("in its place", 64).unwrap();
    gpu.read_buffer(freed);
}
