//! Triangles that are made anew for every frame.

use glam::{DMat4, DVec3};

use super::{
    images,
    judge::Rule,
    lab::Lab,
    row::{Asset, Row, curve},
};
use crate::{
    domain::{
        Error, ErrorKind, Result,
        cancel::NoProgress,
        image::{Lighting, RenderScene},
        plan::SurfacePlan,
        request::{Allowed, ErrorAt, Geometry, Quality, Refinement, Tolerance, ToleranceView},
        stability::{Curve, Worse},
        surface::Surface,
    },
    jobs::fits,
    oracle::{
        hausdorff::{self, Settings},
        metrics::{self, picture::Picture},
        sheet::Sheet,
    },
};

pub(super) const JUMPS: Row = Row {
    name: "pops",
    family: "view-dependent dicing pops",
    title: "Surfaces that jump when they are diced anew",
    story: "A tolerance in pixels asks for other triangles from every place of the camera. Each frame's are within the tolerance of the surface, \
            so two frames' are within twice the tolerance of each other, and the eye sees the jump. Triangles that are kept do not jump, but \
            are too coarse once the camera is near.",
    asset: Asset::OwnSurface,
    parameter: ["tolerance", "px"],
    metric: ["farthest jump from frame to frame", "px"],
    line: 1.0,
    worse: Worse::Upwards,
    literature: LITERATURE,
    run: jumps,
};

pub(super) const FLASHES: Row = Row {
    name: "pop-images",
    family: "view-dependent dicing pops",
    title: "Images that flash when surfaces are diced anew",
    story: "The same frames as images: each is drawn with its own triangles and with those of the frame before, from one camera, so that only the \
            pop differs. Normals jump with the triangles, and light shows it where positions hardly move: finer triangles flash more, not less, \
            until they are smaller than a pixel.",
    asset: Asset::OwnSurface,
    parameter: ["tolerance", "px"],
    metric: ["mean FLIP of a pop, worst frame", "0 to 1"],
    line: 0.02,
    worse: Worse::Downwards,
    literature: LITERATURE,
    run: flashes,
};

const LITERATURE: &[(&str, &str)] = &[
    ("diced anew", "pops unless triangles are below a pixel (Fisher et al. 2009; Karis 2026)"),
    (
        "kept from the first frame",
        "none; a dicing camera is frozen for that (Cook, Carpenter and Catmull 1987; Blender's manual)",
    ),
];
const TOLERANCES_PX: [f64; 4] = [0.5, 1.0, 2.0, 4.0];
const FRAMES: u32 = 4;
const SIDE: u32 = 128;
const FOV_DEGREES: f32 = 40.0;
/// By which the camera comes nearer from frame to frame.
const NEARER: f64 = 0.04;
const MOST_TRIANGLES: u64 = 20_000;
/// Pieces that are cut for a distance.
const MOST_CUTS: u64 = 20_000;
/// Of a pixel, how exactly jumps are measured.
const PRECISION_PX: f64 = 0.05;

struct Frame {
    view: ToleranceView,
    surface: Surface,
    /// Of the scene, which the camera looks at.
    middle: DVec3,
}

impl Frame {
    /// Face-on, at a place.
    fn pixels_per_unit(&self, place: DVec3) -> f64 {
        let eye = DVec3::from_array(self.view.eye.map(f64::from));
        let depth = (place - eye).dot((self.middle - eye).normalize());
        0.5 * f64::from(SIDE) / ((0.5 * f64::from(FOV_DEGREES)).to_radians().tan() * depth)
    }
}

fn jumps(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    swept(lab, &|before, frame| {
        let [a, b] = [before, frame].map(|frame| sheet(lab, &frame.surface));
        let settings = Settings { precision: PRECISION_PX / frame.pixels_per_unit(frame.middle), max_cuts: MOST_CUTS };
        let far = |a: &Sheet<'_>, b: &Sheet<'_>| {
            let found = hausdorff::directed(a, b, &settings, lab.context.cancel, &NoProgress)?;
            Ok::<_, Error>(found.map_or(0.0, |found| found.lo * frame.pixels_per_unit(found.at[0])))
        };
        Ok(far(&a, &b)?.max(far(&b, &a)?))
    })
}

fn flashes(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    swept(lab, &|before, frame| {
        let [a, b] = [before, frame].map(|shown| picture(lab, shown, &frame.view));
        Ok(metrics::compare(&a?, &b?, lab.context.cancel)?.0.flip_mean)
    })
}

/// The worst of all frames, of triangles that are made anew and of those of the first frame.
fn swept(lab: &Lab<'_>, pop: &dyn Fn(&Frame, &Frame) -> Result<f64>) -> Result<Vec<Curve>> {
    let base = lab.own.inputs.scene.meshes.first().map_or(0, |m| m.mesh.triangles.len() as u64);
    if base == 0 || base > MOST_TRIANGLES {
        let message = format!(
            "{base} triangles of the first mesh are diced again and again; at most {MOST_TRIANGLES} are: take a coarser mesh"
        );
        return Err(Error::new(ErrorKind::TooLarge, message));
    }
    let (mut anew, mut kept) = (Vec::new(), Vec::new());
    for tolerance_px in TOLERANCES_PX {
        let mut worst = 0.0;
        let mut before: Option<Frame> = None;
        for number in 0..FRAMES {
            let frame = frame(lab, number, tolerance_px)?;
            if let Some(before) = &before {
                worst = pop(before, &frame)?.max(worst);
            }
            before = Some(frame);
        }
        anew.push([tolerance_px, worst]);
        kept.push([tolerance_px, 0.0]);
    }
    Ok(vec![curve("diced anew", anew), curve("kept from the first frame", kept)])
}

fn frame(lab: &Lab<'_>, number: u32, tolerance_px: f64) -> Result<Frame> {
    let scene = &lab.own.inputs.scene;
    let [low, high] = scene.bounds.map(|p| DVec3::from_array(p.map(f64::from)));
    let (middle, radius) = (0.5 * (low + high), 0.5 * (high - low).length());
    let away = DVec3::new(0.9, 1.1, 1.2) * radius * (1.0 - NEARER * f64::from(number)) * 1.4;
    let [eye, target] = [middle + away, middle].map(|p| p.as_vec3().to_array());
    let view = ToleranceView { eye, target, yfov_degrees: FOV_DEGREES, width: SIDE, height: SIDE };
    let tolerance = Tolerance {
        allowed: Allowed::Pixels { tolerance_px, views: vec![view.clone()] },
        error_at: ErrorAt::Surface,
        quality: Quality::Normal,
    };
    let geometry = Geometry {
        refinement: Refinement::Tolerance(tolerance.clone()),
        max_triangles: Some(MOST_TRIANGLES),
        ..super::meshes::uniform(0)
    };
    let (plan, _) = SurfacePlan::within_tolerance(0, scene, &tolerance, &geometry, MOST_TRIANGLES)?;
    let surface = lab.planned(&scene.meshes[0].mesh, &lab.own.inputs.details[0], &plan)?;
    keeps(lab, (&plan, &surface), tolerance_px);
    Ok(Frame { view, surface, middle })
}

/// The proven bound is within what is asked, or the budget is told of.
fn keeps(lab: &Lab<'_>, (plan, surface): (&SurfacePlan, &Surface), tolerance_px: f64) {
    let told = fits::kept(plan, surface);
    let budget_reached = surface.fit.is_some_and(|fit| fit.budget_reached);
    let is_kept = |(kept, bound): (f64, f64)| {
        bound <= kept * (1.0 + 1e-9) && (kept <= tolerance_px * (1.0 + 1e-9) || budget_reached)
    };
    let fault = (!told.is_some_and(is_kept)).then(|| format!("{tolerance_px} px asked, {told:?} kept and proven"));
    lab.note(Rule::ToleranceKept, fault);
}

/// In the world, by the first node that shows it.
fn world(lab: &Lab<'_>) -> DMat4 {
    let shown = lab.own.inputs.scene.instances.iter().find(|instance| instance.mesh == 0);
    shown.map_or(DMat4::IDENTITY, crate::domain::scene::Instance::world)
}

fn sheet(lab: &Lab<'_>, surface: &Surface) -> Sheet<'static> {
    let world = world(lab);
    let placed = |p: &[f32; 3]| world.transform_point3(DVec3::from_array(p.map(f64::from)));
    Sheet::of_triangles(surface.positions.iter().map(placed).collect(), surface.triangles.clone())
}

fn picture(lab: &Lab<'_>, frame: &Frame, view: &ToleranceView) -> Result<Picture> {
    let camera = images::camera(view.eye, view.target, FOV_DEGREES, [SIDE; 2])?;
    let mesh = &lab.own.inputs.scene.meshes[0].mesh;
    let mut scene = images::scene(vec![images::shown(mesh, &frame.surface)], camera);
    scene.instances[0].world_from_mesh = world(lab).as_mat4().to_cols_array();
    scene.materials[0].unlit = false;
    scene = RenderScene { lighting: Lighting::default(), ..scene };
    Picture::of_images("frame", &lab.shot(&scene, [SIDE; 2])?)
}
