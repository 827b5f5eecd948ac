//! `displace completions`: scripts made from the flags themselves.

use clap::CommandFactory as _;

use crate::{
    args::{Cli, CompletionsArgs},
    error::Result,
    output::Terminal,
};

pub(super) fn run(args: &CompletionsArgs, terminal: &mut Terminal<'_>) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "displace", &mut script);
    terminal.data(&script)
}
