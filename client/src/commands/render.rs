//! `displace render`: an image of the displaced mesh, and further images of the same view.

use std::path::{Path, PathBuf};

use clap::ArgMatches;
use displace_proto::v1::{ImageFormat, Lighting, Output, Pixel, RenderRequest, geometry::Refinement};

use super::{
    Session, blocking,
    surface::{Outcome, Surface, save},
};
use crate::{
    args::{CompressArg, MethodArg, RenderArgs},
    error::{Error, Result},
    jobs::{self, Job},
    options,
    output::{Progress, Target, Terminal},
    request,
};

pub(super) async fn run(
    session: &Session,
    args: &RenderArgs,
    matches: &ArgMatches,
    terminal: &mut Terminal<'_>,
) -> Result<()> {
    perform(session, args, matches, terminal.progress()).await?.tell(terminal)
}

pub(super) async fn perform(
    session: &Session,
    args: &RenderArgs,
    matches: &ArgMatches,
    progress: Progress,
) -> Result<Outcome> {
    let surface = surface(args, matches)?;
    let format = format(&args.output)?;
    refuse_repeated_aovs(args)?;
    Target::new(&args.output)?;
    let (mut surface, mut parcel) = surface.request(session).await?;
    let environment = args.light.env.clone();
    let (parcel, environment) = blocking(move || {
        let environment = environment.map(|path| parcel.environment(&path)).transpose()?;
        Ok((parcel, environment))
    })
    .await?;
    if let Some(geometry) = surface.geometry.as_mut().filter(|_| args.exact) {
        geometry.refinement = Some(Refinement::Exact(true));
    }
    let (views, sequence) = request::sequence(&args.camera, &args.sequence);
    let is_sequence = sequence.is_some();
    let message = RenderRequest {
        surface: Some(surface),
        views,
        sequence,
        lighting: Some(Lighting {
            relief: request::relief(&args.relief),
            ..request::lighting(&args.look, &args.light, environment)
        }),
        aovs: args.aov.iter().map(|&aov| request::aov(aov).into()).collect(),
        format: format.into(),
        samples: args.supersample.unwrap_or_default(),
        preimage: args.preimage.map(|[x, y]| Pixel { x, y }),
    };
    let connection = session.connection().await?;
    let mut result = jobs::run(connection, &Job::Render(Box::new(message)), &parcel.blobs, progress).await?;
    let outputs = std::mem::take(&mut result.outputs);
    let outputs = if is_sequence { frames(outputs, &args.output)? } else { placed(outputs, &args.output)? };
    let written = save(connection, &outputs, progress).await?;
    Ok(Outcome::new(result, &parcel.notes, written))
}

fn surface(args: &RenderArgs, matches: &ArgMatches) -> Result<Surface> {
    let groups = options::groups(&args.detail, matches)?;
    // Who says how fine wants the surface even where the details are those of the file.
    let plain = if args.geometry.is_refined() { MethodArg::Displacement } else { MethodArg::Flat };
    let method = match options::method(args.method, &groups, plain) {
        _ if chooses(args) && !options::are_normals(&groups) => MethodArg::Auto,
        method => method,
    };
    options::refuse_idle(&args.geometry, method)?;
    let geometry = args.geometry.clone();
    let geometry = if method.keeps_tolerance() && !args.exact { geometry.or_pixels() } else { geometry };
    let (mesh, look) = (args.mesh.clone(), args.look.clone());
    Ok(Surface { mesh, groups, geometry, look, method, compress: CompressArg::None, lods: 1 })
}

/// Whether nothing says what is to be made: neither a method, nor how fine its triangles are, nor what they alone have.
fn chooses(args: &RenderArgs) -> bool {
    let is_open = args.method.is_none() && !args.geometry.is_fixed() && !args.sequence.is_asked();
    is_open && !args.exact && args.preimage.is_none()
}

fn format(path: &Path) -> Result<ImageFormat> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("png") => Ok(ImageFormat::Png),
        Some("exr") => Ok(ImageFormat::Exr),
        _ => {
            let message = format!(
                "{} does not say which format; end the name in .png (sRGB, 8 bit) or .exr (linear float)",
                path.display()
            );
            Err(Error::usage("--output", message))
        }
    }
}

fn refuse_repeated_aovs(args: &RenderArgs) -> Result<()> {
    let repeated = args.aov.iter().enumerate().any(|(index, aov)| args.aov[..index].contains(aov));
    if repeated { Err(Error::usage("--aov", "--aov names an image twice; name each once")) } else { Ok(()) }
}

/// The colour image takes the name asked for; `out.png` puts depth beside it as `out.depth.png`.
fn placed(outputs: Vec<Output>, path: &Path) -> Result<Vec<(Output, Target)>> {
    outputs
        .into_iter()
        .map(|output| {
            let stem = output.name.split('.').next().unwrap_or_default();
            let target = Target::new(&match stem {
                "color" => path.to_owned(),
                // A drawing, whatever the image is.
                "preimage" => path.with_extension("preimage.png"),
                _ => beside(path, stem),
            })?;
            Ok((output, target))
        })
        .collect()
}

/// `0007.color.png` becomes `out-0007.png`, and its depth `out-0007.depth.png`.
fn frames(outputs: Vec<Output>, path: &Path) -> Result<Vec<(Output, Target)>> {
    let mut all = Vec::with_capacity(outputs.len());
    for mut output in outputs {
        let Some((number, name)) =
            output.name.split_once('.').filter(|(n, _)| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
        else {
            return Err(Error::internal(format!("the server named a frame '{}', without its number", output.name)));
        };
        let path = numbered(path, number);
        output.name = name.to_owned();
        all.extend(placed(vec![output], &path)?);
    }
    Ok(all)
}

fn numbered(path: &Path, number: &str) -> PathBuf {
    let [stem, extension] = [path.file_stem(), path.extension()].map(|part| part.unwrap_or_default().to_string_lossy());
    path.with_file_name(format!("{stem}-{number}.{extension}"))
}

fn beside(path: &Path, what: &str) -> PathBuf {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    path.with_extension(format!("{what}.{extension}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_says_the_format() {
        assert_eq!(format(Path::new("a.PNG")), Ok(ImageFormat::Png));
        assert_eq!(format(Path::new("a.exr")), Ok(ImageFormat::Exr));
        assert_eq!(format(Path::new("a.jpg")).unwrap_err().field.as_deref(), Some("--output"));
        assert!(format(Path::new("a")).is_err());
    }

    #[test]
    fn frames_are_numbered_before_the_ending() {
        assert_eq!(numbered(Path::new("d/out.png"), "0012"), Path::new("d/out-0012.png"));
        let output = |name: &str| Output { name: name.into(), ..Output::default() };
        let placed = frames(vec![output("0003.color.png"), output("0003.depth.png")], Path::new("out.png")).unwrap();
        let named: Vec<&Path> = placed.iter().map(|(_, target)| target.named()).collect();
        assert_eq!(named, [Path::new("out-0003.png"), Path::new("out-0003.depth.png")]);
        assert!(frames(vec![output("../x.png")], Path::new("out.png")).is_err());
    }

    #[test]
    fn further_images_lie_beside_the_first() {
        assert_eq!(beside(Path::new("d/out.png"), "depth"), Path::new("d/out.depth.png"));
    }
}
