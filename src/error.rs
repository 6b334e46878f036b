//! Exit codes of the program, and the one error type that carries them.

use std::fmt;

/// Exit codes of the program. A failure without one ends with [`Exit::BadInput`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// A comparison was over its threshold.
    ComparisonFailed = 1,
    /// Bad arguments, config or scene.
    BadInput = 2,
    /// No usable device, or a feature that the config needs is missing.
    NoDevice = 3,
    /// The driver reported a lost device.
    DeviceLost = 4,
    /// Host or device memory ran out.
    OutOfMemory = 5,
    /// A file could not be written.
    OutputNotWritten = 6,
}

/// A failure with its exit code. `anyhow` contexts may be added around it.
#[derive(Debug)]
pub struct Failure {
    pub exit: Exit,
    message: String,
}

impl Failure {
    pub fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self { exit, message: message.into() }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Failure {}

/// Builds an [`anyhow::Error`] from a [`Failure`]: `fail!(BadInput, "{file}: ...")`.
#[macro_export]
macro_rules! fail {
    ($exit:ident, $($message:tt)+) => {
        ::anyhow::Error::new($crate::error::Failure::new($crate::error::Exit::$exit, format!($($message)+)))
    };
}

/// Exit code of the [`Failure`] in an error's chain.
pub fn exit_code(error: &anyhow::Error) -> Exit {
    error.downcast_ref::<Failure>().map_or(Exit::BadInput, |failure| failure.exit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context;

    #[test]
    fn the_exit_code_survives_context() {
        let error = Err::<(), _>(fail!(DeviceLost, "gone")).context("pass gather/per-pixel").unwrap_err();
        assert_eq!(exit_code(&error), Exit::DeviceLost);
        assert_eq!(format!("{error:#}"), "pass gather/per-pixel: gone");
        assert_eq!(exit_code(&anyhow::anyhow!("plain")), Exit::BadInput);
    }
}
