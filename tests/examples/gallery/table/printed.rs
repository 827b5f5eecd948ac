//! What the three texts print wrong, beside what is right.

use super::{Section, figures, render, row};

const BALL: &str = "--size 288x240 --orbit -30,20,3.1 --light -0.6,1,0.8 --ambient 0.12";
const SINE: &str = "--expr '0.03*sin(2*pi*10*u)'";
const DOMES: &str = "domes.glb --size 288x216 --eye 0,2.5,0.9 --look-at 0,0,0 --fov 44 --light -1,0.6,-0.2 --ambient 0.08 --normal cyslice.png";
const TWO: &str = "--size 288x240 --light -0.6,1,0.8 --ambient 0.12 --uniform 4 --orbit -30,20,4 --direction random_rgb.png --magnitude random_grey.png --scale 0.5";

pub(super) fn section() -> Section {
    figures(
        "printed",
        "As printed, and right",
        "Formulas of the three texts as they stand in print, each beside the one that does what the text says. Left is right.",
        vec![
            row(
                "Everson: the equation of a sphere",
                "Printed: x = R sin(theta) cos(phi), y = R sin(theta) cos(phi), z = R cos(theta). The second cosine is to be a sine.",
                [
                    render(
                        "printed/sphere",
                        format!("globe.glb {BALL} --base-color globe.png --filter ewa"),
                        "y = R sin(theta) sin(phi): a sphere.",
                    ),
                    render(
                        "printed/sphere-as-printed",
                        "printed.glb --size 288x240 --orbit 30,10,4.2 --light 0.6,0.6,1 --ambient 0.12 --base-color globe.png --filter ewa",
                        "As printed all points lie in the plane x = y: a flat disc, 1.4 times as wide as the sphere, with half of the globe on either side.",
                    ),
                    render(
                        "printed/sphere-edge",
                        "printed.glb --size 288x240 --orbit -41,10,4.2 --light 0.6,0.6,1 --ambient 0.3 --base-color globe.png --filter ewa",
                        "The disc from its edge.",
                    ),
                ],
            ),
            row(
                "Everson: u of a place on the sphere",
                "Printed: u = arccos(x / (R sin(pi v))) / 2 pi. An arc cosine covers half a turn.",
                [
                    render(
                        "printed/u",
                        format!("globe.glb {BALL} --base-color letters.png --projection sphere --filter ewa"),
                        "`--projection sphere`, by `atan2`.",
                    ),
                    render(
                        "printed/u-as-printed",
                        format!(
                            "globe.glb {BALL} --base-color letters.png --projection sphere-as-printed --filter ewa"
                        ),
                        "`--projection sphere-as-printed`: this half shows the other one's cells, mirrored; see the letters.",
                    ),
                ],
            ),
            row(
                "Everson: Phong and Gouraud both use the normal",
                "They do, but Gouraud uses it at vertices alone.",
                [
                    render(
                        "printed/phong",
                        format!(
                            "ball.glb {BALL} --height abstract_height.png --scale 0.2 --method bump --shading phong"
                        ),
                        "`--shading phong`: bumps.",
                    ),
                    render(
                        "printed/gouraud",
                        format!(
                            "ball.glb {BALL} --height abstract_height.png --scale 0.2 --method bump --shading gouraud"
                        ),
                        "`--shading gouraud`: the same bumps are lost between vertices.",
                    ),
                ],
            ),
            row(
                "West: the sign of displacement",
                "Printed: `P = P - NN * mag * Km` in one shader, plus in the other three, so that his figure 7 shows ridges in one picture where the other has grooves.",
                [
                    render(
                        "printed/outwards",
                        format!("ball.glb {BALL} {SINE} --uniform 3"),
                        "Outwards along the normal, as its bump is.",
                    ),
                    render(
                        "printed/inwards",
                        format!("ball.glb {BALL} {SINE} --preset as-printed --uniform 3"),
                        "As printed: ridges have become grooves; the highlight lies elsewhere.",
                    ),
                ],
            ),
            row(
                "West: `calculatenormal` of a polygon mesh",
                "Bump by the normal of the moved facet loses the smooth normal of the mesh. On a ball of 24 x 12 facets:",
                [
                    render(
                        "printed/smooth",
                        format!("coarse.glb {BALL} {SINE} --method bump"),
                        "The surface gradient bends the smooth normal.",
                    ),
                    render(
                        "printed/facets",
                        format!("coarse.glb {BALL} {SINE} --method bump --preset as-printed"),
                        "As printed: facets show through the waves.",
                    ),
                ],
            ),
            row(
                "West: colours as directions",
                "The comment in the shader says `change the range from -1.0 to 1.0`, and the code does not: `mapVector = vector(sampleColor)`.",
                [
                    render("printed/directions", format!("ball.glb {TWO}"), "2 c - 1: lumps go all ways, inwards too."),
                    render(
                        "printed/directions-as-printed",
                        format!("ball.glb {TWO} --preset as-printed"),
                        "As printed every direction has three positive parts: the whole ball swells and leans one way, and dents are gone.",
                    ),
                ],
            ),
            row(
                "CySlice: the S tangent where UVs are mirrored",
                "Domes by their map on a sheet whose right half is mirrored, lit from the left. Red of that map drives T, green drives S.",
                [
                    render(
                        "printed/cyslice",
                        format!("{DOMES} --swizzle grb"),
                        "`--swizzle grb`: all domes are lit from the left.",
                    ),
                    render(
                        "printed/cyslice-as-printed",
                        format!("{DOMES} --preset cyslice"),
                        "`--preset cyslice`: on the right half S points backwards, and domes are lit from the right.",
                    ),
                ],
            ),
        ],
    )
}
