//! Deadlines: `grpc-timeout` ends a call, its stream included, with DEADLINE_EXCEEDED.
//!
//! tonic's own timer answers CANCELLED and does not cover streams. This layer sits inside it and is a little
//! earlier, so its answer is the one that is sent.

use std::{
    pin::Pin,
    task::{Context, Poll},
    time::Duration,
};

use bytes::Bytes;
use futures::future::BoxFuture;
use http_body::Frame;
use tokio::time::{Instant, Sleep};
use tonic::{
    Status,
    body::Body,
    codegen::{
        Service,
        http::{HeaderMap, Request, Response},
    },
};

use super::status::deadline_exceeded;

/// How much earlier than the client's timer: enough to be first, too little to matter.
const EARLIER: Duration = Duration::from_millis(3);

/// Adds deadlines to a service.
#[derive(Clone, Copy, Debug)]
pub struct DeadlineLayer;

impl<S> tower::Layer<S> for DeadlineLayer {
    type Service = Deadline<S>;

    fn layer(&self, inner: S) -> Deadline<S> {
        Deadline { inner }
    }
}

/// A service whose calls end at their deadline.
#[derive(Clone, Debug)]
pub struct Deadline<S> {
    inner: S,
}

impl<S> Service<Request<Body>> for Deadline<S>
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
        let Some(timeout) = timeout_of(request.headers()) else { return Box::pin(self.inner.call(request)) };
        let deadline = Instant::now() + timeout.saturating_sub(EARLIER.min(timeout / 10));
        let answer = tokio::time::timeout_at(deadline, self.inner.call(request));
        Box::pin(async move {
            match answer.await {
                Ok(response) => Ok(response?.map(|body| Body::new(DeadlineBody::new(body, deadline)))),
                Err(_) => Ok(deadline_exceeded().into_http()),
            }
        })
    }
}

/// A body that ends at a deadline.
struct DeadlineBody {
    inner: Option<Body>,
    sleep: Pin<Box<Sleep>>,
}

impl DeadlineBody {
    fn new(inner: Body, deadline: Instant) -> Self {
        Self { inner: Some(inner), sleep: Box::pin(tokio::time::sleep_until(deadline)) }
    }
}

impl http_body::Body for DeadlineBody {
    type Data = Bytes;
    type Error = Status;

    fn poll_frame(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<Result<Frame<Bytes>, Status>>> {
        let Some(inner) = &mut self.inner else { return Poll::Ready(None) };
        if let Poll::Ready(frame) = Pin::new(inner).poll_frame(context) {
            return Poll::Ready(frame);
        }
        if self.sleep.as_mut().poll(context).is_pending() {
            return Poll::Pending;
        }
        // Drops the stream, and with it the listener.
        self.inner = None;
        let mut trailers = HeaderMap::new();
        Poll::Ready(Some(deadline_exceeded().add_header(&mut trailers).map(|()| Frame::trailers(trailers))))
    }

    fn is_end_stream(&self) -> bool {
        self.inner.as_ref().is_none_or(http_body::Body::is_end_stream)
    }
}

/// At most eight digits and a unit, by the gRPC specification. What is malformed is no deadline.
fn timeout_of(headers: &HeaderMap) -> Option<Duration> {
    let text = headers.get("grpc-timeout")?.to_str().ok()?;
    let (digits, unit) = text.split_at_checked(text.len().checked_sub(1)?)?;
    if digits.len() > 8 {
        return None;
    }
    let value: u64 = digits.parse().ok()?;
    Some(match unit {
        "H" => Duration::from_secs(value * 3600),
        "M" => Duration::from_secs(value * 60),
        "S" => Duration::from_secs(value),
        "m" => Duration::from_millis(value),
        "u" => Duration::from_micros(value),
        "n" => Duration::from_nanos(value),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, expected: Option<Duration>) {
        let mut headers = HeaderMap::new();
        headers.insert("grpc-timeout", text.parse().unwrap());
        assert_eq!(timeout_of(&headers), expected, "{text}");
    }

    #[test]
    fn timeouts_read_as_the_specification_says() {
        check("5S", Some(Duration::from_secs(5)));
        check("250m", Some(Duration::from_millis(250)));
        check("99999999H", Some(Duration::from_secs(99_999_999 * 3600)));
    }

    #[test]
    fn malformed_timeouts_are_no_deadline() {
        for text in ["", "S", "5", "5x", "-1S", "999999999S"] {
            check(text, None);
        }
    }
}
