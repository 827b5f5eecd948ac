//! Folds the DETAIL flags, in the order typed, into one group per material.

use std::{collections::HashSet, path::PathBuf};

use clap::{ArgMatches, parser::ValueSource};

use super::layer::{Layer, Modifier, Modifiers, Source};
use crate::{
    args::{DetailArgs, values::Swizzle},
    error::{Error, Result},
};

/// The details of one material, or (`material: None`) of every material that has no group of its own.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MaterialGroup {
    pub(crate) material: Option<String>,
    pub(crate) uv_set: u32,
    pub(crate) layers: Vec<Layer>,
}

/// One DETAIL flag as typed.
#[derive(Clone, Debug, PartialEq)]
enum Token {
    Material(String),
    UvSet(u32),
    Height(PathBuf),
    Vector(PathBuf),
    Direction(PathBuf),
    Magnitude(PathBuf),
    Expression(String),
    Normal(PathBuf),
    Modifier(Modifier),
}

/// Groups in the order typed; none when no DETAIL flag was given.
pub(crate) fn groups(args: &DetailArgs, matches: &ArgMatches) -> Result<Vec<MaterialGroup>> {
    let mut drafts = vec![Draft::new(None)];
    for token in tokens(args, matches) {
        match token {
            Token::Material(name) => drafts.push(Draft::new(Some(name))),
            token => {
                if let Some(draft) = drafts.last_mut() {
                    draft.take(token)?;
                }
            }
        }
    }
    if drafts[0].is_untouched() {
        drafts.remove(0);
    }
    refuse_repeated_materials(&drafts)?;
    drafts.into_iter().map(Draft::finish).collect()
}

fn refuse_repeated_materials(drafts: &[Draft]) -> Result<()> {
    let mut seen = HashSet::new();
    for name in drafts.iter().filter_map(|draft| draft.material.as_deref()) {
        if !seen.insert(name) {
            let message =
                format!("--material {name} opens a second group for the same material; put its maps into one");
            return Err(Error::usage("--material", message));
        }
    }
    Ok(())
}

/// Every DETAIL flag in the order typed.
fn tokens(args: &DetailArgs, matches: &ArgMatches) -> Vec<Token> {
    use Token as T;
    let mut all: Vec<(usize, Token)> = Vec::new();
    let mut add = |id: &str, tokens: Vec<Token>| all.extend(indices(matches, id).into_iter().zip(tokens));
    fn each<V: Clone>(values: &[V], token: impl Fn(V) -> Token) -> Vec<Token> {
        values.iter().cloned().map(token).collect()
    }
    add("material", each(&args.material, T::Material));
    add("uv_set", each(&args.uv_set, T::UvSet));
    add("height", each(&args.height, T::Height));
    add("vector", each(&args.vector, T::Vector));
    add("direction", each(&args.direction, T::Direction));
    add("magnitude", each(&args.magnitude, T::Magnitude));
    add("expr", each(&args.expr, T::Expression));
    add("normal", each(&args.normal, T::Normal));
    add("scale", each(&args.scale, |v| T::Modifier(Modifier::Scale(v))));
    add("midlevel", each(&args.midlevel, |v| T::Modifier(Modifier::Midlevel(v))));
    add("space", each(&args.space, |v| T::Modifier(Modifier::Space(v))));
    add("swizzle", each(&args.swizzle, |v: Swizzle| T::Modifier(Modifier::Swizzle(v))));
    add("sampling", each(&args.sampling, |v| T::Modifier(Modifier::Sampling(v))));
    add("wrap", each(&args.wrap, |v| T::Modifier(Modifier::Wrap(v))));
    add("channel", each(&args.channel, |v| T::Modifier(Modifier::Channel(v))));
    add("invert_height", each(&args.invert_height, |_| T::Modifier(Modifier::InvertHeight)));
    add("flip_v", each(&args.flip_v, |_| T::Modifier(Modifier::FlipV)));
    add("flip_green", each(&args.flip_green, |_| T::Modifier(Modifier::FlipGreen)));
    add("exact_zero", each(&args.exact_zero, |_| T::Modifier(Modifier::ExactZero)));
    add("preset", each(&args.preset, |v| T::Modifier(Modifier::Preset(v))));
    all.sort_by_key(|(index, _)| *index);
    all.into_iter().map(|(_, token)| token).collect()
}

fn indices(matches: &ArgMatches, id: &str) -> Vec<usize> {
    let typed = matches.value_source(id) == Some(ValueSource::CommandLine);
    if typed { matches.indices_of(id).into_iter().flatten().collect() } else { Vec::new() }
}

/// A group under construction.
struct Draft {
    material: Option<String>,
    uv_set: Option<u32>,
    /// Modifiers typed before the first map: they hold for every layer they suit.
    shared: Vec<Modifier>,
    layers: Vec<DraftLayer>,
}

struct DraftLayer {
    source: DraftSource,
    own: Vec<Modifier>,
}

/// `--direction` and `--magnitude` make one layer together, in either order.
enum DraftSource {
    Whole(Source),
    Direction(PathBuf),
    Magnitude(PathBuf),
}

impl Draft {
    fn new(material: Option<String>) -> Self {
        Self { material, uv_set: None, shared: Vec::new(), layers: Vec::new() }
    }

    fn is_untouched(&self) -> bool {
        self.uv_set.is_none() && self.shared.is_empty() && self.layers.is_empty()
    }

    fn take(&mut self, token: Token) -> Result<()> {
        match token {
            Token::Material(_) => {}
            Token::UvSet(set) => return self.set_uv_set(set),
            Token::Height(map) => self.open(DraftSource::Whole(Source::Height(map))),
            Token::Vector(map) => self.open(DraftSource::Whole(Source::Vector(map))),
            Token::Expression(text) => self.open(DraftSource::Whole(Source::Expression(text))),
            Token::Normal(map) => self.open(DraftSource::Whole(Source::Normal(map))),
            Token::Direction(map) => self.pair(DraftSource::Direction(map)),
            Token::Magnitude(map) => self.pair(DraftSource::Magnitude(map)),
            Token::Modifier(modifier) => match self.layers.last_mut() {
                Some(layer) => layer.own.push(modifier),
                None => self.shared.push(modifier),
            },
        }
        Ok(())
    }

    fn set_uv_set(&mut self, set: u32) -> Result<()> {
        match self.uv_set.replace(set) {
            None => Ok(()),
            Some(_) => Err(Error::usage("--uv-set", "--uv-set is given twice in one group; a group has one")),
        }
    }

    fn open(&mut self, source: DraftSource) {
        self.layers.push(DraftLayer { source, own: Vec::new() });
    }

    /// Completes the layer before with its other half, or opens one that waits for it.
    fn pair(&mut self, half: DraftSource) {
        let waiting = self.layers.last().map(|layer| &layer.source);
        let (direction, magnitude) = match (waiting, &half) {
            (Some(DraftSource::Direction(direction)), DraftSource::Magnitude(magnitude))
            | (Some(DraftSource::Magnitude(magnitude)), DraftSource::Direction(direction)) => {
                (direction.clone(), magnitude.clone())
            }
            _ => return self.open(half),
        };
        if let Some(layer) = self.layers.last_mut() {
            layer.source = DraftSource::Whole(Source::DirectionMagnitude { direction, magnitude });
        }
    }

    fn finish(self) -> Result<MaterialGroup> {
        if self.layers.is_empty() {
            return Err(self.empty());
        }
        let shared = self.shared;
        let layers: Vec<Layer> = self.layers.into_iter().map(|layer| layer.finish(&shared)).collect::<Result<_>>()?;
        if let Some(idle) = shared.iter().find(|m| !layers.iter().any(|layer| m.suits(&layer.source))) {
            return Err(idle.refuse(&layers[0].source));
        }
        Ok(MaterialGroup { material: self.material, uv_set: self.uv_set.unwrap_or(0), layers })
    }

    fn empty(&self) -> Error {
        let remedy = "add --height MAP, --vector MAP, --direction MAP --magnitude MAP, --expr E or --normal MAP";
        match (&self.material, self.shared.first()) {
            (Some(name), _) => {
                Error::usage("--material", format!("--material {name} opens a group without a map; {remedy} after it"))
            }
            (None, Some(modifier)) => {
                Error::usage(modifier.flag(), format!("{} has no map to belong to; {remedy}", modifier.flag()))
            }
            (None, None) => Error::usage("--uv-set", format!("--uv-set has no map to belong to; {remedy}")),
        }
    }
}

impl DraftLayer {
    fn finish(self, shared: &[Modifier]) -> Result<Layer> {
        let source = match self.source {
            DraftSource::Whole(source) => source,
            DraftSource::Direction(_) => {
                return Err(Error::usage(
                    "--magnitude",
                    "--direction MAP needs --magnitude MAP: the two make one layer",
                ));
            }
            DraftSource::Magnitude(_) => {
                return Err(Error::usage(
                    "--direction",
                    "--magnitude MAP needs --direction MAP: the two make one layer",
                ));
            }
        };
        let mut own = Modifiers::default();
        for modifier in &self.own {
            if !modifier.suits(&source) {
                return Err(modifier.refuse(&source));
            }
            own.set(modifier)?;
        }
        let mut common = Modifiers::default();
        for modifier in shared.iter().filter(|m| m.suits(&source)) {
            common.set(modifier)?;
        }
        Ok(Layer { source, modifiers: own.or(common) })
    }
}

impl Modifiers {
    /// What is set here, else what is set there.
    fn or(self, other: Self) -> Self {
        Self {
            scale: self.scale.or(other.scale),
            midlevel: self.midlevel.or(other.midlevel),
            space: self.space.or(other.space),
            swizzle: self.swizzle.or(other.swizzle),
            sampling: self.sampling.or(other.sampling),
            wrap: self.wrap.or(other.wrap),
            channel: self.channel.or(other.channel),
            invert_height: self.invert_height.or(other.invert_height),
            flip_v: self.flip_v.or(other.flip_v),
            flip_green: self.flip_green.or(other.flip_green),
            exact_zero: self.exact_zero.or(other.exact_zero),
            preset: self.preset.or(other.preset),
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::{CommandFactory, FromArgMatches};

    use super::*;
    use crate::args::{Cli, Command};

    fn parse(flags: &str) -> Result<Vec<MaterialGroup>> {
        let words = ["displace", "apply", "m.glb", "-o", "o.glb"].into_iter().chain(flags.split_whitespace());
        let matches = Cli::command().try_get_matches_from(words).expect(flags);
        let cli = Cli::from_arg_matches(&matches).expect(flags);
        let Command::Apply(apply) = cli.command else { panic!("apply was typed") };
        let (_, matches) = matches.subcommand().expect("apply was typed");
        groups(&apply.detail, matches)
    }

    fn refused_field(flags: &str) -> Option<String> {
        parse(flags).expect_err(flags).field
    }

    #[test]
    fn a_material_opens_a_group_for_what_follows() {
        let groups = parse("--height a.png --scale 2 --material Roof --uv-set 1 --height b.png --scale -3").unwrap();
        assert_eq!(groups.len(), 2);
        assert_eq!((groups[0].material.as_deref(), groups[0].uv_set), (None, 0));
        assert_eq!(groups[0].layers[0].modifiers.scale, Some(2.0));
        assert_eq!((groups[1].material.as_deref(), groups[1].uv_set), (Some("Roof"), 1));
        assert_eq!(groups[1].layers[0].modifiers.scale, Some(-3.0));
    }

    #[test]
    fn a_modifier_belongs_to_the_map_before_it() {
        let groups = parse("--height a.png --scale 1 --invert-height --vector b.exr --scale 2 --flip-v").unwrap();
        let [first, second] = &groups[0].layers[..] else { panic!("two layers") };
        assert_eq!((first.modifiers.scale, first.modifiers.invert_height), (Some(1.0), Some(true)));
        assert_eq!((second.modifiers.scale, second.modifiers.flip_v), (Some(2.0), Some(true)));
        assert_eq!((second.modifiers.invert_height, first.modifiers.flip_v), (None, None));
    }

    #[test]
    fn a_modifier_before_the_first_map_holds_for_the_group_where_it_suits() {
        let groups = parse("--scale 2 --channel g --height a.png --expr u --scale 5").unwrap();
        let [height, expression] = &groups[0].layers[..] else { panic!("two layers") };
        assert_eq!(height.modifiers.scale, Some(2.0));
        assert_eq!(height.modifiers.channel, Some(ChannelArg::G));
        assert_eq!((expression.modifiers.scale, expression.modifiers.channel), (Some(5.0), None));
    }

    #[test]
    fn direction_and_magnitude_make_one_layer_in_either_order() {
        for flags in ["--direction d.png --magnitude m.png", "--magnitude m.png --scale 2 --direction d.png"] {
            let groups = parse(flags).unwrap();
            let expected = Source::DirectionMagnitude { direction: "d.png".into(), magnitude: "m.png".into() };
            assert_eq!(groups[0].layers.iter().map(|l| &l.source).collect::<Vec<_>>(), [&expected]);
        }
    }

    #[test]
    fn contradictions_name_their_flag() {
        assert_eq!(refused_field("--direction d.png").as_deref(), Some("--magnitude"));
        assert_eq!(refused_field("--magnitude d.png --height h.png").as_deref(), Some("--direction"));
        assert_eq!(refused_field("--scale 2").as_deref(), Some("--scale"));
        assert_eq!(refused_field("--uv-set 2").as_deref(), Some("--uv-set"));
        assert_eq!(refused_field("--height a.png --scale 1 --scale 2").as_deref(), Some("--scale"));
        assert_eq!(refused_field("--height a.png --swizzle bgr").as_deref(), Some("--swizzle"));
        assert_eq!(refused_field("--swizzle bgr --height a.png").as_deref(), Some("--swizzle"));
        assert_eq!(refused_field("--expr u --wrap clamp").as_deref(), Some("--wrap"));
        assert_eq!(refused_field("--height a.png --flip-green").as_deref(), Some("--flip-green"));
        assert_eq!(refused_field("--normal a.png --midlevel 0").as_deref(), Some("--midlevel"));
        assert_eq!(refused_field("--normal a.png --preset as-printed").as_deref(), Some("--preset"));
        assert_eq!(refused_field("--height a.png --preset cyslice").as_deref(), Some("--preset"));
        assert_eq!(refused_field("--material A").as_deref(), Some("--material"));
        assert_eq!(refused_field("--material A --expr u --material A --expr v").as_deref(), Some("--material"));
    }

    #[test]
    fn no_flag_is_no_group() {
        assert_eq!(parse(""), Ok(Vec::new()));
    }

    use crate::args::ChannelArg;
}
