//! Runs the real `displace` command and keeps what it said.

use std::{
    ffi::OsStr,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::OnceLock,
};

/// What a run of the command left behind.
#[derive(Clone, Debug)]
pub struct Run {
    /// `None` when a signal ended it.
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    /// # Panics
    /// When the command did not exit with 0; says what it printed.
    pub fn expect_success(self) -> Self {
        assert_eq!(self.code, Some(0), "displace failed:\n{}{}", self.stdout, self.stderr);
        self
    }

    /// The JSON report of a run with `--json`.
    ///
    /// # Panics
    /// When standard output is not one JSON value.
    #[must_use]
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout)
            .unwrap_or_else(|error| panic!("{error}: standard output is not JSON:\n{}", self.stdout))
    }
}

/// The command with a store and configuration of its own, so that a developer's settings and cached
/// results cannot leak into a test.
pub struct Displace {
    home: tempfile::TempDir,
}

impl Default for Displace {
    fn default() -> Self {
        Self { home: tempfile::tempdir().expect("a temporary folder can be made") }
    }
}

impl Displace {
    /// A folder for the files of this test.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.home.path()
    }

    /// Writes a file into [`Self::folder`].
    ///
    /// # Panics
    /// When the folder cannot be written.
    #[must_use]
    pub fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.home.path().join(name);
        std::fs::write(&path, bytes).expect("the temporary folder can be written");
        path
    }

    #[must_use]
    pub fn command(&self) -> Command {
        let mut command = Command::new(binary("displace"));
        for (variable, folder) in [
            ("XDG_DATA_HOME", "data"),
            ("XDG_CACHE_HOME", "cache"),
            ("XDG_CONFIG_HOME", "config"),
            ("XDG_STATE_HOME", "state"),
        ] {
            command.env(variable, self.home.path().join(folder));
        }
        command.env_remove("DISPLACE_SERVER").current_dir(self.home.path()).stdin(Stdio::null());
        command
    }

    /// # Panics
    /// When the command cannot be started.
    pub fn run<S: AsRef<OsStr>>(&self, args: impl IntoIterator<Item = S>) -> Run {
        let output = self.command().args(args).output().expect("displace can be started");
        Run {
            code: output.status.code(),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

/// Sends a signal (`INT`, `TERM`, `KILL`) by the shell's own `kill`: a small system has no other.
///
/// # Panics
/// When the process is gone.
pub fn signal(process: &Child, name: &str) {
    let sent = Command::new("sh").args(["-c", "kill -$0 $1", name, &process.id().to_string()]).status();
    assert!(sent.expect("a shell can be started").success(), "SIG{name} cannot be sent");
}

/// The path of `displace` or `displaced`, built once with the profile of the running tests: Cargo builds
/// the binaries of other packages for a test only when asked.
///
/// # Panics
/// When the binary cannot be built.
#[must_use]
pub fn binary(name: &'static str) -> PathBuf {
    static BUILT: OnceLock<PathBuf> = OnceLock::new();
    BUILT.get_or_init(build_binaries).join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
}

/// Builds the two binaries and returns the folder that holds them.
fn build_binaries() -> PathBuf {
    let test = std::env::current_exe().expect("a test knows its own path");
    let folder = test.parent().and_then(Path::parent).expect("tests lie in target/PROFILE/deps").to_owned();
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    // The whole workspace: naming packages would choose other features and build every dependency again.
    cargo.args(["build", "--quiet", "--workspace", "--bins"]);
    if folder.ends_with("release") {
        cargo.arg("--release");
    }
    let target = folder.parent().expect("a profile's folder lies in the target folder");
    let status = cargo.arg("--target-dir").arg(target).current_dir(crate::data::repository()).status();
    assert!(status.expect("cargo can be started").success(), "the binaries do not build");
    folder
}
