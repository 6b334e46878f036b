//! Number of points by the size of one: a histogram of triangle areas on the host, for scenes whose areas stay. `density` does the same on
//! the device.

/// Histogram of triangle areas, binned by logarithm.
#[derive(Debug, Clone)]
pub(super) struct Areas {
    bins: Vec<Bin>,
}

/// Triangles of about the same area.
#[derive(Debug, Clone, Default)]
struct Bin {
    count: f64,
    sum: f64,
    largest: f64,
}

impl Default for Areas {
    fn default() -> Self {
        Self { bins: vec![Bin::default(); Self::BINS] }
    }
}

impl Areas {
    const BINS: usize = 4096;
    const PER_OCTAVE: f32 = 48.0;
    /// Relative rounding error of an area on the device.
    const ROUNDING: f64 = 1e-5;

    fn total(&self) -> f64 {
        self.bins.iter().map(|bin| bin.sum).sum()
    }

    pub fn add(&mut self, area: f32) {
        if area > 0.0 {
            let bin = (area.log2() * Self::PER_OCTAVE) as i64 + Self::BINS as i64 / 2;
            let bin = &mut self.bins[bin.clamp(0, Self::BINS as i64 - 1) as usize];
            bin.count += 1.0;
            bin.sum += f64::from(area);
            bin.largest = bin.largest.max(f64::from(area));
        }
    }

    pub fn points(&self, max_area: f32, thin: bool) -> f64 {
        let max_area = f64::from(max_area);
        if thin {
            return self.total() / max_area;
        }
        // Bounded by the largest area of each bin, plus the device's rounding. A mesh of equal triangles may lie just where the next
        // tessellation level begins, and would otherwise give more points than there is room for.
        let some = self.bins.iter().filter(|bin| bin.count > 0.0);
        some.map(|bin| bin.count * points_of_triangle(bin.largest * (1.0 + Self::ROUNDING), max_area)).sum()
    }

    pub fn max_area(&self, points: f64, thin: bool) -> f32 {
        let total = self.total();
        if thin {
            return (total / points) as f32;
        }
        // The number of points falls as the area of one rises.
        let (mut low, mut high) = (total.max(1e-30).ln() - 40.0, total.max(1e-30).ln() + 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.points(middle.exp() as f32, thin) > points { low = middle } else { high = middle }
        }
        high.exp() as f32
    }
}

/// Points of a triangle, by `subdivision` of `glsl/visibility/point.glsl`.
fn points_of_triangle(area: f64, max_area: f64) -> f64 {
    let (split, n) = subdivision(area, max_area);
    split * split * (1.5 * n * n).floor()
}

/// Parts that a side of a triangle is cut into, and the tessellation level of each part: `glsl/visibility/point.glsl`.
pub(super) fn subdivision(area: f64, max_area: f64) -> (f64, f64) {
    let level = |area: f64| if area <= max_area { 1.0 } else { (area * (2.0 / 3.0) / max_area).sqrt().ceil().max(2.0) };
    let split = (level(area) / MOST_LEVEL).ceil();
    (split, level(area / (split * split)).min(MOST_LEVEL))
}

/// Highest tessellation level at which no driver loses patches: `MOST_LEVEL` of `glsl/visibility/point.glsl`.
const MOST_LEVEL: f64 = 15.0;
