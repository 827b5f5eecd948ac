//! Where methods fail, one figure each.

use super::{Section, Source, figures, picture, render, row};

const LIGHT: &str = "--light -1,0.8,0.35 --ambient 0.15";
const TILES: &str = "floor.glb --base-color tiles_color.png --height tiles.png --midlevel 1";
const BRICKS: &str = "floor.glb --base-color bricks_color.png --height bricks.png --scale 0.06 --midlevel 1";
const POSTS: &str = "floor.glb --base-color posts_color.png --height posts.png --scale 0.12 --midlevel 0";
const AT_60: &str = "--size 288x176 --eye 0,1,1.7321 --look-at 0,0,0 --fov 16";
const AT_65: &str = "--size 288x176 --eye 0,0.8452,1.8126 --look-at 0,0,0 --fov 16";
const AT_70: &str = "--size 288x144 --eye 0,0.684,1.8794 --look-at 0,0,0 --fov 13";
const AT_85: &str = "--size 288x96 --eye 0,0.1743,1.9924 --look-at 0,0,0 --fov 6";
const SHEET: &str = "sheet.glb --size 288x216 --eye 0.5,1.7,2.4 --look-at 0.05,-0.05,0.1 --fov 40 --base-color bricks_color.png --height bricks.png --scale 0.09 --midlevel 1";
const MIRRORED: &str = "mirrored.glb --size 288x216 --eye 0,1.6,2.3 --look-at 0,0,0.22 --fov 43 --base-color bricks_color.png --height bricks.png --scale 0.09 --midlevel 1";
const BALL: &str = "ball.glb --size 288x240 --orbit -30,20,3.3 --light -0.6,1,0.8 --ambient 0.12 --height domes.png --scale 0.22 --midlevel 0.5";
const TORUS: &str = "torus.glb --size 288x216 --orbit -30,35,4.2 --light -0.6,1,0.8 --ambient 0.12 --height domes.png --scale 0.2 --midlevel 0.5";
const LOW: &str = "--size 288x176 --eye 0,1,1.7321 --look-at 0,0,0 --fov 16 --light -1,0.35,-0.2 --ambient 0.15";
const SUNK: &str = "sunk.glb --size 288x216 --eye 0.3,0.9,1.2 --look-at 0,0,0 --fov 36 --material surface --height bricks.png --scale 0.12 --midlevel 0.5";

pub(super) fn section() -> Section {
    figures(
        "failures",
        "Where methods fail",
        "Each method has places where it is wrong. One figure for each, with the truth at the end.",
        vec![
            row("Stairs", "Too few even steps: each height is one of a few.", [
                render("failures/stairs-steep", format!("floor.glb --base-color rock_light.png --height rock_height.png --scale 0.2 --midlevel 1 {AT_60} {LIGHT} --method steep --steps 8"), "`steep` with 8 steps: terraces, like a map of contour lines.").against("failures/stairs-truth"),
                render("failures/stairs-occlusion", format!("floor.glb --base-color rock_light.png --height rock_height.png --scale 0.2 --midlevel 1 {AT_60} {LIGHT} --method occlusion --steps 8"), "`occlusion` with the same 8 steps.").against("failures/stairs-truth"),
                render("failures/stairs-exact", format!("floor.glb --base-color rock_light.png --height rock_height.png --scale 0.2 --midlevel 1 {AT_60} {LIGHT} --method exact"), "`exact` has no steps.").against("failures/stairs-truth"),
                render("failures/stairs-truth", format!("floor.glb --base-color rock_light.png --height rock_height.png --scale 0.2 --midlevel 1 {AT_60} {LIGHT} --uniform 5 --supersample 64"), "Displaced."),
            ]),
            row("Swimming", "Two frames of a moving camera, at 60 and 65 degrees. With parallax the joints change their width and the bricks their shape.", [
                render("failures/swimming-parallax-a", format!("{BRICKS} {AT_60} {LIGHT} --method parallax"), "`parallax`, first frame.").against("failures/swimming-truth-a"),
                render("failures/swimming-parallax-b", format!("{BRICKS} {AT_65} {LIGHT} --method parallax"), "`parallax`, next frame.").against("failures/swimming-truth-b"),
                render("failures/swimming-truth-a", format!("{BRICKS} {AT_60} {LIGHT} --uniform 5 --supersample 64"), "Displaced, first frame."),
                render("failures/swimming-truth-b", format!("{BRICKS} {AT_65} {LIGHT} --uniform 5 --supersample 64"), "Displaced, next frame."),
            ]),
            row("Thin posts", "Posts two texels wide. A march whose steps are longer than that leaps over them, here and there.", [
                render("failures/posts-relief", format!("{POSTS} {AT_70} {LIGHT} --method relief --steps 16"), "`relief` with 16 steps: posts are cut to pieces.").against("failures/posts-truth"),
                render("failures/posts-more", format!("{POSTS} {AT_70} {LIGHT} --method relief --steps 64"), "`relief` with 64 steps.").against("failures/posts-truth"),
                render("failures/posts-exact", format!("{POSTS} {AT_70} {LIGHT} --method exact"), "`exact`: whole.").against("failures/posts-truth"),
                render("failures/posts-truth", format!("{POSTS} {AT_70} {LIGHT} --uniform 5 --supersample 64"), "Displaced."),
            ]),
            row("Grazing rays", "At 85 degrees the shift of parallax is eleven times the height.", [
                render("failures/grazing-parallax", format!("{BRICKS} {AT_85} {LIGHT} --method parallax"), "`parallax`: streaks.").against("failures/grazing-truth"),
                render("failures/grazing-limited", format!("{BRICKS} {AT_85} {LIGHT} --method parallax-limited"), "`parallax-limited`: flat, but calm.").against("failures/grazing-truth"),
                render("failures/grazing-relief", format!("{BRICKS} {AT_85} {LIGHT} --method relief --steps 16"), "`relief` with 16 steps.").against("failures/grazing-truth"),
                render("failures/grazing-exact", format!("{BRICKS} {AT_85} {LIGHT} --method exact"), "`exact`.").against("failures/grazing-truth"),
                render("failures/grazing-truth", format!("{BRICKS} {AT_85} {LIGHT} --uniform 5 --supersample 64"), "Displaced."),
            ]),
            row("Borders of charts", "A ray that leaves the chart must not go on in what lies beside it on the map: bricks would show that are not there.", [
                render("failures/border-exact", format!("{SHEET} {LIGHT} --method exact"), "`exact`: rays end where the sheet does. What lies before the base's near edge is not shown.").against("failures/border-truth"),
                render("failures/border-parallax", format!("{SHEET} {LIGHT} --method parallax"), "`parallax`: near the edge places stay on it.").against("failures/border-truth"),
                render("failures/border-truth", format!("{SHEET} {LIGHT} --uniform 6 --supersample 64"), "Displaced: the edge has joints."),
            ]),
            row("Mirrored charts", "The right half of the sheet has mirrored texture coordinates.", [
                render("failures/mirrored-exact", format!("{MIRRORED} {LIGHT} --method exact"), "`exact`: bricks stand up and are lit from the left on both halves; rays go on over the middle, mirrored.").against("failures/mirrored-truth"),
                render("failures/mirrored-parallax", format!("{MIRRORED} {LIGHT} --method parallax"), "`parallax`: the shift goes the right way on both.").against("failures/mirrored-truth"),
                render("failures/mirrored-truth", format!("{MIRRORED} {LIGHT} --uniform 6 --supersample 64"), "Displaced."),
            ]),
            row("Curved bases: a ball", "A march over the tangent plane forgets that the base bends. The outline is where it shows.", [
                render("failures/ball-none", format!("{BALL} --method exact"), "`--silhouettes none`: domes, on a round outline.").against("failures/ball-truth"),
                render("failures/ball-shell", format!("{BALL} --method exact --silhouettes shell"), "`shell`: prisms over the triangles, walked one after the other: domes stand out.").against("failures/ball-truth"),
                render("failures/ball-quadric", format!("{BALL} --method exact --silhouettes quadric"), "`quadric`: the base bent as it is at each vertex (Oliveira and Policarpo 2005).").against("failures/ball-truth"),
                render("failures/ball-truth", format!("{BALL} --uniform 3 --supersample 64"), "Displaced."),
            ]),
            row("Curved bases: a torus", "Inside the ring the base bends both ways.", [
                render("failures/torus-none", format!("{TORUS} --method exact"), "`none`.").against("failures/torus-truth"),
                render("failures/torus-shell", format!("{TORUS} --method exact --silhouettes shell"), "`shell`.").against("failures/torus-truth"),
                render("failures/torus-quadric", format!("{TORUS} --method exact --silhouettes quadric"), "`quadric`.").against("failures/torus-truth"),
                render("failures/torus-truth", format!("{TORUS} --uniform 3 --supersample 64"), "Displaced."),
            ]),
            row("Self-shadow", "A low sun from the left.", [
                render("failures/shadow-none", format!("{BRICKS} {LOW} --method exact"), "`--self-shadow none`: only what faces away is dark.").against("failures/shadow-truth"),
                render("failures/shadow-hard", format!("{BRICKS} {LOW} --method exact --self-shadow hard"), "`hard`: one march to the light.").against("failures/shadow-truth"),
                render("failures/shadow-soft", format!("{BRICKS} {LOW} --method exact --self-shadow soft"), "`soft`: by how far the way to the light lies below the heights.").against("failures/shadow-truth"),
                render("failures/shadow-truth", format!("{BRICKS} {LOW} --uniform 4 --supersample 64 --shadows ray"), "Displaced, shadows by rays."),
            ]),
            row("Depth", "A ball sunk into a relief of bricks: where they meet tells whether the relief has depth.", [
                render("failures/depth-bump", format!("{SUNK} {LIGHT} --method bump"), "`bump`: they meet in the plane of the base: a clean circle."),
                render("failures/depth-exact", format!("{SUNK} {LIGHT} --method exact"), "`exact`: bricks cut into the ball, joints let it through.").against("failures/depth-truth"),
                render("failures/depth-truth", format!("{SUNK} {LIGHT} --uniform 5 --supersample 64"), "Displaced."),
            ]),
            row("What it costs", "`--aov cost`: red are values read, green steps, blue rays that a bound ended; each of its most in the picture.", [
                picture("failures/cost-relief", Source::Beside(format!("render {TILES} --scale 0.05 {AT_60} {LIGHT} --method relief --aov cost"), "cost"), "`relief`: even steps, as many as the angle asks for: most where the floor is far."),
                picture("failures/cost-cone", Source::Beside(format!("render {TILES} --scale 0.05 {AT_60} {LIGHT} --method cone --aov cost"), "cost"), "`cone`: few on tops, more along joints."),
                picture("failures/cost-exact", Source::Beside(format!("render {TILES} --scale 0.05 {AT_60} {LIGHT} --method exact --aov cost"), "cost"), "`exact`: one look on tops, more where rays pass by edges."),
            ]),
        ],
    )
}
