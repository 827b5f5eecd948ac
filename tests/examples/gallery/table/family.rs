//! Every method that shows depth, on four reliefs at three angles, beside the displaced surface.

use super::{Kind, Picture, Row, Section, Source};

/// A relief and what it is on.
struct Relief {
    id: &'static str,
    title: &'static str,
    text: &'static str,
    /// Mesh, maps and light.
    scene: &'static str,
    /// Subdivision of the truth.
    level: u32,
    /// Degrees between the line of sight and the normal.
    views: [(u32, &'static str); 3],
}

/// The floor from two units away, 1 unit wide in the picture; fields of view are vertical.
const FLOOR: [(u32, &str); 3] = [
    (30, "--size 256x160 --eye 0,1.7321,1 --look-at 0,0,0 --fov 17.7"),
    (60, "--size 256x128 --eye 0,1,1.7321 --look-at 0,0,0 --fov 14.2"),
    (80, "--size 256x96 --eye 0,0.3473,1.9696 --look-at 0,0,0 --fov 10.7"),
];
/// The cube from its side: the front face is the one that is told of.
const CUBE: [(u32, &str); 3] = [
    (30, "--size 256x192 --orbit 30,14,6 --fov 15"),
    (60, "--size 256x192 --orbit 60,14,6 --fov 15"),
    (80, "--size 256x192 --orbit 80,14,6 --fov 15"),
];

const RELIEFS: [Relief; 4] = [
    Relief {
        id: "brick",
        title: "Brick",
        text: "Broad tops with steep sides, joints a third as deep as a brick is high.",
        scene: "floor.glb --base-color bricks_color.png --height bricks.png --scale 0.045 --midlevel 1 --light -1,0.8,0.35 --ambient 0.15",
        level: 5,
        views: FLOOR,
    },
    Relief {
        id: "rock",
        title: "Rock",
        text: "Heights at all sizes, without flat parts.",
        scene: "floor.glb --base-color rock_light.png --height rock_height.png --scale 0.16 --midlevel 0.5 --light -1,0.8,0.35 --ambient 0.15",
        level: 5,
        views: FLOOR,
    },
    Relief {
        id: "tiles",
        title: "Tiles",
        text: "Flat tops and joints two texels wide: thin things that a march in even steps may leap over.",
        scene: "floor.glb --base-color tiles_color.png --height tiles.png --scale 0.05 --midlevel 1 --light -1,0.8,0.35 --ambient 0.15",
        level: 5,
        views: FLOOR,
    },
    Relief {
        id: "cube",
        title: "The parallax cube",
        text: "Twelve triangles, every face a crate's side, carved a tenth of the cube deep. Displacement keeps the edges closed: corners move along the mitre of their faces, and what is carved shrinks \
towards the middle. Per pixel each face is carved along its own normal, so ball and planks stay as wide as they are on the map: that is what \
differs even from exact. Angles are those of the face with the frame at the left.",
        scene: "cube.glb --base-color crate_color.png --height crate.png --scale 0.12 --midlevel 1 --light 0.8,1,0.6 --ambient 0.2",
        level: 7,
        views: CUBE,
    },
];

/// (method, title, what to look for)
const METHODS: [(&str, &str, &str); 10] = [
    ("flat", "Flat", "The colour map alone: what depth adds is missing altogether."),
    ("bump", "Bump", "Light is right, places are not: nothing moves, nothing hides."),
    ("parallax", "Parallax", "Kaneko 2001. One lookup shifts the map. At 60 degrees it slides, at 80 it tears."),
    (
        "parallax-limited",
        "Parallax, limited",
        "Welsh 2004. The shift ends at the height itself: calm at 80 degrees, and nearly flat.",
    ),
    (
        "parallax-iterative",
        "Parallax, iterated",
        "Premecz 2006. A few steps along the slope: better where slopes are gentle.",
    ),
    (
        "steep",
        "Steep",
        "McGuire and McGuire 2005. Even steps down the ray to the first below: things hide each other; sides show the steps.",
    ),
    ("occlusion", "Occlusion", "Tatarchuk 2006. The last step taken as straight: the steps vanish."),
    ("relief", "Relief", "Policarpo, Oliveira and Comba 2005. The last step halved five times: sharper at sides."),
    ("cone", "Cone", "Dummer 2006, Policarpo and Oliveira 2007. Steps as long as a cone over each texel is empty."),
    (
        "exact",
        "Exact",
        "A pyramid of greatest heights and the bilinear surface in closed form: no step to choose, nothing missed.",
    ),
];

pub(super) fn sections() -> Vec<Section> {
    let mut sections: Vec<Section> = RELIEFS.iter().map(section).collect();
    sections[0].text = format!("{FIRST} {}", sections[0].text);
    sections
}

const FIRST: &str = "Each method at 30, 60 and 80 degrees from the normal. The displaced surface stays at the top; point at a picture, or touch it, and \
the truth shows in its place. Under each is where the two differ, black where they do not. Shadows are off: this is about places.";

fn section(relief: &Relief) -> Section {
    let mut rows = vec![Row {
        title: "Displacement".to_owned(),
        text: "The truth: vertices moved, about one triangle a texel, by 64 samples a pixel; all else by 4.".to_owned(),
        pictures: relief.views.iter().map(|&(angle, view)| truth(relief, angle, view)).collect(),
    }];
    rows.extend(METHODS.iter().map(|&(method, title, text)| Row {
        title: title.to_owned(),
        text: text.to_owned(),
        pictures: relief.views.iter().map(|&(angle, view)| shown(relief, method, angle, view)).collect(),
    }));
    Section { id: relief.id, title: relief.title.to_owned(), text: relief.text.to_owned(), kind: Kind::Compared, rows }
}

fn truth(relief: &Relief, angle: u32, view: &str) -> Picture {
    let line = format!("render {} {view} --uniform {} --supersample 64", relief.scene, relief.level);
    Picture {
        name: format!("{}/truth-{angle}", relief.id),
        source: Source::Render(line),
        note: format!("{angle} degrees"),
        against: None,
    }
}

fn shown(relief: &Relief, method: &str, angle: u32, view: &str) -> Picture {
    Picture {
        name: format!("{}/{method}-{angle}", relief.id),
        source: Source::Render(format!("render {} {view} --method {method}", relief.scene)),
        note: format!("{angle} degrees"),
        against: Some(format!("{}/truth-{angle}", relief.id)),
    }
}
