//! How the result is made of triangles.

use displace_proto::v1::{self, geometry::Refinement};

use super::{join, known, within};
use crate::domain::{
    Error, Result,
    plan::MAX_LEVEL,
    request::{Geometry, Normals, SeamRule},
};

const DEFAULT_FEATHER_TEXELS: f32 = 3.0;
const MAX_FEATHER_TEXELS: f32 = 4096.0;

pub(super) fn parse(path: &str, geometry: Option<v1::Geometry>) -> Result<Geometry> {
    let geometry = geometry.ok_or_else(|| Error::invalid(path, "is required; give uniform_level, or exact"))?;
    let feather = geometry.feather_texels.unwrap_or(DEFAULT_FEATHER_TEXELS);
    Ok(Geometry {
        uniform_level: level(&join(path, "uniform_level"), geometry.refinement.as_ref())?,
        exact: matches!(geometry.refinement, Some(Refinement::Exact(true))),
        max_triangles: max_triangles(&join(path, "max_triangles"), geometry.max_triangles)?,
        normals: match known(&join(path, "normals"), geometry.normals)? {
            v1::Normals::Unspecified | v1::Normals::Analytic => Normals::Analytic,
            v1::Normals::Geometric => Normals::Geometric,
        },
        seams: match known(&join(path, "seams"), geometry.seams)? {
            v1::SeamRule::Unspecified | v1::SeamRule::Mean => SeamRule::Mean,
            v1::SeamRule::Dominant => SeamRule::Dominant,
        },
        feather_texels: within(&join(path, "feather_texels"), feather, 0.0, MAX_FEATHER_TEXELS)?,
    })
}

fn level(field: &str, refinement: Option<&Refinement>) -> Result<u32> {
    match refinement {
        Some(Refinement::UniformLevel(level)) if *level <= MAX_LEVEL => Ok(*level),
        Some(Refinement::UniformLevel(level)) => {
            Err(Error::invalid(field, format!("{level} is out of range; allowed are 0 to {MAX_LEVEL}")))
        }
        Some(Refinement::Exact(true)) => Ok(0),
        Some(Refinement::Exact(false)) => {
            Err(Error::invalid(field, "exact is false, which asks for nothing; give a level"))
        }
        None => Err(Error::invalid(field, format!("is required; allowed are 0 to {MAX_LEVEL}"))),
    }
}

fn max_triangles(field: &str, most: Option<u64>) -> Result<Option<u64>> {
    if most == Some(0) {
        return Err(Error::invalid(field, "0 triangles is nothing; allowed are 1 or more, absent means no limit"));
    }
    Ok(most)
}
