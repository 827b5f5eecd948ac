//! CySlice's page: the heads, and the tangents as arrows.

use super::{Picture, Section, Source, figures, picture, render, row};

const PATCH: &str = "--size 288x216 --eye 0,2.6,1.1 --look-at 0,0,0.05 --fov 42 --light 0,-1,0 --ambient 0.9 --base-color stripes.png --filter anisotropic";
const HEADS: &str = "python3 tests/gallery/draw_corpus.py DISPLACE CORPUS heads/...";

pub(super) fn section() -> Section {
    figures(
        "cyslice",
        "CySlice: displacement and a normal map together",
        "A coarse displacement map for the outline and a fine normal map for the light, on one head. The head is another one than theirs, \
         from a corpus that is not in the repository; the full set, with figures, is on the other page.",
        vec![
            row(
                "One head",
                "The base is a scan of 17 684 triangles. Look at the outline of brow and nose, and at brows and pores.",
                [
                    head("heads/base.png", "The base, smooth."),
                    head(
                        "heads/displacement.png",
                        "256 x 256 heights of 16 bits: the outline is right, the skin is soft.",
                    ),
                    head(
                        "heads/normal-map.png",
                        "1024 x 1024 normals of 8 bits: skin and hairs, on the base's smooth outline.",
                    ),
                    head("heads/both.png", "Both: the outline of the one, the surface of the other."),
                    head("heads/fine.png", "What both stand for: all 1024 x 1024 heights, displaced."),
                ],
            ),
            row(
                "Which way is S?",
                "Darts along what is taken for the S tangent, on stripes of s and t. Red stripes run along s; the right half of the patch is mirrored. \
                 The page holds the third for the right one; it lacks a sign.",
                [
                    arrows("normal", "N stands up from the patch."),
                    arrows("dpdu", "`dPdu` follows the patch's own grid, and the texture nowhere."),
                    arrows("deriv", "`Deriv(P,s)` follows neither: it adds one over the slopes of s both ways."),
                    arrows("printed", "`dPdu * Dv(t) - dPdv * Du(t)` follows red, but backwards on the mirrored half."),
                    arrows(
                        "right",
                        "With the sign of `Du(s) * Dv(t) - Dv(s) * Du(t)`: along red, towards rising s, on both halves.",
                    ),
                ],
            ),
        ],
    )
}

fn head(file: &'static str, note: &str) -> Picture {
    picture(file, Source::Kept { file, command: HEADS }, note)
}

fn arrows(kind: &str, note: &str) -> Picture {
    render(&format!("cyslice/{kind}"), format!("arrows-{kind}.glb {PATCH}"), note)
}
