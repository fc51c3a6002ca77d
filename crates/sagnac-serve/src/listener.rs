//! Connections: who may reach the server, how many at a time, and for how long.
//!
//! # Threat model
//!
//! **What is protected**: recordings and results of units, the files of this computer, and the truth of a verdict on a bench: nobody
//! but the operator orders, repeats or cancels a test.
//!
//! **Who attacks, and what stands against it**
//!
//! | attacker | wants | rule | where |
//! |---|---|---|---|
//! | another computer of the network | reach the server | it listens at this computer alone; anywhere else only behind a declared proxy, which has the certificate | `serve` |
//! | another user of this computer | order tests, read results | a secret of 256 bits, made at each start, shown to who started the server; compared in constant time; the data folder is the user's own | `token`, `guard` |
//! | a web page in the operator's browser | order tests (cross-site request forgery) | the cookie is `SameSite=Strict`; `Origin` and `Sec-Fetch-Site` of what changes something; only JSON or the parts of a form; no GET changes anything; no CORS | `guard` |
//! | the same by a name that it points at this computer (DNS rebinding) | read results as if it were ours | list of hosts, first, on every method; such a GET tells no origin | `guard` |
//! | a web page that frames ours | have the operator click | `frame-ancestors 'none'`, `X-Frame-Options` | `routes` |
//! | a name, a serial number, a message that holds markup | run a script in our page | templates escape; the policy allows no script but our file | `pages`, `routes` |
//! | a report with markup | ask the server in the operator's name | its policy allows no connection and no form | `results` |
//! | who may order tests | read other files of this computer | recordings lie below configured folders, procedures in configured folders, both by where they really are; uploads get a random name in a folder of their own, so that a manifest among them finds nothing beside it | `recordings`, `catalogue`, `uploads` |
//! | who may order tests | run a program | the process gets its arguments one by one, options before `--`, and no shell; procedures are never uploaded | `worker`, `intake` |
//! | who may order tests | fill the disk, the memory, the processor | size of an upload, quota of all, length of texts, length of the queue, one test a core; events are bounded | `uploads`, `intake`, `queue`, `events` |
//! | a broken or hostile recording | crash or hang the server | it is read by a process of its own, which may be cancelled | `worker` |
//! | a client that is slow or silent | hold every connection | bounds on connections, heads, bodies, pauses, streams, writes that do not move on | here, `uploads`, `api` |
//! | who reads the log | the secret | the log has methods, paths and status, no queries, no heads, no bodies; the secret stands behind `#`, which browsers do not send | `guard` |
//!
//! **Not protected against**: the administrator of this computer; another program of the same user, which can read the data folder
//! as it is; who may write into a recordings folder, and thereby chooses what is tested, also between the look at a name and its
//! reading; who may write into a procedures folder: a procedure may name a program to run. There is no encryption of its own: behind a
//! proxy, the way between proxy and server is trusted. The server refuses to run with all rights, and signs nothing: keys stay at the terminal.

use axum::Router;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::future::Future;
use std::io::{Error, ErrorKind, Result};
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;
use tokio::time::{Instant, Sleep, sleep};

/// Most connections at a time.
pub const MAX_CONNECTIONS: usize = 128;
/// Longest time in which the head of a request arrives, also on a connection that was used before.
const MAX_HEAD_TIME: Duration = Duration::from_secs(15);
/// Most bytes of a head.
const MAX_HEAD_BYTES: usize = 16 << 10;
/// Longest time in which nothing of an answer moves on.
const MAX_WRITE_PAUSE: Duration = Duration::from_secs(30);
/// Pause after the system gave no connection, as where it has no more files.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

/// Serves connections until the task ends.
pub async fn serve(listener: TcpListener, router: Router) {
    let slots = Arc::new(Semaphore::new(MAX_CONNECTIONS));
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            sleep(ACCEPT_PAUSE).await;
            continue;
        };
        // One too many is closed at once, so that it does not wait for those that are slow.
        let Ok(slot) = slots.clone().try_acquire_owned() else { continue };
        let router = router.clone();
        tokio::spawn(async move {
            connection(stream, router).await;
            drop(slot);
        });
    }
}

async fn connection(stream: TcpStream, router: Router) {
    let served = hyper::server::conn::http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(MAX_HEAD_TIME)
        .max_buf_size(MAX_HEAD_BYTES)
        .serve_connection(TokioIo::new(Moving::new(stream)), TowerToHyperService::new(router))
        .await;
    // A client that went away or spoke no HTTP is nobody to answer.
    drop(served);
}

/// A connection that ends where nothing of an answer moves on.
struct Moving {
    stream: TcpStream,
    stuck: Option<Pin<Box<Sleep>>>,
}

impl Moving {
    fn new(stream: TcpStream) -> Moving {
        Moving { stream, stuck: None }
    }

    /// Passes on what a write gave, or its end where it has waited for too long.
    fn watched<T>(&mut self, written: Poll<Result<T>>, context: &mut Context<'_>) -> Poll<Result<T>> {
        if written.is_ready() {
            self.stuck = None;
            return written;
        }
        let stuck = self
            .stuck
            .get_or_insert_with(|| Box::pin(tokio::time::sleep_until(Instant::now() + MAX_WRITE_PAUSE)));
        match stuck.as_mut().poll(context) {
            Poll::Ready(()) => Poll::Ready(Err(Error::from(ErrorKind::TimedOut))),
            Poll::Pending => Poll::Pending,
        }
    }
}

impl AsyncRead for Moving {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<Result<()>> {
        Pin::new(&mut self.stream).poll_read(context, into)
    }
}

impl AsyncWrite for Moving {
    fn poll_write(mut self: Pin<&mut Self>, context: &mut Context<'_>, bytes: &[u8]) -> Poll<Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write(context, bytes);
        self.watched(written, context)
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Result<()>> {
        let flushed = Pin::new(&mut self.stream).poll_flush(context);
        self.watched(flushed, context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}
