//! Methods that fill slots, by the keys and names of the config, and what a device must have for each.

use crate::config::choices;
use crate::fail;
use crate::gpu::{Adapter, Feature};
use anyhow::Result;
use serde::Serialize;
use serde::de::value::StrDeserializer;
use serde::de::{DeserializeOwned, IntoDeserializer};

/// Features that a method needs, in ways of which any one will do; the first is the one that a refusal names.
pub type Needs = &'static [&'static [Feature]];

/// A method that runs on every device.
pub const NOTHING: Needs = &[&[]];

/// A key's choice of a method. It is implemented beside the stage's functions, by a `match` that names all methods.
pub trait Choice: Copy + Serialize + DeserializeOwned {
    /// The key that makes the choice.
    const KEY: &'static str;

    /// What a device must have for the method.
    fn needs(self) -> Needs;
}

/// A way to fill a slot.
#[derive(Debug, Clone)]
pub struct Method {
    /// Its key in the config; the slot's name where there is but one way.
    pub slot: &'static str,
    /// Its name in the config.
    pub name: String,
    needs: Needs,
}

impl Method {
    /// The only way to fill a slot.
    pub fn only(slot: &'static str, name: &'static str, needs: Needs) -> Self {
        Self { slot, name: name.to_owned(), needs }
    }

    /// A choice's method.
    pub fn of<C: Choice>(choice: C) -> Self {
        let Ok(serde_json::Value::String(name)) = serde_json::to_value(choice) else { unreachable!("{} is chosen by a name", C::KEY) };
        Self { slot: C::KEY, name, needs: choice.needs() }
    }

    /// All methods of a key.
    pub fn every<C: Choice>() -> Vec<Self> {
        let of_name = |name: &'static str| {
            let name: StrDeserializer<'_, serde::de::value::Error> = name.into_deserializer();
            C::deserialize(name).map(Self::of)
        };
        let methods = choices(C::KEY).map(of_name).collect::<Result<_, _>>();
        methods.unwrap_or_else(|error| unreachable!("{}: serde knows the names: {error}", C::KEY))
    }

    /// Features that the device lacks for it.
    pub fn missing(&self, adapter: &Adapter) -> Vec<Feature> {
        let ways: Vec<Vec<Feature>> = self.needs.iter().map(|features| adapter.missing(features)).collect();
        if ways.iter().any(Vec::is_empty) { Vec::new() } else { ways.into_iter().next().unwrap_or_default() }
    }

    /// Refuses the method where the device lacks something for it.
    pub fn check(&self, adapter: &Adapter) -> Result<()> {
        let missing = self.missing(adapter);
        if missing.is_empty() {
            return Ok(());
        }
        let list = missing.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        Err(fail!(
            NoDevice,
            "{} = \"{}\" needs {list}, which {} lacks; `manylight doctor` shows what runs here",
            self.slot,
            self.name,
            adapter.name
        ))
    }
}
