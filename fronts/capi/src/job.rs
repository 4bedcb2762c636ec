//! Results of kept queries that another thread makes ready.

use casca::{KeptJob, KeptResult};

use crate::border::{Out, give};
use crate::error::{Failure, call, casca_status};
use crate::handle::Registry;
use crate::query::{QUERIES, casca_query};
use crate::scene::{SCENES, casca_scene};
use crate::view::{self, casca_view};

static JOBS: Registry<Job> = Registry::new(5);

/// The work of finding a new result for a kept query, on any thread. {0} is none.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct casca_job {
    /// A number that only casca can read.
    pub handle: u64,
}

enum Job {
    Waiting(Box<KeptJob>),
    Done(Box<KeptResult>),
    /// While it runs, and after it panicked.
    Taken,
}

/// Prepares a job that finds a new result for views like this one, ahead of time. Run it on any
/// thread by casca_job_run, and give it to casca_query_install. query needs CASCA_KEPT.
///
/// The job reads a copy of the scene, so that the scene may change meanwhile. Costs that copy the
/// first time, later the static objects that changed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_query_prepare(
    query: casca_query,
    scene: casca_scene,
    view: *const casca_view,
    job: *mut casca_job,
) -> casca_status {
    give(job, "job", || {
        let view = view::read(view)?;
        let state = SCENES.shared(scene.handle)?;
        let mut camera = QUERIES.exclusive(query.handle)?;
        let made = camera.kept()?.prepare(&state.scene, &view);
        Ok(casca_job { handle: JOBS.add(Job::Waiting(Box::new(made)))? })
    })
}

/// Runs a job, on the thread that calls. A job that is done stays as it is. Costs a query.
#[unsafe(no_mangle)]
pub extern "C" fn casca_job_run(job: casca_job) -> casca_status {
    call(|| {
        let mut job = JOBS.exclusive(job.handle)?;
        *job = match std::mem::replace(&mut *job, Job::Taken) {
            Job::Waiting(waiting) => Job::Done(Box::new(waiting.run())),
            other => other,
        };
        Ok(())
    })
}

/// Frees a job without using it.
#[unsafe(no_mangle)]
pub extern "C" fn casca_job_free(job: casca_job) -> casca_status {
    call(|| JOBS.take(job.handle).map(drop))
}

/// Gives the result of a job to the kept query; the job is freed by it. Runs answer from the result
/// as soon as it holds for their view. is_taken, unless null, gets whether it fits: not if more
/// than 2,048 static objects changed since, or if the scene is another one.
///
/// Errors: a job that has not run; it then stays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_query_install(
    query: casca_query,
    scene: casca_scene,
    job: casca_job,
    is_taken: *mut bool,
) -> casca_status {
    call(|| {
        let out = Out::or_null(is_taken, "is_taken")?;
        let state = SCENES.shared(scene.handle)?;
        let mut camera = QUERIES.exclusive(query.handle)?;
        let kept = camera.kept()?;
        if !matches!(*JOBS.shared(job.handle)?, Job::Done(_)) {
            return Err(Failure::argument("the job has not run: call casca_job_run first"));
        }
        let Job::Done(result) = JOBS.take(job.handle)? else {
            return Err(Failure::argument("the job was run anew meanwhile"));
        };
        let taken = kept.install(*result, &state.scene);
        out.set(taken);
        Ok(())
    })
}
