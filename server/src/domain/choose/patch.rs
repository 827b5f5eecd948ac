//! A part of a base triangle as one view sees it: what a height does to it on the screen.
//!
//! All lengths are mesh-local. With r(q) = (x, y, w) . (q, 1) of the rows of `pixel_from_local`, a point q + d is projected
//! M d w(q) / w(q + d) pixels from q, M d = (x . d - p_x w . d, y . d - p_y w . d), where p is the pixel of q: M is the same for
//! all points of one ray. Over a patch what is bounded is a rational Bézier triangle: it lies in the hull of its control points.

use glam::{DMat2, DVec2, DVec3, DVec4};

use super::facts::Window;

/// A part of a base triangle, and how it is seen.
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    pub corners: [DVec3; 3],
    /// Blends of the base triangle's unit normals, as long as blending leaves them. Shading has their direction.
    pub normals: [DVec3; 3],
    /// Blends of the welded directions of its corners. Heights go along them divided by the length of the blended normal.
    pub directions: [DVec3; 3],
    /// Where the corners lie on the height map, texels of the finest level.
    pub texels: [DVec2; 3],
    pub base: BaseTriangle,
    /// From where the chart that it is on ends, at least.
    pub seam_distance: f64,
    /// Whether it is at a side of its triangle that is open, or has one across that is seen from behind.
    pub is_rim: bool,
}

/// What a patch needs to know of the whole triangle and of what is around it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BaseTriangle {
    /// Of its corners on the map, texels.
    pub texels: [DVec2; 3],
    /// Around them.
    pub window: Window,
    /// Of its sides.
    pub longest_side: f64,
    /// How much the direction of heights changes for each unit of length, at most, in it and in what is near it.
    pub direction_rate: f64,
    /// How far what is near it leaves its plane, or lies elsewhere on the map than it would, for each unit of length.
    pub bend_rate: f64,
}

/// How an instance of a mesh is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Rows x, y and w of what takes mesh-local points to pixels.
    pub pixel_from_local: [DVec4; 3],
    /// Mesh-local: the eye and 1, or the direction to it and 0 of a view without perspective.
    pub eye: DVec4,
    pub size_px: DVec2,
    /// Least w of what is seen.
    pub near: f64,
}

/// A patch as a view sees it; all bounds hold for any place of it.
#[derive(Clone, Debug)]
pub struct PatchView {
    pub patch: Patch,
    /// Of the patch on the map, texels.
    pub window: Window,
    /// On the screen, of the base.
    pub area_px: f64,
    /// Whether the base's front is seen; heights per pixel are shown on it alone.
    pub is_front: bool,
    /// Pixels times w that a height of 1 is long on the screen, along the direction of heights.
    pub rise: f64,
    /// The same along the shading normal.
    pub rise_of_normal: f64,
    /// Pixels times w that a length of 1 is at most, in any direction.
    pub rho: f64,
    /// Texels towards the viewer for each unit of height: a box.
    pub slope: Window,
    /// Of the angle between the ray and the normal; with skew normals, length along the triangle for each unit of height.
    pub tangent: f64,
    /// Least and greatest cosine of the angle between the ray and the normal.
    pub cosine: [f64; 2],
    /// How high the eye is above the base, along normals; infinite without perspective.
    pub eye_height: f64,
    /// Least w of the base.
    pub least_w: f64,
    /// How much w changes for each unit of height along directions.
    pub w_rise: [f64; 2],
    /// How much the direction of heights and the normal of the same place differ.
    pub mitre: f64,
    /// The longest that a direction of heights is.
    pub longest_direction: f64,
    /// How much longer than blended directions they are, where blended normals are short.
    pub stretch: f64,
    /// Most texels of the finest level along the shorter axis of a sample's footprint.
    pub texels_per_sample: f64,
    /// Most texels of the map for each unit of length.
    pub most_texels: f64,
    /// How much w changes at most for each unit of length.
    pub w_rate: f64,
    /// Pixels from the base's outline at least: what sticks out less leaves the outline as it is.
    pub outline_distance_px: f64,
}

const PAIRS: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]];
/// Samples of a pixel's side; each is marched by itself.
const SAMPLES_ACROSS: f64 = 2.0;
/// Of what rounding makes of the number of a level.
const LEVEL_MARGIN: f64 = 1.001;

impl Patch {
    /// In four, each like it.
    #[must_use]
    pub fn split(&self) -> [Self; 4] {
        let middles = [[0, 1], [1, 2], [2, 0]];
        let [p, n, d] =
            [&self.corners, &self.normals, &self.directions].map(|v| middles.map(|[i, j]| 0.5 * (v[i] + v[j])));
        let t = middles.map(|[i, j]| 0.5 * (self.texels[i] + self.texels[j]));
        // Of corners 0 to 2, and of the middles of the sides after them.
        [[0, 3, 5], [3, 1, 4], [5, 4, 2], [4, 5, 3]].map(|parts| Self {
            corners: parts.map(|k| if k < 3 { self.corners[k] } else { p[k - 3] }),
            normals: parts.map(|k| if k < 3 { self.normals[k] } else { n[k - 3] }),
            directions: parts.map(|k| if k < 3 { self.directions[k] } else { d[k - 3] }),
            texels: parts.map(|k| if k < 3 { self.texels[k] } else { t[k - 3] }),
            ..*self
        })
    }
}

impl View {
    /// x, y and w of M: what a vector adds, at a pixel.
    fn moved(&self, pixel: DVec2, vector: DVec3) -> DVec2 {
        let [x, y, w] = self.pixel_from_local.map(|row| row.truncate().dot(vector));
        DVec2::new(x, y) - pixel * w
    }

    #[must_use]
    pub fn w(&self, point: DVec3) -> f64 {
        self.pixel_from_local[2].dot(point.extend(1.0))
    }

    #[must_use]
    pub fn pixel(&self, point: DVec3) -> DVec2 {
        let [x, y, w] = self.pixel_from_local.map(|row| row.dot(point.extend(1.0)));
        DVec2::new(x, y) / w
    }

    /// Towards the eye, of any length, linear in the point.
    fn towards(&self, point: DVec3) -> DVec3 {
        self.eye.truncate() - point * self.eye.w
    }

    /// Largest singular value of M at a pixel.
    fn rho(&self, pixel: DVec2) -> f64 {
        let [x, y, w] = self.pixel_from_local.map(DVec4::truncate);
        let (a, b) = (x - w * pixel.x, y - w * pixel.y);
        let (half, apart) = (0.5 * (a.dot(a) + b.dot(b)), 0.5 * (a.dot(a) - b.dot(b)));
        (half + apart.hypot(a.dot(b))).sqrt()
    }
}

/// Linear over a triangle times linear: at control points.
fn net<T>(product: impl Fn(usize, usize) -> T) -> [T; 6]
where
    T: std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    PAIRS.map(|[i, j]| (product(i, j) + product(j, i)) * 0.5)
}

fn most(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(f64::NEG_INFINITY, f64::max)
}

fn least(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(f64::INFINITY, f64::min)
}

/// The shortest and the longest that what is blended of vectors gets.
fn lengths(vectors: [DVec3; 3]) -> [f64; 2] {
    let middle = vectors.iter().sum::<DVec3>() / 3.0;
    let unit = middle.normalize_or_zero();
    let shortest = least(vectors.map(|v| v.dot(unit)));
    [shortest, most(vectors.map(DVec3::length))]
}

/// What a patch is in its own plane.
struct Plane {
    front: DVec3,
    sides: [DVec3; 2],
    texel_edges: DMat2,
}

impl Plane {
    /// None where it has no area, in space or on the map.
    fn of(patch: &Patch) -> Option<Self> {
        let [a, b, c] = patch.corners;
        let sides = [b - a, c - a];
        let normal = sides[0].cross(sides[1]);
        let front = normal.try_normalize()?;
        let facing = patch.normals.iter().sum::<DVec3>().dot(front);
        let [p, q, r] = patch.texels;
        let texel_edges = DMat2::from_cols(q - p, r - p);
        let has_area = texel_edges.determinant() != 0.0;
        has_area.then_some(Self { front: if facing < 0.0 { -front } else { front }, sides, texel_edges })
    }

    /// Texels of a vector in the plane.
    fn texels(&self, vector: DVec3) -> DVec2 {
        let [a, b] = self.sides;
        let gram = DMat2::from_cols_array(&[a.dot(a), a.dot(b), a.dot(b), b.dot(b)]);
        self.texel_edges * (gram.inverse() * DVec2::new(a.dot(vector), b.dot(vector)))
    }

    /// The vectors in the plane that texels along u and along v are.
    fn texel_axes(&self) -> [DVec3; 2] {
        let from_texels = self.texel_edges.inverse();
        [from_texels.x_axis, from_texels.y_axis].map(|share| self.sides[0] * share.x + self.sides[1] * share.y)
    }
}

/// Singular values of two columns.
fn singular(a: DVec3, b: DVec3) -> [f64; 2] {
    let (half, apart) = (0.5 * (a.dot(a) + b.dot(b)), 0.5 * (a.dot(a) - b.dot(b)));
    let root = apart.hypot(a.dot(b));
    [(half - root).max(0.0).sqrt(), (half + root).sqrt()]
}

/// Pixels times w of the texel that is longest at pixel k, at least anywhere on the patch: along the way that it goes there
/// it changes linearly.
fn longest_texel(view: &View, axes: [DVec3; 2], pixels: [DVec2; 3], k: usize) -> f64 {
    let [x, y] = axes.map(|axis| view.moved(pixels[k], axis));
    // The texel direction of the greatest singular value.
    let angle = 0.5 * (2.0 * x.dot(y)).atan2(x.length_squared() - y.length_squared());
    let way = DVec2::from_angle(angle);
    let texel = axes[0] * way.x + axes[1] * way.y;
    let along = view.moved(pixels[k], texel).normalize_or_zero();
    least(pixels.map(|pixel| view.moved(pixel, texel).dot(along)))
}

impl PatchView {
    /// None of a patch that is not all before the viewer, or has no area in space or on the map.
    #[must_use]
    pub fn new(patch: Patch, view: &View) -> Option<Self> {
        let plane = Plane::of(&patch)?;
        let w = patch.corners.map(|corner| view.w(corner));
        if least(w) <= view.near.max(f64::MIN_POSITIVE) {
            return None;
        }
        let pixels = patch.corners.map(|corner| view.pixel(corner));
        let [shortest, longest] = lengths(patch.normals);
        let shortest = shortest.max(1e-3);
        let rise_of = |vectors: [DVec3; 3]| {
            let moved = |i: usize, j: usize| view.moved(pixels[i], vectors[j]) * w[i];
            let weights = net(|i, _| w[i]);
            most(net(moved).into_iter().zip(weights).map(|(m, w)| (m / w).length())) / shortest
        };
        let towards = patch.corners.map(|corner| view.towards(corner));
        let facing = towards[0].dot(plane.front);
        let upright = patch.normals.map(|n| n.dot(plane.front));
        let leaning = net(|i, j| towards[i] * upright[j] - patch.normals[j] * facing);
        let slopes = leaning.map(|g| plane.texels(g) / facing);
        let slope = Window::around(slopes.iter().flat_map(|s| [*s / shortest, *s / longest]));
        let along = net(|i, j| towards[i].dot(patch.normals[j]));
        let far = lengths(towards);
        let w_row = view.pixel_from_local[2].truncate();
        let w_of = patch.directions.map(|d| w_row.dot(d));
        let w_ends = w_of.into_iter().flat_map(|w| [w / shortest, w / longest]);
        let axes = plane.texel_axes();
        let texel_px = (0..3).map(|k| longest_texel(view, axes, pixels, k)).fold(f64::MIN_POSITIVE, f64::max);
        let mitre = most((0..3).map(|k| (patch.directions[k] - patch.normals[k]).length())) / shortest;
        let area = (pixels[1] - pixels[0]).perp_dot(pixels[2] - pixels[0]).abs() / 2.0;
        Some(Self {
            window: Window::around(patch.texels),
            area_px: area,
            is_front: facing > 0.0,
            rise: rise_of(patch.directions),
            rise_of_normal: rise_of(patch.normals),
            rho: most(pixels.map(|pixel| view.rho(pixel))),
            slope,
            tangent: most(leaning.map(DVec3::length)) / (facing.abs() * shortest),
            cosine: [
                (least(along) / (far[1] * longest)).clamp(0.0, 1.0),
                (most(along) / (far[0].max(1e-9 * far[1]) * shortest)).clamp(0.0, 1.0),
            ],
            eye_height: if view.eye.w == 0.0 { f64::INFINITY } else { facing / (most(upright) / shortest).min(1.0) },
            least_w: least(w),
            w_rise: [least(w_ends.clone()), most(w_ends)],
            mitre,
            longest_direction: most(patch.directions.map(DVec3::length)) / shortest,
            stretch: most(patch.directions.map(DVec3::length)) * (1.0 / shortest - 1.0),
            texels_per_sample: LEVEL_MARGIN * most(w) / texel_px / SAMPLES_ACROSS,
            most_texels: 1.0 / singular(axes[0], axes[1])[0],
            w_rate: w_row.length(),
            outline_distance_px: 0.0,
            patch,
        })
    }

    /// Which level of so many is marched at most.
    #[must_use]
    pub fn level(&self, count: usize) -> usize {
        (self.texels_per_sample.max(1.0).log2().floor() as usize).min(count - 1)
    }
}
