//! Expressions such as `0.5*sin(20*pi*x)`: parsed to one small bytecode with a cost limit.
//! The bytecode and its interpreters are `displace_glsl::expression`.

mod parser;
mod token;

use displace_glsl::expression::{Fault, Instruction, MAX_INSTRUCTIONS, MAX_STACK, check, reads};

use super::{Error, Result};
use parser::Node;

/// Longest source text, in bytes.
pub const MAX_SOURCE_BYTES: usize = 4096;

/// A compiled expression; `code` has passed `displace_glsl::expression::check`.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    pub source: String,
    pub code: Vec<Instruction>,
}

impl Program {
    /// Parses and compiles. Variables are u v x y z nx ny nz, constants pi and e.
    pub fn parse(source: &str) -> Result<Self> {
        if source.len() > MAX_SOURCE_BYTES {
            let length = source.len();
            return Err(invalid(format!("the text has {length} bytes; allowed are at most {MAX_SOURCE_BYTES}")));
        }
        let tree = parser::parse(source).map_err(|problem| invalid(problem.with_caret(source)))?.folded();
        let mut code = Vec::new();
        emit(&tree, &mut code);
        match check(&code) {
            Ok(()) => Ok(Self { source: source.to_owned(), code }),
            Err(Fault::TooLong) => {
                Err(invalid(format!("takes {} steps; allowed are at most {MAX_INSTRUCTIONS}: simplify it", code.len())))
            }
            Err(Fault::TooDeep) => {
                Err(invalid(format!("holds more than {MAX_STACK} values at once: write the deepest operand first")))
            }
            Err(Fault::Malformed) => Err(Error::internal("an expression compiled to malformed code")),
        }
    }

    /// Whether the expression depends on the texture coordinates.
    #[must_use]
    pub fn reads_uv(&self) -> bool {
        reads(&self.code, 0..=1)
    }

    /// Whether the expression depends on the normal.
    #[must_use]
    pub fn reads_normal(&self) -> bool {
        reads(&self.code, 5..=7)
    }
}

fn invalid(message: String) -> Error {
    Error::invalid("expression", message)
}

fn emit(node: &Node, code: &mut Vec<Instruction>) {
    if let Node::Apply(_, _, arguments) = node {
        arguments.iter().for_each(|argument| emit(argument, code));
    }
    code.push(node.instruction());
}

#[cfg(test)]
mod tests {
    use displace_glsl::expression::{VARIABLES, evaluate};

    use super::*;

    /// u = 0.25, v = 0.5, x = 2, y = −3, z = 0.1, n = (0, 0, 1).
    const AT: [f64; VARIABLES] = [0.25, 0.5, 2.0, -3.0, 0.1, 0.0, 0.0, 1.0];

    fn value(source: &str) -> f64 {
        evaluate(&Program::parse(source).unwrap_or_else(|e| panic!("{e}")).code, &AT)
    }

    fn message(source: &str) -> String {
        Program::parse(source).map(|p| format!("{p:?}")).unwrap_err().message
    }

    #[test]
    fn operators_bind_as_in_mathematics() {
        for (source, expected) in [
            ("1 + 2 * 3", 7.0),
            ("-x^2", -4.0),
            ("2^-1", 0.5),
            ("2^3^2", 512.0),
            ("10 - 4 - 3", 3.0),
            ("12 / 2 / 3", 2.0),
            ("(1 + 2) * 3", 9.0),
            ("x^3 + y^2", 17.0),
            ("--x", 2.0),
            ("1.5e-1 + .5", 0.65),
        ] {
            assert!((value(source) - expected).abs() < 1e-6, "{source} gives {}", value(source));
        }
    }

    #[test]
    fn functions_mean_what_glsl_means() {
        for (source, expected) in [
            ("sin(pi*v)", 1.0),
            ("mod(y, x)", 1.0),
            ("fract(-z)", 0.9),
            ("clamp(y, -1, 1)", -1.0),
            ("mix(x, y, 0.25)", 0.75),
            ("smoothstep(0, 1, u)", 0.15625),
            ("step(0, y)", 0.0),
            ("sign(y)", -1.0),
            ("log(exp(x))", 2.0),
            ("pow(x, v)", std::f64::consts::SQRT_2),
            ("min(x, max(y, nz))", 1.0),
            ("atan(1)", std::f64::consts::FRAC_PI_4),
            ("e", std::f64::consts::E),
        ] {
            assert!((value(source) - expected).abs() < 1e-6, "{source} gives {}", value(source));
        }
    }

    #[test]
    fn constants_fold_before_they_are_rounded() {
        let program = Program::parse("sin(20*pi*u)").unwrap();
        assert_eq!(program.code.len(), 4);
        assert_eq!(program.code[0].value, (20.0 * std::f64::consts::PI) as f32);
    }

    #[test]
    fn an_error_points_at_its_column() {
        assert_eq!(message("sin(20*)"), "expected a value, found ')' at column 8\n  sin(20*)\n         ^");
        assert_eq!(message("1 +"), "expected a value, found the end at column 4\n  1 +\n     ^");
        assert!(message("u $ v").starts_with("unexpected character '$' at column 3"));
        assert!(message("u v").starts_with("expected an operator or the end, found 'v' at column 3"));
        assert!(message("(u").starts_with("expected ')', found the end at column 3"));
        assert!(message("w + 1").contains("unknown name 'w' at column 1; variables are u, v, x"));
        assert!(message("sine(u)").contains("unknown function 'sine' at column 1; functions are abs"));
        assert!(message("sin(u, v)").starts_with("sin takes 1 argument, found 2 at column 1"));
        assert!(message("").starts_with("expected a value, found the end at column 1"));
        assert!(message("1e99").starts_with("the number '1e99' does not fit 32 bits at column 1"));
    }

    #[test]
    fn hostile_nesting_is_refused_before_it_hurts() {
        assert!(message(&"(".repeat(4000)).starts_with("nested deeper than"));
        assert!(message(&"-".repeat(4000)).starts_with("nested deeper than"));
        assert!(message(&"u^".repeat(2000)).starts_with("nested deeper than"));
        assert!(message(&"x".repeat(5000)).contains("5000 bytes"));
        let doubling = (0..60).fold("u".to_owned(), |inner, _| format!("smoothstep({inner},1,v)"));
        assert!(message(&doubling).contains("smoothstep makes more than"));
    }

    #[test]
    fn limits_name_themselves() {
        assert!(message(&vec!["u"; 200].join("+")).contains("takes 399 steps"));
        let deep = (0..20).fold("u".to_owned(), |inner, _| format!("v*({inner}+1)"));
        assert!(message(&deep).contains("more than 16 values"));
    }
}
