//! Lets web pages of named origins call the service by gRPC-Web. Without origins it does nothing.

use std::{
    sync::Arc,
    task::{Context, Poll},
};

use futures::future::BoxFuture;
use tonic::{
    body::Body,
    codegen::{
        Service,
        http::{HeaderMap, HeaderValue, Method, Request, Response, header},
    },
};

use super::EXPOSED_HEADERS;
use crate::domain::{Error, Result};

/// How long a browser may remember a preflight, seconds.
const REMEMBER_SECS: &str = "3600";

/// Adds the answers browsers ask for.
#[derive(Clone, Debug)]
pub struct CorsLayer {
    origins: Arc<[HeaderValue]>,
}

impl CorsLayer {
    pub(crate) fn new(origins: &[String]) -> Result<Self> {
        let parse = |origin: &String| {
            let bad =
                || Error::invalid("cors_origins", format!("'{origin}' is not an origin such as https://example.org"));
            HeaderValue::from_str(origin).map_err(|cause| bad().with_cause(cause))
        };
        Ok(Self { origins: origins.iter().map(parse).collect::<Result<Vec<_>>>()?.into() })
    }
}

impl<S> tower::Layer<S> for CorsLayer {
    type Service = Cors<S>;

    fn layer(&self, inner: S) -> Cors<S> {
        Cors { inner, origins: Arc::clone(&self.origins) }
    }
}

/// A service that answers preflights itself.
#[derive(Clone, Debug)]
pub struct Cors<S> {
    inner: S,
    origins: Arc<[HeaderValue]>,
}

impl<S> Service<Request<Body>> for Cors<S>
where
    S: Service<Request<Body>, Response = Response<Body>>,
    S::Future: Send + 'static,
    S::Error: Send + 'static,
{
    type Response = Response<Body>;
    type Error = S::Error;
    type Future = BoxFuture<'static, Result<Response<Body>, S::Error>>;

    fn poll_ready(&mut self, context: &mut Context<'_>) -> Poll<Result<(), S::Error>> {
        self.inner.poll_ready(context)
    }

    fn call(&mut self, request: Request<Body>) -> Self::Future {
        let origin = request.headers().get(header::ORIGIN).filter(|origin| self.origins.contains(origin)).cloned();
        let Some(origin) = origin else { return Box::pin(self.inner.call(request)) };
        if request.method() == Method::OPTIONS {
            let answer = preflight(request.headers(), origin);
            return Box::pin(async move { Ok(answer) });
        }
        let answer = self.inner.call(request);
        Box::pin(async move {
            let mut response = answer.await?;
            allow(response.headers_mut(), origin);
            Ok(response)
        })
    }
}

fn allow(headers: &mut HeaderMap, origin: HeaderValue) {
    headers.insert(header::ACCESS_CONTROL_ALLOW_ORIGIN, origin);
    headers.insert(header::VARY, HeaderValue::from_static("origin"));
    for name in EXPOSED_HEADERS {
        headers.append(header::ACCESS_CONTROL_EXPOSE_HEADERS, name.into());
    }
}

fn preflight(asked: &HeaderMap, origin: HeaderValue) -> Response<Body> {
    let mut response = Response::new(Body::empty());
    let headers = response.headers_mut();
    allow(headers, origin);
    headers.insert(header::ACCESS_CONTROL_ALLOW_METHODS, HeaderValue::from_static("POST"));
    headers.insert(header::ACCESS_CONTROL_MAX_AGE, HeaderValue::from_static(REMEMBER_SECS));
    if let Some(names) = asked.get(header::ACCESS_CONTROL_REQUEST_HEADERS) {
        headers.insert(header::ACCESS_CONTROL_ALLOW_HEADERS, names.clone());
    }
    response
}
