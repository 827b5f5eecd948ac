//! `displace compare`: how far two images are apart.

use std::fmt::Write as _;

use displace_proto::v1::{CompareRequest, Comparison};
use serde_json::{Value, json};

use super::{
    Session,
    answer::{answer, wanted},
    blocking,
};
use crate::{
    args::CompareArgs,
    error::{Error, Result},
    jobs::Job,
    output::{Terminal, count},
    request::Parcel,
};

pub(super) async fn run(session: &Session, args: &CompareArgs, terminal: &mut Terminal<'_>) -> Result<()> {
    let difference = wanted("difference.png", args.output.as_deref())?;
    let (message, parcel) = request(session, args).await?;
    let report = answer(session, &Job::Compare(message), &parcel, difference, terminal.progress()).await?;
    let comparison = report.comparison.ok_or_else(|| Error::internal("the server's report holds no comparison"))?;
    terminal.report(&as_json(&comparison), &words(&comparison))
}

async fn request(session: &Session, args: &CompareArgs) -> Result<(CompareRequest, Parcel)> {
    let (a, b) = (args.a.clone(), args.b.clone());
    let (fresh, linger_secs) = (session.global.fresh, Some(session.connection().await?.linger_secs));
    blocking(move || {
        let mut parcel = Parcel::default();
        let (a, b) = (Some(parcel.file(&a)?), Some(parcel.file(&b)?));
        Ok((CompareRequest { a, b, fresh, linger_secs }, parcel))
    })
    .await
}

/// What the images do not tell is absent.
fn as_json(found: &Comparison) -> Value {
    let mut value =
        json!({ "flip_mean": found.flip_mean, "flip_p99": found.flip_p99, "rmse_linear": found.rmse_linear });
    if let Some(ssim) = found.ssim {
        value["ssim"] = ssim.into();
    }
    if let Some(pixels) = found.silhouette_xor_px {
        value["silhouette_xor_px"] = pixels.into();
    }
    if let Some(pixels) = found.hit_error_px {
        value["hit_error_px"] = pixels.into();
    }
    value
}

fn words(found: &Comparison) -> String {
    let mut text = format!(
        "FLIP {:.6} mean, {:.6} at the 99th percentile; 0 is the same\nRMSE {:.6} in linear light\n",
        found.flip_mean, found.flip_p99, found.rmse_linear
    );
    if let Some(ssim) = found.ssim {
        let _ = writeln!(text, "SSIM {ssim:.6}; 1 is the same");
    }
    if let Some(pixels) = found.silhouette_xor_px {
        let _ = writeln!(text, "outlines differ in {} pixels", count(pixels));
    }
    if let Some(pixels) = found.hit_error_px {
        let _ = writeln!(text, "places differ by {pixels:.3} pixels at the 99th percentile");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(found: &Comparison) -> Vec<String> {
        as_json(found).as_object().unwrap().keys().cloned().collect()
    }

    #[test]
    fn what_the_images_do_not_tell_is_absent() {
        assert_eq!(keys(&Comparison::default()), ["flip_mean", "flip_p99", "rmse_linear"]);
        let all = Comparison {
            ssim: Some(1.0),
            silhouette_xor_px: Some(1234),
            hit_error_px: Some(0.5),
            ..Comparison::default()
        };
        let expected = ["flip_mean", "flip_p99", "rmse_linear", "ssim", "silhouette_xor_px", "hit_error_px"];
        assert_eq!(keys(&all), expected);
        assert!(words(&all).contains("1 234 pixels") && words(&all).contains("0.500 pixels"));
        assert!(!words(&Comparison::default()).contains("SSIM"));
    }
}
