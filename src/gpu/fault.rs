//! Injected errors. The environment variable `MANYLIGHT_FAULT` holds `device-lost:PASS` or `out-of-memory:NAME`, with the name of a pass or
//! of an image or buffer. The error is returned where the driver would return it.

use anyhow::{Result, bail};

/// Name of the environment variable.
pub const VARIABLE: &str = "MANYLIGHT_FAULT";

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fault {
    /// Submitting work with this pass loses the device.
    DeviceLost { pass: String },
    /// Creating this image or buffer runs out of device memory.
    OutOfMemory { resource: String },
}

impl Fault {
    /// Parses the environment variable.
    pub fn from_environment() -> Result<Option<Self>> {
        let Ok(text) = std::env::var(VARIABLE) else { return Ok(None) };
        match text.split_once(':') {
            Some(("device-lost", pass)) => Ok(Some(Self::DeviceLost { pass: pass.into() })),
            Some(("out-of-memory", resource)) => Ok(Some(Self::OutOfMemory { resource: resource.into() })),
            _ => bail!("{VARIABLE}={text}: expected device-lost:PASS or out-of-memory:RESOURCE"),
        }
    }
}
