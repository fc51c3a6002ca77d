//! What the optimiser makes of a function that costs seconds a row.

mod support;

use datafusion::prelude::{SessionConfig, SessionContext};
use sagnac_archive::functions::Function;
use sagnac_archive::{job_list, session, stores};
use support::Archive;

#[tokio::test(flavor = "multi_thread")]
async fn no_recording_is_evaluated_twice() {
    let archive = Archive::of(6, 300);
    let context = SessionContext::new_with_state(session::state(SessionConfig::new()).unwrap());
    let table = job_list::table(stores::folder(&archive.path("jobs")).unwrap()).unwrap();
    context.register_table("jobs", table).unwrap();
    let once = "SELECT uri, sagnac_analyze(uri) AS o FROM jobs";
    for sql in [
        format!("SELECT uri, o['serial'], o['verdict'], o['hash'] FROM ({once})"),
        format!("SELECT o['serial'] FROM ({once}) WHERE o['verdict'] = 'none' AND o['error'] IS NULL"),
        format!("SELECT o['serial'], o['hash'] FROM ({once}) ORDER BY o['hash'] LIMIT 6"),
        format!("SELECT o['verdict'], count(*) FROM ({once}) GROUP BY o['verdict'] HAVING count(*) > 0"),
    ] {
        let before = Function::evaluated();
        let rows: usize =
            context.sql(&sql).await.unwrap().collect().await.unwrap().iter().map(|b| b.num_rows()).sum();
        assert!(rows > 0, "{sql}");
        assert_eq!(Function::evaluated() - before, 6, "{sql}");
    }
}
