//! What a command needs of a service in this process.

use crate::args::Command;

/// Whether a command makes the device work, or asks about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Need {
    Device,
    StoreOnly,
}

impl Need {
    pub(crate) fn of(command: &Command) -> Self {
        match command {
            Command::Demo(_)
            | Command::Apply(_)
            | Command::Render(_)
            | Command::Chart(_)
            | Command::Status
            | Command::Health(_) => Self::Device,
            Command::Compare(_)
            | Command::Measure(_)
            | Command::Describe(_)
            | Command::Assets(_)
            | Command::Methods
            | Command::Completions(_) => Self::StoreOnly,
        }
    }
}
