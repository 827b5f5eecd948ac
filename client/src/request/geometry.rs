//! How the result is made of triangles, from what was typed.

use displace_proto::v1::{self, geometry::Refinement, tolerance::Allowed};

use crate::args::{BaseArg, ErrorAtArg, GeometryArgs, NormalsArg, QualityArg, SeamsArg, values::View};

pub(crate) fn geometry(args: &GeometryArgs) -> v1::Geometry {
    v1::Geometry {
        refinement: Some(refinement(args)),
        max_triangles: args.max_triangles,
        normals: match args.normals {
            NormalsArg::Analytic => v1::Normals::Analytic,
            NormalsArg::Geometric => v1::Normals::Geometric,
            NormalsArg::Map => v1::Normals::Map,
        }
        .into(),
        seams: seams(args.seams).into(),
        feather_texels: Some(args.feather),
        normal_map_size: args.normal_map_size.unwrap_or(0),
        base: base(args.base).into(),
    }
}

/// Where nothing is said of it, which only a flat render may do, the mesh stays as it is: level 0.
fn refinement(args: &GeometryArgs) -> Refinement {
    let Some(allowed) = allowed(args) else { return Refinement::UniformLevel(args.uniform.unwrap_or(0)) };
    Refinement::Tolerance(v1::Tolerance {
        allowed: Some(allowed),
        error_at: match args.error_at {
            None => v1::ErrorAt::Unspecified,
            Some(ErrorAtArg::Surface) => v1::ErrorAt::Surface,
            Some(ErrorAtArg::Texels) => v1::ErrorAt::Texels,
        }
        .into(),
        quality: match args.quality {
            None => v1::Quality::Unspecified,
            Some(QualityArg::Normal) => v1::Quality::Normal,
            Some(QualityArg::High) => v1::Quality::High,
        }
        .into(),
    })
}

fn allowed(args: &GeometryArgs) -> Option<Allowed> {
    match (args.tolerance, args.tolerance_world, args.tolerance_px) {
        (Some(share), ..) => Some(Allowed::Diagonal(share)),
        (_, Some(length), _) => Some(Allowed::World(length)),
        (.., Some(tolerance_px)) => {
            let views = args.view.iter().map(view).collect();
            Some(Allowed::Pixels(v1::PixelTolerance { tolerance_px, views }))
        }
        (None, None, None) => None,
    }
}

fn view(view: &View) -> v1::ToleranceView {
    v1::ToleranceView {
        eye: view.eye.to_vec(),
        target: view.look_at.to_vec(),
        yfov_degrees: Some(view.yfov_degrees),
        width: view.size.width,
        height: view.size.height,
    }
}

pub(crate) fn seams(seams: SeamsArg) -> v1::SeamRule {
    match seams {
        SeamsArg::Mean => v1::SeamRule::Mean,
        SeamsArg::Dominant => v1::SeamRule::Dominant,
    }
}

pub(crate) fn base(base: BaseArg) -> v1::Base {
    match base {
        BaseArg::Flat => v1::Base::Flat,
        BaseArg::Pn => v1::Base::Pn,
        BaseArg::Phong => v1::Base::Phong,
        BaseArg::Loop => v1::Base::Loop,
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::*;

    #[derive(clap::Parser)]
    struct Typed {
        #[command(flatten)]
        geometry: GeometryArgs,
    }

    /// What `apply` or, without the default, `render` asks for.
    fn asked(flags: &[&str], has_default: bool) -> Refinement {
        let typed = Typed::try_parse_from([&["displace"], flags].concat()).unwrap_or_else(|e| panic!("{e}")).geometry;
        refinement(&if has_default { typed.or_tolerance() } else { typed })
    }

    fn allowed_by(flags: &[&str]) -> Allowed {
        let Refinement::Tolerance(tolerance) = asked(flags, true) else { panic!("{flags:?}: a tolerance") };
        tolerance.allowed.expect("it says how far")
    }

    #[test]
    fn a_thousandth_of_the_diagonal_is_asked_for_where_nothing_is_said() {
        assert_eq!(allowed_by(&[]), Allowed::Diagonal(1e-3));
        assert_eq!(asked(&[], false), Refinement::UniformLevel(0));
        assert_eq!(asked(&["--uniform", "3"], true), Refinement::UniformLevel(3));
    }

    #[test]
    fn each_unit_has_its_flag() {
        assert_eq!(allowed_by(&["--tolerance", "1e-4"]), Allowed::Diagonal(1e-4));
        assert_eq!(allowed_by(&["--tolerance-world", "0.02"]), Allowed::World(0.02));
        let views = ["--view", "0,1,3;0,0,0;40;64x48", "--view", "-3,1,0;0,0,0;40;32x32"];
        let Allowed::Pixels(pixels) = allowed_by(&[&["--tolerance-px", "0.5"][..], &views].concat()) else {
            panic!("pixels")
        };
        assert_eq!((pixels.tolerance_px, pixels.views.len()), (0.5, 2));
        assert_eq!((pixels.views[1].width, pixels.views[0].height), (32, 48));
        assert_eq!(pixels.views[1].eye, [-3.0, 1.0, 0.0]);
    }

    #[test]
    fn what_belongs_to_a_tolerance_goes_with_the_default_too() {
        let Refinement::Tolerance(tolerance) = asked(&["--quality", "high", "--error-at", "texels"], true) else {
            panic!("a tolerance")
        };
        let (error_at, quality) = (v1::ErrorAt::Texels.into(), v1::Quality::High.into());
        assert_eq!((tolerance.error_at, tolerance.quality), (error_at, quality));
    }
}
