//! A viewer's part: triangles with their normals, tangents and coordinates, and the map of their material.

use std::sync::Arc;

use displace_server::{
    domain::{
        detail::Detail,
        gltf::{Limits, load},
        mesh::Mesh,
    },
    oracle::surface::{SeamChoice, Surface},
};
use displace_tests::surfaces::uniform;
use glam::{DVec2, DVec3, Vec3, Vec4};
use rand::{RngExt as _, SeedableRng as _, rngs::StdRng};
use serde_json::Value;

const SAMPLES: usize = 3000;

/// Mesh `level` of a file, of one primitive.
pub(super) struct Reader {
    mesh: Mesh,
    map: image::RgbImage,
}

pub(super) fn split(bytes: &[u8]) -> (Value, Vec<u8>) {
    let glb = gltf::Glb::from_slice(bytes).expect("a GLB");
    (serde_json::from_slice(&glb.json).expect("JSON"), glb.bin.unwrap_or_default().into_owned())
}

pub(super) fn document(bytes: &[u8]) -> Value {
    split(bytes).0
}

/// Of rising values.
pub(super) fn quantile(rising: &[f64], share: f64) -> f64 {
    rising[(share * (rising.len() - 1) as f64) as usize]
}

impl Reader {
    pub(super) fn open(bytes: &[u8], level: usize) -> Self {
        let scene = load(&bytes.to_vec().into(), &|_| None, &Limits::default()).expect("the result loads");
        let mesh = scene.meshes[level].mesh.clone();
        let material = mesh.primitives[0].material.expect("a material");
        let texture = &scene.document["materials"][material]["normalTexture"];
        assert_eq!(texture["texCoord"], 0);
        let number = |value: &Value| value.as_u64().expect("a number") as usize;
        let image = number(&scene.document["textures"][number(&texture["index"])]["source"]);
        let bytes = scene.images[image].bytes.as_ref().expect("it is in the file");
        Self { mesh, map: image::load_from_memory(bytes).expect("a PNG").to_rgb8() }
    }

    /// Angles between the normals of the surface over `base` and those seen with the map, and without; rising.
    pub(super) fn angles_degrees(&self, base: &Mesh, detail: &Arc<Detail>) -> [Vec<f64>; 2] {
        let surface = Surface::new(base, &[Some(Arc::clone(detail))], SeamChoice::from(&uniform(0)));
        let mut random = StdRng::seed_from_u64(7);
        let largest = (0..self.mesh.triangles.len()).map(|triangle| self.area(triangle)).fold(0.0, f64::max);
        let mut angles = [Vec::new(), Vec::new()];
        while angles[0].len() < SAMPLES {
            let triangle = random.random_range(0..self.mesh.triangles.len());
            if self.area(triangle) < largest * random.random::<f64>() {
                continue;
            }
            let (root, t) = (random.random::<f64>().sqrt(), random.random::<f64>());
            let b = DVec3::new(1.0 - root, root * (1.0 - t), root * t);
            let uv = at(&self.mesh, triangle, b);
            let Some((t, place)) = find(base, uv) else { continue };
            let (_, normal) = surface.position_and_normal(t, place);
            let apart = |seen: DVec3| seen.cross(normal).length().atan2(seen.dot(normal)).to_degrees();
            angles[0].push(apart(self.seen(triangle, b, uv)));
            angles[1].push(apart(self.blend(triangle, b).0));
        }
        angles.iter_mut().for_each(|angles| angles.sort_by(f64::total_cmp));
        angles
    }

    fn area(&self, triangle: usize) -> f64 {
        let place = |av: u32| Vec3::from(self.mesh.gv_position[self.mesh.av_gv[av as usize] as usize]).as_dvec3();
        let [a, b, c] = self.mesh.triangles[triangle].av.map(place);
        (b - a).cross(c - a).length()
    }

    /// Normal and tangent, as interpolated.
    fn blend(&self, triangle: usize, b: DVec3) -> (DVec3, DVec3) {
        let (mut normal, mut tangent) = (DVec3::ZERO, DVec3::ZERO);
        for (k, av) in self.mesh.triangles[triangle].av.into_iter().enumerate() {
            normal += b[k] * Vec3::from(self.mesh.av_normal[av as usize]).as_dvec3();
            tangent += b[k] * Vec4::from(self.mesh.av_tangent[av as usize]).truncate().as_dvec3();
        }
        (normal, tangent)
    }

    fn seen(&self, triangle: usize, b: DVec3, uv: DVec2) -> DVec3 {
        let (normal, tangent) = self.blend(triangle, b);
        let handedness = f64::from(self.mesh.av_tangent[self.mesh.triangles[triangle].av[0] as usize][3]);
        let bitangent = handedness * normal.cross(tangent);
        let texel = self.texel(uv);
        (texel.x * tangent + texel.y * bitangent + texel.z * normal).normalize()
    }

    /// Bilinear, repeating.
    fn texel(&self, uv: DVec2) -> DVec3 {
        let size = DVec2::new(self.map.width().into(), self.map.height().into());
        let place = uv * size - 0.5;
        let mut sum = DVec3::ZERO;
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let corner = place.floor() + DVec2::new(dx, dy);
            let weight = (1.0 - (place - corner).abs()).element_product();
            let x = corner.x.rem_euclid(size.x) as u32;
            let pixel = self.map.get_pixel(x, corner.y.rem_euclid(size.y) as u32);
            sum += weight * DVec3::from_array(pixel.0.map(|v| f64::from(v) / 255.0 * 2.0 - 1.0));
        }
        sum
    }
}

fn uvs(mesh: &Mesh, triangle: usize) -> [DVec2; 3] {
    let values = &mesh.attribute("TEXCOORD_0").expect("it has UVs").values;
    mesh.triangles[triangle].av.map(|av| DVec2::new(values[2 * av as usize].into(), values[2 * av as usize + 1].into()))
}

fn at(mesh: &Mesh, triangle: usize, b: DVec3) -> DVec2 {
    let [p, q, r] = uvs(mesh, triangle);
    b.x * p + b.y * q + b.z * r
}

/// The triangle in which a place of the map lies, and its barycentrics there.
fn find(mesh: &Mesh, uv: DVec2) -> Option<(usize, DVec3)> {
    (0..mesh.triangles.len()).find_map(|triangle| {
        let [p, q, r] = uvs(mesh, triangle);
        let area = (q - p).perp_dot(r - p);
        let b = DVec3::new((q - uv).perp_dot(r - uv), (r - uv).perp_dot(p - uv), (p - uv).perp_dot(q - uv)) / area;
        (area != 0.0 && b.min_element() > 1e-9).then_some((triangle, b))
    })
}
