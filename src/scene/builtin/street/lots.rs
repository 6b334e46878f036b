//! Which houses stand where.

use super::super::noise::unit;
use super::{CROSS, END, FRONT, HALF};
use glam::{Affine3A, Mat3A, Vec3, Vec3A};

/// What a wall is made of; an index of [`super::materials::Palette::walls`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wall {
    White,
    Cream,
    Grey,
    Sand,
    Blush,
    PaleBlue,
    Coral,
    Ochre,
    Green,
    Blue,
    Turquoise,
    RedBrick,
    YellowBrick,
    Ashlar,
}

/// The ground floor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Base {
    /// A shop with the sign and, if there is one, the awning of this number.
    Shop(usize, Option<usize>),
    /// A flat, and the door of the house with the paint of this number.
    Home(usize),
}

/// What is around the windows of the upper floors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dress {
    /// Sills alone.
    Plain,
    /// Flat bands.
    Bands,
    /// Bands with a cornice over each.
    Hoods,
    /// Shutters with the paint of this number.
    Shutters(usize),
    /// French windows with bands and balconies.
    Balconies,
    /// No windows: a hoarding of this colour.
    Hoarding(usize),
}

/// What ends the front.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Top {
    /// A flat roof behind a parapet.
    Parapet,
    /// A roof of clay tiles.
    Tiles,
    /// A steep slated roof with dormers.
    Mansard,
    /// A parapet and a clock tower behind it.
    Tower,
}

/// A house as it is built.
#[derive(Debug, Clone, Copy)]
pub struct Lot {
    /// Width of its front.
    pub width: f32,
    pub storeys: usize,
    /// Windows side by side.
    pub bays: usize,
    /// Walls of the ground floor and of the upper floors.
    pub walls: [Wall; 2],
    pub base: Base,
    pub dress: Dress,
    pub top: Top,
}

/// A house where it stands: x along its front to the right of who looks at it, z out of the front, the origin at the foot of the front's left
/// end.
#[derive(Debug, Clone, Copy)]
pub struct House {
    pub lot: Lot,
    pub place: Affine3A,
    pub number: u32,
    /// The houses left and right of it. Where there is none, the house has a front on that side too, or a bare wall.
    pub beside: [Beside; 2],
}

#[derive(Debug, Clone, Copy)]
pub enum Beside {
    /// A house with eaves at this height, whose front projects by so much.
    House { eaves: f32, projection: f32 },
    /// A street.
    Street,
    /// Nothing that is seen.
    Nothing,
}

impl Lot {
    /// Height of the ground floor.
    pub fn ground(&self) -> f32 {
        match self.base {
            Base::Shop(..) => 4.15,
            Base::Home(_) => 3.75,
        }
    }
}

impl House {
    /// Height of an upper floor.
    pub fn rise(&self) -> f32 {
        rise(self.number)
    }

    /// Height of the floor of an upper storey; 1 is the first.
    pub fn floor(&self, storey: usize) -> f32 {
        self.lot.ground() + (storey as f32 - 1.0) * self.rise()
    }

    pub fn eaves(&self) -> f32 {
        eaves(&self.lot, self.number)
    }

    /// How far the front stands before the row's line. It differs between neighbours.
    pub fn projection(&self) -> f32 {
        projection(self.number)
    }
}

fn rise(number: u32) -> f32 {
    3.15 + 0.35 * unit(number, 1, 0x815e)
}

fn eaves(lot: &Lot, number: u32) -> f32 {
    lot.ground() + (lot.storeys as f32 - 1.0) * rise(number) + 0.4
}

fn projection(number: u32) -> f32 {
    [0.0, 0.12, 0.05, 0.18][number as usize % 4]
}

fn shop(width: f32, storeys: usize, bays: usize, walls: [Wall; 2], sign: (usize, Option<usize>), dress: Dress, top: Top) -> Lot {
    Lot { width, storeys, bays, walls, base: Base::Shop(sign.0, sign.1), dress, top }
}

fn home(width: f32, storeys: usize, bays: usize, walls: [Wall; 2], door: usize, dress: Dress, top: Top) -> Lot {
    Lot { width, storeys, bays, walls, base: Base::Home(door), dress, top }
}

/// All houses of the street and of its ends.
pub fn houses() -> Vec<House> {
    use Dress::{Balconies, Bands, Hoarding, Hoods, Plain, Shutters};
    use Top::{Mansard, Parapet, Tiles, Tower};
    use Wall::*;
    // In the sun, seen from left to right: strong colours.
    let sunny = [
        shop(11.0, 4, 4, [Ashlar, Ochre], (3, Some(0)), Hoods, Parapet),
        shop(9.0, 3, 3, [Coral, Coral], (1, Some(1)), Shutters(0), Tiles),
        shop(12.0, 5, 4, [Ashlar, White], (2, Some(2)), Balconies, Mansard),
        shop(8.0, 4, 3, [RedBrick, RedBrick], (4, None), Hoarding(0), Parapet),
        shop(13.0, 4, 5, [White, Turquoise], (0, Some(3)), Bands, Parapet),
        home(10.0, 4, 4, [Ashlar, YellowBrick], 1, Hoods, Tiles),
        shop(9.0, 5, 3, [Ashlar, Coral], (3, Some(0)), Balconies, Mansard),
        shop(12.0, 3, 4, [White, Blue], (2, Some(2)), Shutters(2), Tiles),
        shop(8.0, 4, 3, [Grey, Grey], (1, None), Hoarding(2), Parapet),
        home(10.0, 4, 4, [White, Green], 0, Bands, Tiles),
        shop(8.0, 3, 3, [Ashlar, RedBrick], (4, Some(1)), Plain, Parapet),
    ];
    // In the shade: pale walls, on which coloured light shows.
    let shady = [
        shop(9.0, 3, 3, [Ashlar, Cream], (0, Some(0)), Bands, Parapet),
        home(12.0, 4, 5, [Sand, White], 2, Shutters(1), Tiles),
        shop(10.0, 4, 4, [Ashlar, Grey], (2, Some(2)), Balconies, Mansard),
        shop(8.0, 3, 3, [White, White], (1, Some(1)), Shutters(2), Tiles),
        home(11.0, 4, 4, [Ashlar, YellowBrick], 0, Hoods, Parapet),
        shop(13.0, 4, 5, [Ashlar, White], (3, Some(3)), Balconies, Mansard),
        shop(9.0, 3, 3, [Blush, Blush], (4, Some(0)), Shutters(0), Tiles),
        shop(10.0, 4, 4, [Cream, Cream], (1, None), Bands, Parapet),
        home(12.0, 4, 5, [Ashlar, White], 1, Hoods, Tiles),
        shop(7.0, 3, 2, [PaleBlue, PaleBlue], (0, Some(2)), Plain, Parapet),
        shop(9.0, 4, 3, [Ashlar, Sand], (2, Some(1)), Balconies, Mansard),
    ];
    let end = |middle: Lot| {
        [
            shop(12.4, 4, 5, [Ashlar, Blush], (2, Some(2)), Shutters(0), Tiles),
            middle,
            shop(12.4, 4, 5, [Ashlar, Cream], (0, Some(0)), Balconies, Mansard),
        ]
    };
    let far = end(home(13.6, 4, 5, [Ashlar, Ashlar], 0, Hoods, Tower));
    let near = end(home(13.6, 5, 5, [Ashlar, White], 2, Balconies, Mansard));
    let closing = |wall: Wall, dress: Dress, top: Top| [home(CROSS + 0.2, 4, 5, [Ashlar, wall], 1, dress, top)];

    let mut all = Vec::new();
    let mut row = |corner: [f32; 2], right: Vec3, lots: &[Lot], ends: Beside| {
        let mut foot = Vec3::new(corner[0], 0.0, corner[1]);
        let first = all.len() as u32;
        for (i, lot) in lots.iter().enumerate() {
            let number = first + i as u32;
            let beside = [i.checked_sub(1), Some(i + 1)].map(|other| match other.and_then(|i| Some((i, lots.get(i)?))) {
                Some((i, lot)) => Beside::House { eaves: eaves(lot, first + i as u32), projection: projection(first + i as u32) },
                None => ends,
            });
            let axes = Mat3A::from_cols(right.into(), Vec3A::Y, right.cross(Vec3::Y).into());
            all.push(House { lot: *lot, place: Affine3A { matrix3: axes, translation: foot.into() }, number, beside });
            foot += right * lot.width;
        }
    };
    row([-HALF, -FRONT], Vec3::X, &sunny, Beside::Street);
    row([HALF, FRONT], Vec3::NEG_X, &shady, Beside::Street);
    let across = HALF + CROSS;
    row([across, -END - 0.2], Vec3::Z, &far, Beside::Nothing);
    row([-across, END + 0.2], Vec3::NEG_Z, &near, Beside::Nothing);
    row([HALF - 0.1, -END], Vec3::X, &closing(Wall::Sand, Bands, Tiles), Beside::Nothing);
    row([across + 0.1, END], Vec3::NEG_X, &closing(Wall::PaleBlue, Shutters(2), Parapet), Beside::Nothing);
    row([-across - 0.1, -END], Vec3::X, &closing(Wall::White, Hoods, Parapet), Beside::Nothing);
    row([-HALF + 0.1, END], Vec3::NEG_X, &closing(Wall::Blush, Bands, Tiles), Beside::Nothing);
    all
}
