//! Names of image layers, for commands and tables.

use crate::config::nearest;
use crate::fail;
use anyhow::Result;
use std::fmt;

/// A layer of a test and one of its reference; each is a sum of named layers.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerPair {
    pub test: Vec<String>,
    pub reference: Vec<String>,
}

impl LayerPair {
    /// The colours without a name, for both.
    pub fn radiance() -> Self {
        Self { test: vec!["RGB".to_owned()], reference: vec!["RGB".to_owned()] }
    }

    /// Parses `LAYER`, a sum `LAYER+LAYER`, or `TEST=REFERENCE` for different names.
    ///
    /// # Errors
    /// The expected form; the caller adds the place of the text.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (test, reference) = text.split_once('=').unwrap_or((text, text));
        let [test, reference] = [test, reference].map(|sum| sum.split('+').map(|name| name.trim().to_owned()).collect::<Vec<_>>());
        if test.iter().chain(&reference).any(|name| name.is_empty() || name.contains('=')) {
            return Err("expects LAYER, LAYER+LAYER or TEST=REFERENCE, as in direct+indirect=RGB".to_owned());
        }
        Ok(Self { test, reference })
    }
}

impl fmt::Display for LayerPair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [test, reference] = [&self.test, &self.reference].map(|names| names.join("+"));
        if test == reference { write!(f, "{test}") } else { write!(f, "{test}={reference}") }
    }
}

/// A layer of a frame whose flicker is measured, by its luminance.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Intensity {
    /// The picture's radiance before exposure, W/(m^2 sr).
    #[default]
    Radiance,
    /// Radiance of the direct light.
    Direct,
    /// Radiance of the indirect light.
    Indirect,
    /// Indirect irradiance after filtering, W/m^2, independent of surfaces' textures.
    Irradiance,
}

impl Intensity {
    const ALL: [Self; 4] = [Self::Radiance, Self::Direct, Self::Indirect, Self::Irradiance];

    /// Name of the layer in an EXR.
    pub fn name(self) -> &'static str {
        match self {
            Self::Radiance => "RGB",
            Self::Direct => "direct",
            Self::Indirect => "indirect",
            Self::Irradiance => "irradiance",
        }
    }

    /// The layer with this name.
    ///
    /// # Errors
    /// `BadInput` with the known names.
    pub fn parse(name: &str) -> Result<Self> {
        let names = Self::ALL.map(Self::name);
        Self::ALL.into_iter().find(|layer| layer.name() == name).ok_or_else(|| {
            let all = names.join(", ");
            let hint = nearest(name, &names).map_or(format!("there are {all}"), |near| format!("did you mean {near}? There are {all}"));
            fail!(BadInput, "there is no layer {name} to measure the flicker of; {hint}")
        })
    }
}
