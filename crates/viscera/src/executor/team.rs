//! Threads that stand by while one leads them through loops of a few microseconds.
//!
//! A general pool takes 1.6 to 1.9 µs to hand a loop over and hear of its end, which a step does fifty times and more. Here it is one word that all
//! look at: a signal is there when its cache line is, after 0.2 µs. Who has not taken up a loop when its leader is through is not waited for, so
//! that a thread that the system has put aside costs nothing but its help.

#![allow(unsafe_code)]

use std::any::Any;
use std::cell::{Cell, UnsafeCell};
use std::hint::spin_loop;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};

/// How often a thread looks in vain before it lets others have its core, where there is one for each.
const PATIENCE: u32 = 2000;

/// What is to be done by each member, whose number it is told.
type Job<'a> = dyn Fn(usize) + Sync + 'a;

/// A leader's helpers; dropped, they end.
#[derive(Debug)]
pub(super) struct Team {
    shared: Arc<Shared>,
    helpers: Vec<JoinHandle<()>>,
}

#[derive(Debug)]
struct Shared {
    /// Number of the loop from bit 32 on, whether it may be taken up, and how many helpers are in it.
    state: Padded<AtomicU64>,
    job: JobCell,
    /// Whether somebody leads.
    is_led: AtomicBool,
    is_over: AtomicBool,
    has_panicked: AtomicBool,
    panic: Mutex<Option<Box<dyn Any + Send>>>,
    /// How often a thread looks in vain before it lets others have its core.
    patience: u32,
}

/// A cache line of its own, and the one that is fetched along.
#[derive(Debug)]
#[repr(align(128))]
struct Padded<V>(V);

const OPEN: u64 = 1 << 31;
const HELPERS: u64 = OPEN - 1;
const NUMBER: u64 = 1 << 32;

#[derive(Debug)]
struct JobCell(UnsafeCell<*const Job<'static>>);

// SAFETY: the leader alone writes it, while the loop is closed and no helper is in it; a helper reads it after it has entered an open one.
unsafe impl Sync for JobCell {}
// SAFETY: what it points to is shared between threads (`Job` is `Sync`), and read only within a loop.
unsafe impl Send for JobCell {}

thread_local! {
    /// The team that this thread leads and that waits for its next loop.
    static LED: Cell<*const Shared> = const { Cell::new(ptr::null()) };
}

impl Team {
    /// A leader's `helpers` helpers.
    pub(super) fn new(helpers: usize) -> io::Result<Self> {
        let has_cores = thread::available_parallelism().is_ok_and(|cores| helpers < cores.get());
        let shared = Arc::new(Shared {
            patience: if has_cores { PATIENCE } else { 0 },
            state: Padded(AtomicU64::new(0)),
            job: JobCell(UnsafeCell::new(ptr::from_ref::<Job>(&|_| ()))),
            is_led: AtomicBool::new(false),
            is_over: AtomicBool::new(false),
            has_panicked: AtomicBool::new(false),
            panic: Mutex::new(None),
        });
        let mut team = Self { shared, helpers: Vec::with_capacity(helpers) };
        for member in 1..=helpers {
            let shared = Arc::clone(&team.shared);
            let name = format!("viscera-{member}");
            team.helpers.push(thread::Builder::new().name(name).spawn(move || shared.help(member))?);
        }
        Ok(team)
    }

    /// How many there are, with their leader.
    pub(super) fn members(&self) -> usize {
        self.helpers.len() + 1
    }

    /// Does `work` with the helpers standing by; without them where they are led by another thread.
    pub(super) fn lead<R>(&self, work: impl FnOnce() -> R) -> R {
        if !LED.get().is_null() || self.shared.is_led.swap(true, Ordering::Acquire) {
            return work();
        }
        let _lead = Lead(&self.shared);
        // One that nobody heard of, as its leader had one too.
        self.shared.has_panicked.store(false, Ordering::Relaxed);
        LED.set(Arc::as_ptr(&self.shared));
        self.helpers.iter().for_each(|helper| helper.thread().unpark());
        work()
    }

    /// Whether the calling thread leads, and is not in a loop.
    pub(super) fn is_at_hand(&self) -> bool {
        ptr::eq(LED.get(), Arc::as_ptr(&self.shared))
    }

    /// Lets all members do the job, the leader as number 0; a helper that comes too late does not. The team must be at hand.
    pub(super) fn share(&self, job: &Job<'_>) {
        assert!(self.is_at_hand(), "only who leads shares loops");
        LED.set(ptr::null());
        let open = Open(&self.shared);
        // SAFETY: `open` is dropped before `job` goes out of scope, also where a job panics, and its drop waits for all helpers to be out of the loop.
        // Before that it is closed, and none is in it.
        unsafe { *self.shared.job.0.get() = std::mem::transmute::<*const Job<'_>, *const Job<'static>>(job) };
        let number = self.shared.state.0.load(Ordering::Relaxed) / NUMBER;
        self.shared.state.0.store(number.wrapping_add(1).wrapping_mul(NUMBER) | OPEN, Ordering::Release);
        job(0);
        drop(open);
        LED.set(Arc::as_ptr(&self.shared));
        if self.shared.has_panicked.swap(false, Ordering::Acquire)
            && let Some(panic) = self.shared.panic.lock().ok().and_then(|mut last| last.take())
        {
            resume_unwind(panic);
        }
    }
}

impl Shared {
    /// A helper's life.
    fn help(&self, member: usize) {
        let (mut seen, mut vain) = (0, 0);
        while !self.is_over.load(Ordering::Relaxed) {
            let state = self.state.0.load(Ordering::Acquire);
            if state & OPEN == 0 || state / NUMBER == seen {
                vain += 1;
                if vain < self.patience {
                    spin_loop();
                } else if self.is_led.load(Ordering::Relaxed) {
                    thread::yield_now();
                } else {
                    thread::park();
                    vain = 0;
                }
                continue;
            }
            if self.state.0.compare_exchange(state, state + 1, Ordering::AcqRel, Ordering::Relaxed).is_err() {
                continue;
            }
            (seen, vain) = (state / NUMBER, 0);
            // SAFETY: the loop is open and has this helper in it: the leader waits for it before the job is gone.
            let job = unsafe { &**self.job.0.get() };
            if let Err(panic) = catch_unwind(AssertUnwindSafe(|| job(member))) {
                if let Ok(mut last) = self.panic.lock() {
                    *last = Some(panic);
                }
                self.has_panicked.store(true, Ordering::Release);
            }
            self.state.0.fetch_sub(1, Ordering::Release);
        }
    }
}

/// While it lives, the calling thread leads.
struct Lead<'a>(&'a Shared);

impl Drop for Lead<'_> {
    fn drop(&mut self) {
        LED.set(ptr::null());
        self.0.is_led.store(false, Ordering::Release);
    }
}

/// While it lives, helpers may be in a loop.
struct Open<'a>(&'a Shared);

impl Drop for Open<'_> {
    fn drop(&mut self) {
        let state = &self.0.state.0;
        let mut now = state.fetch_and(!OPEN, Ordering::AcqRel);
        let mut vain = 0;
        while now & HELPERS != 0 {
            vain += 1;
            if vain < self.0.patience {
                spin_loop();
            } else {
                thread::yield_now();
            }
            now = state.load(Ordering::Acquire);
        }
    }
}

impl Drop for Team {
    fn drop(&mut self) {
        self.shared.is_over.store(true, Ordering::Relaxed);
        for helper in self.helpers.drain(..) {
            helper.thread().unpark();
            // A panic of a job was given to its leader.
            let _ = helper.join();
        }
    }
}
