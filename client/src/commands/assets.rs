//! `displace assets`: what the server's store holds.

use std::path::{Path, PathBuf};

use displace_proto::v1::{AssetOrigin, DeleteRequest, ListRequest};
use serde_json::{Value, json};

use super::{Session, blocking};
use crate::{
    args::AssetsCommand,
    connection::{CALL_DEADLINE, request},
    error::{Error, Result},
    output::{Target, Terminal, bytes},
    transfer::{Blob, download, parse_name, resource_name, to_writer, unary, upload},
};

pub(super) async fn run(session: &Session, command: &AssetsCommand, terminal: &mut Terminal<'_>) -> Result<()> {
    match command {
        AssetsCommand::Put { files } => put(session, files.clone(), terminal).await,
        AssetsCommand::Get { name, output } => get(session, name, output, terminal).await,
        AssetsCommand::Ls => list(session, terminal).await,
        AssetsCommand::Rm { names } => remove(session, names, terminal).await,
    }
}

async fn put(session: &Session, files: Vec<PathBuf>, terminal: &mut Terminal<'_>) -> Result<()> {
    let blobs: Vec<Blob> = blocking(move || files.iter().map(|file| Blob::of_file(file)).collect()).await?;
    upload(session.connection().await?, &blobs, &terminal.progress()).await?;
    let assets: Vec<Value> = blobs
        .iter()
        .map(|blob| json!({ "path": blob.label, "name": resource_name(&blob.digest), "bytes": blob.digest.size_bytes }))
        .collect();
    let words: String = blobs.iter().map(|blob| format!("{}  {}\n", resource_name(&blob.digest), blob.label)).collect();
    terminal.report(&json!({ "assets": assets }), &words)
}

async fn get(session: &Session, name: &str, output: &Path, terminal: &mut Terminal<'_>) -> Result<()> {
    let digest = parse_name(name)?;
    let progress = terminal.progress();
    if output == Path::new("-") {
        if terminal.json {
            return Err(Error::usage("--output", "--output - and --json both want stdout; name a file"));
        }
        return to_writer(session.connection().await?, &digest, terminal.stdout, &progress).await;
    }
    let target = Target::new(output)?;
    download(session.connection().await?, &digest, &target, &progress).await?;
    let path = target.named().display().to_string();
    let words = format!("{path}  {}\n", bytes(digest.size_bytes));
    terminal.report(&json!({ "path": path, "name": resource_name(&digest), "bytes": digest.size_bytes }), &words)
}

async fn list(session: &Session, terminal: &mut Terminal<'_>) -> Result<()> {
    let connection = session.connection().await?;
    let (mut all, mut page_token) = (Vec::new(), String::new());
    loop {
        let page = unary(|| {
            let message = ListRequest { page_size: 1000, page_token: page_token.clone() };
            async move { connection.assets().list(request(message, CALL_DEADLINE)).await }
        })
        .await?;
        for asset in page.assets {
            let origin = if asset.origin() == AssetOrigin::Output { "output" } else { "upload" };
            let size = asset.digest.map_or(0, |digest| digest.size_bytes);
            if terminal.json {
                let last_use = asset.last_use_time.map(|time| time.seconds);
                all.push(
                    json!({ "name": asset.name, "bytes": size, "origin": origin, "last_use_unix_secs": last_use }),
                );
            } else {
                terminal.data(format!("{}  {origin}  {}\n", asset.name, bytes(size)).as_bytes())?;
            }
        }
        page_token = page.next_page_token;
        if page_token.is_empty() {
            break;
        }
    }
    if terminal.json { terminal.report(&json!({ "assets": all }), "") } else { Ok(()) }
}

async fn remove(session: &Session, names: &[String], terminal: &mut Terminal<'_>) -> Result<()> {
    let names: Vec<String> =
        names.iter().map(|name| parse_name(name).map(|d| resource_name(&d))).collect::<Result<_>>()?;
    let connection = session.connection().await?;
    let mut removed = Vec::new();
    let mut words = String::new();
    for name in names {
        let answer = unary(|| {
            let message = DeleteRequest { name: name.clone() };
            async move { connection.assets().delete(request(message, CALL_DEADLINE)).await }
        })
        .await?;
        words += &format!("{name}  {}\n", if answer.deleted { "removed" } else { "was not stored" });
        removed.push(json!({ "name": name, "deleted": answer.deleted }));
    }
    terminal.report(&json!({ "assets": removed }), &words)
}
