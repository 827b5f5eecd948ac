//! West 2007, figures 1 to 5 and 7 to 10. Figure 6 is a screenshot of an editor.

use super::{Picture, Section, Source, figures, picture, render, row};

const BALL: &str = "ball.glb --size 288x240 --orbit -30,20,3.1 --light -0.6,1,0.8 --ambient 0.12";
const GLOBE: &str = "globe.glb --size 288x240 --orbit -30,20,3.1 --light -0.6,1,0.8 --ambient 0.12";
const SINE: &str = "--expr '0.03*sin(2*pi*10*u)'";
const WALL: &str = "wall.glb --size 288x240 --eye 1.9,0.9,2.9 --look-at 0.1,-0.09,0 --fov 36 --light -1,0.9,0.5 --ambient 0.15 --base-color";
const BRICKS: &str = "bricks_color.png --height bricks.png --scale 0.07";
const HOLES: &str = "holes_color.png --height holes.png --scale 0.12 --midlevel 0.9";
const FLOOR: &str = "floor.glb --size 288x240 --eye 0.5,1,1.5 --look-at 0,0,0 --fov 34 --light -1,0.55,-0.35 --ambient 0.15 --base-color bricks_color.png --height bricks.png --scale 0.06 --midlevel 1";
const TWO: &str = "--direction random_rgb.png --magnitude random_grey.png --scale 0.5";
const KNOBBLY: &str = "ball.glb --size 288x240 --ambient 0.12 --uniform 4";

pub(super) fn section() -> Section {
    figures(
        "west",
        "West 2007: from bumps to non-linear displacement",
        "Neil West's report for the NCCA, figure by figure. He built bump, displacement and non-linear displacement as RenderMan \
         shaders, and dropped normal, parallax and relief mapping; they are here. His figure 6 shows an editor.",
        vec![
            row(
                "Figure 1: what bump mapping does to a surface",
                "Only normals change (Blinn 1978). Light says bumps; the outline stays a circle, and nothing hides anything.",
                [
                    render("west/1-plain", BALL, "The ball as it is."),
                    render(
                        "west/1-procedural",
                        format!("{BALL} {SINE} --method bump"),
                        "Procedural: `sin(2 pi 10 s)` of the shader in his appendix.",
                    ),
                    render(
                        "west/1-image",
                        format!("{BALL} --height abstract_height.png --scale 0.2 --method bump"),
                        "The same of a grey map.",
                    ),
                ],
            ),
            row(
                "Figure 2: kinds of maps, the comparison that was dropped",
                "An RGB map holds a normal for each texel, made here from the very heights that bump takes its slopes from: the two pictures ought to be one.",
                [
                    picture(
                        "west/2-map",
                        Source::Map("bricks_normal.png"),
                        "The map: red leans right, green leans up, blue is out.",
                    ),
                    render(
                        "west/2-normal",
                        format!("{WALL} bricks_color.png --normal bricks_normal.png"),
                        "The wall is flat; its normals are the map's.",
                    ),
                    render(
                        "west/2-bump",
                        format!("{WALL} bricks_color.png --height bricks.png --scale 0.039 --method bump"),
                        "Bump by the grey map: the same light, in less memory and with 16 bits.",
                    )
                    .against("west/2-normal"),
                ],
            ),
            row(
                "Figure 3: parallax mapping",
                "Kaneko 2001, as F.E.A.R. had it for bullet holes: where the map is read moves with the view. Look at the far rims of the holes.",
                [
                    render("west/3-bump", format!("{WALL} {HOLES} --method bump"), "Bump: holes are painted on."),
                    render(
                        "west/3-parallax",
                        format!("{WALL} {HOLES} --method parallax"),
                        "Parallax: the bottoms slide under the rims, by one lookup.",
                    ),
                    render(
                        "west/3-displaced",
                        format!("{WALL} {HOLES} --uniform 4"),
                        "Displaced: near rims hide the bottoms, which parallax cannot do.",
                    ),
                ],
            ),
            row(
                "Figure 4: relief mapping",
                "A ray through the height map (Policarpo, Oliveira and Comba 2005) finds what hides what, and a second one towards the light what lies in shadow.",
                [
                    render(
                        "west/4-relief",
                        format!("{FLOOR} --method relief"),
                        "Bricks hide mortar; no vertex has moved.",
                    ),
                    render(
                        "west/4-shadow",
                        format!("{FLOOR} --method relief --self-shadow hard"),
                        "With self-shadow: the joints away from the light are dark.",
                    ),
                    render(
                        "west/4-displaced",
                        format!("{FLOOR} --uniform 4 --shadows ray"),
                        "Displaced, with shadows by rays: what it should look like.",
                    ),
                ],
            ),
            row(
                "Figure 5: the principle of displacement",
                "Cook 1984: points move along the normal, so outline, occlusion and shadow are those of geometry.",
                [
                    render("west/5-flat", format!("{BALL} --shadows ray"), "The base."),
                    render(
                        "west/5-bump",
                        format!(
                            "{BALL} --height rock_height.png --scale 0.3 --midlevel 0.5 --method bump --shadows ray"
                        ),
                        "Its normals bent by the map.",
                    ),
                    render(
                        "west/5-displaced",
                        format!("{BALL} --height rock_height.png --scale 0.3 --midlevel 0.5 --uniform 3 --shadows ray"),
                        "Its points moved by the same map: look at the rim, and at the shadows.",
                    ),
                ],
            ),
            row(
                "Figure 7: a formula as bump and as displacement",
                "Left to right as in the report. Light lies in the same places on both; the outline tells them apart. As printed they do not match: see the errors below.",
                [
                    render("west/7-color", format!("{GLOBE} --base-color ripples.png"), "A simple colour map."),
                    render(
                        "west/7-bump",
                        format!("{GLOBE} --base-color ripples.png {SINE} --method bump"),
                        "Bump: depth is faked, the outline is a circle.",
                    ),
                    render(
                        "west/7-displaced",
                        format!("{GLOBE} --base-color ripples.png {SINE} --uniform 3"),
                        "Displacement: ridges stand out at the rim and narrow towards the pole, as high as elsewhere.",
                    ),
                ],
            ),
            row(
                "Figure 8: bricks as bump and as displacement",
                "A colour map, and with it a grey map of heights.",
                [
                    render("west/8-color", format!("{WALL} bricks_color.png"), "Colour alone: wallpaper."),
                    render(
                        "west/8-bump",
                        format!("{WALL} {BRICKS} --method bump"),
                        "Bump: each brick is lit at one edge; the border of the wall is straight.",
                    ),
                    render(
                        "west/8-displaced",
                        format!("{WALL} {BRICKS} --uniform 4"),
                        "Displacement: bricks hide the joints behind them, and the border has their teeth.",
                    ),
                ],
            ),
            row(
                "Figure 9: non-linear displacement",
                "A sphere by a colour map of directions and a grey map of magnitudes, from two sides. Lumps lean over and hide their own feet, \
                 which heights along the normal never do. The shader of the report decodes colours another way: see the errors below.",
                [
                    knobbly("west/9-front", "-30,20,4", "-0.6,1,0.8", "From the front."),
                    knobbly(
                        "west/9-back",
                        "150,20,4",
                        "0.6,1,-0.8",
                        "From behind. His maps did not wrap, and left a seam; these do.",
                    ),
                    knobbly(
                        "west/9-seam",
                        "90,10,4",
                        "0.8,1,0.6",
                        "Where u goes from 1 to 0: no seam; at the poles the map is still pinched.",
                    ),
                ],
            ),
            row(
                "Figure 10: the maps of figure 9",
                "His own way to test maps: random colours and random greys, blurred.",
                [
                    picture(
                        "west/10-direction",
                        Source::Map("random_rgb.png"),
                        "Direction: 2 c - 1 along tangent, bitangent and normal; mid grey is nowhere.",
                    ),
                    picture(
                        "west/10-magnitude",
                        Source::Map("random_grey.png"),
                        "Magnitude: black is 0, white the full way.",
                    ),
                ],
            ),
        ],
    )
}

fn knobbly(name: &str, orbit: &str, light: &str, note: &str) -> Picture {
    render(name, format!("{KNOBBLY} --orbit {orbit} --light {light} {TWO}"), note)
}
