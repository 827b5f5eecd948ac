//! How the result is made of triangles.

use displace_proto::v1::{self, geometry};

use super::{join, known, tolerance, within};
use crate::domain::{
    Error, Result,
    normal_map::SIZES,
    plan::MAX_LEVEL,
    request::{Base, Geometry, Normals, Refinement, SeamRule},
};

const DEFAULT_FEATHER_TEXELS: f32 = 3.0;
const MAX_FEATHER_TEXELS: f32 = 4096.0;

pub(super) fn parse(path: &str, geometry: Option<v1::Geometry>) -> Result<Geometry> {
    let geometry =
        geometry.ok_or_else(|| Error::invalid(path, "is required; give tolerance, uniform_level, or exact"))?;
    let feather = geometry.feather_texels.unwrap_or(DEFAULT_FEATHER_TEXELS);
    Ok(Geometry {
        refinement: refinement(path, geometry.refinement.as_ref())?,
        max_triangles: max_triangles(&join(path, "max_triangles"), geometry.max_triangles)?,
        normals: normals(path, &geometry)?,
        seams: match known(&join(path, "seams"), geometry.seams)? {
            v1::SeamRule::Unspecified | v1::SeamRule::Mean => SeamRule::Mean,
            v1::SeamRule::Dominant => SeamRule::Dominant,
        },
        base: match known(&join(path, "base"), geometry.base)? {
            v1::Base::Unspecified | v1::Base::Flat => Base::Flat,
            v1::Base::Pn => Base::Pn,
            v1::Base::Phong => Base::Phong,
            v1::Base::Loop => Base::Loop,
        },
        feather_texels: within(&join(path, "feather_texels"), feather, 0.0, MAX_FEATHER_TEXELS)?,
    })
}

fn normals(path: &str, geometry: &v1::Geometry) -> Result<Normals> {
    let (field, size) = (join(path, "normal_map_size"), geometry.normal_map_size);
    let kind = known(&join(path, "normals"), geometry.normals)?;
    if size != 0 && kind != v1::Normals::Map {
        return Err(Error::invalid(field, format!("is {size}, and no normal map is asked for: leave it 0")));
    }
    if size != 0 && !SIZES.contains(&size) {
        let (least, most) = SIZES.into_inner();
        return Err(Error::invalid(
            field,
            format!("{size} is out of range; allowed are {least} to {most} texels a side"),
        ));
    }
    Ok(match kind {
        v1::Normals::Unspecified | v1::Normals::Analytic => Normals::Analytic,
        v1::Normals::Geometric => Normals::Geometric,
        v1::Normals::Map => Normals::Map { size: (size != 0).then_some(size) },
    })
}

fn refinement(path: &str, refinement: Option<&geometry::Refinement>) -> Result<Refinement> {
    use geometry::Refinement as Asked;
    match refinement {
        Some(Asked::UniformLevel(level)) => Ok(Refinement::Uniform(self::level(&join(path, "uniform_level"), *level)?)),
        Some(Asked::Exact(true)) => Ok(Refinement::Exact),
        Some(Asked::Exact(false)) => {
            Err(Error::invalid(join(path, "exact"), "is false, which asks for nothing; give a tolerance or a level"))
        }
        Some(Asked::Tolerance(tolerance)) => {
            Ok(Refinement::Tolerance(tolerance::parse(&join(path, "tolerance"), tolerance)?))
        }
        None => Err(Error::invalid(join(path, "refinement"), "is required; give tolerance, uniform_level, or exact")),
    }
}

fn level(field: &str, level: u32) -> Result<u32> {
    if level <= MAX_LEVEL {
        return Ok(level);
    }
    Err(Error::invalid(field, format!("{level} is out of range; allowed are 0 to {MAX_LEVEL}")))
}

fn max_triangles(field: &str, most: Option<u64>) -> Result<Option<u64>> {
    if most == Some(0) {
        return Err(Error::invalid(field, "0 triangles is nothing; allowed are 1 or more, absent means no limit"));
    }
    Ok(most)
}
