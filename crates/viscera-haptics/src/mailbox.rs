//! The newest value from one thread to another, where neither ever waits.
//!
//! Three slots: the writer fills one that nobody looks at and swaps it against the one in the middle; the reader swaps the one in the
//! middle against its own when there is something new. Each side makes a bounded number of steps whatever the other does, also
//! when that one is interrupted amid its own. The slots are atomic words, so that this takes no `unsafe`.
//! (The crate `triple_buffer` is the same idea for any type, under a licence that this project does not take.)

use std::marker::PhantomData;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};

use crate::sample::{Contact, Pose, Sample};
use crate::{Matrix, Vector};

/// A value as `N` words.
pub trait Packed<const N: usize>: Copy {
    /// As words.
    fn pack(&self) -> [u64; N];
    /// From the words of [`Packed::pack`].
    fn unpack(words: &[u64; N]) -> Self;
}

/// Says that the slot in the middle has not been read.
const FRESH: u8 = 4;
const SLOT: u8 = 3;

#[derive(Debug)]
struct Slots<const N: usize> {
    slots: [[AtomicU64; N]; 3],
    /// Number of the slot in the middle, and whether it is fresh.
    middle: AtomicU8,
}

/// The side that gives values away.
#[derive(Debug)]
pub struct Writer<V, const N: usize> {
    slots: Arc<Slots<N>>,
    back: u8,
    value: PhantomData<fn(V)>,
}

/// The side that takes the newest value.
#[derive(Debug)]
pub struct Reader<V, const N: usize> {
    slots: Arc<Slots<N>>,
    front: u8,
    value: PhantomData<fn() -> V>,
}

/// Both sides of an empty mailbox.
pub fn mailbox<V: Packed<N>, const N: usize>() -> (Writer<V, N>, Reader<V, N>) {
    let slots = [(); 3].map(|()| [(); N].map(|()| AtomicU64::new(0)));
    let slots = Arc::new(Slots { slots, middle: AtomicU8::new(1) });
    let writer = Writer { slots: Arc::clone(&slots), back: 0, value: PhantomData };
    (writer, Reader { slots, front: 2, value: PhantomData })
}

impl<V: Packed<N>, const N: usize> Writer<V, N> {
    /// Puts a value in. One that was not read is replaced.
    pub fn write(&mut self, value: &V) {
        for (slot, word) in self.slots.slots[self.back as usize].iter().zip(value.pack()) {
            slot.store(word, Ordering::Relaxed);
        }
        // What was stored before is seen by whoever gets this number.
        self.back = self.slots.middle.swap(self.back | FRESH, Ordering::AcqRel) & SLOT;
    }
}

impl<V: Packed<N>, const N: usize> Reader<V, N> {
    /// Takes the newest value out, if there is one that was not taken yet.
    pub fn take(&mut self) -> Option<V> {
        if self.slots.middle.load(Ordering::Relaxed) & FRESH == 0 {
            return None;
        }
        self.front = self.slots.middle.swap(self.front, Ordering::AcqRel) & SLOT;
        let slot = &self.slots.slots[self.front as usize];
        Some(V::unpack(&std::array::from_fn(|word| slot[word].load(Ordering::Relaxed))))
    }

    /// Whether there still is a side that gives values.
    pub fn is_connected(&self) -> bool {
        Arc::strong_count(&self.slots) > 1
    }
}

/// Words of a [`Sample`].
pub const SAMPLE_WORDS: usize = 18;
/// Words of a [`Pose`].
pub const POSE_WORDS: usize = 17;

impl Packed<SAMPLE_WORDS> for Sample {
    fn pack(&self) -> [u64; SAMPLE_WORDS] {
        let mut words = Words::default();
        words.number(self.time).vector(self.position).vector(self.force);
        // A stiffness that is not known is one of no numbers: a sample that has such is refused before it comes here.
        words.matrix(self.stiffness.unwrap_or(Matrix::ZERO * f64::NAN));
        words.number(if self.contact == Contact::Pressing { 1.0 } else { 0.0 });
        words.finish()
    }

    fn unpack(words: &[u64; SAMPLE_WORDS]) -> Self {
        let mut words = Numbers(words.iter());
        let (time, position, force) = (words.number(), words.vector(), words.vector());
        let stiffness = Some(words.matrix()).filter(|stiffness| stiffness.is_finite());
        let contact = if words.number() > 0.0 { Contact::Pressing } else { Contact::Holding };
        Self { time, position, force, stiffness, contact }
    }
}

impl Packed<POSE_WORDS> for Pose {
    fn pack(&self) -> [u64; POSE_WORDS] {
        let mut words = Words::default();
        words.number(self.time).vector(self.position).matrix(self.orientation).vector(self.velocity);
        words.number(self.trigger);
        words.finish()
    }

    fn unpack(words: &[u64; POSE_WORDS]) -> Self {
        let mut words = Numbers(words.iter());
        Self {
            time: words.number(),
            position: words.vector(),
            orientation: words.matrix(),
            velocity: words.vector(),
            trigger: words.number(),
        }
    }
}

/// Numbers on their way into words.
struct Words<const N: usize> {
    words: [u64; N],
    count: usize,
}

impl<const N: usize> Default for Words<N> {
    fn default() -> Self {
        Self { words: [0; N], count: 0 }
    }
}

impl<const N: usize> Words<N> {
    fn number(&mut self, value: f64) -> &mut Self {
        self.words[self.count] = value.to_bits();
        self.count += 1;
        self
    }

    fn vector(&mut self, value: Vector) -> &mut Self {
        self.number(value.x).number(value.y).number(value.z)
    }

    fn matrix(&mut self, value: Matrix) -> &mut Self {
        let [a, b, c] = value.columns;
        self.vector(a).vector(b).vector(c)
    }

    fn finish(&self) -> [u64; N] {
        self.words
    }
}

/// Numbers on their way out of words, in the same order.
struct Numbers<'a>(std::slice::Iter<'a, u64>);

impl Numbers<'_> {
    fn number(&mut self) -> f64 {
        f64::from_bits(self.0.next().copied().unwrap_or(0))
    }

    fn vector(&mut self) -> Vector {
        Vector::new(self.number(), self.number(), self.number())
    }

    fn matrix(&mut self) -> Matrix {
        Matrix::from_columns(self.vector(), self.vector(), self.vector())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Copy, Debug)]
    struct Same([u64; 8]);

    impl Packed<8> for Same {
        fn pack(&self) -> [u64; 8] {
            self.0
        }
        fn unpack(words: &[u64; 8]) -> Self {
            Self(*words)
        }
    }

    /// A value that was torn would hold words of two writes; one that came late would be older than one before it.
    #[test]
    fn values_come_whole_and_in_order_while_both_sides_run() {
        const WRITES: u64 = 200_000;
        let (mut writer, mut reader) = mailbox::<Same, 8>();
        let writing = std::thread::spawn(move || (1..=WRITES).for_each(|number| writer.write(&Same([number; 8]))));
        let mut last = 0;
        while last < WRITES {
            if let Some(Same(words)) = reader.take() {
                assert!(words.iter().all(|&word| word == words[0]), "{words:?} is torn");
                assert!(words[0] > last, "{} after {last}", words[0]);
                last = words[0];
            }
        }
        writing.join().expect("writing ends");
        assert!(reader.take().is_none(), "a value is taken once");
    }

    #[test]
    fn samples_and_poses_come_as_they_were_given() {
        let vector = |x: f64| Vector::new(x, x + 1.0, x + 2.0);
        let matrix = Matrix::from_columns(vector(10.0), vector(20.0), vector(30.0));
        for (stiffness, contact) in [(None, Contact::Holding), (Some(matrix), Contact::Pressing)] {
            let sample = Sample { time: 0.5, position: vector(1.0), force: vector(4.0), stiffness, contact };
            assert_eq!(Sample::unpack(&sample.pack()), sample);
        }
        let pose = Pose { time: 0.5, position: vector(1.0), orientation: matrix, velocity: vector(7.0), trigger: 0.25 };
        assert_eq!(Pose::unpack(&pose.pack()), pose);
    }
}
