//! Heights as they are laid out, against the maps that displacement reads.
