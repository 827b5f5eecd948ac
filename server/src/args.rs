//! The command line of `displaced`: the settings as flags, and the file they may come from.

use std::path::PathBuf;

use clap::Parser;

use crate::{
    config::{Config, Settings},
    domain::{Error, Result},
    jobs::BUILD_ID,
};

/// displaced: tessellates, displaces and renders glTF meshes with Vulkan compute, over gRPC.
#[derive(Clone, Debug, Parser)]
#[command(name = "displaced", version = BUILD_ID, about, long_about = None)]
pub struct Args {
    /// TOML file of settings; its words are the flags with `_` for `-`
    #[arg(long, env = "DISPLACE_CONFIG", value_name = "FILE")]
    pub config: Option<PathBuf>,

    #[command(flatten)]
    pub settings: Settings,
}

impl Args {
    /// Flags and environment over the file, over the defaults.
    pub fn into_config(self) -> Result<Config> {
        let file = self.config.as_deref().map(Settings::from_file).transpose()?;
        Config::from(self.settings.or(file.unwrap_or_default())).check()
    }

    /// No flags: what the environment says.
    pub fn from_environment() -> Result<Self> {
        Self::try_parse_from(["displaced"]).map_err(|cause| Error::invalid("environment", cause.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn flags_are_well_formed() {
        Args::command().debug_assert();
    }

    #[test]
    fn every_limit_says_its_default_and_its_variable() {
        let command = Args::command();
        for arg in command.get_arguments().filter(|arg| arg.get_id() != "config" && !arg.is_hide_set()) {
            let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
            let is_builtin = matches!(arg.get_id().as_str(), "help" | "version");
            assert!(is_builtin || help.contains("[default: ") && arg.get_env().is_some(), "{}", arg.get_id());
        }
    }
}
