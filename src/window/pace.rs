//! Size of the picture while the camera moves, so that ten frames a second are held.

/// Sides of the picture, as shares of the config's. Few, since each size has images of its own.
const STEPS: [f32; 6] = [1.0, 0.7, 0.5, 0.35, 0.25, 0.125];
/// Longest frame, ms: a tenth of a second, less what the window itself takes.
const MOST_MS: f64 = 90.0;

/// Times of frames of a moving camera, by their size.
#[derive(Debug, Clone, Default)]
pub struct Pace {
    /// Last time of each step, ms.
    ms: [Option<f64>; STEPS.len()],
    /// Time of a whole frame at rest, ms.
    rest_ms: f64,
}

impl Pace {
    /// Takes over the time of a frame.
    pub fn measured(&mut self, scale: f32, moving: bool, ms: f64) {
        match STEPS.iter().position(|step| *step == scale) {
            Some(step) if moving => self.ms[step] = Some(ms),
            _ => self.rest_ms = ms,
        }
    }

    /// The largest step whose frame is short enough. Where even the smallest is not, the largest that is hardly longer.
    pub fn scale(&self) -> f32 {
        let (fixed, a_pixel) = self.line();
        let expected = |step: &f32| fixed + a_pixel * f64::from(step * step);
        let most = MOST_MS.max(1.25 * expected(&STEPS[STEPS.len() - 1]));
        let step = STEPS.iter().position(|step| expected(step) <= most).unwrap_or(STEPS.len() - 1);
        // A larger one is tried where there is time left, since nothing else tells what pixels cost.
        // The smallest one says nothing: its pixels are few.
        let has_room = self.ms[step].is_some_and(|ms| ms < 0.8 * MOST_MS || step + 1 == STEPS.len());
        let larger = step.checked_sub(1).filter(|larger| has_room && self.ms[*larger].is_none());
        STEPS[larger.unwrap_or(step)]
    }

    /// Time of a frame without pixels, and what all pixels add: the least squares of the known steps.
    fn line(&self) -> (f64, f64) {
        let known: Vec<(f64, f64)> = STEPS.iter().zip(self.ms).filter_map(|(step, ms)| Some((f64::from(step * step), ms?))).collect();
        let count = known.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| known.iter().map(of).sum::<f64>() / count;
        match known.as_slice() {
            [] => (0.0, self.rest_ms),
            // As if all of it were the pixels'.
            [(pixels, ms)] => (0.0, ms / pixels),
            _ => {
                let (x, y) = (mean(|at| at.0), mean(|at| at.1));
                let (xy, xx) = known.iter().fold((0.0, 0.0), |(xy, xx), at| (xy + (at.0 - x) * (at.1 - y), xx + (at.0 - x) * (at.0 - x)));
                let slope = (xy / xx).max(0.0);
                ((y - slope * x).max(0.0), slope)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Scale after some frames of a device that takes `fixed` ms and `pixels` ms for all pixels.
    fn settled(fixed: f64, pixels: f64) -> f32 {
        let mut pace = Pace::default();
        pace.measured(1.0, false, 2.0 * (fixed + pixels));
        for _ in 0..8 {
            let scale = pace.scale();
            pace.measured(scale, true, fixed + pixels * f64::from(scale * scale));
        }
        pace.scale()
    }

    #[test]
    fn a_fast_device_moves_whole_pictures() {
        assert_eq!((settled(5.0, 20.0), settled(60.0, 20.0)), (1.0, 1.0));
    }

    #[test]
    fn a_slow_one_shrinks_them_until_they_are_in_time() {
        assert_eq!((settled(10.0, 300.0), settled(60.0, 400.0)), (0.5, 0.25));
    }

    #[test]
    fn pixels_are_not_given_up_where_they_cost_little() {
        assert!(settled(200.0, 40.0) >= 0.7 && settled(110.0, 30.0) >= 0.7);
    }
}
