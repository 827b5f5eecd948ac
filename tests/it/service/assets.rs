//! Assets: by content, by tenant, within the limit, whole or not at all.

use std::time::Duration;

use displace_proto::v1::{self, assets_client::AssetsClient};
use futures::TryStreamExt as _;
use tonic::{Code, Request, Status, transport::Channel};
use tonic_types::StatusExt as _;

use super::{Harness, digest_of, name_of, result};

pub(super) async fn read(
    assets: &mut AssetsClient<Channel>,
    name: &str,
    offset: u64,
    limit: u64,
) -> Result<Vec<u8>, Status> {
    let request = v1::ReadRequest { name: name.into(), read_offset_bytes: offset, read_limit_bytes: limit };
    let parts: Vec<v1::ReadResponse> = assets.read(request).await?.into_inner().try_collect().await?;
    assert!(parts.iter().all(|part| !part.data.is_empty() && part.data.len() <= 256 << 10));
    Ok(parts.iter().flat_map(|part| part.data.iter().copied()).collect())
}

#[tokio::test(flavor = "multi_thread")]
async fn what_is_stored_is_found_and_read_in_ranges() {
    let harness = Harness::start().await;
    let bytes: Vec<u8> = (0..1_000_000u32).map(|n| (n * 7 + n / 256) as u8).collect();
    let name = name_of(&harness.put(&bytes).await);
    let mut assets = harness.assets();
    assert_eq!(read(&mut assets, &name, 0, 0).await.unwrap(), bytes);
    assert_eq!(read(&mut assets, &name, 999_990, 0).await.unwrap(), bytes[999_990..]);
    assert_eq!(read(&mut assets, &name, 300_000, 400_000).await.unwrap(), bytes[300_000..700_000]);
    assert_eq!(read(&mut assets, &name, 1_000_000, 0).await.unwrap(), b"");
    assert_eq!(read(&mut assets, &name, 1_000_001, 0).await.unwrap_err().code(), Code::InvalidArgument);
}

#[tokio::test(flavor = "multi_thread")]
async fn find_missing_tells_what_is_not_stored() {
    let harness = Harness::start().await;
    let stored = harness.put(b"stored").await;
    let absent = digest_of(b"absent");
    let request = v1::FindMissingRequest { digests: vec![absent.clone(), stored, absent.clone()] };
    let missing = harness.assets().find_missing(request).await.unwrap().into_inner().missing;
    assert_eq!(missing, [absent.clone(), absent]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_bad_blob_does_not_stop_the_others_of_its_batch() {
    let harness = Harness::start().await;
    let blob = |digest, data: &'static [u8]| v1::batch_write_request::Blob { digest: Some(digest), data: data.into() };
    let blobs = vec![blob(digest_of(b"other"), b"bytes"), blob(digest_of(b"good"), b"good")];
    let entries = harness.assets().batch_write(v1::BatchWriteRequest { blobs }).await.unwrap().into_inner().entries;
    let codes: Vec<i32> = entries.iter().map(|entry| entry.status.as_ref().unwrap().code).collect();
    assert_eq!(codes, [Code::InvalidArgument as i32, 0]);
    let digests = vec![digest_of(b"other"), digest_of(b"good")];
    let missing = harness.assets().find_missing(v1::FindMissingRequest { digests }).await.unwrap().into_inner().missing;
    assert_eq!(missing, [digest_of(b"other")]);
}

#[tokio::test(flavor = "multi_thread")]
async fn tenants_do_not_see_each_others_assets() {
    let harness = Harness::start().await;
    let digest = harness.put(b"secret").await;
    let of = |tenant: &str| {
        let mut request = Request::new(v1::FindMissingRequest { digests: vec![digest.clone()] });
        request.metadata_mut().insert(displace_proto::TENANT_METADATA, tenant.parse().unwrap());
        request
    };
    let missing = harness.assets().find_missing(of("other")).await.unwrap().into_inner().missing;
    assert_eq!(missing, std::slice::from_ref(&digest));
    let status = harness.assets().find_missing(of("../default")).await.unwrap_err();
    assert_eq!(status.code(), Code::InvalidArgument);
}

#[tokio::test(flavor = "multi_thread")]
async fn listing_turns_pages_in_the_order_of_digests() {
    let harness = Harness::start().await;
    for n in 0..25u8 {
        harness.put(&[n]).await;
    }
    let mut names = Vec::new();
    let mut page_token = String::new();
    loop {
        let request = v1::ListRequest { page_size: 10, page_token };
        let page = harness.assets().list(request).await.unwrap().into_inner();
        names.extend(page.assets.into_iter().map(|asset| asset.name));
        page_token = page.next_page_token;
        if page_token.is_empty() {
            break;
        }
    }
    assert_eq!(names.len(), 25);
    assert!(names.is_sorted());
}

#[tokio::test(flavor = "multi_thread")]
async fn deleting_is_idempotent() {
    let harness = Harness::start().await;
    let name = name_of(&harness.put(b"bytes").await);
    let delete = || v1::DeleteRequest { name: name.clone() };
    assert!(harness.assets().delete(delete()).await.unwrap().into_inner().deleted);
    assert!(!harness.assets().delete(delete()).await.unwrap().into_inner().deleted);
    let status = harness.assets().get(v1::GetRequest { name: name.clone() }).await.unwrap_err();
    assert_eq!(status.code(), Code::NotFound);
    assert_eq!(status.get_details_resource_info().unwrap().resource_name, name);
}

#[tokio::test(flavor = "multi_thread")]
async fn damaged_bytes_are_data_loss_and_can_be_stored_again() {
    let harness = Harness::start().await;
    let digest = harness.put(b"whole bytes").await;
    let folder = harness.folder.path().join("store/t/default/assets").join(&digest.hash[..2]);
    std::fs::write(folder.join(format!("{}-{}", digest.hash, digest.size_bytes)), b"other bytes").unwrap();
    let status = read(&mut harness.assets(), &name_of(&digest), 0, 0).await.unwrap_err();
    assert_eq!(status.code(), Code::DataLoss);
    let request = v1::FindMissingRequest { digests: vec![digest.clone()] };
    assert_eq!(
        harness.assets().find_missing(request).await.unwrap().into_inner().missing,
        std::slice::from_ref(&digest)
    );
    harness.put(b"whole bytes").await;
    assert_eq!(read(&mut harness.assets(), &name_of(&digest), 0, 0).await.unwrap(), b"whole bytes");
}

#[tokio::test(flavor = "multi_thread")]
async fn results_leave_before_uploads_and_the_oldest_first() {
    let harness = Harness::with(|config| {
        config.store_bytes = 100_000;
        config.store_keep_secs = 0;
    })
    .await;
    let upload = harness.put(&[7; 30_000]).await;
    let mut made = Vec::new();
    for n in 0..6 {
        let updates = harness.displace(&format!("make 20000 {n}")).await;
        made.push(result(&updates).outputs[0].digest.clone().unwrap());
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    // All jobs make the same bytes: one asset, and all six results stand on it.
    assert!(made.iter().all(|digest| *digest == made[0]));
    let outputs = make_distinct(&harness).await;
    let request = v1::FindMissingRequest { digests: outputs.iter().cloned().chain([upload.clone()]).collect() };
    let missing = harness.assets().find_missing(request).await.unwrap().into_inner().missing;
    assert!(!missing.contains(&upload), "an upload went before a result");
    assert!(!missing.is_empty() && !missing.contains(outputs.last().unwrap()), "the newest result went");
    assert_eq!(missing, outputs[..missing.len()], "not the oldest first");
    assert!(harness.statistics().await.store_bytes <= 100_000);
}

/// Six outputs of 20 000 different bytes.
async fn make_distinct(harness: &Harness) -> Vec<v1::Digest> {
    let mut outputs = Vec::new();
    for n in 0..6usize {
        let updates = harness.displace(&format!("make {}", 20_000 + n)).await;
        outputs.push(result(&updates).outputs[0].digest.clone().unwrap());
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    outputs
}

#[tokio::test(flavor = "multi_thread")]
async fn a_result_whose_output_was_removed_is_computed_again() {
    let harness = Harness::start().await;
    let first = harness.displace("ok").await;
    let output = result(&first).outputs[0].digest.clone().unwrap();
    harness.assets().delete(v1::DeleteRequest { name: name_of(&output) }).await.unwrap();
    let second = harness.displace("ok").await;
    assert_eq!(harness.runs(), 2);
    assert!(!result(&second).report.as_ref().unwrap().cached);
}
