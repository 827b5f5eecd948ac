//! Everson's lecture: spheres, the sphere map, the two directions of mapping.

use super::{Section, Source, figures, picture, render, row};

const BALL: &str = "ball.glb --size 288x240 --orbit -30,20,3.1 --light -0.6,1,0.8 --ambient 0.12";
const GLOBE: &str = "globe.glb --size 288x240 --orbit -30,20,3.1 --light -0.6,1,0.8 --ambient 0.12";
const MAPPING: &str = "cargo run -p displace-tests --example mapping -- OUT";

pub(super) fn section() -> Section {
    figures(
        "everson",
        "Everson: texture and bump mapping",
        "Richard Everson's slides of COM3404. What they call anti-aliasing, and the filters that do it, is on the other page.",
        vec![
            row(
                "Spheres",
                "Texture, opacity, reflection, and bumps.",
                [
                    render(
                        "everson/texture",
                        format!("{GLOBE} --base-color globe.png --filter ewa"),
                        "A map on a sphere: a net of 30 degrees, even on the map, narrow at the pole.",
                    ),
                    render(
                        "everson/opacity",
                        format!("{GLOBE} --base-color globe.png --opacity holed.png --alpha blend --filter ewa"),
                        "With a map of opacity: through the holes shows the inside of the far side.",
                    ),
                    render(
                        "everson/reflection",
                        "mirror.glb --size 288x240 --orbit -30,20,3.1 --env sky.hdr --shading pbr",
                        "A reflection map: sun, horizon and ground bend round the ball. There is one reflection; nothing shows itself.",
                    ),
                    render(
                        "everson/bump",
                        format!("{BALL} --expr '0.05*sin(30*x)*sin(30*y)*sin(30*z)' --method bump"),
                        "Bumps: his slide says `Silhouette of spheres is smooth!`, and it is.",
                    ),
                    render(
                        "everson/displaced",
                        format!("{BALL} --expr '0.05*sin(30*x)*sin(30*y)*sin(30*z)' --uniform 3"),
                        "The same, displaced: it is not.",
                    ),
                ],
            ),
            row(
                "Round a sphere",
                "u = phi / 2 pi, v = theta / pi. Each cell of the map has an F, columns differ in hue.",
                [
                    render(
                        "everson/sphere-map",
                        format!("{GLOBE} --base-color letters.png --projection sphere --filter ewa"),
                        "By `atan2`: letters read as they are, all around.",
                    ),
                    render(
                        "everson/sphere-pole",
                        "globe.glb --size 288x240 --orbit -30,75,3.1 --light -0.6,1,0.8 --ambient 0.12 --base-color letters.png --projection sphere --filter ewa",
                        "At the pole all columns meet, and nothing is noise.",
                    ),
                    picture("everson/map", Source::Map("letters.png"), "The map."),
                ],
            ),
            row(
                "Forward and inverse mapping",
                "A checker of 128 x 128 texels on a floor.",
                [
                    picture(
                        "everson/forward",
                        Source::Kept { file: "texture/forward.png", command: MAPPING },
                        "Forward: each texel to its pixel. Magenta was never hit, green more than once.",
                    ),
                    picture(
                        "everson/inverse",
                        Source::Kept { file: "texture/inverse.png", command: MAPPING },
                        "Inverse: each pixel looks its place up. No hole, no overlap.",
                    ),
                    picture(
                        "everson/preimage",
                        Source::Kept {
                            file: "texture/preimage-far.png",
                            command: "displace render floor.glb --preimage 160,112 ..., by draw.py",
                        },
                        "The pre-image of one pixel on the map: a long thin quadrangle, and the ellipse that weighs its texels.",
                    ),
                ],
            ),
        ],
    )
}
