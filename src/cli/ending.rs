//! Requests to end that a verb carries out itself, after the piece of work that it is at.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Requests that are left to the verb: the first ends it after the present piece of work, the second ends that too. A further
/// one ends the program at once.
const DEFERRED_REQUESTS: usize = 2;

static DEFERS: AtomicBool = AtomicBool::new(false);
static REQUESTS: AtomicUsize = AtomicUsize::new(0);

/// From now on, requests to end are left to the verb.
pub fn defer() {
    DEFERS.store(true, Ordering::SeqCst);
}

/// Takes a request to end; false where the program is to end at once.
pub fn request() -> bool {
    DEFERS.load(Ordering::SeqCst) && REQUESTS.fetch_add(1, Ordering::SeqCst) < DEFERRED_REQUESTS
}

/// True where the verb is to end after the present piece of work.
pub fn is_asked() -> bool {
    REQUESTS.load(Ordering::SeqCst) > 0
}

/// True where the present piece of work is to end too.
pub fn is_urgent() -> bool {
    REQUESTS.load(Ordering::SeqCst) >= DEFERRED_REQUESTS
}
