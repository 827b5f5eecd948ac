//! `displace methods`: how a detail can be realised.

use displace_proto::v1::{GetCapabilitiesRequest, MethodInfo};
use serde_json::{Value, json};

use super::Session;
use crate::{
    connection::{CALL_DEADLINE, request},
    error::Result,
    output::Terminal,
    transfer::unary,
};

pub(super) async fn run(session: &Session, terminal: &mut Terminal<'_>) -> Result<()> {
    let connection = session.connection().await?;
    let answer = unary(|| async move {
        connection.server().get_capabilities(request(GetCapabilitiesRequest {}, CALL_DEADLINE)).await
    })
    .await?;
    let methods: Vec<Value> = answer.methods.iter().map(as_json).collect();
    let words: String = answer.methods.iter().map(words).collect();
    terminal.report(&json!({ "methods": methods }), &words)
}

fn as_json(method: &MethodInfo) -> Value {
    json!({ "name": method.name, "summary": method.summary, "represents": method.represents, "cost": method.cost })
}

fn words(method: &MethodInfo) -> String {
    let MethodInfo { name, summary, represents, cost } = method;
    format!("{name}\n    {summary}\n    represents: {}; cost: {cost}\n", represents.join(", "))
}
