//! `sagnac serve`: the pages of a bench. What a server is and does stands in the package `sagnac-serve`; here is what it is
//! started with, and what it asks of the program.

#[cfg(not(feature = "serve"))]
use crate::i18n::{Lang, note};
use clap::Args;
use std::net::IpAddr;
use std::num::{NonZeroU64, NonZeroUsize};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct ServeArgs {
    /// Port; 0 takes one that is free
    #[arg(long, value_name = "PORT", default_value_t = 8643)]
    pub port: u16,
    /// Folder for the queue, uploads and results
    #[arg(long, value_name = "DIR", default_value = "bench")]
    pub data: PathBuf,
    /// Folder with recordings, besides 'recordings' below the data; repeatable
    #[arg(long, value_name = "DIR")]
    pub recordings: Vec<PathBuf>,
    /// Folder with procedures and limits, besides 'procedures' below the data; repeatable
    #[arg(long, value_name = "DIR")]
    pub procedures: Vec<PathBuf>,
    /// Rules (TOML): which part number is tested by what
    #[arg(long, value_name = "FILE")]
    pub rules: Option<PathBuf>,
    /// Store to keep the results in
    #[arg(long, value_name = "STORE")]
    pub store: Option<PathBuf>,
    /// Name of the test station
    #[arg(long, value_name = "NAME")]
    pub station: Option<String>,
    /// Number of tests at a time [default: number of cores]
    #[arg(long, value_name = "COUNT")]
    pub jobs: Option<NonZeroUsize>,
    /// Address to listen at; any but this computer's own needs --behind-proxy
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1")]
    pub listen: IpAddr,
    /// Address by which browsers reach the server through a proxy that has the certificate, as https://bench.example.com
    #[arg(long, value_name = "URL")]
    pub behind_proxy: Option<String>,
    /// Largest upload, MiB
    #[arg(long, value_name = "MIB", default_value = "2048")]
    pub max_upload: NonZeroU64,
    /// Largest sum of all uploads, MiB
    #[arg(long, value_name = "MIB", default_value = "51200")]
    pub upload_quota: NonZeroU64,
    /// Run with all rights, as in a container
    #[arg(long)]
    pub allow_root: bool,
}

/// Says that this program has no server, and how to get one that has.
///
/// # Errors
/// Always: the diagnostic, in words.
#[cfg(not(feature = "serve"))]
pub fn main(_: &ServeArgs, lang: Lang) -> Result<u8, String> {
    Err(super::place::error(&note!("serve.not_built"), lang))
}

#[cfg(feature = "serve")]
pub use server::main;

#[cfg(feature = "serve")]
mod server {
    use crate::cli::serve::ServeArgs;
    use crate::cli::{ending, exit, place};
    use crate::config::serve as rules_file;
    use crate::config::shipped::{SHIPPED_LIMITS, SHIPPED_PROCEDURES, Shipped};
    use crate::executable;
    use crate::i18n::{Lang, Localize, Note, io_reason, note};
    use crate::output::{Kind, MAX_RECORD_BYTES};
    use crate::record::read;
    use crate::report::bench;
    use crate::signing::{chain, files_of};
    use crate::verify::stated_hashes;
    use sagnac_serve::{
        Harness, Listen, LocalText, Outcome, ProxyError, PublicOrigin, Rule, Server, Setup, StartError,
    };
    use std::net::SocketAddr;
    use std::path::Path;
    use std::time::Duration;

    /// Pause between two looks for a request to end.
    const REQUEST_POLL: Duration = Duration::from_millis(50);
    /// Binary shift from MiB to bytes.
    const MIB_SHIFT: u32 = 20;

    /// Serves until it is asked to end.
    ///
    /// # Errors
    /// The diagnostic, in words.
    pub fn main(args: &ServeArgs, lang: Lang) -> Result<u8, String> {
        ending::defer();
        let setup = setup(args, lang)?;
        let jobs = setup.jobs;
        let server = Server::start(setup, Box::new(Program));
        let server = server.map_err(|e| place::error(&refused(&e), lang))?;
        let ready = note!("serve.ready", url = server.sign_in_url());
        place::print(&format!("{}\n{}\n", ready.say(lang), note!("serve.how", jobs).say(lang)));
        if server.waiting() > 0 {
            place::print(&format!("{}\n", note!("serve.resumed", n = server.waiting()).say(lang)));
        }
        while !ending::is_asked() {
            std::thread::sleep(REQUEST_POLL);
        }
        server.stop();
        Ok(exit::PASS)
    }

    fn setup(args: &ServeArgs, lang: Lang) -> Result<Setup, String> {
        let error = |note: Note| place::error(&note, lang);
        let program =
            executable::path().map_err(|e| error(note!("serve.no_program", reason = io_reason(&e))))?;
        let behind_proxy = args.behind_proxy.as_deref().map(|url| {
            PublicOrigin::parse(url).map_err(|why| {
                error(match why {
                    ProxyError::NotEncrypted => note!("serve.proxy_not_encrypted", url),
                    ProxyError::NotAHost => note!("serve.proxy_not_a_host", url),
                })
            })
        });
        let rules = match &args.rules {
            Some(path) => rules_file::load(path).map_err(|p| p.say(lang))?,
            None => vec![],
        };
        if let Some(store) = &args.store
            && let Err(why) = crate::store::Store::open(store)
        {
            return Err(error(why.note()));
        }
        let rule = |r: rules_file::PartRule| Rule { part: r.part, procedure: r.procedure, limits: r.limits };
        let names = |all: &[Shipped]| all.iter().map(|shipped| shipped.name.to_owned()).collect();
        let cores = std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get);
        Ok(Setup {
            program,
            data: args.data.clone(),
            recordings: args.recordings.clone(),
            procedures: args.procedures.clone(),
            shipped: sagnac_serve::Shipped {
                procedures: names(SHIPPED_PROCEDURES),
                limits: names(SHIPPED_LIMITS),
            },
            rules: rules.into_iter().map(rule).collect(),
            store: args.store.as_deref().map(std::path::absolute).transpose().ok().flatten(),
            station: args.station.clone(),
            lang: match lang {
                Lang::En => sagnac_serve::Lang::En,
                Lang::Ru => sagnac_serve::Lang::Ru,
            },
            listen: Listen {
                address: SocketAddr::new(args.listen, args.port),
                behind_proxy: behind_proxy.transpose()?,
            },
            jobs: args.jobs.map_or(cores, std::num::NonZeroUsize::get),
            max_upload: args.max_upload.get().saturating_mul(1 << MIB_SHIFT),
            upload_quota: args.upload_quota.get().saturating_mul(1 << MIB_SHIFT),
            allow_root: args.allow_root,
        })
    }

    /// Why a server does not start, and what to do.
    fn refused(why: &StartError) -> Note {
        let path = |path: &Path| place::shown(path);
        match why {
            StartError::Root => note!("serve.root"),
            StartError::Exposed(address) => note!("serve.exposed", address = address.ip().to_string()),
            StartError::File(at, e) if e.kind() == std::io::ErrorKind::InvalidData => {
                note!("serve.queue_damaged", path = path(at), reason = e.to_string())
            }
            StartError::File(at, e) => note!("serve.unusable", path = path(at), reason = io_reason(e)),
            StartError::Taken(at) => note!("serve.taken", path = path(at)),
            StartError::Address(address, e) => {
                note!("serve.not_listening", address = address.to_string(), reason = io_reason(e))
            }
            StartError::System(e) => note!("serve.system", reason = io_reason(e)),
        }
    }

    /// The program, as the server asks it.
    struct Program;

    impl Harness for Program {
        fn outcome(&self, folder: &Path) -> Option<Outcome> {
            let file = folder.join(Kind::Result.record_file());
            let bytes = sagnac_ingest::read_file(&file, MAX_RECORD_BYTES).ok()?;
            Some(bench::outcome(&read::from_slice(&bytes).ok()?))
        }

        fn signatures(&self, folder: &Path) -> Vec<LocalText> {
            let files = files_of(folder, stated_hashes(folder).into_keys());
            bench::signatures(&chain(folder, &files))
        }

        fn log(&self, line: &str) {
            place::eprint_diagnostic(&format!("{} {line}\n", crate::moment::now().format("%FT%TZ")));
        }
    }
}
