//! Methods that fill slots, named as in the config, and the features that a device needs for each.

use crate::config::choices;
use crate::fail;
use crate::gpu::{Adapter, Feature};
use anyhow::Result;
use serde::Serialize;
use serde::de::value::StrDeserializer;
use serde::de::{DeserializeOwned, IntoDeserializer};

/// Alternative lists of features, of which the device needs one in full; a refusal names the first list.
pub type Needs = &'static [&'static [Feature]];

/// A method that runs on every device.
pub const NOTHING: Needs = &[&[]];

/// A key of the config that chooses a method. It is implemented beside the stage's functions, by a `match` that names all methods.
pub trait Choice: Copy + Serialize + DeserializeOwned {
    /// The key.
    const KEY: &'static str;

    /// Features that the method needs.
    fn needs(self) -> Needs;
}

/// A way to fill a slot.
#[derive(Debug, Clone)]
pub struct Method {
    /// Key in the config; the slot's name if there is no choice.
    pub slot: &'static str,
    /// Name in the config.
    pub name: String,
    needs: Needs,
}

impl Method {
    /// The one method of a slot without a choice.
    pub fn only(slot: &'static str, name: &'static str, needs: Needs) -> Self {
        Self { slot, name: name.to_owned(), needs }
    }

    /// The chosen method.
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

    /// Features that the device lacks for the method.
    pub fn missing(&self, adapter: &Adapter) -> Vec<Feature> {
        let ways: Vec<Vec<Feature>> = self.needs.iter().map(|features| adapter.missing(features)).collect();
        if ways.iter().any(Vec::is_empty) { Vec::new() } else { ways.into_iter().next().unwrap_or_default() }
    }

    /// Refuses the method on a device that lacks a feature.
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
