//! The words of an expression and where they stand.

/// A fault in the text, at a column counted from 0 in characters.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Problem {
    pub message: String,
    pub column: usize,
    /// Follows the column in the message.
    pub hint: String,
}

impl Problem {
    pub(super) fn new(column: usize, message: impl Into<String>) -> Self {
        Self { message: message.into(), column, hint: String::new() }
    }

    pub(super) fn hint(mut self, hint: String) -> Self {
        self.hint = hint;
        self
    }

    /// The message, then the source with a caret under the column.
    pub(super) fn with_caret(&self, source: &str) -> String {
        let Self { message, column, hint } = self;
        let shown: String = source.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        format!("{message} at column {}{hint}\n  {shown}\n  {}^", column + 1, " ".repeat(*column))
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Name(String),
    Symbol(char),
    End,
}

/// A token, its column, and its text as messages show it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Placed {
    pub token: Token,
    pub column: usize,
    pub text: String,
}

pub(super) fn tokens(source: &str) -> Result<Vec<Placed>, Problem> {
    let chars: Vec<char> = source.chars().collect();
    let mut placed = Vec::new();
    let mut at = 0;
    while at < chars.len() {
        if chars[at].is_whitespace() {
            at += 1;
            continue;
        }
        let length = word_length(&chars[at..]);
        let text: String = chars[at..at + length].iter().collect();
        placed.push(Placed { token: token(&text, at)?, column: at, text: format!("'{text}'") });
        at += length;
    }
    placed.push(Placed { token: Token::End, column: chars.len(), text: "the end".into() });
    Ok(placed)
}

/// Characters of the word at the start of `chars`.
fn word_length(chars: &[char]) -> usize {
    let first = chars[0];
    if first.is_ascii_digit() || first == '.' {
        number_length(chars)
    } else if first.is_ascii_alphabetic() {
        chars.iter().take_while(|c| c.is_ascii_alphanumeric() || **c == '_').count()
    } else {
        1
    }
}

fn number_length(chars: &[char]) -> usize {
    let digits = |from: usize| chars[from..].iter().take_while(|c| c.is_ascii_digit() || **c == '.').count();
    let mut length = digits(0);
    if matches!(chars.get(length), Some('e' | 'E')) {
        let sign = usize::from(matches!(chars.get(length + 1), Some('+' | '-')));
        let exponent = chars.get(length + 1 + sign..).map_or(0, |_| digits(length + 1 + sign));
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    length
}

fn token(text: &str, column: usize) -> Result<Token, Problem> {
    match text.chars().next() {
        Some(c) if c.is_ascii_digit() || c == '.' => number(text, column),
        Some(c) if c.is_ascii_alphabetic() => Ok(Token::Name(text.to_owned())),
        Some(c) if "+-*/^(),".contains(c) => Ok(Token::Symbol(c)),
        _ => Err(Problem::new(column, format!("unexpected character '{}'", text.escape_debug()))),
    }
}

fn number(text: &str, column: usize) -> Result<Token, Problem> {
    let value: f64 = text.parse().map_err(|_| Problem::new(column, format!("'{text}' is not a number")))?;
    if (value as f32).is_finite() {
        Ok(Token::Number(value))
    } else {
        Err(Problem::new(column, format!("the number '{text}' does not fit 32 bits")))
    }
}
