//! Uploads: continued after a break, verified at the end, in little memory.

use displace_proto::v1::{self, assets_client::AssetsClient};
use futures::{StreamExt as _, stream};
use sha2::{Digest as _, Sha256};
use tonic::{Code, transport::Channel};
use tonic_types::StatusExt as _;

use super::{Harness, assets::read, digest_of, name_of};

const CHUNK: usize = 256 << 10;

pub(super) fn parts(name: &str, bytes: &[u8], from: usize, finish: bool) -> Vec<v1::WriteRequest> {
    let mut parts: Vec<v1::WriteRequest> = bytes[from..]
        .chunks(CHUNK)
        .enumerate()
        .map(|(n, data)| v1::WriteRequest {
            write_offset_bytes: (from + n * CHUNK) as u64,
            data: bytes::Bytes::copy_from_slice(data),
            ..Default::default()
        })
        .collect();
    parts[0].name = name.into();
    parts.last_mut().unwrap().finish = finish;
    parts
}

async fn write(
    assets: &mut AssetsClient<Channel>,
    parts: Vec<v1::WriteRequest>,
) -> Result<v1::WriteResponse, tonic::Status> {
    assets.write(stream::iter(parts)).await.map(tonic::Response::into_inner)
}

fn noise(count: usize) -> Vec<u8> {
    (0..count).map(|n| (n.wrapping_mul(2_654_435_761) >> 11) as u8).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn an_upload_is_continued_where_it_broke() {
    let harness = Harness::start().await;
    let bytes = noise(3 << 20);
    let name = name_of(&digest_of(&bytes));
    let mut assets = harness.assets();
    let broken = write(&mut assets, parts(&name, &bytes[..1 << 20], 0, false)).await.unwrap();
    assert_eq!((broken.committed_bytes, broken.complete), (1 << 20, false));
    let query = v1::QueryWriteRequest { name: name.clone(), ..Default::default() };
    let here = assets.query_write(query).await.unwrap().into_inner().committed_bytes;
    assert_eq!(here, 1 << 20);
    let done = write(&mut assets, parts(&name, &bytes, here as usize, true)).await.unwrap();
    assert_eq!((done.committed_bytes, done.complete), (3 << 20, true));
    assert_eq!(read(&mut assets, &name, 0, 0).await.unwrap(), bytes);
}

#[tokio::test(flavor = "multi_thread")]
async fn bytes_the_server_has_may_be_sent_again() {
    let harness = Harness::start().await;
    let bytes = noise(1 << 20);
    let name = name_of(&digest_of(&bytes));
    let mut assets = harness.assets();
    write(&mut assets, parts(&name, &bytes[..700_000], 0, false)).await.unwrap();
    assert!(write(&mut assets, parts(&name, &bytes, 0, true)).await.unwrap().complete);
    assert_eq!(read(&mut assets, &name, 0, 0).await.unwrap(), bytes);
}

#[tokio::test(flavor = "multi_thread")]
async fn an_upload_is_continued_by_a_server_that_was_started_again() {
    let harness = Harness::start().await;
    let bytes = noise(1 << 20);
    let name = name_of(&digest_of(&bytes));
    write(&mut harness.assets(), parts(&name, &bytes[..512 << 10], 0, false)).await.unwrap();
    let Harness { folder, service, .. } = harness;
    drop(service);
    let config = super::test_config(&folder);
    let spy = std::sync::Arc::default();
    let service = displace_server::service::Service::start(config, super::parts(&spy)).await.unwrap().in_process();
    let mut assets = AssetsClient::new(service.channel());
    // The lock of the first server goes when its last call has ended.
    let query = v1::QueryWriteRequest { name: name.clone(), ..Default::default() };
    let here = assets.query_write(query).await.unwrap().into_inner().committed_bytes;
    let done = write(&mut assets, parts(&name, &bytes, here as usize, true)).await.unwrap();
    assert!(done.complete);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_gap_names_the_place_to_continue() {
    let harness = Harness::start().await;
    let bytes = noise(1 << 20);
    let name = name_of(&digest_of(&bytes));
    let status = write(&mut harness.assets(), parts(&name, &bytes, CHUNK, true)).await.unwrap_err();
    assert_eq!(status.code(), Code::InvalidArgument);
    assert!(status.message().contains("continue at 0"), "{}", status.message());
    assert_eq!(status.get_details_bad_request().unwrap().field_violations[0].field, "write_offset_bytes");
}

#[tokio::test(flavor = "multi_thread")]
async fn bytes_that_do_not_match_their_name_are_not_stored() {
    let harness = Harness::start().await;
    let (bytes, mut other) = (noise(600_000), noise(600_000));
    other[300_000] ^= 1;
    let name = name_of(&digest_of(&bytes));
    let mut assets = harness.assets();
    let status = write(&mut assets, parts(&name, &other, 0, true)).await.unwrap_err();
    assert_eq!(status.code(), Code::InvalidArgument);
    let query = v1::QueryWriteRequest { name: name.clone(), ..Default::default() };
    let state = assets.query_write(query).await.unwrap().into_inner();
    assert_eq!((state.committed_bytes, state.complete), (0, false));
    assert!(write(&mut assets, parts(&name, &bytes, 0, true)).await.unwrap().complete);
}

#[tokio::test(flavor = "multi_thread")]
async fn an_asset_that_is_stored_is_accepted_at_once() {
    let harness = Harness::start().await;
    let bytes = noise(2 << 20);
    let name = name_of(&digest_of(&bytes));
    let mut assets = harness.assets();
    write(&mut assets, parts(&name, &bytes, 0, true)).await.unwrap();
    let first_only = parts(&name, &bytes, 0, true).into_iter().take(1).collect();
    assert!(write(&mut assets, first_only).await.unwrap().complete);
}

#[tokio::test(flavor = "multi_thread")]
async fn parts_by_unary_calls_and_by_stream_continue_each_other() {
    let harness = Harness::start().await;
    let bytes = noise(600_000);
    let name = name_of(&digest_of(&bytes));
    let mut assets = harness.assets();
    let part =
        v1::WritePartRequest { name: name.clone(), data: bytes[..300_000].to_vec().into(), ..Default::default() };
    assert_eq!(assets.write_part(part).await.unwrap().into_inner().committed_bytes, 300_000);
    assert!(write(&mut assets, parts(&name, &bytes, 300_000, true)).await.unwrap().complete);
}

#[tokio::test(flavor = "multi_thread")]
async fn an_asset_above_the_limit_is_refused_before_its_bytes_come() {
    let harness = Harness::with(|config| config.max_asset_bytes = 1000).await;
    let bytes = noise(1001);
    let name = name_of(&digest_of(&bytes));
    let status = write(&mut harness.assets(), parts(&name, &bytes, 0, true)).await.unwrap_err();
    assert_eq!(status.code(), Code::FailedPrecondition);
}

#[tokio::test(flavor = "multi_thread")]
async fn many_uploads_of_the_same_bytes_store_them_once() {
    let harness = Harness::start().await;
    let bytes = noise(2 << 20);
    let name = name_of(&digest_of(&bytes));
    let upload = |_| {
        let (mut assets, parts) = (harness.assets(), parts(&name, &bytes, 0, true));
        async move { write(&mut assets, parts).await.unwrap().complete }
    };
    assert!(futures::future::join_all((0..8).map(upload)).await.into_iter().all(|complete| complete));
    assert_eq!(read(&mut harness.assets(), &name, 0, 0).await.unwrap(), bytes);
}

/// A stream of `count` chunks that exists one chunk at a time.
pub(super) fn endless(name: String, count: u64) -> impl futures::Stream<Item = v1::WriteRequest> + Send + 'static {
    stream::iter(0..count).map(move |n| v1::WriteRequest {
        name: if n == 0 { name.clone() } else { String::new() },
        write_offset_bytes: n * CHUNK as u64,
        data: chunk(n),
        finish: n + 1 == count,
        ..Default::default()
    })
}

fn chunk(n: u64) -> bytes::Bytes {
    let mut data = vec![0; CHUNK];
    data[..8].copy_from_slice(&n.to_le_bytes());
    data.into()
}

/// The name of what `endless` sends.
pub(super) fn endless_name(count: u64) -> String {
    let mut hasher = Sha256::new();
    (0..count).for_each(|n| hasher.update(chunk(n)));
    let hash: String = hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    format!("assets/sha256/{hash}/{}", count * CHUNK as u64)
}
