//! One layer of detail: a map or an expression, and the modifiers that belong to it.

use std::path::PathBuf;

use crate::{
    args::{ChannelArg, PresetArg, SamplingArg, SpaceArg, WrapArg, values::Swizzle},
    error::{Error, Result},
};

/// Where a layer's values come from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Source {
    Height(PathBuf),
    Vector(PathBuf),
    DirectionMagnitude { direction: PathBuf, magnitude: PathBuf },
    Expression(String),
    Normal(PathBuf),
}

impl Source {
    pub(crate) fn is_vector(&self) -> bool {
        matches!(self, Self::Vector(_) | Self::DirectionMagnitude { .. })
    }

    pub(crate) fn is_normal(&self) -> bool {
        matches!(self, Self::Normal(_))
    }

    /// The flag that made the layer.
    pub(crate) fn flag(&self) -> &'static str {
        match self {
            Self::Height(_) => "--height",
            Self::Vector(_) => "--vector",
            Self::DirectionMagnitude { .. } => "--direction",
            Self::Expression(_) => "--expr",
            Self::Normal(_) => "--normal",
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layer {
    pub(crate) source: Source,
    pub(crate) modifiers: Modifiers,
}

/// Flags that say how a map or an expression is read; absent ones take the service's defaults.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Modifiers {
    pub(crate) scale: Option<f32>,
    pub(crate) midlevel: Option<f32>,
    pub(crate) space: Option<SpaceArg>,
    pub(crate) swizzle: Option<Swizzle>,
    pub(crate) sampling: Option<SamplingArg>,
    pub(crate) wrap: Option<WrapArg>,
    pub(crate) channel: Option<ChannelArg>,
    pub(crate) invert_height: Option<bool>,
    pub(crate) flip_v: Option<bool>,
    pub(crate) flip_green: Option<bool>,
    pub(crate) exact_zero: Option<bool>,
    pub(crate) preset: Option<PresetArg>,
}

/// One modifier as typed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Modifier {
    Scale(f32),
    Midlevel(f32),
    Space(SpaceArg),
    Swizzle(Swizzle),
    Sampling(SamplingArg),
    Wrap(WrapArg),
    Channel(ChannelArg),
    InvertHeight,
    FlipV,
    FlipGreen,
    ExactZero,
    Preset(PresetArg),
}

impl Modifier {
    pub(crate) fn flag(&self) -> &'static str {
        match self {
            Self::Scale(_) => "--scale",
            Self::Midlevel(_) => "--midlevel",
            Self::Space(_) => "--space",
            Self::Swizzle(_) => "--swizzle",
            Self::Sampling(_) => "--sampling",
            Self::Wrap(_) => "--wrap",
            Self::Channel(_) => "--channel",
            Self::InvertHeight => "--invert-height",
            Self::FlipV => "--flip-v",
            Self::FlipGreen => "--flip-green",
            Self::ExactZero => "--exact-zero",
            Self::Preset(_) => "--preset",
        }
    }

    /// Whether the modifier says something about this kind of source.
    pub(crate) fn suits(&self, source: &Source) -> bool {
        match self {
            Self::Scale(_) => true,
            Self::Midlevel(_) => !matches!(source, Source::Normal(_)),
            Self::Channel(_) | Self::InvertHeight => matches!(source, Source::Height(_)),
            Self::Space(_) | Self::Swizzle(_) => source.is_vector() || source.is_normal(),
            Self::FlipGreen | Self::ExactZero | Self::Preset(PresetArg::Cyslice) => source.is_normal(),
            Self::Preset(PresetArg::AsPrinted) => !source.is_normal() && !matches!(source, Source::Vector(_)),
            Self::Sampling(_) | Self::Wrap(_) | Self::FlipV => !matches!(source, Source::Expression(_)),
        }
    }

    fn suited_flags(&self) -> &'static str {
        match self {
            Self::Scale(_) => "any map or --expr",
            Self::Midlevel(_) => "any map but --normal, or --expr",
            Self::Channel(_) | Self::InvertHeight => "--height",
            Self::Space(_) | Self::Swizzle(_) => "--vector, --direction or --normal",
            Self::FlipGreen | Self::ExactZero | Self::Preset(PresetArg::Cyslice) => "--normal",
            Self::Preset(PresetArg::AsPrinted) => "--direction, --height or --expr",
            Self::Sampling(_) | Self::Wrap(_) | Self::FlipV => "--height, --vector, --direction or --normal",
        }
    }

    pub(crate) fn refuse(&self, source: &Source) -> Error {
        let message =
            format!("{} says nothing about {}; it belongs after {}", self.flag(), source.flag(), self.suited_flags());
        Error::usage(self.flag(), message)
    }
}

impl Modifiers {
    /// Sets one modifier; the same one twice for one layer is a contradiction.
    pub(crate) fn set(&mut self, modifier: &Modifier) -> Result<()> {
        fn put<T: Clone>(slot: &mut Option<T>, value: &T) -> bool {
            slot.replace(value.clone()).is_none()
        }
        let first = match modifier {
            Modifier::Scale(value) => put(&mut self.scale, value),
            Modifier::Midlevel(value) => put(&mut self.midlevel, value),
            Modifier::Space(value) => put(&mut self.space, value),
            Modifier::Swizzle(value) => put(&mut self.swizzle, value),
            Modifier::Sampling(value) => put(&mut self.sampling, value),
            Modifier::Wrap(value) => put(&mut self.wrap, value),
            Modifier::Channel(value) => put(&mut self.channel, value),
            Modifier::InvertHeight => put(&mut self.invert_height, &true),
            Modifier::FlipV => put(&mut self.flip_v, &true),
            Modifier::FlipGreen => put(&mut self.flip_green, &true),
            Modifier::ExactZero => put(&mut self.exact_zero, &true),
            Modifier::Preset(value) => put(&mut self.preset, value),
        };
        if first {
            return Ok(());
        }
        let message = format!("{0} is given twice for one map; a {0} belongs to the map before it", modifier.flag());
        Err(Error::usage(modifier.flag(), message))
    }
}
