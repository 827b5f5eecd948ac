//! From words to a tree, by precedence: `+ -`, then `* /`, then unary `-`, then `^` (right to left).

use displace_glsl::expression::{Instruction, MAX_INTEGER_POWER, Op, VARIABLES, Variable, evaluate};

use super::token::{Placed, Problem, Token, tokens};

/// Deepest nesting of parentheses, signs and powers.
const MAX_DEPTH: usize = 64;

const VARIABLE_NAMES: [(&str, Variable); VARIABLES] = [
    ("u", Variable::U),
    ("v", Variable::V),
    ("x", Variable::X),
    ("y", Variable::Y),
    ("z", Variable::Z),
    ("nx", Variable::NormalX),
    ("ny", Variable::NormalY),
    ("nz", Variable::NormalZ),
];

/// Name and number of arguments; [`call`] says what each becomes.
const FUNCTIONS: [(&str, usize); 25] = [
    ("abs", 1),
    ("atan", 1),
    ("atan2", 2),
    ("clamp", 3),
    ("cos", 1),
    ("exp", 1),
    ("exp2", 1),
    ("floor", 1),
    ("fract", 1),
    ("log", 1),
    ("log2", 1),
    ("max", 2),
    ("min", 2),
    ("mix", 3),
    ("mod", 2),
    ("noise", 3),
    ("pow", 2),
    ("sign", 1),
    ("sin", 1),
    ("smoothstep", 3),
    ("sqrt", 1),
    ("step", 2),
    ("tan", 1),
    ("ceil", 1),
    ("round", 1),
];

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    Constant(f64),
    Variable(Variable),
    /// Operation, immediate value, operands.
    Apply(Op, f32, Vec<Node>),
}

/// Far more than fit a program, few enough to hold.
const MAX_NODES: usize = 4096;

impl Node {
    fn apply<const N: usize>(op: Op, operands: [Self; N]) -> Self {
        Self::Apply(op, 0.0, operands.into())
    }

    fn nodes(&self) -> usize {
        match self {
            Self::Apply(_, _, operands) => 1 + operands.iter().map(Self::nodes).sum::<usize>(),
            _ => 1,
        }
    }

    pub(super) fn instruction(&self) -> Instruction {
        match self {
            Self::Constant(value) => Instruction::new(Op::Constant, *value as f32),
            Self::Variable(variable) => Instruction::new(Op::Variable, *variable as u32 as f32),
            Self::Apply(op, value, _) => Instruction::new(*op, *value),
        }
    }

    /// Replaces operations on constants by their result, computed in f64 and rounded once.
    pub(super) fn folded(self) -> Self {
        let Self::Apply(op, value, operands) = self else { return self };
        let operands: Vec<Self> = operands.into_iter().map(Self::folded).collect();
        match fold(op, value, &operands) {
            Some(result) => Self::Constant(result),
            None => Self::Apply(op, value, operands),
        }
    }
}

/// The result when all operands are constant and the result is finite in f32.
fn fold(op: Op, value: f32, operands: &[Node]) -> Option<f64> {
    let mut variables = [0.0; VARIABLES];
    let mut code = Vec::new();
    for (k, operand) in operands.iter().enumerate() {
        let Node::Constant(constant) = operand else { return None };
        variables[k] = *constant;
        code.push(Instruction::new(Op::Variable, k as f32));
    }
    code.push(Instruction::new(op, value));
    let result: f64 = evaluate(&code, &variables);
    (result as f32).is_finite().then_some(result)
}

pub(super) fn parse(source: &str) -> Result<Node, Problem> {
    let mut parser = Parser { tokens: tokens(source)?, at: 0, depth: 0 };
    let tree = parser.sum()?;
    parser.expect_end()?;
    Ok(tree)
}

struct Parser {
    /// The last one is `End` and is never passed.
    tokens: Vec<Placed>,
    at: usize,
    depth: usize,
}

impl Parser {
    fn peek(&self) -> &Placed {
        &self.tokens[self.at]
    }

    fn next(&mut self) -> Placed {
        let placed = self.peek().clone();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        placed
    }

    fn take(&mut self, symbol: char) -> bool {
        let found = self.peek().token == Token::Symbol(symbol);
        if found {
            self.next();
        }
        found
    }

    fn expected(&self, what: &str) -> Problem {
        let found = self.peek();
        Problem::new(found.column, format!("expected {what}, found {}", found.text))
    }

    fn expect_end(&self) -> Result<(), Problem> {
        if self.peek().token == Token::End { Ok(()) } else { Err(self.expected("an operator or the end")) }
    }

    fn deeper<T>(&mut self, parse: impl FnOnce(&mut Self) -> Result<T, Problem>) -> Result<T, Problem> {
        if self.depth == MAX_DEPTH {
            return Err(Problem::new(self.peek().column, format!("nested deeper than {MAX_DEPTH}")));
        }
        self.depth += 1;
        let result = parse(self);
        self.depth -= 1;
        result
    }

    fn sum(&mut self) -> Result<Node, Problem> {
        let mut left = self.product()?;
        loop {
            let op = match () {
                () if self.take('+') => Op::Add,
                () if self.take('-') => Op::Subtract,
                () => return Ok(left),
            };
            left = Node::apply(op, [left, self.product()?]);
        }
    }

    fn product(&mut self) -> Result<Node, Problem> {
        let mut left = self.signed()?;
        loop {
            let op = match () {
                () if self.take('*') => Op::Multiply,
                () if self.take('/') => Op::Divide,
                () => return Ok(left),
            };
            left = Node::apply(op, [left, self.signed()?]);
        }
    }

    fn signed(&mut self) -> Result<Node, Problem> {
        if self.take('-') {
            Ok(Node::apply(Op::Negate, [self.deeper(Self::signed)?]))
        } else if self.take('+') {
            self.deeper(Self::signed)
        } else {
            self.power()
        }
    }

    fn power(&mut self) -> Result<Node, Problem> {
        let base = self.atom()?;
        if !self.take('^') {
            return Ok(base);
        }
        let exponent = self.deeper(Self::signed)?;
        Ok(raised(base, exponent))
    }

    fn atom(&mut self) -> Result<Node, Problem> {
        match self.peek().token.clone() {
            Token::Number(value) => {
                self.next();
                Ok(Node::Constant(value))
            }
            Token::Name(name) => self.named(&name),
            Token::Symbol('(') => {
                self.next();
                let inner = self.deeper(Self::sum)?;
                if self.take(')') { Ok(inner) } else { Err(self.expected("')'")) }
            }
            _ => Err(self.expected("a value")),
        }
    }

    fn named(&mut self, name: &str) -> Result<Node, Problem> {
        let column = self.next().column;
        if self.take('(') {
            let arguments = self.arguments()?;
            return call(name, arguments, column);
        }
        match name {
            "pi" => return Ok(Node::Constant(std::f64::consts::PI)),
            "e" => return Ok(Node::Constant(std::f64::consts::E)),
            _ => {}
        }
        match VARIABLE_NAMES.iter().find(|(known, _)| *known == name) {
            Some((_, variable)) => Ok(Node::Variable(*variable)),
            None => Err(Problem::new(column, format!("unknown name '{name}'"))
                .hint("; variables are u, v, x, y, z, nx, ny, nz; constants are pi, e".into())),
        }
    }

    fn arguments(&mut self) -> Result<Vec<Node>, Problem> {
        let mut arguments = vec![self.deeper(Self::sum)?];
        while self.take(',') {
            arguments.push(self.deeper(Self::sum)?);
        }
        if self.take(')') { Ok(arguments) } else { Err(self.expected("',' or ')'")) }
    }
}

fn call(name: &str, arguments: Vec<Node>, column: usize) -> Result<Node, Problem> {
    let Some((_, arity)) = FUNCTIONS.iter().find(|(known, _)| *known == name) else {
        let names: Vec<&str> = FUNCTIONS.iter().map(|(known, _)| *known).collect();
        let hint = format!("; functions are {}", names.join(", "));
        return Err(Problem::new(column, format!("unknown function '{name}'")).hint(hint));
    };
    let (found, plural) = (arguments.len(), if *arity == 1 { "" } else { "s" });
    if found != *arity {
        return Err(Problem::new(column, format!("{name} takes {arity} argument{plural}, found {found}")));
    }
    let made = function(name, arguments);
    // Some functions use an operand twice: nested, they would double it again and again.
    if made.nodes() > MAX_NODES {
        let message = format!("{name} makes more than {MAX_NODES} steps of this: simplify it");
        return Err(Problem::new(column, message));
    }
    Ok(made)
}

/// What a call with the right number of arguments becomes.
fn function(name: &str, arguments: Vec<Node>) -> Node {
    use Node::Constant;
    let mut rest = arguments.into_iter();
    let mut next = || rest.next().unwrap_or(Constant(0.0));
    match name {
        "abs" => Node::apply(Op::Absolute, [next()]),
        "atan" => Node::apply(Op::ArcTangent2, [next(), Constant(1.0)]),
        "atan2" => Node::apply(Op::ArcTangent2, [next(), next()]),
        "ceil" => {
            let below = Node::apply(Op::Floor, [Node::apply(Op::Negate, [next()])]);
            Node::apply(Op::Negate, [below])
        }
        "clamp" => {
            let above = Node::apply(Op::Maximum, [next(), next()]);
            Node::apply(Op::Minimum, [above, next()])
        }
        "cos" => Node::apply(Op::Cosine, [next()]),
        "exp" => {
            let scaled = Node::apply(Op::Multiply, [next(), Constant(std::f64::consts::LOG2_E)]);
            Node::apply(Op::Exp2, [scaled])
        }
        "exp2" => Node::apply(Op::Exp2, [next()]),
        "floor" => Node::apply(Op::Floor, [next()]),
        "fract" => Node::apply(Op::Modulo, [next(), Constant(1.0)]),
        "log" => {
            let log2 = Node::apply(Op::Log2, [next()]);
            Node::apply(Op::Multiply, [log2, Constant(std::f64::consts::LN_2)])
        }
        "log2" => Node::apply(Op::Log2, [next()]),
        "max" => Node::apply(Op::Maximum, [next(), next()]),
        "min" => Node::apply(Op::Minimum, [next(), next()]),
        "mix" => Node::apply(Op::Mix, [next(), next(), next()]),
        "mod" => Node::apply(Op::Modulo, [next(), next()]),
        "noise" => Node::apply(Op::Noise, [next(), next(), next()]),
        "pow" => raised(next(), next()),
        "round" => {
            let half_up = Node::apply(Op::Add, [next(), Constant(0.5)]);
            Node::apply(Op::Floor, [half_up])
        }
        "sign" => Node::apply(Op::Sign, [next()]),
        "sin" => Node::apply(Op::Sine, [next()]),
        "smoothstep" => {
            let (from, to, x) = (next(), next(), next());
            let width = Node::apply(Op::Subtract, [to, from.clone()]);
            let t = Node::apply(Op::Divide, [Node::apply(Op::Subtract, [x, from]), width]);
            let positive = Node::apply(Op::Maximum, [t, Constant(0.0)]);
            Node::apply(Op::Smooth, [Node::apply(Op::Minimum, [positive, Constant(1.0)])])
        }
        "sqrt" => Node::apply(Op::SquareRoot, [next()]),
        "step" => Node::apply(Op::Step, [next(), next()]),
        _ => Node::apply(Op::Tangent, [next()]),
    }
}

/// `base ^ exponent`: whole constant exponents become chains of multiplications, others 2^(y log2 x).
fn raised(base: Node, exponent: Node) -> Node {
    match exponent.folded() {
        Node::Constant(0.0) => Node::Constant(1.0),
        Node::Constant(n) if n.fract() == 0.0 && n.abs() <= f64::from(MAX_INTEGER_POWER) => {
            Node::Apply(Op::PowerInteger, n as f32, vec![base])
        }
        exponent => {
            let scaled = Node::apply(Op::Multiply, [exponent, Node::apply(Op::Log2, [base])]);
            Node::apply(Op::Exp2, [scaled])
        }
    }
}
