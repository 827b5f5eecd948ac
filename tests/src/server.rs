//! A whole server inside the test process, and the command line talking to it.

use std::sync::{OnceLock, mpsc};

use displace_server::{
    config::Config,
    service::{Parts, Service},
};

use crate::{cli::Run, device::TEST_DEVICE_BYTES};

/// The address of a server on the Vulkan device with the validation layers on, started once for all tests
/// of this process. Its store is thrown away.
#[must_use]
pub fn validated() -> &'static str {
    static URL: OnceLock<String> = OnceLock::new();
    URL.get_or_init(|| start(Config { validation: true, ..Config::default() }))
}

/// The same on the f64 device: needs no Vulkan.
#[must_use]
pub fn reference() -> &'static str {
    static URL: OnceLock<String> = OnceLock::new();
    URL.get_or_init(|| start(Config { device: "reference".into(), ..Config::default() }))
}

/// Starts a server with these settings, a folder of its own and a free port, for as long as the process lives.
///
/// # Panics
/// When it does not start.
#[must_use]
pub fn start(config: Config) -> String {
    let (started, address) = mpsc::channel();
    std::thread::spawn(move || serve(config, &started));
    address.recv().expect("the server starts: run deploy/setup if it lacks a device")
}

fn serve(config: Config, started: &mpsc::Sender<String>) {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let config = Config {
        listen: "127.0.0.1:0".parse().expect("an address"),
        store: folder.path().join("store"),
        cache: folder.path().join("cache"),
        device_bytes: TEST_DEVICE_BYTES,
        ..config
    };
    let runtime = tokio::runtime::Runtime::new().expect("a runtime can be made");
    runtime.block_on(async {
        let parts = Parts::standard(&config);
        let service = Service::start(config, parts).await.unwrap_or_else(|error| panic!("{error}"));
        let bound = service.bind().await.expect("a port is free");
        started.send(format!("http://{}", bound.address)).expect("the test waits");
        bound.run(std::future::pending()).await.expect("the server runs");
    });
}

/// Runs a command line in this process, through the client library's entry.
#[must_use]
pub fn displace<S: AsRef<str>>(args: &[S]) -> Run {
    let (mut stdout, mut stderr) = (Vec::new(), Vec::new());
    let words = std::iter::once("displace").chain(args.iter().map(AsRef::as_ref));
    let code = displace_client::run(words, &mut stdout, &mut stderr);
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    Run { code: Some(code.into()), stdout: text(stdout), stderr: text(stderr) }
}
