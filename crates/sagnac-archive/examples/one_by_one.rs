//! The analysis alone, one recording after another: what a run over an archive is measured against.
//!
//! `cargo run --release --example one_by_one -- FILES`

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut bytes = 0;
    for path in std::env::args().skip(1) {
        let result = sagnac::Analysis::default().run(&sagnac::Recording::open(&path)?)?;
        bytes += serde_json::to_string(result.record())?.len();
    }
    println!("{bytes} bytes of results");
    Ok(())
}
