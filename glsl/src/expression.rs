//! The bytecode of expressions: what the parser writes, the shaders interpret in f32, and the CPU
//! interprets over f64, dual numbers (exact derivatives) and intervals (bounds). No text here.

pub mod dual;
pub mod interval;
pub mod interval_jet;
pub mod noise;

pub use dual::Dual;
pub use interval::Interval;
pub use interval_jet::IntervalJet;

/// Longest program, in instructions: the cost limit of one evaluation.
pub const MAX_INSTRUCTIONS: usize = 256;
/// Deepest stack a program may need; the shaders keep this many slots in registers.
pub const MAX_STACK: usize = 16;
/// Largest exponent of [`Op::PowerInteger`], either sign; other powers go through log2 and exp2.
pub const MAX_INTEGER_POWER: i32 = 31;

/// What an instruction does. The numbers are shared with `expression.glsl`.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Pushes `value`.
    Constant = 0,
    /// Pushes variable number `value`, see [`Variable`].
    Variable = 1,
    Add = 2,
    Subtract = 3,
    Multiply = 4,
    Divide = 5,
    Negate = 6,
    /// Raises the top to the whole power `value` by a chain of multiplications.
    PowerInteger = 7,
    /// a² (3 − 2 a): the fade of smoothstep.
    Smooth = 8,
    Sine = 9,
    Cosine = 10,
    Tangent = 11,
    SquareRoot = 12,
    Absolute = 13,
    Minimum = 14,
    Maximum = 15,
    Floor = 16,
    Modulo = 17,
    Mix = 18,
    Step = 19,
    Sign = 20,
    Exp2 = 21,
    Log2 = 22,
    ArcTangent2 = 23,
    Noise = 24,
}

impl Op {
    const ALL: [Self; 25] = [
        Self::Constant,
        Self::Variable,
        Self::Add,
        Self::Subtract,
        Self::Multiply,
        Self::Divide,
        Self::Negate,
        Self::PowerInteger,
        Self::Smooth,
        Self::Sine,
        Self::Cosine,
        Self::Tangent,
        Self::SquareRoot,
        Self::Absolute,
        Self::Minimum,
        Self::Maximum,
        Self::Floor,
        Self::Modulo,
        Self::Mix,
        Self::Step,
        Self::Sign,
        Self::Exp2,
        Self::Log2,
        Self::ArcTangent2,
        Self::Noise,
    ];

    /// Values taken from the stack; every instruction leaves one.
    #[must_use]
    pub const fn arity(self) -> usize {
        match self {
            Self::Constant | Self::Variable => 0,
            Self::Negate
            | Self::PowerInteger
            | Self::Smooth
            | Self::Sine
            | Self::Cosine
            | Self::Tangent
            | Self::SquareRoot
            | Self::Absolute
            | Self::Floor
            | Self::Sign
            | Self::Exp2
            | Self::Log2 => 1,
            Self::Mix | Self::Noise => 3,
            _ => 2,
        }
    }
}

/// What a program can read at a point of the base surface; positions and normals in mesh-local axes.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Variable {
    U = 0,
    V = 1,
    X = 2,
    Y = 3,
    Z = 4,
    NormalX = 5,
    NormalY = 6,
    NormalZ = 7,
}

pub const VARIABLES: usize = 8;

/// One step of a program, as the shaders read it.
pub use crate::layout::geometry::Instruction;

impl Instruction {
    #[must_use]
    pub const fn new(op: Op, value: f32) -> Self {
        Self { op: op as u32, value }
    }

    #[must_use]
    pub fn operation(self) -> Option<Op> {
        Op::ALL.get(self.op as usize).copied()
    }
}

/// Why a program cannot run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// More than [`MAX_INSTRUCTIONS`].
    TooLong,
    /// More than [`MAX_STACK`] values at once.
    TooDeep,
    /// An unknown operation or variable, an empty stack, or not exactly one result.
    Malformed,
}

/// Proves that a program stays within its limits, so that no interpreter needs to check again.
pub fn check(code: &[Instruction]) -> Result<(), Fault> {
    if code.len() > MAX_INSTRUCTIONS {
        return Err(Fault::TooLong);
    }
    let mut depth = 0usize;
    for instruction in code {
        let op = instruction.operation().ok_or(Fault::Malformed)?;
        let known = op != Op::Variable || (0.0..VARIABLES as f32).contains(&instruction.value);
        depth = depth.checked_sub(op.arity()).filter(|_| known).ok_or(Fault::Malformed)? + 1;
        if depth > MAX_STACK {
            return Err(Fault::TooDeep);
        }
    }
    if depth == 1 { Ok(()) } else { Err(Fault::Malformed) }
}

/// Whether a program reads one of the variables in `range`.
#[must_use]
pub fn reads(code: &[Instruction], range: std::ops::RangeInclusive<u32>) -> bool {
    code.iter().any(|i| i.op == Op::Variable as u32 && range.contains(&(i.value as u32)))
}

/// What the interpreter computes with.
pub trait Number: Copy {
    fn constant(value: f64) -> Self;
    fn add(self, o: Self) -> Self;
    fn sub(self, o: Self) -> Self;
    fn mul(self, o: Self) -> Self;
    fn div(self, o: Self) -> Self;
    fn neg(self) -> Self;
    fn powi(self, n: i32) -> Self;
    fn sin(self) -> Self;
    fn cos(self) -> Self;
    fn tan(self) -> Self;
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    fn min(self, o: Self) -> Self;
    fn max(self, o: Self) -> Self;
    fn floor(self) -> Self;
    /// −1, 0 or 1.
    fn sign(self) -> Self;
    /// 0 where `self` is below `edge`, else 1.
    fn step(edge: Self, x: Self) -> Self;
    fn exp2(self) -> Self;
    fn log2(self) -> Self;
    fn atan2(self, x: Self) -> Self;
    fn noise(x: Self, y: Self, z: Self) -> Self;

    /// x − y floor(x / y), as in GLSL.
    fn modulo(self, y: Self) -> Self {
        self.sub(y.mul(self.div(y).floor()))
    }

    fn mix(a: Self, b: Self, t: Self) -> Self {
        a.add(b.sub(a).mul(t))
    }

    /// self² (3 − 2 self).
    fn smooth(self) -> Self {
        self.powi(2).mul(Self::constant(3.0).sub(Self::constant(2.0).mul(self)))
    }
}

/// Runs a program that [`check`] has accepted.
pub fn evaluate<N: Number>(code: &[Instruction], variables: &[N; VARIABLES]) -> N {
    let mut stack = [N::constant(0.0); MAX_STACK];
    let mut top = 0usize;
    for instruction in code {
        let Some(op) = instruction.operation() else { continue };
        let arity = op.arity();
        let first = top.saturating_sub(arity);
        let arguments = [stack[first], stack[(first + 1).min(MAX_STACK - 1)], stack[(first + 2).min(MAX_STACK - 1)]];
        stack[first] = apply(op, instruction.value, arguments, variables);
        top = first + 1;
    }
    stack[0]
}

fn apply<N: Number>(op: Op, value: f32, [a, b, c]: [N; 3], variables: &[N; VARIABLES]) -> N {
    match op {
        Op::Constant => N::constant(f64::from(value)),
        Op::Variable => variables[value as usize % VARIABLES],
        Op::Add => a.add(b),
        Op::Subtract => a.sub(b),
        Op::Multiply => a.mul(b),
        Op::Divide => a.div(b),
        Op::Negate => a.neg(),
        Op::PowerInteger => a.powi(value as i32),
        Op::Smooth => a.smooth(),
        Op::Sine => a.sin(),
        Op::Cosine => a.cos(),
        Op::Tangent => a.tan(),
        Op::SquareRoot => a.sqrt(),
        Op::Absolute => a.abs(),
        Op::Minimum => a.min(b),
        Op::Maximum => a.max(b),
        Op::Floor => a.floor(),
        Op::Modulo => a.modulo(b),
        Op::Mix => N::mix(a, b, c),
        Op::Step => N::step(a, b),
        Op::Sign => a.sign(),
        Op::Exp2 => a.exp2(),
        Op::Log2 => a.log2(),
        Op::ArcTangent2 => a.atan2(b),
        Op::Noise => N::noise(a, b, c),
    }
}

impl Number for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn add(self, o: Self) -> Self {
        self + o
    }
    fn sub(self, o: Self) -> Self {
        self - o
    }
    fn mul(self, o: Self) -> Self {
        self * o
    }
    fn div(self, o: Self) -> Self {
        self / o
    }
    fn neg(self) -> Self {
        -self
    }
    fn powi(self, n: i32) -> Self {
        f64::powi(self, n)
    }
    fn sin(self) -> Self {
        f64::sin(self)
    }
    fn cos(self) -> Self {
        f64::cos(self)
    }
    fn tan(self) -> Self {
        f64::tan(self)
    }
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    fn abs(self) -> Self {
        f64::abs(self)
    }
    fn min(self, o: Self) -> Self {
        f64::min(self, o)
    }
    fn max(self, o: Self) -> Self {
        f64::max(self, o)
    }
    fn floor(self) -> Self {
        f64::floor(self)
    }
    fn sign(self) -> Self {
        if self > 0.0 {
            1.0
        } else if self < 0.0 {
            -1.0
        } else {
            0.0
        }
    }
    fn step(edge: Self, x: Self) -> Self {
        if x < edge { 0.0 } else { 1.0 }
    }
    fn exp2(self) -> Self {
        f64::exp2(self)
    }
    fn log2(self) -> Self {
        f64::log2(self)
    }
    fn atan2(self, x: Self) -> Self {
        f64::atan2(self, x)
    }
    fn noise(x: Self, y: Self, z: Self) -> Self {
        noise::value_and_gradient([x, y, z])[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn push(value: f32) -> Instruction {
        Instruction::new(Op::Constant, value)
    }

    #[test]
    fn operations_keep_the_numbers_the_shaders_know() {
        for (number, op) in Op::ALL.into_iter().enumerate() {
            assert_eq!(op as usize, number);
        }
    }

    #[test]
    fn a_program_must_leave_exactly_one_value() {
        assert_eq!(check(&[]), Err(Fault::Malformed));
        assert_eq!(check(&[push(1.0), push(2.0)]), Err(Fault::Malformed));
        assert_eq!(check(&[Instruction::new(Op::Add, 0.0)]), Err(Fault::Malformed));
        assert_eq!(check(&[Instruction { op: 99, value: 0.0 }]), Err(Fault::Malformed));
        assert_eq!(check(&[Instruction::new(Op::Variable, 8.0)]), Err(Fault::Malformed));
        assert_eq!(check(&[push(1.0), push(2.0), Instruction::new(Op::Add, 0.0)]), Ok(()));
    }

    #[test]
    fn limits_are_enforced() {
        assert_eq!(check(&vec![push(1.0); MAX_INSTRUCTIONS + 1]), Err(Fault::TooLong));
        assert_eq!(check(&[push(1.0); MAX_STACK + 1]), Err(Fault::TooDeep));
    }

    #[test]
    fn arguments_keep_their_order() {
        let code = [push(1.0), push(5.0), push(0.25), Instruction::new(Op::Mix, 0.0)];
        assert_eq!(evaluate(&code, &[0.0f64; VARIABLES]), 2.0);
    }
}
