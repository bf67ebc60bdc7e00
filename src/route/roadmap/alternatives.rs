//! Paths of different classes: the shortest path of each, by a search over vertices and the words of the rays crossed on the
//! way (Bhattacharya, Likhachev, Kumar 2012).

use super::field::DistanceField;
use super::free::FreeSpace;
use super::graph::Roadmap;
use super::word::{Word, WordTree};
use crate::base::frontier::Frontier;
use crate::base::geometry::{Segment, Vec2, cross};

/// Most pairs of a vertex and a word that a search looks at: about 0.1 s.
const MOST_STATES: usize = 50_000;

/// A part of a path so many times as long as a free line between its ends is a loop, if it does not pass all obstacles on
/// the same side as the line.
const NEARLY_CLOSED: f64 = 5.0;

/// The shortest path of a class.
#[derive(Clone, Debug, PartialEq)]
pub struct Alternative {
    /// From the start to the goal, both included, m.
    pub path: Vec<Vec2>,
    /// Its length, m.
    pub length: f64,
    /// The sides on which it passes obstacles.
    pub class: Word,
}

/// A place reached on a path of a class.
#[derive(Clone, Copy, Debug)]
struct State {
    place: Vec2,
    word: u32,
    /// The state before; of the start, itself.
    before: u32,
    length: f64,
}

/// The shortest paths of the classes from a place to the goal of a field, shortest first, at most `most`; no two are of one
/// class. `roadmap` and `free` are those of the field.
///
/// A path that comes back to a place after a loop around an obstacle is left out. A search ends after 50 000 pairs of a
/// vertex and a class; it then returns the paths found so far.
pub fn alternatives(
    roadmap: &Roadmap,
    free: &FreeSpace,
    field: &DistanceField,
    from: Vec2,
    most: usize,
) -> Vec<Alternative> {
    let (vertices, goal) = (roadmap.vertices(), field.goal());
    let goal_number = vertices.len() as u32;
    let place = |k: u32| vertices.get(k as usize).copied().unwrap_or(goal);
    let mut search = Search { free, words: WordTree::default(), states: Vec::new() };
    search.states.push(State { place: from, word: 0, before: 0, length: 0.0 });
    // The words with which each vertex, and the goal, was reached.
    let mut known: Vec<Vec<u32>> = vec![Vec::new(); vertices.len() + 1];
    // By the length of the whole path: the vertex, the state before.
    let mut queue: Frontier<(u32, u32)> = Frontier::new();
    for k in (0..goal_number).filter(|k| field.length(*k).is_finite()) {
        queue.push((place(k) - from).norm() + field.length(k), (k, 0));
    }
    if free.is_clear(from, goal) {
        queue.push((goal - from).norm(), (goal_number, 0));
    }
    let mut found = Vec::new();
    while found.len() < most
        && search.states.len() < MOST_STATES
        && let Some((_, (vertex, before))) = queue.pop()
    {
        let to = place(vertex);
        let words = &mut known[vertex as usize];
        let Some(state) = search.reach(to, before, words) else { continue };
        words.push(state.word);
        if vertex == goal_number {
            found.push(search.alternative(state));
            continue;
        }
        let number = search.states.len() as u32;
        search.states.push(state);
        for &(next, edge) in roadmap.neighbours(vertex) {
            queue.push(state.length + edge + field.length(next), (next, number));
        }
        if field.sees_goal(vertex) {
            queue.push(state.length + (goal - to).norm(), (goal_number, number));
        }
    }
    found
}

struct Search<'f> {
    free: &'f FreeSpace,
    words: WordTree,
    states: Vec<State>,
}

impl Search<'_> {
    fn after(&mut self, word: u32, from: Vec2, to: Vec2) -> u32 {
        self.words.extend(word, self.free.rays().crossings(from, to))
    }

    /// The state after a line from another state to a place; `None` if its word is among the known ones, the line is not
    /// free, or the path has a loop around an obstacle.
    fn reach(&mut self, to: Vec2, before: u32, known: &[u32]) -> Option<State> {
        let last = self.states[before as usize];
        let word = self.after(last.word, last.place, to);
        // Edges of the roadmap are free; lines from the start are tested here.
        if known.contains(&word)
            || (before == 0 && !self.free.is_clear(last.place, to))
            || self.has_loop(before, to)
        {
            return None;
        }
        Some(State { place: to, word, before, length: last.length + (to - last.place).norm() })
    }

    /// Whether a path that goes on from a state to a place comes back there, or on the way, to where it has been.
    fn has_loop(&mut self, before: u32, to: Vec2) -> bool {
        let last = self.states[before as usize];
        let line = Segment::new(last.place, to);
        let mut at = before;
        while at != 0 {
            let end = self.states[at as usize];
            let start = self.states[end.before as usize];
            at = end.before;
            // Most lines before are too far away, however the parts are cut.
            let far = (end.place - last.place).norm() - (end.length - start.length) - line.length();
            if last.length + line.length() - start.length <= NEARLY_CLOSED * far {
                continue;
            }
            let (x, y) = closest(&Segment::new(start.place, end.place), &line);
            let part = last.length + (y - last.place).norm() - start.length - (x - start.place).norm();
            if part > NEARLY_CLOSED * (y - x).norm() {
                let (there, here) =
                    (self.after(start.word, start.place, x), self.after(last.word, last.place, y));
                if self.after(there, x, y) != here && self.free.is_clear(x, y) {
                    return true;
                }
            }
        }
        false
    }

    fn alternative(&self, goal: State) -> Alternative {
        let mut path = vec![goal.place];
        let mut at = goal.before;
        while at != 0 {
            let state = self.states[at as usize];
            path.push(state.place);
            at = state.before;
        }
        path.push(self.states[0].place);
        path.reverse();
        Alternative { path, length: goal.length, class: self.words.word(goal.word) }
    }
}

/// Two points, one of each segment, that are nearest to each other; where the segments cross, the same point.
fn closest(a: &Segment, b: &Segment) -> (Vec2, Vec2) {
    let side = |s: &Segment, p: Vec2| cross(s.b - s.a, p - s.a);
    let (from, to) = (side(a, b.a), side(a, b.b));
    let apart = |p: f64, q: f64| (p > 0.0 && q < 0.0) || (p < 0.0 && q > 0.0);
    if apart(from, to) && apart(side(b, a.a), side(b, a.b)) {
        let meeting = b.a + (b.b - b.a) * (from / (from - to));
        return (meeting, meeting);
    }
    let pairs = [(a.nearest(b.a), b.a), (a.nearest(b.b), b.b), (a.a, b.nearest(a.a)), (a.b, b.nearest(a.b))];
    let square = |(p, q): (Vec2, Vec2)| (p - q).norm_squared();
    pairs
        .into_iter()
        .reduce(|known, pair| if square(pair) < square(known) { pair } else { known })
        .unwrap_or(pairs[0])
}
