//! Configuration: every setting in one table, with unit, default and environment variable.
//!
//! File (TOML) < environment < flag. `Settings` is what somebody wrote, `Config` is what it means.

use std::{net::SocketAddr, path::PathBuf};

use serde::Deserialize;

use crate::domain::{Error, Result};

/// Declares `Settings` (all optional: flags, environment, file), `Config` (all known) and how one becomes the
/// other.
macro_rules! settings {
    ($($name:ident: $type:ty = $default:expr, $shown:literal, $env:literal, $unit:literal, $help:literal;)*) => {
        /// What was written: on the command line, in the environment, or in a file.
        #[derive(Clone, Debug, Default, PartialEq, clap::Args, Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub struct Settings {
            $(
                #[doc = $help]
                #[arg(long, env = $env, value_name = $unit, help = concat!($help, " [default: ", $shown, "]"))]
                pub $name: Option<$type>,
            )*
        }

        impl Settings {
            /// These, and where they are silent the others.
            #[must_use]
            pub fn or(self, others: Self) -> Self {
                Self { $($name: self.$name.or(others.$name),)* }
            }
        }

        /// What holds.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Config {
            $(
                #[doc = $help]
                pub $name: $type,
            )*
        }

        impl From<Settings> for Config {
            fn from(settings: Settings) -> Self {
                Self { $($name: settings.$name.unwrap_or_else(|| $default),)* }
            }
        }
    };
}

settings! {
    listen: SocketAddr = SocketAddr::from(([127, 0, 0, 1], 7878)), "127.0.0.1:7878", "DISPLACE_LISTEN", "ADDRESS:PORT",
        "Address to listen on; port 0 takes a free one and logs it";
    store: PathBuf = data_folder().join("store"), "XDG data folder", "DISPLACE_STORE", "DIR",
        "Folder of assets and results";
    cache: PathBuf = cache_folder(), "XDG cache folder", "DISPLACE_CACHE", "DIR",
        "Folder of compiled pipelines";
    device: String = String::new(), "the best", "DISPLACE_DEVICE", "NAME|INDEX|UUID|reference",
        "Device that runs jobs; `reference` computes in f64 on the processor and needs no Vulkan";
    validation: bool = false, "false", "DISPLACE_VALIDATION", "BOOL",
        "Run with the Vulkan validation layer";
    log: String = "info".into(), "info", "DISPLACE_LOG", "FILTER",
        "What to log: a level, or a filter such as displace_server=debug";
    log_format: LogFormat = LogFormat::Auto, "auto", "DISPLACE_LOG_FORMAT", "FORMAT",
        "How to log: auto is human on a terminal and json otherwise";
    store_bytes: u64 = 64 * GIB, "64 GiB", "DISPLACE_STORE_BYTES", "BYTES",
        "Most bytes in the store; what was used longest ago is removed, results first";
    store_keep_secs: u64 = 600, "600", "DISPLACE_STORE_KEEP_SECS", "SECONDS",
        "What was used this recently is removed only if nothing else is left";
    upload_ttl_secs: u64 = 86_400, "86400", "DISPLACE_UPLOAD_TTL_SECS", "SECONDS",
        "An unfinished upload untouched for this long is removed";
    max_asset_bytes: u64 = 8 * GIB, "8 GiB", "DISPLACE_MAX_ASSET_BYTES", "BYTES",
        "Largest asset";
    max_batch_bytes: u64 = 3 * MIB, "3 MiB", "DISPLACE_MAX_BATCH_BYTES", "BYTES",
        "Largest sum of the data of a batch";
    max_message_bytes: u64 = 4 * MIB, "4 MiB", "DISPLACE_MAX_MESSAGE_BYTES", "BYTES",
        "Largest message a client may send";
    max_transfers: u32 = 64, "64", "DISPLACE_MAX_TRANSFERS", "COUNT",
        "Uploads and downloads at once; one more is told to come back";
    max_queued_jobs: u32 = 32, "32", "DISPLACE_MAX_QUEUED_JOBS", "COUNT",
        "Jobs that may wait for the device; one more is told to come back";
    job_bytes: u64 = 8 * GIB, "8 GiB", "DISPLACE_JOB_BYTES", "BYTES",
        "Host memory of all jobs together, as admitted";
    device_bytes: u64 = 8 * GIB, "8 GiB", "DISPLACE_DEVICE_BYTES", "BYTES",
        "Device memory of one job";
    max_image_pixels: u32 = 8192, "8192", "DISPLACE_MAX_IMAGE_PIXELS", "PIXELS",
        "Largest width and height of an image";
    linger_secs: u64 = 10, "10", "DISPLACE_LINGER_SECS", "SECONDS",
        "How long a job goes on when nobody listens";
    drain_secs: u64 = 2, "2", "DISPLACE_DRAIN_SECS", "SECONDS",
        "Time between saying not ready and refusing work, for balancers to notice";
    shutdown_secs: u64 = 30, "30", "DISPLACE_SHUTDOWN_SECS", "SECONDS",
        "Time for calls under way to finish after that; then the process ends";
    keepalive_secs: u64 = 20, "20", "DISPLACE_KEEPALIVE_SECS", "SECONDS",
        "Silence after which a connection is asked whether it lives";
    keepalive_timeout_secs: u64 = 10, "10", "DISPLACE_KEEPALIVE_TIMEOUT_SECS", "SECONDS",
        "Time it has to answer";
    max_connection_age_secs: u64 = 3600, "3600", "DISPLACE_MAX_CONNECTION_AGE_SECS", "SECONDS",
        "Age at which a connection is asked to end, so that balancers can spread clients anew";
    max_connection_age_grace_secs: u64 = 600, "600", "DISPLACE_MAX_CONNECTION_AGE_GRACE_SECS", "SECONDS",
        "Time its calls have to finish";
    max_streams: u32 = 256, "256", "DISPLACE_MAX_STREAMS", "COUNT",
        "Calls at once on one connection";
    stream_window_bytes: u32 = 4 << 20, "4 MiB", "DISPLACE_STREAM_WINDOW_BYTES", "BYTES",
        "HTTP/2 window of a call";
    connection_window_bytes: u32 = 8 << 20, "8 MiB", "DISPLACE_CONNECTION_WINDOW_BYTES", "BYTES",
        "HTTP/2 window of a connection";
    cors_origins: Vec<String> = Vec::new(), "none", "DISPLACE_CORS_ORIGINS", "ORIGIN",
        "Origins of web pages that may call by gRPC-Web";
}

const MIB: u64 = 1 << 20;
const GIB: u64 = 1 << 30;

/// How to log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LogFormat {
    #[default]
    Auto,
    Human,
    Json,
}

impl Settings {
    /// What a file says. A word it does not know is an error that names the line.
    pub fn from_file(path: &std::path::Path) -> Result<Self> {
        let shown = path.display();
        let text = std::fs::read_to_string(path)
            .map_err(|cause| Error::invalid("config", format!("cannot read '{shown}': {cause}")))?;
        toml::from_str(&text).map_err(|cause| Error::invalid("config", format!("'{shown}': {cause}")))
    }

    /// What the environment says.
    pub fn from_environment() -> Result<Self> {
        crate::args::Args::from_environment().map(|args| args.settings)
    }
}

impl Default for Config {
    fn default() -> Self {
        Settings::default().into()
    }
}

impl Config {
    /// Refuses what cannot work, before anything is opened.
    pub fn check(self) -> Result<Self> {
        let bad = |field: &str, message: String| Err(Error::invalid(field, message));
        if self.store.to_string_lossy().contains("://") {
            let shown = self.store.display();
            return bad("store", format!("'{shown}' is not a folder; this version stores in folders only"));
        }
        let (batch, message) = (self.max_batch_bytes, self.max_message_bytes);
        if batch >= message {
            return bad("max_batch_bytes", format!("{batch} must be below max_message_bytes, {message}"));
        }
        for (field, value) in self.that_must_not_be_zero() {
            if value == 0 {
                return bad(field, "0 is out of range; allowed are 1 or more".into());
            }
        }
        Ok(self)
    }

    fn that_must_not_be_zero(&self) -> [(&'static str, u64); 12] {
        [
            ("store_bytes", self.store_bytes),
            ("max_asset_bytes", self.max_asset_bytes),
            ("max_transfers", self.max_transfers.into()),
            ("job_bytes", self.job_bytes),
            ("device_bytes", self.device_bytes),
            ("max_image_pixels", self.max_image_pixels.into()),
            ("keepalive_secs", self.keepalive_secs),
            ("keepalive_timeout_secs", self.keepalive_timeout_secs),
            ("max_connection_age_secs", self.max_connection_age_secs),
            ("max_connection_age_grace_secs", self.max_connection_age_grace_secs),
            ("max_streams", self.max_streams.into()),
            ("max_batch_bytes", self.max_batch_bytes),
        ]
    }
}

fn folders() -> Option<directories::ProjectDirs> {
    directories::ProjectDirs::from("", "", "displace")
}

/// Without a home folder, a folder of the system for temporary files.
fn data_folder() -> PathBuf {
    folders().map_or_else(|| std::env::temp_dir().join("displace"), |folders| folders.data_dir().into())
}

fn cache_folder() -> PathBuf {
    folders().map_or_else(|| std::env::temp_dir().join("displace-cache"), |folders| folders.cache_dir().into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(file: &str, expected: &str) {
        let error = toml::from_str::<Settings>(file).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }

    #[test]
    fn what_is_nearer_wins() {
        let file: Settings = toml::from_str("store_bytes = 5\nlinger_secs = 1").unwrap();
        let flags = Settings { store_bytes: Some(7), ..Settings::default() };
        let config = Config::from(flags.or(file));
        assert_eq!((config.store_bytes, config.linger_secs, config.drain_secs), (7, 1, 2));
    }

    #[test]
    fn unknown_words_in_a_file_are_errors() {
        check("stroe = '/tmp'", "unknown field `stroe`");
        check("store_bytes = 'much'", "invalid type");
    }

    #[test]
    fn settings_that_cannot_work_are_refused_by_name() {
        let config = Config { max_batch_bytes: 5 << 20, ..Config::default() };
        assert_eq!(config.check().unwrap_err().field.as_deref(), Some("max_batch_bytes"));
        let config = Config { store: "s3://bucket".into(), ..Config::default() };
        assert_eq!(config.check().unwrap_err().field.as_deref(), Some("store"));
    }
}
