//! From the graph of values to linear code: every value in the outermost loop that its running agents
//! allow, operands before users, one register each.

use super::node::{Crowd, Cut, Graph, Id, Join, Node};
use crate::model::{Arithmetic, Fold, Who};

/// An instruction.
#[derive(Clone, Debug)]
pub(super) enum Instruction {
    /// Compute a value from registers into a register.
    Do(Id, Node),
    /// Begin of loop number so and so.
    Enter(u32),
    /// End of it.
    Leave(u32),
}

/// A loop.
#[derive(Clone, Copy, Debug)]
pub(super) struct Loop {
    pub(super) join: Join,
    pub(super) crowd: Crowd,
    /// The running agent that it moves.
    pub(super) var: u32,
    /// Register of the body's value.
    pub(super) body: Id,
    /// Register of the result.
    pub(super) into: Id,
    /// Register that counts members, for means.
    pub(super) count: Id,
    /// First instruction of the body.
    pub(super) start: usize,
    /// First instruction after the loop.
    pub(super) exit: usize,
    /// Whether eight members of one trial can be taken at once.
    pub(super) lanewise: bool,
    /// Register of a smallest measure in the body, and which of its values may be larger than they are.
    pub(super) cut: Option<(Id, Cut)>,
}

/// Linear code.
#[derive(Clone, Debug, Default)]
pub(super) struct Schedule {
    pub(super) instructions: Vec<Instruction>,
    pub(super) loops: Vec<Loop>,
    /// Register of each node, numbers and truth values counted apart.
    pub(super) registers: Vec<Id>,
    /// How many registers of numbers there are.
    pub(super) numbers: u32,
    /// How many registers of truth values there are.
    pub(super) truths: u32,
    /// How many running agents there are.
    pub(super) running: u32,
    /// Registers of numbers that never change.
    pub(super) constants: Vec<(Id, f64)>,
}

/// Makes linear code that computes the roots.
pub(super) fn schedule(graph: &Graph, roots: &[Id]) -> Schedule {
    let mut out = Schedule::default();
    for (id, node) in graph.nodes.iter().enumerate() {
        let bank = if node.is_truth() { &mut out.truths } else { &mut out.numbers };
        out.registers.push(*bank);
        *bank += 1;
        match *node {
            Node::Constant(bits) => out.constants.push((out.registers[id], f64::from_bits(bits))),
            Node::Loop(_, _, var, _) => out.running = out.running.max(var + 1),
            _ => {}
        }
    }
    emit(graph, roots, 0, &mut Visits::of(graph), &mut out);
    out
}

/// Which nodes were come upon in the present look.
struct Visits {
    looks: u32,
    last: Vec<u32>,
}

impl Visits {
    fn of(graph: &Graph) -> Self {
        Self { looks: 0, last: vec![0; graph.nodes.len()] }
    }

    /// The nodes that the roots need and that belong at least `level` loops deep, ascending: what belongs less deep,
    /// and all that it needs, was computed before. Nothing else is looked at, so that many loops take no longer
    /// than all they are made of.
    fn needed(&mut self, graph: &Graph, roots: &[Id], level: u32) -> Vec<Id> {
        self.looks += 1;
        let mut found = Vec::new();
        let mut open = roots.to_vec();
        while let Some(id) = open.pop() {
            let is_new = std::mem::replace(&mut self.last[id as usize], self.looks) != self.looks;
            if is_new && graph.level(id) >= level {
                found.push(id);
                open.extend(graph.nodes[id as usize].operands());
            }
        }
        found.sort_unstable();
        found
    }
}

/// Appends all values that the roots need and that belong exactly `level` loops deep.
fn emit(graph: &Graph, roots: &[Id], level: u32, visits: &mut Visits, out: &mut Schedule) {
    for id in visits.needed(graph, roots, level) {
        if graph.level(id) != level {
            continue;
        }
        let id = id as usize;
        let node = &graph.nodes[id];
        let mut node = node.clone();
        let into = out.registers[id];
        match node {
            Node::Constant(_) => {}
            Node::Loop(join, crowd, var, body) => {
                let number = out.loops.len();
                let count = out.numbers;
                out.numbers += 1;
                let register = out.registers[body as usize];
                out.instructions.push(Instruction::Enter(number as u32));
                let start = out.instructions.len();
                let info = Loop {
                    join,
                    crowd,
                    var,
                    body: register,
                    into,
                    count,
                    start,
                    exit: start,
                    lanewise: false,
                    cut: cut(graph, &node).map(|(id, cut)| (out.registers[id as usize], cut)),
                };
                out.loops.push(info);
                emit(graph, &[body], var + 1, visits, out);
                let inside = &out.instructions[start..];
                out.loops[number].lanewise =
                    inside.iter().all(|one| matches!(one, Instruction::Do(_, node) if node.is_lanewise()));
                out.instructions.push(Instruction::Leave(number as u32));
                out.loops[number].exit = out.instructions.len();
            }
            _ => {
                for operand in node.operands_mut() {
                    *operand = out.registers[*operand as usize];
                }
                out.instructions.push(Instruction::Do(into, node));
            }
        }
    }
}

/// The smallest measure around the running agent of a loop of which nobody wants to know more than the least of all
/// members, or whether it is above a bound: to raise it in others changes nothing.
fn cut(graph: &Graph, node: &Node) -> Option<(Id, Cut)> {
    let Node::Loop(join, crowd, var, body) = *node else { return None };
    let me = Who::Running(var);
    let (value, cut) = if join == Join::Fold(Fold::Min) && crowd.except.is_none() {
        (body, Cut::Least(crowd.list))
    } else {
        let (value, bound) = compared(graph, body, me)?;
        (value, Cut::Above(bound))
    };
    let id = smallest(graph, value, me)?;
    // Nothing else in the body needs it.
    (graph.ways(body, id) == 1).then_some((id, cut))
}

/// What a condition compares of the smallest measure around an agent with a number, and the bits of that.
fn compared(graph: &Graph, condition: Id, me: Who) -> Option<(Id, u64)> {
    let mut part = vec![false; condition as usize + 1];
    part[condition as usize] = true;
    // Operands come before their users.
    for id in (0..part.len()).rev() {
        if !part[id] {
            continue;
        }
        match graph.nodes[id] {
            Node::Not(a) => part[a as usize] = true,
            Node::And(ref all) | Node::Or(ref all) => all.iter().for_each(|&a| part[a as usize] = true),
            Node::Compare(_, a, b) => {
                for (value, bound) in [(a, b), (b, a)] {
                    if let Node::Constant(bits) = graph.nodes[bound as usize]
                        && smallest(graph, value, me).is_some()
                    {
                        return Some((value, bits));
                    }
                }
            }
            _ => {}
        }
    }
    None
}

/// The smallest measure around an agent that a value is for all who are there, or the lesser of that and something else.
fn smallest(graph: &Graph, value: Id, me: Who) -> Option<Id> {
    // Who is not there is not among the members either.
    let mut id = match graph.nodes[value as usize] {
        Node::Select(here, id, _) if graph.nodes[here as usize] == Node::Present(me) => id,
        _ => value,
    };
    // The walls, which are the same however far the others are, stand second.
    if let Node::Combine(Arithmetic::Min, first, _) = graph.nodes[id as usize] {
        id = first;
    }
    match graph.nodes[id as usize] {
        Node::Nearest(who, crowd, _) if who == me && crowd.except == Some(me) => Some(id),
        _ => None,
    }
}
