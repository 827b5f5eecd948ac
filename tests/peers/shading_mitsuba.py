"""Scenes of `shading_scenes.py` in Mitsuba 3. The module that imports this one has chosen a variant.

Mitsuba takes glTF's texture coordinates and rows as they are. Its normal maps have the bitangent cross(n, dP/du), right where
texture coordinates are not mirrored, with dP/du of the triangle, not smoothed. Its environment has -Z at u = 0, and its first
and last rows lie on the poles.
"""

import json
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

import shading_scenes

SAMPLES_PER_PASS = 64
# Towards it: that of blender_mesh.py.
SUN = (0.5, 0.8, 1.0)


def load(folder: Path, size: int, bsdf: str = "principled") -> mi.Scene:
    """`bsdf`: principled (Burley 2012), gltf (glTF 2.0 appendix B, from this file), or diffuse, which is under a sun."""
    camera = json.loads((folder / "camera.json").read_text())
    towards = [-x for x in SUN]
    sun = {"type": "directional", "direction": towards, "irradiance": {"type": "rgb", "value": np.pi}}
    light = sun if bsdf == "diffuse" else {"type": "envmap", "bitmap": mi.Bitmap(environment())}
    shape = mesh(folder, material(folder, bsdf))
    return mi.load_dict({"type": "scene", "sensor": sensor(camera, size), "light": light, "mesh": shape})


def environment() -> np.ndarray:
    width, height = shading_scenes.ENVIRONMENT_SIZE
    light = shading_scenes.environment(width, height + 1, rows_at_ends=True)
    return np.roll(light, -round(shading_scenes.FORWARD_U * width), axis=1)


def sensor(camera: dict, size: int) -> dict:
    eye, target = np.array(camera["eye"]), np.array(camera["target"])
    far = float(np.linalg.norm(eye - target))
    film = {"type": "hdrfilm", "width": size, "height": size, "pixel_format": "rgba", "component_format": "float32"}
    to_world = mi.ScalarTransform4f().look_at(eye.tolist(), target.tolist(), [0, 1, 0])
    view = {"fov": camera["yfov_degrees"], "fov_axis": "y", "near_clip": 1e-3 * far, "far_clip": 1e3 * far}
    return {"type": "perspective", "to_world": to_world, "film": film | {"rfilter": {"type": "box"}}, **view}


def material(folder: Path, bsdf: str) -> dict:
    surface = np.array(mi.Bitmap(str(folder / "metallic_roughness.png")))
    channels = {"roughness": bitmap(surface[..., 1:2]), "metallic": bitmap(surface[..., 2:3])}
    color = np.array(mi.Bitmap(str(folder / "base.png")))[..., :3]
    normal = np.array(mi.Bitmap(str(folder / "normal.png")))[..., :3]
    base = {"type": bsdf, "base_color": bitmap(color, raw=False), **channels}
    if bsdf == "principled":
        # 0.5 is a reflectance of 0.04.
        base |= {"specular": 0.5}
    if bsdf == "diffuse":
        base = {"type": bsdf, "reflectance": bitmap(color, raw=False)}
    mapped = {"type": "normalmap", "normalmap": bitmap(normal), "bsdf": base}
    return mapped | {"use_shadowing_function": False, "flip_invalid_normals": False}


def bitmap(values: np.ndarray, raw: bool = True) -> dict:
    # Texels are f32, not half floats.
    kept = {"raw": raw, "filter_type": "bilinear", "format": "variant"}
    return {"type": "bitmap", "bitmap": mi.Bitmap(np.ascontiguousarray(values)), **kept}


def mesh(folder: Path, bsdf: dict) -> mi.Mesh:
    given = np.load(folder / "mesh.npz")
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(bsdf)
    flags = {"has_vertex_normals": True, "has_vertex_texcoords": True}
    made = mi.Mesh("mesh", len(given["positions"]), len(given["triangles"]), props=properties, **flags)
    parameters = mi.traverse(made)
    parameters["vertex_positions"], parameters["vertex_normals"] = given["positions"].ravel(), given["normals"].ravel()
    parameters["vertex_texcoords"], parameters["faces"] = given["uvs"].ravel(), given["triangles"].astype(np.uint32).ravel()
    parameters.update()
    return made


def render(scene: mi.Scene, samples: int, shadows: bool = True, first_seed: int = 0) -> np.ndarray:
    """Linear colours over black and coverage, (H, W, 4): the environment's light reflected once."""
    kind = {"type": "path", "max_depth": 2} if shadows else {"type": "unshadowed"}
    integrator = mi.load_dict({**kind, "hide_emitters": True})
    # A pass keeps all of its samples in memory.
    passes = max(1, samples // SAMPLES_PER_PASS)
    done = [np.array(mi.render(scene, integrator=integrator, spp=samples // passes, seed=first_seed + k)) for k in range(passes)]
    return np.mean(done, axis=0, dtype=np.float64)


class Unshadowed(mi.SamplingIntegrator):
    """The environment's light reflected once, by multiple importance sampling (Veach 1997), whatever stands in its way."""

    def sample(self, scene, sampler, ray, medium=None, active=True):
        si = scene.ray_intersect(ray, active)
        hit = active & si.is_valid()
        sky, bsdf, context = scene.environment(), si.bsdf(ray), mi.BSDFContext()
        ds, radiance = sky.sample_direction(si, sampler.next_2d(hit), hit)
        wo = si.to_local(ds.d)
        value, pdf = bsdf.eval_pdf(context, si, wo, hit)
        light = dr.select(hit & (ds.pdf > 0), value * radiance * weight(ds.pdf, pdf), 0)
        sample, value = bsdf.sample(context, si, sampler.next_1d(hit), sampler.next_2d(hit), hit)
        towards = dr.zeros(mi.DirectionSample3f)
        towards.d = si.to_world(sample.wo)
        seen = dr.zeros(mi.SurfaceInteraction3f)
        seen.wi = -towards.d
        other = sky.pdf_direction(si, towards, hit)
        light += dr.select(hit & (sample.pdf > 0), value * sky.eval(seen, hit) * weight(sample.pdf, other), 0)
        return light, hit, []


def weight(pdf, other):
    return pdf / (pdf + other)


class GltfMaterial(mi.BSDF):
    """glTF 2.0, appendix B: GGX with the height-correlated masking, Schlick's reflectance, a diffuse base under it."""

    def __init__(self, properties):
        mi.BSDF.__init__(self, properties)
        self.textures = [properties[name] for name in ("base_color", "roughness", "metallic")]
        self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide]
        self.m_flags = self.m_components[0]

    def alpha(self, si, active):
        return dr.maximum(dr.square(self.textures[1].eval_1(si, active)), 1e-3)

    def eval_pdf(self, context, si, wo, active=True):
        base, metallic, alpha = self.textures[0].eval(si, active), self.textures[2].eval_1(si, active), self.alpha(si, active)
        cos_i, cos_o = mi.Frame3f.cos_theta(si.wi), mi.Frame3f.cos_theta(wo)
        active = active & (cos_i > 0) & (cos_o > 0)
        half = dr.normalize(si.wi + wo)
        distribution = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha)
        d = distribution.eval(half)
        root = lambda a, b: a * dr.sqrt(dr.square(alpha) + (1 - dr.square(alpha)) * dr.square(b))  # noqa: E731
        visibility = 0.5 / (root(cos_i, cos_o) + root(cos_o, cos_i))
        schlick = dr.power(1 - dr.abs(dr.dot(wo, half)), 5)
        dielectric, metal = 0.04 + 0.96 * schlick, base + (1 - base) * schlick
        matte = (1 - dielectric) * base / dr.pi + dielectric * visibility * d
        value = (matte + (metal * visibility * d - matte) * metallic) * cos_o
        pdf = 0.5 * mi.warp.square_to_cosine_hemisphere_pdf(wo) + 0.5 * distribution.pdf(si.wi, half) / (4 * dr.dot(wo, half))
        return dr.select(active, value, 0), dr.select(active, pdf, 0)

    def eval(self, context, si, wo, active=True):
        return self.eval_pdf(context, si, wo, active)[0]

    def pdf(self, context, si, wo, active=True):
        return self.eval_pdf(context, si, wo, active)[1]

    def sample(self, context, si, choice, place, active=True):
        facet = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, self.alpha(si, active)).sample(si.wi, place)[0]
        sample = dr.zeros(mi.BSDFSample3f)
        sample.wo = dr.select(choice < 0.5, mi.warp.square_to_cosine_hemisphere(place), mi.reflect(si.wi, facet))
        value, sample.pdf = self.eval_pdf(context, si, sample.wo, active)
        sample.eta, sample.sampled_type, sample.sampled_component = 1.0, mi.UInt32(+self.m_flags), 0
        return sample, dr.select(sample.pdf > 0, value / sample.pdf, 0)

    def traverse(self, callback):
        for name, texture in zip(("base_color", "roughness", "metallic"), self.textures):
            callback.put(name, texture, mi.ParamFlags.NonDifferentiable)


mi.register_integrator("unshadowed", Unshadowed)
mi.register_bsdf("gltf", GltfMaterial)
