//! The way to a server: one elsewhere over TCP, or one in this process over a pipe. Both speak the same
//! gRPC, so everything behind this file is the same code.

#[cfg(feature = "local")]
mod local;
mod need;
mod retry;
mod status;

use std::{
    sync::{Mutex, PoisonError},
    time::Duration,
};

use displace_proto::v1::{
    assets_client::AssetsClient, displacement_client::DisplacementClient, server_client::ServerClient,
};
use tokio::task::JoinSet;
use tonic::{
    Request,
    transport::{Channel, Endpoint},
};
use tonic_health::pb::health_client::HealthClient;

pub(crate) use need::Need;
pub(crate) use retry::{Attempts, with_retries};
pub(crate) use status::{failure, is_transient, missing_assets};

use crate::{
    args::Global,
    error::{Error, Kind, Result},
};

/// Deadline of calls that only ask.
pub(crate) const CALL_DEADLINE: Duration = Duration::from_secs(60);
/// Deadline of calls that read a whole mesh.
pub(crate) const MESH_DEADLINE: Duration = Duration::from_secs(600);
/// Deadline of one stream of a job or a transfer; a transfer goes on in another stream.
pub(crate) const STREAM_DEADLINE: Duration = Duration::from_secs(6 * 3600);

/// Seconds a job goes on at a server elsewhere when this client is gone: long enough to call again after a
/// lost connection. Ctrl-C says farewell instead, which ends the job at once.
const REMOTE_LINGER_SECS: u32 = 10;
/// How long saying farewell to a server may keep an interrupted command.
const FAREWELL: Duration = Duration::from_secs(2);

/// An open way to a server.
pub(crate) struct Connection {
    channel: Channel,
    pub(crate) linger_secs: u32,
    farewells: Mutex<JoinSet<()>>,
    #[cfg(feature = "local")]
    local: Option<local::LocalServer>,
}

impl Connection {
    pub(crate) async fn open(global: &Global, need: Need) -> Result<Self> {
        // An empty variable is one that is not set.
        match global.server.as_deref().filter(|server| !server.is_empty()) {
            Some(_) if global.device.is_some() => Err(Error::usage(
                "--device",
                "--device chooses the device of the service in this process; a server chooses its own: leave out --device or --server",
            )),
            Some(server) => Self::remote(server).await,
            None => Self::local(global, need).await,
        }
    }

    async fn remote(server: &str) -> Result<Self> {
        let endpoint = endpoint(server)?;
        let channel = with_retries(|| async { endpoint.connect().await.map_err(|e| unreachable(server, &e)) }).await?;
        Ok(Self {
            channel,
            linger_secs: REMOTE_LINGER_SECS,
            farewells: Mutex::default(),
            #[cfg(feature = "local")]
            local: None,
        })
    }

    #[cfg(feature = "local")]
    async fn local(global: &Global, need: Need) -> Result<Self> {
        let (server, channel) = local::LocalServer::start(global, need).await?;
        Ok(Self { channel, linger_secs: 0, farewells: Mutex::default(), local: Some(server) })
    }

    #[cfg(not(feature = "local"))]
    async fn local(_global: &Global, _need: Need) -> Result<Self> {
        let message = "this build holds no service; give --server URL or set DISPLACE_SERVER";
        Err(Error::usage("--server", message))
    }

    pub(crate) fn assets(&self) -> AssetsClient<Channel> {
        AssetsClient::new(self.channel.clone())
    }

    pub(crate) fn displacement(&self) -> DisplacementClient<Channel> {
        DisplacementClient::new(self.channel.clone()).max_decoding_message_size(64 << 20)
    }

    pub(crate) fn server(&self) -> ServerClient<Channel> {
        ServerClient::new(self.channel.clone())
    }

    pub(crate) fn health(&self) -> HealthClient<Channel> {
        HealthClient::new(self.channel.clone())
    }

    /// A last word to the server, which closing waits for.
    pub(crate) fn farewell(&self, word: impl Future<Output = ()> + Send + 'static) {
        self.farewells.lock().unwrap_or_else(PoisonError::into_inner).spawn(word);
    }

    /// Lets farewells out and the service in this process put its work away. Quick: nothing of the user's
    /// waits for it.
    pub(crate) async fn close(self) {
        let mut farewells = self.farewells.into_inner().unwrap_or_else(PoisonError::into_inner);
        let _ = tokio::time::timeout(FAREWELL, async { while farewells.join_next().await.is_some() {} }).await;
        #[cfg(feature = "local")]
        if let Some(local) = self.local {
            drop(self.channel);
            local.stop().await;
        }
    }
}

/// A request with a deadline.
pub(crate) fn request<T>(message: T, deadline: Duration) -> Request<T> {
    let mut request = Request::new(message);
    request.set_timeout(deadline);
    request
}

fn endpoint(server: &str) -> Result<Endpoint> {
    let refuse = |why: &str| {
        Error::usage("--server", format!("'{server}' {why}; give an address such as http://127.0.0.1:7878"))
    };
    let url = if server.contains("://") { server.to_owned() } else { format!("http://{server}") };
    if url.starts_with("https://") {
        return Err(refuse("asks for TLS, which this build does not speak: use a proxy beside the client"));
    }
    let endpoint = Endpoint::from_shared(url).map_err(|_| refuse("is no address"))?;
    let is_http = endpoint.uri().scheme_str() == Some("http") && endpoint.uri().host().is_some_and(|h| !h.is_empty());
    if !is_http {
        return Err(refuse("is no http address"));
    }
    Ok(tuned(endpoint)?.connect_timeout(Duration::from_secs(5)))
}

/// Windows and keep-alive of the service page: a silent peer is found within 30 s, and one stream fills a
/// connection of 40 ms.
fn tuned(endpoint: Endpoint) -> Result<Endpoint> {
    let named = endpoint
        .user_agent(concat!("displace/", env!("CARGO_PKG_VERSION")))
        .map_err(|e| Error::internal(format!("the client's own name is refused: {e}")))?;
    Ok(named
        .initial_stream_window_size(4 << 20)
        .initial_connection_window_size(8 << 20)
        .http2_keep_alive_interval(Duration::from_secs(20))
        .keep_alive_timeout(Duration::from_secs(10))
        .tcp_nodelay(true))
}

fn unreachable(server: &str, cause: &tonic::transport::Error) -> Error {
    let mut reason: &dyn std::error::Error = cause;
    while let Some(source) = reason.source() {
        reason = source;
    }
    let message = format!("the server at {server} cannot be reached: {reason}; is displaced running there?");
    Error::new(Kind::Unavailable, message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_may_leave_out_the_scheme() {
        assert_eq!(endpoint("127.0.0.1:7878").unwrap().uri().to_string(), "http://127.0.0.1:7878/");
        for bad in [" ", "https://h:1", "ftp://h", "http://", "a b"] {
            let error = endpoint(bad).expect_err(bad);
            assert_eq!(error.field.as_deref(), Some("--server"), "{bad}");
        }
    }
}
