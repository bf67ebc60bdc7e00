//! What is said of each member, said of one: the running agent of a quantifier or fold becomes a fixed one.

use crate::model::{AgentId, Bool, Num, Place, Set, Who};

/// The running agent of `depth` becomes a fixed one; deeper ones move up a place.
fn who(who: Who, depth: u32, id: AgentId) -> Who {
    match who {
        Who::Running(n) if n == depth => Who::Agent(id),
        Who::Running(n) if n > depth => Who::Running(n - 1),
        other => other,
    }
}

fn set(from: &Set, depth: u32, id: AgentId) -> Set {
    Set { members: from.members.clone(), except: from.except.map(|w| who(w, depth, id)) }
}

fn place(from: &Place, depth: u32, id: AgentId) -> Place {
    match from {
        Place::Agent(w) => Place::Agent(who(*w, depth, id)),
        Place::Point(x, y) => {
            Place::Point(Box::new(instantiate_num(x, depth, id)), Box::new(instantiate_num(y, depth, id)))
        }
        Place::Centroid(s) => Place::Centroid(set(s, depth, id)),
        Place::Region(_) | Place::Barrier(_) => from.clone(),
    }
}

pub(super) fn instantiate_num(num: &Num, depth: u32, id: AgentId) -> Num {
    let n = |inner: &Num| Box::new(instantiate_num(inner, depth, id));
    let b = |inner: &Bool| Box::new(instantiate_bool(inner, depth, id));
    match num {
        Num::Constant(_) | Num::Time | Num::Variable(_) | Num::Crossings(..) | Num::Voronoi(_) => num.clone(),
        Num::Of(field, w) => Num::Of(*field, who(*w, depth, id)),
        Num::Coordinate(axis, p) => Num::Coordinate(*axis, place(p, depth, id)),
        Num::Distance(p, q) => Num::Distance(place(p, depth, id), place(q, depth, id)),
        Num::Depth(p, region) => Num::Depth(place(p, depth, id), *region),
        Num::OfTwo(pair, v, w) => Num::OfTwo(*pair, who(*v, depth, id), who(*w, depth, id)),
        Num::OfSet(collective, s) => Num::OfSet(*collective, set(s, depth, id)),
        Num::Apply(function, x) => Num::Apply(*function, n(x)),
        Num::Combine(op, x, y) => Num::Combine(*op, n(x), n(y)),
        Num::Fold(fold, s, body) => Num::Fold(*fold, set(s, depth, id), n(body)),
        Num::Count(s, body) => Num::Count(set(s, depth, id), b(body)),
        Num::If(c, x, y) => Num::If(b(c), n(x), n(y)),
    }
}

pub(super) fn instantiate_bool(truth: &Bool, depth: u32, id: AgentId) -> Bool {
    let n = |inner: &Num| Box::new(instantiate_num(inner, depth, id));
    let b = |inner: &Bool| instantiate_bool(inner, depth, id);
    match truth {
        Bool::Constant(_) => truth.clone(),
        Bool::Compare(op, x, y) => Bool::Compare(*op, n(x), n(y)),
        Bool::Not(inner) => Bool::Not(Box::new(b(inner))),
        Bool::And(list) => Bool::And(list.iter().map(b).collect()),
        Bool::Or(list) => Bool::Or(list.iter().map(b).collect()),
        Bool::Iff(x, y) => Bool::Iff(Box::new(b(x)), Box::new(b(y))),
        Bool::In(w, region) => Bool::In(who(*w, depth, id), *region),
        Bool::Present(w) => Bool::Present(who(*w, depth, id)),
        Bool::Contact(w) => Bool::Contact(who(*w, depth, id)),
        Bool::Touching(v, w) => Bool::Touching(who(*v, depth, id), who(*w, depth, id)),
        Bool::Forall(s, body) => Bool::Forall(set(s, depth, id), Box::new(b(body))),
        Bool::Exists(s, body) => Bool::Exists(set(s, depth, id), Box::new(b(body))),
    }
}
