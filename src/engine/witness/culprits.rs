//! Who made a condition true or false, or gave a number its value, in one state.

use crate::engine::trials::prepared::PreparedWorld;
use crate::engine::witness::grounds::Asked;
use crate::kernel::{Code, Readings, State};
use crate::model::{AgentId, Bool, Num, Scenario, Set, Who};

/// How many agents are named at most.
pub(super) const NAMED: usize = 3;
/// How many are asked about at once, first and at most.
const FIRST: usize = 64;
const AT_ONCE: usize = 4096;

/// Looks for them in a state.
pub(super) struct Search<'s> {
    prepared: &'s PreparedWorld,
    state: &'s State,
    /// Whether the time is over.
    stop: &'s dyn Fn() -> bool,
    found: Vec<AgentId>,
    /// How many quantifiers are around: what is said of their members is about those.
    inside: u32,
    /// The comparisons that decide; of the members of a set those of the first.
    compared: Vec<(Num, Num)>,
    /// Whether the first agent was found as a member of a set.
    is_member: bool,
    /// Whether the first agent was found as the one with the smallest or largest value of a fold.
    is_extreme: bool,
}

impl<'s> Search<'s> {
    /// Nobody found yet.
    pub(super) fn of(prepared: &'s PreparedWorld, state: &'s State, stop: &'s dyn Fn() -> bool) -> Self {
        Self {
            prepared,
            state,
            stop,
            found: Vec::new(),
            inside: 0,
            compared: Vec::new(),
            is_member: false,
            is_extreme: false,
        }
    }

    /// Those who were found.
    pub(super) fn found(&self) -> &[AgentId] {
        &self.found
    }

    /// The comparison that decides, if it is just one and about the first who was found: by name, or as the
    /// extreme of a fold.
    pub(super) fn compared(&self) -> Option<(&Num, &Num)> {
        let [(a, b)] = &self.compared[..] else { return None };
        let mut is_about = self.is_extreme;
        for side in [a, b] {
            side.mentions(&mut |id| is_about |= Some(&id) == self.found.first());
        }
        is_about.then_some((a, b))
    }

    /// Whether the first who was found is a member of a set that is asked about.
    pub(super) const fn is_member(&self) -> bool {
        self.is_member
    }

    /// What some numbers are in this state.
    pub(super) fn values(&self, nums: &[Num]) -> Vec<f64> {
        self.read(&[], nums).signals.iter().map(|lanes| lanes.0[0]).collect()
    }

    fn read(&self, atoms: &[Bool], nums: &[Num]) -> Readings {
        let mut readings = Readings::default();
        Code::compile(self.scenario(), atoms, nums).run(&self.prepared.program, self.state, &mut readings);
        readings
    }

    /// The scenario.
    pub(super) fn scenario(&self) -> &'s Scenario {
        &self.prepared.program.scenario
    }

    /// The name of an agent in this state.
    pub(super) fn name_of(&self, id: AgentId) -> Option<String> {
        self.scenario().agents.get(id.0 as usize)?;
        Some(self.state.name_of(self.scenario(), id, 0))
    }

    /// Whether nobody was found.
    pub(super) const fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// The first few who were found.
    pub(super) fn named(&self) -> &[AgentId] {
        &self.found[..NAMED.min(self.found.len())]
    }

    /// Whether a condition of this state holds.
    pub(super) fn holds(&self, atom: &Bool) -> bool {
        self.which(std::slice::from_ref(atom)).first().is_some_and(|holds| *holds)
    }

    /// Which of some conditions hold: asked at once, so that who is near whom is sought once.
    fn which(&self, atoms: &[Bool]) -> Vec<bool> {
        self.read(atoms, &[]).atoms.iter().map(|mask| mask.has(0)).collect()
    }

    /// The members of a list of whom a condition has a truth value, the first few, with what it is of each.
    fn those(&self, members: &[AgentId], truth: bool, of: impl Fn(AgentId) -> Bool) -> Vec<(AgentId, Bool)> {
        let mut found = Vec::new();
        for some in in_chunks(members) {
            let conditions: Vec<Bool> = some.iter().map(|id| of(*id)).collect();
            let which = self.which(&conditions);
            let all = some.iter().zip(conditions).zip(which);
            found.extend(all.filter(|(_, holds)| *holds == truth).map(|((id, one), _)| (*id, one)));
            if found.len() >= NAMED || (self.stop)() {
                break;
            }
        }
        found
    }

    pub(super) fn name(&mut self, id: AgentId) {
        if !self.found.contains(&id) {
            self.found.push(id);
        }
    }

    /// Names the members of sets that are spoken of by a name that they share, as `a` in `forall a in crowd`: those
    /// whose own names do not stand in the text.
    pub(super) fn name_members(&mut self, text: &str, mentions: impl FnOnce(&mut dyn FnMut(AgentId))) {
        let agents = &self.scenario().agents;
        mentions(&mut |id| {
            let hidden = |name: &str| name.ends_with(']') && !text.contains(name);
            if self.found.len() < NAMED && agents.get(id.0 as usize).is_some_and(|a| hidden(&a.name)) {
                self.name(id);
            }
        });
    }

    /// Names those who are there of whom a number speaks one by one, but not within a fold.
    pub(super) fn name_all_in(&mut self, num: &Num) {
        let mut named = Vec::new();
        spoken_of(num, &mut |id| named.push(id));
        named.retain(|id| self.is_there(*id));
        for id in named {
            self.name(id);
        }
    }

    pub(super) fn is_there(&self, id: AgentId) -> bool {
        let slot = self.state.slot(id.0 as usize, 0);
        self.state.present[slot.block].has(slot.lane)
    }

    /// Those of a set who are there: nobody else counts.
    fn members(&self, set: &Set) -> Vec<AgentId> {
        let out = match set.except {
            Some(Who::Agent(id)) => Some(id),
            _ => None,
        };
        set.members.iter().copied().filter(|id| Some(*id) != out && self.is_there(*id)).collect()
    }

    /// The agents that make a condition true or false.
    pub(super) fn walk(&mut self, atom: &Bool, truth: bool) {
        match atom {
            Bool::Constant(_) => {}
            Bool::Not(inner) => self.walk(inner, !truth),
            Bool::And(list) | Bool::Or(list) => {
                for part in list {
                    if self.holds(part) == truth {
                        self.walk(part, truth);
                        // A false conjunct, or a true disjunct, is enough.
                        if matches!(atom, Bool::And(_)) != truth {
                            break;
                        }
                    }
                }
            }
            Bool::Iff(a, b) => {
                let first = self.holds(a);
                self.walk(a, first);
                self.walk(b, first == truth);
            }
            Bool::Forall(set, body) | Bool::Exists(set, body) => {
                if matches!(atom, Bool::Forall(..)) == truth {
                    return;
                }
                let members = self.members(set);
                for (id, one) in self.those(&members, truth, |id| body.of_member(id)) {
                    self.is_member |= self.found.is_empty();
                    let is_first = self.found.is_empty() || self.found.first() == Some(&id);
                    self.name(id);
                    let compared = self.compared.len();
                    self.inside += 1;
                    self.walk(&one, truth);
                    self.inside -= 1;
                    if !is_first {
                        self.compared.truncate(compared);
                    }
                    if self.found.len() >= NAMED {
                        return;
                    }
                }
            }
            Bool::Compare(_, a, b) => {
                let compared = ((**a).clone(), (**b).clone());
                if !self.compared.contains(&compared) {
                    self.compared.push(compared);
                }
                let before = self.found.len();
                self.extremum(a);
                self.extremum(b);
                self.is_member |= before == 0 && !self.found.is_empty();
                if self.found.len() == before && self.inside == 0 {
                    self.name_all_in(a);
                    self.name_all_in(b);
                }
            }
            Bool::In(Who::Agent(id), _) | Bool::Present(Who::Agent(id)) => self.name(*id),
            Bool::Contact(Who::Agent(id)) => {
                let id = *id;
                self.name(id);
                if truth {
                    let all = (0..self.scenario().agents.len() as u32).map(AgentId);
                    let others: Vec<AgentId> = all.filter(|other| *other != id).collect();
                    let touches = |other| Bool::Touching(Who::Agent(id), Who::Agent(other));
                    for (other, _) in self.those(&others, true, touches) {
                        self.name(other);
                    }
                }
            }
            Bool::Touching(Who::Agent(a), Who::Agent(b)) => {
                self.name(*a);
                self.name(*b);
            }
            Bool::In(..) | Bool::Present(_) | Bool::Contact(_) | Bool::Touching(..) => {}
        }
    }

    /// The member with the smallest or largest value of a fold names itself.
    pub(super) fn extremum(&mut self, num: &Num) {
        match num {
            Num::Combine(_, a, b) => {
                self.extremum(a);
                self.extremum(b);
            }
            // The margin of who may not be there yet stands in a condition.
            Num::Apply(_, a) | Num::If(_, a, _) => self.extremum(a),
            // Those who were counted.
            Num::Count(set, body) if !matches!(**body, Bool::Constant(_)) => {
                let members = self.members(set);
                for (id, _) in self.those(&members, true, |id| body.of_member(id)) {
                    if self.found.len() < NAMED {
                        self.name(id);
                    }
                }
            }
            _ => {}
        }
        let Num::Fold(fold, set, body) = num else { return };
        let smallest = match fold {
            crate::model::Fold::Min => true,
            crate::model::Fold::Max => false,
            crate::model::Fold::Sum | crate::model::Fold::Mean => return,
        };
        let mut best: Option<(AgentId, f64)> = None;
        for some in in_chunks(&self.members(set)) {
            let values: Vec<Num> = some.iter().map(|id| body.of_member(*id)).collect();
            for (id, value) in some.iter().zip(self.values(&values)) {
                let better = |best: f64| if smallest { value < best } else { value > best };
                // What is not a number comes last.
                let first = best.is_none_or(|(_, best)| better(best) || best.is_nan() && !value.is_nan());
                best = if first { Some((*id, value)) } else { best };
            }
            if (self.stop)() {
                return;
            }
        }
        if let Some((best, _)) = best {
            self.is_extreme |= self.found.is_empty();
            self.name(best);
        }
    }
}

impl Asked for Search<'_> {
    fn holds(&self, condition: &Bool) -> bool {
        Search::holds(self, condition)
    }

    fn is_late(&self) -> bool {
        (self.stop)()
    }

    fn first(&self, set: &Set, body: &Bool, truth: bool) -> Option<AgentId> {
        let members = self.members(set);
        self.those(&members, truth, |id| body.of_member(id)).first().map(|(id, _)| *id)
    }
}

/// Tells of each agent that a number is about by itself: of a fold it is the set.
fn spoken_of(num: &Num, tell: &mut dyn FnMut(AgentId)) {
    match num {
        Num::Apply(_, a) => spoken_of(a, tell),
        Num::Combine(_, a, b) => {
            spoken_of(a, tell);
            spoken_of(b, tell);
        }
        Num::If(condition, a, b) => {
            condition.mentions(tell);
            spoken_of(a, tell);
            spoken_of(b, tell);
        }
        Num::Fold(..) | Num::Count(..) | Num::OfSet(..) => {}
        other => other.mentions(tell),
    }
}

/// Who is asked about at once: few at first, since the first may be enough.
fn in_chunks(mut members: &[AgentId]) -> impl Iterator<Item = &[AgentId]> {
    let mut most = FIRST;
    std::iter::from_fn(move || {
        let (some, rest) = members.split_at(most.min(members.len()));
        members = rest;
        most = AT_ONCE.min(8 * most);
        (!some.is_empty()).then_some(some)
    })
}
