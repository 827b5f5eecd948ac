//! Expressions such as `0.5*sin(20*pi*x)`: parsed to one small bytecode with a cost limit.

/// A compiled expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    pub source: String,
}
