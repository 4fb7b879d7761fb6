//! Where the threads of a team wait, and come in while the gate is open.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::{self, NonNull};
use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use crossbeam_utils::CachePadded;

/// Bits of the state: whether the gate is open, how many came in, and above them the number of the round.
const OPEN: u64 = 1;
const ONE_CAME: u64 = 2;
const CAME: u64 = 0xfffe;
const ROUND: u32 = 16;

/// How often a thread looks before it lets others have its core, with a core of its own and without.
const PATIENCE: u32 = 20_000;
const HASTE: u32 = 20;

/// What a panic carries.
type Panic = Box<dyn Any + Send>;

/// What the threads are to do while the gate is open.
struct Task<'a>(&'a (dyn Fn(usize) + Sync));

#[derive(Debug)]
pub(crate) struct Gate {
    state: CachePadded<AtomicU64>,
    /// How many of those that came in this round have left.
    left: CachePadded<AtomicU64>,
    /// The task of the round; good from before the gate opens until all have left.
    task: AtomicPtr<Task<'static>>,
    /// Whether somebody has the team to himself.
    taken: AtomicBool,
    /// How many callers want the threads awake.
    callers: AtomicUsize,
    dismissed: AtomicBool,
    bed: Mutex<()>,
    bell: Condvar,
    /// The first panic of the round.
    panic: Mutex<Option<Panic>>,
    patience: u32,
}

impl Gate {
    pub(crate) fn new(patient: bool) -> Self {
        Self {
            state: CachePadded::new(AtomicU64::new(0)),
            left: CachePadded::new(AtomicU64::new(0)),
            task: AtomicPtr::new(ptr::null_mut()),
            taken: AtomicBool::new(false),
            callers: AtomicUsize::new(0),
            dismissed: AtomicBool::new(false),
            bed: Mutex::new(()),
            bell: Condvar::new(),
            panic: Mutex::new(None),
            patience: if patient { PATIENCE } else { HASTE },
        }
    }

    /// Takes the team, unless somebody has it; [`Gate::hold_open`] gives it back.
    pub(crate) fn take(&self) -> bool {
        !self.taken.swap(true, Ordering::Acquire)
    }

    /// Keeps the threads awake while what it gives lives.
    pub(crate) fn rouse(&self) -> Awake<'_> {
        if self.callers.fetch_add(1, Ordering::SeqCst) == 0 {
            let _bed = self.bed();
            self.bell.notify_all();
        }
        Awake(self)
    }

    /// The same where nobody keeps them awake yet.
    pub(crate) fn rouse_unless_awake(&self) -> Option<Awake<'_>> {
        (self.callers.load(Ordering::Relaxed) == 0).then(|| self.rouse())
    }

    /// Calls `work` while others may come in and call it too; then waits until they have left. The team must be taken, and is free afterwards.
    /// Gives the first panic of any call.
    pub(crate) fn hold_open(&self, work: &(dyn Fn(usize) + Sync)) -> Option<Panic> {
        let task = Task(work);
        self.task.store(ptr::from_ref(&task).cast::<Task<'static>>().cast_mut(), Ordering::Relaxed);
        let round = (self.state.load(Ordering::Relaxed) >> ROUND) + 1;
        self.state.store(round << ROUND | OPEN, Ordering::Release);
        self.call(&task, 0);
        let came = (self.state.fetch_and(!OPEN, Ordering::AcqRel) & CAME) / ONE_CAME;
        self.wait_until(|| self.left.load(Ordering::Acquire) == came);
        self.left.store(0, Ordering::Relaxed);
        let panic = self.panic().take();
        self.taken.store(false, Ordering::Release);
        panic
    }

    /// What a thread of the team does all its life.
    pub(crate) fn serve(&self, number: usize) {
        let mut last = 0;
        while let Some(round) = self.come_in(last) {
            let task = NonNull::new(self.task.load(Ordering::Relaxed));
            if let Some(task) = task {
                // SAFETY: This thread came in: it raised the count of the state while the gate was open. Whoever opened it stored a pointer to a task
                // of his own stack before, which the exchange has made visible, and stays in `hold_open`, panic or not, until `left`
                // says that this thread has left. So the task lives, and what it borrows; and it is `Sync`.
                #[allow(unsafe_code)]
                let task = unsafe { task.as_ref() };
                self.call(task, number);
            }
            last = round;
            self.left.fetch_add(1, Ordering::Release);
        }
    }

    /// Waits for a round after the `last` one and comes in; none when the team is dismissed.
    fn come_in(&self, last: u64) -> Option<u64> {
        loop {
            let state = self.state.load(Ordering::Acquire);
            if state & OPEN != 0 && state >> ROUND != last {
                let came = self.state.compare_exchange(state, state + ONE_CAME, Ordering::AcqRel, Ordering::Relaxed);
                if came.is_ok() {
                    return Some(state >> ROUND);
                }
                continue;
            }
            self.wait_until(|| {
                self.state.load(Ordering::Relaxed) != state || self.callers.load(Ordering::Relaxed) == 0
            });
            if self.callers.load(Ordering::SeqCst) == 0 && !self.sleep() {
                return None;
            }
        }
    }

    /// Sleeps until somebody rouses the threads; whether they are still wanted.
    fn sleep(&self) -> bool {
        let mut bed = self.bed();
        while self.callers.load(Ordering::SeqCst) == 0 && !self.dismissed.load(Ordering::SeqCst) {
            bed = self.bell.wait(bed).unwrap_or_else(PoisonError::into_inner);
        }
        !self.dismissed.load(Ordering::SeqCst)
    }

    /// Sends the threads home.
    pub(crate) fn dismiss(&self) {
        self.dismissed.store(true, Ordering::SeqCst);
        let _bed = self.bed();
        self.bell.notify_all();
    }

    fn call(&self, task: &Task<'_>, number: usize) {
        if let Err(panic) = catch_unwind(AssertUnwindSafe(|| (task.0)(number))) {
            self.panic().get_or_insert(panic);
        }
    }

    fn wait_until(&self, done: impl Fn() -> bool) {
        let mut looks = 0;
        while !done() {
            looks += 1;
            if looks < self.patience {
                std::hint::spin_loop();
            } else {
                std::thread::yield_now();
            }
        }
    }

    fn bed(&self) -> MutexGuard<'_, ()> {
        self.bed.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn panic(&self) -> MutexGuard<'_, Option<Panic>> {
        self.panic.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Keeps the threads of a team awake.
pub(crate) struct Awake<'a>(&'a Gate);

impl Drop for Awake<'_> {
    fn drop(&mut self) {
        self.0.callers.fetch_sub(1, Ordering::SeqCst);
    }
}
