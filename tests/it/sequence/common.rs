//! Two tessellations cut by one another: every invariant holds, and what is between them is between them everywhere.

use std::sync::{Arc, OnceLock};

use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress},
        detail::Detail,
        mesh::Mesh,
        plan::TessellationPlan,
        request::{Allowed, ErrorAt, Geometry, Quality, Refinement, Tolerance},
        surface::{Common, Surface},
    },
    oracle::{
        invariants,
        sampled_error::{Sampled, lattice},
        surface as oracle,
    },
    render::JobContext,
};
use displace_tests::{
    device,
    meshes::{self, TestMesh},
    surfaces::{detail, expression, noise_height, tolerance_plan, uniform},
};
use glam::{DMat3, DVec3};

/// Of the mesh's own units.
const TOLERANCES: [f64; 2] = [0.03, 0.015];
/// f32 positions of meshes of extent 2.
const ROUNDING: f64 = 4.0 / (1 << 24) as f64;

struct Pair {
    name: &'static str,
    mesh: Mesh,
    detail: Arc<Detail>,
    surfaces: [Surface; 2],
}

impl Pair {
    fn new(mesh: &TestMesh, detail: Arc<Detail>) -> Self {
        let (name, mesh) = (mesh.name, mesh.to_mesh());
        let surfaces = TOLERANCES.map(|world| within(&mesh, &detail, world));
        Self { name, mesh, detail, surfaces }
    }

    fn both(&self) -> [&Surface; 2] {
        self.surfaces.each_ref()
    }

    fn common(&self) -> Common {
        Common::new(&self.mesh, self.both())
    }
}

fn within(mesh: &Mesh, detail: &Arc<Detail>, world: f64) -> Surface {
    let tolerance = Tolerance { allowed: Allowed::World(world), error_at: ErrorAt::Surface, quality: Quality::Normal };
    let geometry = Geometry { refinement: Refinement::Tolerance(tolerance.clone()), ..uniform(0) };
    let mut plan = tolerance_plan(mesh, &tolerance, &geometry);
    if let TessellationPlan::Tolerance(tolerance) = &mut plan.tessellation {
        tolerance.spans_base = false;
    }
    let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
    let details = vec![Some(Arc::clone(detail)); mesh.primitives.len()];
    device::reference().displace(&job, &plan, mesh, &details).expect("it is made").0
}

fn pairs() -> &'static [Pair] {
    static PAIRS: OnceLock<Vec<Pair>> = OnceLock::new();
    PAIRS.get_or_init(|| {
        let waves = detail(expression("0.06*sin(5*pi*u)*cos(3*pi*v)"), 1.0);
        let noise = |size| detail(noise_height(size, 5), 0.15);
        vec![
            Pair::new(&meshes::plane(1), waves),
            Pair::new(&meshes::torus(8, 6), noise(16)),
            Pair::new(&meshes::cube(), noise(8)),
        ]
    })
}

/// Where a surface has a place of base triangle `t`, by trying all of its triangles there.
fn position(mesh: &Mesh, surface: &Surface, t: usize, at: DVec3) -> DVec3 {
    let own = &surface.triangles[surface.triangles_of(t)];
    let weights_of = |ids: &[u32; 3]| {
        let corner = |id: u32| {
            let units = surface.layout.place(mesh, id as usize).within(mesh, t).expect("it is of the base triangle");
            DVec3::from_array(units.map(f64::from)) / f64::from(1u32 << 24)
        };
        let [a, b, c] = ids.map(corner);
        DMat3::from_cols(a, b, c).inverse() * at
    };
    let tried = own.iter().map(|ids| (ids, weights_of(ids)));
    let (ids, weights) = tried.max_by(|a, b| a.1.min_element().total_cmp(&b.1.min_element())).expect("triangles");
    let place = |k: usize| DVec3::from_array(surface.positions[ids[k] as usize].map(f64::from));
    weights.x * place(0) + weights.y * place(1) + weights.z * place(2)
}

#[test]
fn what_is_between_two_tessellations_keeps_every_invariant_of_a_surface() {
    for pair in pairs() {
        let common = pair.common();
        for share in [0.0, 0.25, 0.7, 1.0] {
            let between = common.between(&pair.mesh, pair.both(), share);
            // Parts are named by whole units, which may take the area from a sliver of them.
            let broken: Vec<String> = invariants::of_surface(&pair.mesh, &between)
                .into_iter()
                .filter(|broken| !broken.rule.starts_with("partition"))
                .map(|broken| broken.to_string())
                .collect();
            assert!(broken.is_empty(), "{} at {share}: {broken:?}", pair.name);
        }
        let counts = pair.surfaces.each_ref().map(|surface| surface.triangles.len());
        assert!(common.triangles() > counts[1] && counts[1] > counts[0], "{}: {counts:?}", pair.name);
    }
}

#[test]
fn every_place_is_the_share_of_the_way_from_one_to_the_other() {
    for pair in pairs() {
        let (common, mesh) = (pair.common(), &pair.mesh);
        for share in [0.0, 0.4, 1.0] {
            let between = common.between(mesh, pair.both(), share);
            let places = [DVec3::new(0.31, 0.42, 0.27), DVec3::new(0.07, 0.11, 0.82), DVec3::new(0.5, 0.25, 0.25)];
            for t in 0..mesh.triangles.len() {
                for at in places {
                    let [a, b] = pair.both().map(|surface| position(mesh, surface, t, at));
                    let apart = position(mesh, &between, t, at).distance(a.lerp(b, share));
                    assert!(apart < ROUNDING, "{} triangle {t} at {at}: {apart:e}", pair.name);
                }
            }
        }
    }
}

#[test]
fn what_is_between_two_that_keep_a_tolerance_keeps_it() {
    for pair in pairs() {
        let common = pair.common();
        let details = vec![Some(Arc::clone(&pair.detail)); pair.mesh.primitives.len()];
        let truth = oracle::Surface::new(&pair.mesh, &details, oracle::SeamChoice::from(&uniform(0)));
        for share in [0.25, 0.5, 0.75] {
            let between = common.between(&pair.mesh, pair.both(), share);
            let position = |vertex: u32| DVec3::from_array(between.positions[vertex as usize].map(f64::from));
            let [a, b] = pair.surfaces.each_ref().map(|surface| surface.fit.expect("of a tolerance").bound_local);
            let allowed = share * b + (1.0 - share) * a;
            let sampled = Sampled { truth: &truth, surface: &between, position: &position, allowed: &|_| allowed };
            let all: Vec<usize> = (0..between.triangles.len()).collect();
            let shares = sampled.shares(&all, |_| lattice(4), &Cancel::default()).expect("nobody cancels");
            let worst = shares.into_iter().fold(0.0, f64::max);
            assert!(worst <= 1.0 && worst > 0.3, "{} at {share}: {worst} of what is allowed", pair.name);
        }
    }
}

#[test]
fn a_tessellation_and_itself_have_all_of_its_triangles_in_common() {
    for pair in pairs() {
        let [coarse, _] = pair.both();
        let common = Common::new(&pair.mesh, [coarse, coarse]);
        let same = common.between(&pair.mesh, [coarse, coarse], 0.5);
        assert_eq!(
            (same.triangles.len(), &same.positions),
            (coarse.triangles.len(), &coarse.positions),
            "{}",
            pair.name
        );
        assert_eq!(same.attributes, coarse.attributes);
    }
}
