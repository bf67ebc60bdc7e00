//! Reduced words: the class of a path by the rays it crosses (elements of a free group).

use std::collections::HashMap;

/// Signed crossings of rays in order, without neighbours that cancel. Letter `k + 1` is a crossing of ray `k` from the right
/// to the left of its direction, `-(k + 1)` a crossing back. Two paths with the same ends can be deformed into each other
/// exactly if their words are equal.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Word(Vec<i32>);

impl Word {
    /// The letters.
    pub fn letters(&self) -> &[i32] {
        &self.0
    }

    /// Appends a crossing; it cancels the last one if that is its inverse.
    pub(super) fn push(&mut self, letter: i32) {
        if self.0.last() == Some(&-letter) {
            self.0.pop();
        } else {
            self.0.push(letter);
        }
    }
}

/// Words met in a search, by number; 0 is the empty word. Each is known by its beginning and its last letter.
#[derive(Debug, Default)]
pub(super) struct WordTree {
    /// The word without its last letter, and that letter; of word `k + 1` at `k`.
    parents: Vec<(u32, i32)>,
    children: HashMap<(u32, i32), u32>,
}

impl WordTree {
    fn parent(&self, word: u32) -> Option<(u32, i32)> {
        self.parents.get((word as usize).checked_sub(1)?).copied()
    }

    /// The word after some more crossings.
    pub(super) fn extend(&mut self, word: u32, letters: impl Iterator<Item = i32>) -> u32 {
        letters.fold(word, |word, letter| match self.parent(word) {
            Some((parent, last)) if last == -letter => parent,
            _ => *self.children.entry((word, letter)).or_insert_with(|| {
                self.parents.push((word, letter));
                self.parents.len() as u32
            }),
        })
    }

    /// The letters of a word.
    pub(super) fn word(&self, mut number: u32) -> Word {
        let mut letters = Vec::new();
        while let Some((parent, letter)) = self.parent(number) {
            letters.push(letter);
            number = parent;
        }
        letters.reverse();
        Word(letters)
    }
}
