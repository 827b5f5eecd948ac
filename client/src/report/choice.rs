//! What `--method auto` chose, as JSON and in words.

use displace_proto::v1::{Choice, MethodOption};
use serde_json::{Value, json};

use super::put;
use crate::output::{count, duration_ms};

/// As the contract has it; what is not known is absent.
pub(super) fn json(choice: &Choice) -> Value {
    let chosen = choice.chosen.clone().unwrap_or_default();
    let mut value = option_json(&chosen);
    value["material"] = choice.material.as_str().into();
    value["tolerance_px"] = choice.tolerance_px.into();
    put(&mut value, "measured", choice.measured_px);
    put(&mut value, "shades_rest", choice.shades_rest.then_some(true));
    put(&mut value, "next_better", choice.next_better.as_ref().map(option_json));
    put(&mut value, "next_cheaper", choice.next_cheaper.as_ref().map(option_json));
    if !choice.reason.is_empty() {
        value["reason"] = choice.reason.as_str().into();
    }
    value
}

fn option_json(option: &MethodOption) -> Value {
    let MethodOption { pixels, rays, fetches, vertices, triangles, .. } = option;
    let mut value = json!({
        "method": option.method,
        "setting": option.setting,
        "cost": {
            "ms": option.cost_ms, "pixels": pixels, "rays": rays, "fetches": fetches, "vertices": vertices, "triangles": triangles,
        },
    });
    put(&mut value, "predicted", option.predicted_px);
    put(&mut value, "predicted_outline", option.predicted_outline_px);
    value
}

pub(super) fn words(choice: &Choice) -> String {
    let name = if choice.material.is_empty() { "no name".to_owned() } else { format!("'{}'", choice.material) };
    let chosen = choice.chosen.clone().unwrap_or_default();
    let measured = choice.measured_px.map_or(String::new(), |px| format!(", measured {px:.3} px"));
    let mut text =
        format!("material {name} by {}{measured}, of {} px allowed\n", option_words(&chosen), choice.tolerance_px);
    if choice.shades_rest {
        text += "  what is finer than its triangles bends normals\n";
    }
    let beside = [("next better", &choice.next_better), ("next cheaper", &choice.next_cheaper)];
    for (what, option) in beside {
        text += &option.as_ref().map_or(String::new(), |option| format!("  {what}: {}\n", option_words(option)));
    }
    if !choice.reason.is_empty() {
        text += &format!("  {}\n", choice.reason);
    }
    text
}

fn option_words(option: &MethodOption) -> String {
    let name = format!("{} {}", option.method, option.setting);
    let known = |px: Option<f64>| px.map_or("no bound".to_owned(), |px| format!("{px:.3} px"));
    let triangles = match option.triangles {
        made if made >= 1.0 => format!(", about {} triangles", count(made as u64)),
        _ => String::new(),
    };
    format!(
        "{} (at most {}, outline {}, about {}{triangles})",
        name.trim_end(),
        known(option.predicted_px),
        known(option.predicted_outline_px),
        duration_ms(option.cost_ms)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn option(method: &str, predicted_px: Option<f64>) -> MethodOption {
        MethodOption { method: method.into(), predicted_px, cost_ms: 12.0, ..MethodOption::default() }
    }

    #[test]
    fn what_was_chosen_stands_with_its_neighbours() {
        let choice = Choice {
            material: "wall".into(),
            chosen: Some(option("exact", Some(0.25))),
            next_better: Some(option("displacement", Some(0.125))),
            next_cheaper: Some(option("bump", None)),
            tolerance_px: 0.5,
            measured_px: Some(0.2),
            reason: String::new(),
            shades_rest: false,
        };
        let value = json(&choice);
        assert_eq!(
            (&value["method"], &value["predicted"], &value["measured"]),
            (&"exact".into(), &0.25.into(), &0.2.into())
        );
        assert_eq!(value["next_better"]["method"], "displacement");
        assert!(value["next_cheaper"].get("predicted").is_none() && value.get("reason").is_none(), "{value}");
        let text = words(&choice);
        for part in ["'wall' by exact", "at most 0.250 px", "measured 0.200 px", "next cheaper: bump (at most no bound"]
        {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert!(value.get("shades_rest").is_none() && !text.contains("finer"));
        let displaced = Choice { shades_rest: true, ..choice };
        assert_eq!(json(&displaced)["shades_rest"], true);
        assert!(words(&displaced).contains("finer than its triangles bends normals"));
    }
}
