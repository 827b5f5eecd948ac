//! What the demo shows: command lines, and the words around them.

/// One heading of the page.
pub(super) struct Scene {
    pub(super) title: &'static str,
    /// What to look for.
    pub(super) text: &'static str,
    /// As typed in the demo's folder.
    pub(super) commands: &'static [&'static str],
}

/// Words of a command that end so are files of the demo's folder, and its own folders.
pub(super) const FILE_ENDINGS: [&str; 7] = [".glb", ".gltf", ".png", ".jpg", ".exr", ".hdr", "/"];

/// What it ends with.
pub(super) const CHART: Scene = Scene {
    title: "Speed against accuracy",
    text: "Every method and setting on the same rock, each against the surface itself: what it takes, and how far off it is. \
           Small, and run once: `displace chart` measures your own mesh, maps and camera.",
    commands: &[
        "displace chart input/ground.glb --height input/rock_height.png --scale 0.2 --orbit 35,35,1.9 --light 1,0.9,-0.4 --size 128x128 --repeats 1 --truth-samples 16 -o chart/",
    ],
};

pub(super) const SCENES: [Scene; 4] = [
    Scene {
        title: "Rock",
        text: "A plane of 128 triangles, its colours alone and with the 16-bit height map that belongs to them. \
               Light and silhouette follow the displaced surface.",
        commands: &[
            "displace render input/ground.glb --base-color input/rock_color.jpg --orbit 35,30,3.2 --light 1,0.9,-0.4 --ambient 0.4 --size 960x600 -o rock-flat.png",
            "displace render input/ground.glb --height input/rock_height.png --scale 0.3 --base-color input/rock_color.jpg --uniform 6 --orbit 35,30,3.2 --light 1,0.9,-0.4 --ambient 0.4 --size 960x600 -o rock.png",
            "displace apply input/ground.glb --height input/rock_height.png --scale 0.3 --base-color input/rock_color.jpg --uniform 6 -o rock.glb",
        ],
    },
    Scene {
        title: "Suzanne",
        text: "Detail without a map or texture coordinates: an expression over the position. Hard edges and seams of \
               the texture stay closed.",
        commands: &[
            "displace render input/Suzanne.gltf --orbit 25,8,3.9 --ambient 0.3 --size 960x720 -o suzanne-flat.png",
            "displace render input/Suzanne.gltf --expr '0.012*sin(70*y)*cos(20*x)' --uniform 3 --orbit 25,8,3.9 --ambient 0.3 --size 960x720 -o suzanne.png",
            "displace apply input/Suzanne.gltf --expr '0.012*sin(70*y)*cos(20*x)' --uniform 3 -o suzanne.glb",
        ],
    },
    Scene {
        title: "Torus",
        text: "A height map across texture seams in both directions. The two sides of a seam are reconciled, so there \
               is no crack to see.",
        commands: &[
            "displace render input/torus.glb --height input/abstract_height.png --scale 0.1 --uniform 4 --orbit 20,38,4.4 --ambient 0.25 --size 960x720 -o torus.png",
            "displace apply input/torus.glb --height input/abstract_height.png --scale 0.1 --uniform 3 -o torus.glb",
        ],
    },
    Scene {
        title: "Scales",
        text: "Vector displacement: every point moves in all three directions, so scales lean over their neighbours, \
               which no height map can do. Beside the image, its normals.",
        commands: &[
            "displace render input/sphere.glb --vector input/scales_vector.exr --scale 0.14 --uniform 5 --aov normal --orbit 20,20,4.2 --ambient 0.25 --size 960x720 -o scales.png",
            "displace apply input/sphere.glb --vector input/scales_vector.exr --scale 0.14 --uniform 4 -o scales.glb",
        ],
    },
];
