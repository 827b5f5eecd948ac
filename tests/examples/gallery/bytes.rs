//! What a base mesh with its map weighs beside the mesh that the two describe: West's wish for light scenes.

use std::{fmt::Write as _, fs};

use serde_json::Value;

use crate::{
    Figures, Result,
    displace::{Displace, words},
};

/// (name, mesh, map, flags)
const SCENES: [(&str, &str, &str, &str); 3] = [
    ("Brick wall", "sheet.glb", "bricks.png", "--scale 0.04"),
    ("Folded ball", "ball.glb", "abstract_height.png", "--scale 0.3"),
    ("Bullet holes", "sheet.glb", "holes.png", "--scale 0.06"),
];
const TOLERANCES: [&str; 2] = ["1e-3", "1e-4"];
const PACKINGS: [(&str, &str); 3] =
    [("plain", ""), ("quantize", "--compress quantize"), ("meshopt", "--compress meshopt")];

/// Displaces each scene at each tolerance, and keeps how many bytes and triangles come out.
pub(crate) fn measure(displace: &Displace, figures: &mut Figures) -> Result<()> {
    for (name, mesh, map, flags) in SCENES {
        for (kind, file) in [("base", mesh), ("map", map)] {
            let bytes = fs::metadata(displace.folder().join(file))?.len();
            figures.insert(format!("bytes {name} {kind}"), bytes as f64);
        }
        for (tolerance, (packing, flag)) in TOLERANCES.iter().flat_map(|t| PACKINGS.iter().map(move |p| (t, p))) {
            let line =
                format!("apply {mesh} --height {map} {flags} --tolerance {tolerance} {flag} --json --quiet -o out.glb");
            let report: Value = serde_json::from_str(&displace.run(&words(&line))?)?;
            let bytes = report["outputs"][0]["bytes"].as_f64().ok_or("the result has no size")?;
            figures.insert(format!("bytes {name} {tolerance} {packing}"), bytes);
            let triangles = report["triangles"].as_f64().ok_or("the result has no triangles")?;
            figures.insert(format!("triangles {name} {tolerance} {packing}"), triangles);
        }
        println!("bytes of {name}");
    }
    Ok(())
}

/// The section of the page.
pub(crate) fn table(figures: &Figures) -> String {
    let mut html = HEAD.to_owned();
    for (name, ..) in SCENES {
        let get = |key: &str| figures.get(key).copied().unwrap_or(f64::NAN);
        let (base, map) = (get(&format!("bytes {name} base")), get(&format!("bytes {name} map")));
        for tolerance in TOLERANCES {
            let packed = PACKINGS.map(|(packing, _)| get(&format!("bytes {name} {tolerance} {packing}")));
            let triangles = get(&format!("triangles {name} {tolerance} plain"));
            let _ = write!(
                html,
                "<tr><td>{name}</td><td>{}</td><td>{tolerance}</td><td>{triangles}</td>",
                kilobytes(base + map)
            );
            for bytes in packed {
                let _ = write!(html, "<td>{} <small>({:.1}x)</small></td>", kilobytes(bytes), bytes / (base + map));
            }
            html += "</tr>\n";
        }
    }
    html + "</table></div>\n</section>\n"
}

fn kilobytes(bytes: f64) -> String {
    format!("{:.0} KB", bytes / 1000.0)
}

const HEAD: &str = "<section id=\"bytes\">\n<h2>A base and its map, or the mesh they make</h2>\n\
<p class=\"lead\">West's hope was to use basic geometry in a scene to form complex shapes at render time, and therefore save on large \
scene files. Bytes of the base mesh and the height map as PNG, beside the displaced mesh as GLB, with how many times as \
many that is. The tolerance is a share of the scene's diagonal. At 1e-3 the packed wall of bricks weighs little more than half of its map; at \
1e-4, a 28th of a texel, nearly four times as much. Packed positions lie on a grid of 16 bits, for \
which the same tolerance asks for up to a third more triangles; from 65 536 vertices on their indices are twice as long.</p>\n<div class=\"wide\"><table>\n<tr><th>scene</th>\
<th>base and map</th><th>tolerance</th><th>triangles</th><th>plain</th><th>quantize</th><th>meshopt</th></tr>\n";
