//! `displace apply`: displaced geometry as GLB, or what it would take.

use clap::ArgMatches;
use displace_proto::v1::{EstimateRequest, estimate_request};

use super::{
    Session,
    surface::{Outcome, Surface, output, save},
};
use crate::{
    args::{ApplyArgs, MethodArg},
    connection::{MESH_DEADLINE, request},
    error::{Error, Result},
    jobs::{self, Job},
    options,
    output::{Progress, Target, Terminal},
    report,
    transfer::{unary, upload},
};

pub(super) async fn run(
    session: &Session,
    args: &ApplyArgs,
    matches: &ArgMatches,
    terminal: &mut Terminal<'_>,
) -> Result<()> {
    if args.dry_run {
        return estimate(session, args, matches, terminal).await;
    }
    perform(session, args, matches, terminal.progress()).await?.tell(terminal)
}

pub(super) async fn perform(
    session: &Session,
    args: &ApplyArgs,
    matches: &ArgMatches,
    progress: Progress,
) -> Result<Outcome> {
    let surface = surface(args, matches)?;
    let path = args.output.as_deref().ok_or_else(|| Error::usage("--output", "--output OUT.glb is missing"))?;
    let target = Target::new(path)?;
    let (message, parcel) = surface.request(session).await?;
    let connection = session.connection().await?;
    let result = jobs::run(connection, &Job::Displace(message), &parcel.blobs, progress).await?;
    let mesh = output(&result, "mesh.glb")?.clone();
    let written = save(connection, &[(mesh, target)], progress).await?;
    Ok(Outcome::new(result, &parcel.notes, written))
}

fn surface(args: &ApplyArgs, matches: &ArgMatches) -> Result<Surface> {
    let groups = options::groups(&args.detail, matches)?;
    let method = match args.method {
        None if !args.geometry.view.is_empty() => MethodArg::Auto,
        asked => options::method(asked, &groups, MethodArg::Displacement),
    };
    let geometry = args.geometry.clone().or_tolerance();
    geometry.require_views()?;
    let (mesh, look, compress, lods) = (args.mesh.clone(), args.look.clone(), args.compress, args.lods);
    Ok(Surface { mesh, groups, geometry, look, method, compress, lods })
}

/// Estimate reads the assets, so they are uploaded; nothing is computed.
async fn estimate(
    session: &Session,
    args: &ApplyArgs,
    matches: &ArgMatches,
    terminal: &mut Terminal<'_>,
) -> Result<()> {
    let (message, parcel) = surface(args, matches)?.request(session).await?;
    let connection = session.connection().await?;
    upload(connection, &parcel.blobs, &terminal.progress()).await?;
    let mut estimate = unary(|| {
        let message = EstimateRequest { request: Some(estimate_request::Request::Displace(message.clone())) };
        async move { connection.displacement().estimate(request(message, MESH_DEADLINE)).await }
    })
    .await?;
    estimate.warnings.extend(report::conversion_warnings(&parcel.notes));
    terminal.report(&report::estimate_json(&estimate), &report::estimate_words(&estimate))
}
