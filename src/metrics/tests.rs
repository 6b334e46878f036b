use super::*;
use crate::error::{Exit, exit_code};

const WIDTH: usize = 48;
const HEIGHT: usize = 80;

/// Colours from 0.5 to 3.5 with edges and slopes.
fn picture() -> Vec<f32> {
    let value = |i: usize| {
        let (x, y, channel) = (i / 3 % WIDTH, i / 3 / WIDTH, i % 3);
        let block = if (x / 9 + y / 7).is_multiple_of(2) { 1.0 } else { 0.0 };
        0.5 + block + (x + 2 * y) as f32 / (WIDTH + 2 * HEIGHT) as f32 + channel as f32 * 0.25
    };
    (0..WIDTH * HEIGHT * 3).map(value).collect()
}

/// Numbers from -1 to 1, a function of the seed.
fn noise(seed: u32) -> impl Iterator<Item = f32> {
    std::iter::successors(Some(seed), |state| Some(state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453)))
        .skip(1)
        .map(|state| ((state >> 8) & 0xffff) as f32 / 32_767.5 - 1.0)
}

fn radiance(values: Vec<f32>) -> Image {
    Image::new(WIDTH, Content::Radiance, &["R", "G", "B"], values).unwrap()
}

fn shown(values: Vec<f32>) -> Image {
    Image::new(WIDTH, Content::Shown, &["R", "G", "B"], values).unwrap()
}

fn against_the_picture(change: impl FnOnce(&mut Vec<f32>)) -> Comparison {
    let mut test = picture();
    change(&mut test);
    compare(&radiance(test), &radiance(picture())).unwrap()
}

#[track_caller]
fn assert_near(figure: f64, expected: f64) {
    assert!((figure - expected).abs() <= 1e-4 * expected.abs(), "{figure} is not {expected}");
}

#[test]
fn the_same_image_has_no_error_at_all() {
    for image in [radiance(picture()), shown(picture().iter().map(|value| value / 4.0).collect())] {
        let Comparison { measures, map } = compare(&image, &image).unwrap();
        let figures = (measures.rmse + measures.mae, measures.relmse, measures.energy, measures.worst, measures.flip);
        assert_eq!(figures, (0.0, 0.0, Some(1.0), 0.0, Some(0.0)));
        assert!(map.iter().all(|&error| error == 0.0));
        assert_eq!(map.len(), WIDTH * HEIGHT);
    }
}

#[test]
fn what_is_brighter_by_a_tenth_has_that_energy() {
    let bright = |image: &mut Vec<f32>| image.iter_mut().for_each(|value| *value *= 1.1);
    let Comparison { measures, .. } = against_the_picture(bright);
    assert_near(measures.energy.unwrap(), 1.1);
    // 0.01 r² / (r² + 0.01), summed by hand in another order than the program's.
    let by_hand: f64 = picture().iter().rev().map(|&r| f64::from(r).powi(2)).map(|square| 0.01 * square / (square + 0.01)).sum();
    assert_near(measures.relmse, by_hand / (WIDTH * HEIGHT * 3) as f64);
    assert!((0.009..0.01).contains(&measures.relmse), "{}", measures.relmse);
    let square: f64 = picture().iter().map(|&r| 0.01 * f64::from(r).powi(2)).sum();
    assert_near(measures.rmse, (square / (WIDTH * HEIGHT * 3) as f64).sqrt());
    assert!(measures.flip.unwrap() > 0.01);
}

#[test]
fn an_offset_has_the_known_error_and_the_luminances_are_those_of_its_colours() {
    let redder = |image: &mut Vec<f32>| image.iter_mut().step_by(3).for_each(|value| *value += 0.5);
    let Comparison { measures, .. } = against_the_picture(redder);
    assert_near(measures.rmse, (0.25_f64 / 3.0).sqrt());
    assert_near(measures.mae, 0.5 / 3.0);
    assert_near(measures.worst, 0.5);
    let mean = measures.mean.unwrap();
    assert_near(mean.test - mean.reference, 0.5 * 0.2126);
    assert_eq!(measures.energy, Some(mean.test / mean.reference));
}

#[test]
fn what_moved_by_a_pixel_has_its_energy_and_its_errors_at_the_edges() {
    let Comparison { measures, map } = against_the_picture(|image| {
        let moved = picture();
        image[3..].copy_from_slice(&moved[..moved.len() - 3]);
    });
    assert!((measures.energy.unwrap() - 1.0).abs() < 0.01, "{:?}", measures.energy);
    // The edges are steps of 1, and more than a hundredth of the pixels is at an edge.
    assert!((0.9..1.1).contains(&measures.worst), "{}", measures.worst);
    assert!((0.01..0.5).contains(&measures.flip.unwrap()), "{:?}", measures.flip);
    let row = &map[40 * WIDTH..41 * WIDTH];
    assert!(row[18] > 3.0 * row[23], "beside an edge and between two: {row:?}");
}

#[test]
fn one_bad_pixel_of_many_is_in_the_mean_and_on_the_map_but_not_among_the_worst_hundredth() {
    let at = 33 * WIDTH + 20;
    let Comparison { measures, map } = against_the_picture(|image| image[at * 3..at * 3 + 3].fill(50.0));
    assert_eq!(measures.worst, 0.0);
    let square: f64 = picture()[at * 3..at * 3 + 3].iter().map(|&r| (50.0 - f64::from(r)).powi(2)).sum();
    assert_near(measures.rmse, (square / (WIDTH * HEIGHT * 3) as f64).sqrt());
    assert!(map[at] > 0.05 && map[at + 20] == 0.0, "{} {}", map[at], map[at + 20]);
}

#[test]
fn the_worst_hundredth_begins_where_it_should() {
    let plain = |values: Vec<f32>| Image::new(10, Content::Data, &["Z"], values).unwrap();
    let errors = |count: usize| compare(&plain((0..count).map(|i| i as f32).collect()), &plain(vec![0.0; count])).unwrap().measures.worst;
    // Ranks 99, 198 and, rounded up, 10 and 109.
    assert_eq!([100, 200, 10, 110].map(errors), [98.0, 197.0, 9.0, 108.0]);
}

#[test]
fn a_number_that_is_none_is_an_error_with_its_channel_and_its_pixel() {
    for (value, what) in [(f32::NAN, "not a number"), (f32::INFINITY, "infinite"), (f32::NEG_INFINITY, "infinite")] {
        let mut values = picture();
        values[(7 * WIDTH + 5) * 3 + 1] = value;
        values[(9 * WIDTH + 5) * 3] = f32::NAN;
        let error = Image::new(WIDTH, Content::Radiance, &["R", "G", "B"], values).unwrap_err();
        assert_eq!(error.to_string(), format!("channel G is {what} at pixel (5, 7)"));
        assert_eq!(exit_code(&error), Exit::BadInput);
    }
}

#[test]
fn images_of_different_sizes_or_kinds_are_refused() {
    let wide = Image::new(WIDTH * 2, Content::Radiance, &["R", "G", "B"], picture()).unwrap();
    let error = compare(&wide, &radiance(picture())).unwrap_err();
    assert_eq!(error.to_string(), "the sizes differ: 96 x 40 pixels in the test, 48 x 80 in the reference");
    assert_eq!(exit_code(&error), Exit::BadInput);
    let depth = Image::new(WIDTH, Content::Data, &["Z"], vec![1.0; WIDTH * HEIGHT]).unwrap();
    for (other, says) in [(depth, "one number a pixel"), (shown(picture()), "tone-mapped colours")] {
        let error = compare(&radiance(picture()), &other).unwrap_err();
        assert_eq!(error.to_string(), format!("the test holds radiance, the reference {says}"));
    }
}

#[test]
fn numbers_that_are_no_colours_have_no_flip_and_vectors_no_mean() {
    let data = |channels: &[&str], factor: f32| {
        Image::new(WIDTH, Content::Data, channels, (0..WIDTH * 3).map(|i| i as f32 * factor).collect()).unwrap()
    };
    let depth = compare(&data(&["Z"], 1.5), &data(&["Z"], 1.0)).unwrap();
    assert_eq!((depth.measures.flip, depth.measures.exposures), (None, None));
    assert_near(depth.measures.energy.unwrap(), 1.5);
    // The map is the error over the largest error, which the last pixel has.
    assert_eq!((depth.map[0], depth.map[WIDTH * 3 - 1]), (0.0, 1.0));
    let normals = compare(&data(&["X", "Y", "Z"], 1.5), &data(&["X", "Y", "Z"], 1.0)).unwrap();
    assert_eq!((normals.measures.flip, normals.measures.energy, normals.measures.mean), (None, None, None));
    assert!(normals.measures.rmse > 0.0);
}

#[test]
fn a_black_reference_makes_the_energy_infinite_or_1() {
    let black = radiance(vec![0.0; WIDTH * HEIGHT * 3]);
    assert_eq!(compare(&black, &black).unwrap().measures.energy, Some(1.0));
    let lit = compare(&radiance(picture()), &black).unwrap().measures;
    assert_eq!(lit.energy, Some(f64::INFINITY));
    assert!(lit.flip.unwrap() > 0.5 && lit.relmse > 1.0);
    assert_eq!(serde_json::to_value(&lit).unwrap()["energy"], serde_json::Value::Null);
    assert_eq!(compare(&black, &radiance(picture())).unwrap().measures.energy, Some(0.0));
}

#[test]
fn more_noise_is_more_error_in_every_measure() {
    let noisy = |strength: f32| {
        against_the_picture(|image| image.iter_mut().zip(noise(7)).for_each(|(value, noise)| *value += noise * strength)).measures
    };
    let measures = [0.0, 0.01, 0.03, 0.1, 0.3].map(noisy);
    let figures: [fn(&Measures) -> f64; 5] = [|m| m.rmse, |m| m.mae, |m| m.relmse, |m| m.worst, |m| m.flip.unwrap()];
    for figure in figures {
        let rising: Vec<f64> = measures.iter().map(figure).collect();
        assert!(rising.windows(2).all(|pair| pair[0] < pair[1]), "{rising:?}");
    }
}

#[test]
fn figures_do_not_depend_on_the_number_of_cores() {
    let noisy: Vec<f32> = picture().into_iter().zip(noise(3)).map(|(value, noise)| value + noise * 0.1).collect();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| compare(&radiance(noisy.clone()), &radiance(picture())).unwrap())
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn frames_are_summed_up_as_documented() {
    let frame = |rmse: f64, test: f64, flip: Option<f64>| Measures {
        rmse,
        mae: rmse / 2.0,
        relmse: rmse / 10.0,
        energy: Some(test / 2.0),
        worst: rmse * 2.0,
        flip,
        mean: Some(Means { test, reference: 2.0 }),
        exposures: None,
    };
    let all = Measures::over_frames(&[frame(3.0, 1.0, Some(0.1)), frame(4.0, 4.0, Some(0.3))]).unwrap();
    assert_near(all.rmse, 12.5_f64.sqrt());
    assert_near(all.mae, 1.75);
    assert_near(all.relmse, 0.35);
    assert_near(all.flip.unwrap(), 0.2);
    assert_eq!((all.energy, all.worst), (Some(1.25), 8.0));
    assert_eq!(Measures::over_frames(&[frame(1.0, 1.0, Some(0.1)), frame(1.0, 1.0, None)]).unwrap().flip, None);
    assert_eq!(Measures::over_frames(&[]), None);
}
