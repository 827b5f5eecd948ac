//! `displaced` as a process: killed, filled, told to end. It runs on `reference`, so no Vulkan is needed.

use std::{
    io::{BufRead as _, BufReader},
    path::Path,
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use displace_proto::v1::{self, assets_client::AssetsClient, server_client::ServerClient};
use displace_tests::cli::{binary, signal};
use tonic::transport::Channel;

use super::{
    assets::read,
    digest_of, name_of,
    uploads::{endless, endless_name, parts},
};

/// The memory that streaming may take above idle.
const STREAMING_BYTES: u64 = 32 << 20;

struct Daemon {
    child: Child,
    url: String,
}

impl Daemon {
    fn start(store: &Path) -> Self {
        let mut command = Command::new(binary("displaced"));
        command.args(["--listen", "127.0.0.1:0", "--device", "reference", "--log-format", "json"]);
        command.args(["--drain-secs", "0", "--shutdown-secs", "2"]);
        command.arg("--store").arg(store).arg("--cache").arg(store.join("cache"));
        let mut child = command.stdin(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let address = loop {
            let line = lines.next().expect("displaced ended before it was ready").unwrap();
            let entry: serde_json::Value = serde_json::from_str(&line).unwrap_or_else(|_| panic!("{line}"));
            if let Some(address) = entry["address"].as_str() {
                break address.to_owned();
            }
        };
        // A full pipe would stop the process.
        std::thread::spawn(move || lines.for_each(drop));
        Self { child, url: format!("http://{address}") }
    }

    async fn channel(&self) -> Channel {
        Channel::from_shared(self.url.clone()).unwrap().connect().await.unwrap()
    }

    fn signal(&self, name: &str) {
        signal(&self.child, name);
    }

    fn high_water_bytes(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
        line.trim().strip_suffix(" kB").unwrap().trim().parse::<u64>().unwrap() << 10
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        // It may have ended already.
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_killed_during_an_upload_leaves_no_torn_asset() {
    let folder = tempfile::tempdir().unwrap();
    let bytes: Vec<u8> = (0..8u32 << 20).map(|n| (n >> 3) as u8).collect();
    let name = name_of(&digest_of(&bytes));
    let daemon = Daemon::start(folder.path());
    let mut assets = AssetsClient::new(daemon.channel().await);
    let half = parts(&name, &bytes[..4 << 20], 0, false);
    let held = futures::StreamExt::chain(futures::stream::iter(half), futures::stream::pending());
    let upload = tokio::spawn(async move { assets.write(held).await });
    let staged = || std::fs::read_dir(folder.path().join("staging")).unwrap().flatten().next();
    super::until(|| staged().is_some_and(|file| file.metadata().unwrap().len() >= 1 << 20)).await;
    daemon.signal("KILL");
    assert!(upload.await.unwrap().is_err());
    drop(daemon);

    let daemon = Daemon::start(folder.path());
    let mut assets = AssetsClient::new(daemon.channel().await);
    let request = v1::FindMissingRequest { digests: vec![digest_of(&bytes)] };
    assert_eq!(assets.find_missing(request).await.unwrap().into_inner().missing.len(), 1);
    let query = v1::QueryWriteRequest { name: name.clone(), ..Default::default() };
    let here = assets.query_write(query).await.unwrap().into_inner().committed_bytes as usize;
    assert!((1 << 20..=4 << 20).contains(&here));
    let rest = parts(&name, &bytes, here, true);
    assert!(assets.write(futures::stream::iter(rest)).await.unwrap().into_inner().complete);
    assert_eq!(read(&mut assets, &name, 0, 0).await.unwrap(), bytes);
}

/// Sends and fetches `mebibytes` and says how much memory the server took above idle.
async fn streaming_bytes(mebibytes: u64) -> u64 {
    let folder = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(folder.path());
    let channel = daemon.channel().await;
    let mut assets = AssetsClient::new(channel.clone());
    ServerClient::new(channel).get_capabilities(v1::GetCapabilitiesRequest {}).await.unwrap();
    let idle = daemon.high_water_bytes();
    let name = endless_name(mebibytes * 4);
    let started = Instant::now();
    let written = assets.write(endless(name.clone(), mebibytes * 4)).await.unwrap().into_inner();
    assert!(written.complete);
    let up = started.elapsed();
    let request = v1::ReadRequest { name, ..Default::default() };
    let mut stream = assets.read(request).await.unwrap().into_inner();
    let mut count = 0;
    while let Some(part) = stream.message().await.unwrap() {
        count += part.data.len() as u64;
    }
    assert_eq!(count, mebibytes << 20);
    let down = started.elapsed() - up;
    let above = daemon.high_water_bytes() - idle;
    println!("{mebibytes} MiB: up {up:?}, down {down:?}, {} KiB above idle ({} KiB)", above >> 10, idle >> 10);
    above
}

#[tokio::test(flavor = "multi_thread")]
async fn streaming_takes_little_memory_whatever_the_size() {
    assert!(streaming_bytes(128).await <= STREAMING_BYTES);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "a gibibyte each way takes a while; run with --ignored"]
async fn a_gibibyte_takes_no_more_memory() {
    assert!(streaming_bytes(1024).await <= STREAMING_BYTES);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_terminated_server_exits_with_success() {
    let folder = tempfile::tempdir().unwrap();
    let mut daemon = Daemon::start(folder.path());
    let started = Instant::now();
    daemon.signal("TERM");
    assert_eq!(daemon.child.wait().unwrap().code(), Some(0));
    assert!(started.elapsed() < Duration::from_secs(3));
}
