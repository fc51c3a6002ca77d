//! `job.toml`: a run, written down.

use crate::functions::Function;
use serde::Deserialize;
use std::fmt::Write;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;

/// A job as its file has it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Job {
    /// The job list: a folder of shards, or one shard.
    pub jobs: String,
    /// What to do with each recording.
    pub call: Spanned<Call>,
    /// Folder of the results; `--out` takes its place.
    pub out: Option<String>,
    /// Which rows of the list: a condition in SQL.
    #[serde(rename = "where")]
    pub condition: Option<Spanned<String>>,
    /// Procedure of every row; else the column `procedure` of the list.
    pub procedure: Option<Spanned<String>>,
    /// Limits of every row; else the column `limits`.
    pub limits: Option<Spanned<String>>,
    /// Model of every row; else the column `model`.
    pub model: Option<Spanned<String>>,
    /// Scheduler of a cluster; `--scheduler` takes its place.
    pub scheduler: Option<String>,
}

/// Treatment of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Call {
    /// As `sagnac analyze` does.
    Analyze,
    /// As `sagnac run` does.
    Run,
    /// As `sagnac explain` does.
    Explain,
}

impl Call {
    /// The function that does it.
    pub fn function(self) -> Function {
        match self {
            Call::Analyze => Function::Analyze,
            Call::Run => Function::Run,
            Call::Explain => Function::Explain,
        }
    }
}

impl Job {
    /// Reads the text of a job file.
    ///
    /// # Errors
    /// Every problem with file, line and column, and what to do.
    pub fn read(text: &str, file: &str) -> Result<Job, String> {
        let job: Job = toml::from_str(text).map_err(|e| {
            let help = "a job has jobs, call, and where they are needed out, where, procedure, limits, model, scheduler";
            problem(file, text, e.span().unwrap_or(0..0), e.message(), help)
        })?;
        let mut problems = String::new();
        let call = *job.call.get_ref();
        let useless: [(&Option<Spanned<String>>, &str, Call); 3] = [
            (&job.procedure, "procedure", Call::Run),
            (&job.limits, "limits", Call::Run),
            (&job.model, "model", Call::Explain),
        ];
        for (value, key, of) in useless {
            if let Some(value) = value.as_ref().filter(|_| call != of) {
                let what = format!("`{key}` does not belong to this call");
                let name = of.function().name().trim_start_matches("sagnac_");
                let help = format!("leave it out, or set call = \"{name}\"");
                problems += &problem(file, text, value.span(), &what, &help);
            }
        }
        if let Some(condition) = job.condition.as_ref().filter(|c| c.get_ref().trim().is_empty()) {
            let help = "write a condition over columns of the list, such as \"uri like '%2026%'\", or leave `where` out";
            problems += &problem(file, text, condition.span(), "`where` is empty", help);
        }
        if problems.is_empty() { Ok(job) } else { Err(problems) }
    }

    /// The query of the job. Relative paths in it are resolved against `base`, the folder of the job file.
    pub fn sql(&self, base: &Path) -> String {
        let argument = |value: &Option<Spanned<String>>, column: &str| match value {
            Some(text) => format!("'{}'", beside(base, text.get_ref()).replace('\'', "''")),
            None => column.to_owned(),
        };
        let function = self.call.get_ref().function();
        let own = match self.call.get_ref() {
            Call::Analyze => String::new(),
            Call::Run => {
                format!("{}, {}, ", argument(&self.procedure, "procedure"), argument(&self.limits, "limits"))
            }
            Call::Explain => format!("{}, ", argument(&self.model, "model")),
        };
        let condition =
            self.condition.as_ref().map(|c| format!(" WHERE {}", c.get_ref())).unwrap_or_default();
        format!("SELECT {}(uri, {own}unit) FROM jobs{condition}", function.name())
    }
}

/// A file that a job names: a path is one beside the job, an address stays.
pub fn beside(base: &Path, named: &str) -> String {
    if named.contains("://") { named.to_owned() } else { base.join(named).display().to_string() }
}

/// One diagnostic: where, what, what to do.
fn problem(file: &str, text: &str, span: Range<usize>, what: &str, help: &str) -> String {
    let before = text.get(..span.start).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(out, "error: {file}:{line}:{column}: {what}\n  help: {help}");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_is_a_query() {
        let text = "jobs = \"jobs\"\ncall = \"run\"\nwhere = \"unit is null\"\nlimits = \"o'hara.toml\"\n";
        let sql = Job::read(text, "job.toml").unwrap().sql(Path::new("/jobs"));
        assert_eq!(
            sql,
            "SELECT sagnac_run(uri, procedure, '/jobs/o''hara.toml', unit) FROM jobs WHERE unit is null"
        );
    }

    #[test]
    fn every_problem_has_its_place() {
        let text = "jobs = \"jobs\"\ncall = \"analyze\"\nprocedure = \"p.toml\"\n  model = \"m.toml\"\n";
        let problems = Job::read(text, "job.toml").unwrap_err();
        assert!(problems.contains("job.toml:3:13: `procedure` does not belong"), "{problems}");
        assert!(problems.contains("job.toml:4:11: `model` does not belong"), "{problems}");
        let unknown = Job::read("jobs = \"j\"\ncall = \"run\"\nlimit = 3\n", "job.toml").unwrap_err();
        assert!(unknown.contains("job.toml:3:1: unknown field `limit`"), "{unknown}");
        let call = Job::read("jobs = \"j\"\ncall = \"test\"\n", "job.toml").unwrap_err();
        assert!(call.contains("job.toml:2:8:") && call.contains("help:"), "{call}");
    }
}
