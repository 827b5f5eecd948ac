//! MikkTSpace tangents (Mikkelsen 2008) of meshes of any size.
//!
//! They are the true dP/du, right on mirrored UVs (handedness in w), and triangles without UV area borrow
//! from their neighbours. The tangents at a vertex follow from the triangles around it alone, so lots of
//! triangles go through the generator in parallel, each with the triangles that touch it: the same bits as
//! all at once, in linear time. Only a triangle without UV area between two mirrored sheets may side with
//! either.

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use rayon::prelude::*;

use super::tangents::repaired_tangent;
use crate::domain::{Error, ErrorKind, Result, mesh::Csr};

/// Triangles around one vertex that the generator handles in seconds: its time grows with the square.
const LARGEST_FAN: usize = 8192;
/// From here the generator, which walks a fan by recursion, gets a stack of its own.
const DEEP_FAN: usize = 256;
const STACK_BYTES: usize = 4096 * LARGEST_FAN;
/// Triangles of a lot: its surroundings are small beside it, and many lots keep all cores busy.
const LOT: usize = 4096;
/// Triangles of a lot with its surroundings, several times what a sensible mesh in random order has.
const MOST_AROUND: usize = 64 * LOT;

/// Tangents as glTF wants them, one per corner, in the order of `triangles`. Corners are named by vertex;
/// vertices of equal position, normal and UV count as one. A corner with no usable UVs around gets some
/// direction across its normal. Fails with `TooLarge` where too many triangles meet in one vertex.
pub fn mikk_tangents(
    triangles: &[[u32; 3]],
    position: impl Fn(u32) -> [f32; 3] + Sync,
    normal: impl Fn(u32) -> [f32; 3] + Sync,
    uv: impl Fn(u32) -> [f32; 2] + Sync,
) -> Result<Vec<[f32; 4]>> {
    in_lots(&Vertices { triangles, position, normal, uv }, LOT)
}

fn in_lots<P, N, U>(vertices: &Vertices<'_, P, N, U>, lot: usize) -> Result<Vec<[f32; 4]>>
where
    P: Fn(u32) -> [f32; 3] + Sync,
    N: Fn(u32) -> [f32; 3] + Sync,
    U: Fn(u32) -> [f32; 2] + Sync,
{
    let fans = Fans::new(vertices);
    let largest = fans.largest();
    if largest > LARGEST_FAN {
        let message = format!(
            "{largest} triangles meet in one vertex; tangents are made for at most {LARGEST_FAN}: split the fan"
        );
        return Err(Error::too_large("TANGENT", message));
    }
    let mut tangents = vec![[0.0; 4]; vertices.triangles.len() * 3];
    tangents.par_chunks_mut(3 * lot).enumerate().try_for_each(|(k, out)| {
        let first = k * lot;
        let own = first..first + out.len() / 3;
        let (around, deepest) = fans.around(&own);
        if around.len() > MOST_AROUND {
            let message = format!(
                "{} triangles touch a run of {}; tangents are made where at most {MOST_AROUND} do: weld less, or sort the triangles",
                around.len(),
                own.len()
            );
            return Err(Error::too_large("TANGENT", message));
        }
        let corners = Corners { vertices, around, first: first as u32, out };
        if deepest < DEEP_FAN { generate(corners) } else { on_a_deep_stack(corners) }
    })?;
    Ok(tangents)
}

fn generate<P, N, U>(mut corners: Corners<'_, P, N, U>) -> Result<()>
where
    P: Fn(u32) -> [f32; 3],
    N: Fn(u32) -> [f32; 3],
    U: Fn(u32) -> [f32; 2],
{
    generate_tangents(&mut corners)
        .map_err(|error| Error::internal("tangents could not be made").with_cause(error.to_string()))
}

fn on_a_deep_stack<P, N, U>(corners: Corners<'_, P, N, U>) -> Result<()>
where
    P: Fn(u32) -> [f32; 3] + Sync,
    N: Fn(u32) -> [f32; 3] + Sync,
    U: Fn(u32) -> [f32; 2] + Sync,
{
    std::thread::scope(|scope| {
        let builder = std::thread::Builder::new().name("mikktspace".into()).stack_size(STACK_BYTES);
        let thread = builder.spawn_scoped(scope, || generate(corners)).map_err(|cause| {
            Error::new(ErrorKind::TooLarge, "no memory for the stack of the tangent generator").with_cause(cause)
        })?;
        thread.join().unwrap_or_else(|_| Err(Error::internal("the tangent generator failed")))
    })
}

struct Vertices<'a, P, N, U> {
    triangles: &'a [[u32; 3]],
    position: P,
    normal: N,
    uv: U,
}

/// The triangles around each vertex, vertices of equal value being one.
struct Fans {
    /// The fan of each corner.
    of_corner: Vec<[u32; 3]>,
    triangles: Csr,
}

impl Fans {
    fn new<P, N, U>(vertices: &Vertices<'_, P, N, U>) -> Self
    where
        P: Fn(u32) -> [f32; 3] + Sync,
        N: Fn(u32) -> [f32; 3] + Sync,
        U: Fn(u32) -> [f32; 2] + Sync,
    {
        let count = vertices.triangles.as_flattened().iter().max().map_or(0, |&v| v + 1);
        let key = |v: u32| {
            let ([px, py, pz], [nx, ny, nz], [u, v]) = ((vertices.position)(v), (vertices.normal)(v), (vertices.uv)(v));
            [px, py, pz, nx, ny, nz, u, v].map(f32::to_bits)
        };
        let mut order: Vec<([u32; 8], u32)> = (0..count).into_par_iter().map(|v| (key(v), v)).collect();
        order.par_sort_unstable();
        let mut fan = vec![0; count as usize];
        let mut fans = 0;
        for (i, (key, v)) in order.iter().enumerate() {
            fans += u32::from(i > 0 && order[i - 1].0 != *key);
            fan[*v as usize] = fans;
        }
        let of_corner: Vec<[u32; 3]> = vertices.triangles.par_iter().map(|t| t.map(|v| fan[v as usize])).collect();
        let pairs: Vec<(u32, u32)> =
            of_corner.iter().enumerate().flat_map(|(t, fans)| fans.map(|fan| (fan, t as u32))).collect();
        let lists = if count == 0 { 0 } else { fans as usize + 1 };
        Self { triangles: Csr::from_pairs(lists, &pairs), of_corner }
    }

    fn largest(&self) -> usize {
        self.triangles.offsets.windows(2).map(|pair| pair[1] - pair[0]).max().unwrap_or(0) as usize
    }

    /// All triangles that share a vertex with the triangles `own`, ascending, and the largest fan among them.
    fn around(&self, own: &std::ops::Range<usize>) -> (Vec<u32>, usize) {
        let mut fans = self.of_corner[own.clone()].as_flattened().to_vec();
        fans.sort_unstable();
        fans.dedup();
        let lists = fans.iter().map(|&fan| self.triangles.list(fan as usize));
        let mut around: Vec<u32> = lists.flatten().copied().collect();
        around.sort_unstable();
        around.dedup();
        let sizes =
            around.iter().flat_map(|&t| self.of_corner[t as usize]).map(|fan| self.triangles.list(fan as usize).len());
        let deepest = sizes.max().unwrap_or(0);
        (around, deepest)
    }
}

/// One lot and its surroundings, as the generator reads them.
struct Corners<'a, P, N, U> {
    vertices: &'a Vertices<'a, P, N, U>,
    around: Vec<u32>,
    /// First triangle of the lot, whose corners `out` holds.
    first: u32,
    out: &'a mut [[f32; 4]],
}

impl<P, N, U> Corners<'_, P, N, U> {
    fn vertex(&self, face: usize, corner: usize) -> u32 {
        self.vertices.triangles[self.around[face] as usize][corner]
    }
}

impl<P, N, U> Geometry for Corners<'_, P, N, U>
where
    P: Fn(u32) -> [f32; 3],
    N: Fn(u32) -> [f32; 3],
    U: Fn(u32) -> [f32; 2],
{
    fn num_faces(&self) -> usize {
        self.around.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        (self.vertices.position)(self.vertex(face, corner))
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        (self.vertices.normal)(self.vertex(face, corner))
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        (self.vertices.uv)(self.vertex(face, corner))
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let normal = self.normal(face, corner);
        let own = self.around[face].checked_sub(self.first).map(|t| t as usize * 3 + corner);
        if let Some(tangent) = own.and_then(|place| self.out.get_mut(place)) {
            let [x, y, z, w] = space.map_or([0.0, 0.0, 0.0, 1.0], |space| space.tangent_encoded());
            // glTF's v runs down the image and its bitangent up, so the handedness is the other one.
            *tangent = repaired_tangent([x, y, z, -w], normal);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Vertices on a bent grid with mirrored UVs beyond the middle, some of them doubled.
    fn in_lots_of(lot: usize, triangles: &[[u32; 3]]) -> Vec<[f32; 4]> {
        let place = |v: u32| [(v % 5) as f32, (v / 5 % 5) as f32];
        let vertices = Vertices {
            triangles,
            position: |v| [place(v)[0], place(v)[1], place(v)[0] * place(v)[1] * 0.3],
            normal: |v| glam::Vec3::new(place(v)[1] * -0.3, place(v)[0] * -0.3, 1.0).normalize().to_array(),
            uv: |v| [(place(v)[0] - 2.0).abs() + 0.1 * place(v)[1], place(v)[1] * 0.7],
        };
        in_lots(&vertices, lot).unwrap()
    }

    fn has_area([a, b, c]: [u32; 3]) -> bool {
        let uv = |v: u32| [((v % 5) as f32 - 2.0).abs() + 0.1 * (v / 5 % 5) as f32, (v / 5 % 5) as f32 * 0.7];
        let ([ax, ay], [bx, by], [cx, cy]) = (uv(a), uv(b), uv(c));
        ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)).abs() > 1e-3
    }

    proptest! {
        /// Whatever the connection: sheets, folds, fans, edges of many triangles.
        #[test]
        fn lots_give_the_bits_of_the_whole(faces in prop::collection::vec(prop::array::uniform3(0u32..50), 1..120), lot in 1usize..9) {
            let faces: Vec<[u32; 3]> = faces.into_iter().filter(|&f| has_area(f)).collect();
            let bits = |tangents: Vec<[f32; 4]>| tangents.into_iter().map(|t| t.map(f32::to_bits)).collect::<Vec<_>>();
            prop_assert_eq!(bits(in_lots_of(lot, &faces)), bits(in_lots_of(usize::MAX / 3, &faces)));
        }
    }
}
