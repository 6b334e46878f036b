//! Sums of the path tracer, with means, variances and errors.

/// A layer of the sums, numbered as in `glsl/reference/path.comp`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sum {
    /// All light; the fourth channel counts the paths that hit a surface.
    Radiance,
    /// Sum of squared differences of the radiance from its mean (Welford 1962).
    Spread,
    /// Indirect irradiance of the first surface, if it reflects diffusely.
    Irradiance,
    /// Base colour of the first surface.
    Albedo,
    Direct,
    /// Light that the first surface reflects after this many more surfaces; from 1.
    Bounce(u32),
}

impl Sum {
    fn index(self) -> usize {
        match self {
            Self::Radiance => 0,
            Self::Spread => 1,
            Self::Irradiance => 2,
            Self::Albedo => 3,
            Self::Direct => 4,
            Self::Bounce(k) => 4 + k as usize,
        }
    }

    /// Number of layers for this many bounces.
    pub fn count(bounces: u32) -> u32 {
        5 + bounces
    }

    /// All layers for this many bounces in order, with their names in files.
    pub fn all(bounces: u32) -> Vec<(String, Self)> {
        let named = [("radiance", Self::Radiance), ("spread", Self::Spread), ("irradiance", Self::Irradiance), ("albedo", Self::Albedo)];
        let mut all: Vec<_> = named.into_iter().map(|(name, layer)| (name.to_owned(), layer)).collect();
        all.push(("direct".to_owned(), Self::Direct));
        all.extend((1..=bounces).map(|k| (format!("bounce{k}"), Self::Bounce(k))));
        all
    }
}

/// Sums over the paths of every pixel: four numbers a pixel, row by row from the top, layer by layer. The same number of layers with
/// rounding errors follows.
#[derive(Debug, Clone, PartialEq)]
pub struct Sums {
    pub size: [u32; 2],
    pub bounces: u32,
    /// Paths a pixel.
    pub samples: u32,
    pub texels: Vec<[f32; 4]>,
}

impl Sums {
    /// Empty sums.
    pub fn new(size: [u32; 2], bounces: u32) -> Self {
        let pixels = size[0] as usize * size[1] as usize;
        Self { size, bounces, samples: 0, texels: vec![[0.0; 4]; 2 * pixels * Sum::count(bounces) as usize] }
    }

    /// Layers of the image that holds the sums.
    pub fn image_layers(&self) -> u32 {
        2 * Sum::count(self.bounces)
    }

    pub fn pixels(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    /// Sums of a layer.
    pub fn layer(&self, layer: Sum) -> Vec<[f64; 4]> {
        (0..self.pixels()).map(|pixel| self.layer_at(layer, pixel)).collect()
    }

    /// Means of a layer.
    pub fn mean(&self, layer: Sum) -> Vec<[f32; 4]> {
        (0..self.pixels()).map(|pixel| self.mean_at(layer, pixel)).collect()
    }

    /// Sums of a layer at a pixel by its index.
    fn layer_at(&self, layer: Sum, pixel: usize) -> [f64; 4] {
        let (at, rest_at) = (layer.index(), layer.index() + Sum::count(self.bounces) as usize);
        let [sum, rest] = [at, rest_at].map(|at| self.texels[at * self.pixels() + pixel]);
        std::array::from_fn(|i| f64::from(sum[i]) + f64::from(rest[i]))
    }

    /// Mean of a layer at a pixel by its index.
    pub fn mean_at(&self, layer: Sum, pixel: usize) -> [f32; 4] {
        self.layer_at(layer, pixel).map(|sum| (sum / f64::from(self.samples.max(1))) as f32)
    }

    /// Variance of the mean radiance at a pixel by its index; infinite for fewer than two paths.
    pub fn variance_at(&self, pixel: usize) -> [f32; 3] {
        let [r, g, b, _] = self.layer_at(Sum::Spread, pixel);
        [r, g, b].map(|spread| self.variance_of(spread))
    }

    /// Variance of the mean, given the sum of squared differences from it.
    fn variance_of(&self, spread: f64) -> f32 {
        let n = f64::from(self.samples);
        if self.samples > 1 { (spread.max(0.0) / (n * (n - 1.0))) as f32 } else { f32::INFINITY }
    }

    /// Mean indirect light: all bounces.
    pub fn indirect(&self) -> Vec<[f32; 4]> {
        let mut sum = vec![[0.0; 4]; self.pixels()];
        for k in 1..=self.bounces {
            for (sum, mean) in sum.iter_mut().zip(self.mean(Sum::Bounce(k))) {
                *sum = std::array::from_fn(|i| sum[i] + mean[i]);
            }
        }
        sum
    }

    /// Variance of the mean radiance; infinite for fewer than two paths, which give no estimate.
    pub fn variance(&self) -> Vec<[f32; 3]> {
        self.layer(Sum::Spread).iter().map(|texel| [texel[0], texel[1], texel[2]].map(|spread| self.variance_of(spread))).collect()
    }

    /// Relative error for `--target-error`: root mean square of the standard error over pixels and channels, over the mean radiance.
    /// Infinite while unknown.
    pub fn relative_error(&self) -> f64 {
        let mean = self.mean(Sum::Radiance).iter().flat_map(|texel| texel[..3].to_vec()).map(f64::from).sum::<f64>();
        let variance = self.variance().iter().flatten().map(|v| f64::from(*v)).sum::<f64>();
        let count = 3.0 * self.pixels() as f64;
        // A black picture may have light that no path has found yet.
        if self.samples < 2 || mean == 0.0 { f64::INFINITY } else { (variance / count).sqrt() / (mean / count) }
    }
}
