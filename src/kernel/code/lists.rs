//! The lists of members that crowds refer to, each kept once.

use super::node::Crowd;
use crate::model::{AgentId, Set, Who};
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

/// Most members of a set that has a list of its own for each agent left out.
const OWN_LIST: usize = 64;

/// Lists of members.
#[derive(Debug, Default)]
pub(super) struct Lists {
    /// The lists.
    pub(super) all: Vec<Vec<u32>>,
    /// Where they are, by their hashes.
    known: HashMap<u64, Vec<u32>>,
    /// The members that were asked for last, and their list: thousands of questions in a row have the same.
    last: Option<(Arc<[AgentId]>, u32)>,
}

impl Lists {
    /// The crowd of a set. Of few, each agent has a list of the others; of many, all share one and leave somebody out on
    /// the way, for lists of everybody else would take the square of their number.
    pub(super) fn crowd(&mut self, set: &Set) -> Crowd {
        let members = set.members.iter().map(|id| id.0);
        match set.except {
            Some(Who::Agent(AgentId(out))) if set.members.len() <= OWN_LIST => {
                Crowd { list: self.list(members.filter(|&id| id != out).collect()), except: None }
            }
            except => {
                let list = match &self.last {
                    Some((last, list)) if Arc::ptr_eq(last, &set.members) => *list,
                    _ => self.list(members.collect()),
                };
                self.last = Some((Arc::clone(&set.members), list));
                Crowd { list, except }
            }
        }
    }

    fn list(&mut self, members: Vec<u32>) -> u32 {
        let mut hasher = DefaultHasher::new();
        members.hash(&mut hasher);
        let known = self.known.entry(hasher.finish()).or_default();
        if let Some(&list) = known.iter().find(|&&list| self.all[list as usize] == members) {
            return list;
        }
        let list = self.all.len() as u32;
        known.push(list);
        self.all.push(members);
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn without(members: u32, out: u32) -> Set {
        Set { members: (0..members).map(AgentId).collect(), except: Some(Who::Agent(AgentId(out))) }
    }

    #[test]
    fn agents_of_a_large_crowd_share_the_list_of_it() {
        let mut lists = Lists::default();
        let crowds: Vec<Crowd> = (0..4000).map(|out| lists.crowd(&without(4000, out))).collect();
        assert_eq!(lists.all.len(), 1);
        assert!(crowds.iter().enumerate().all(|(k, c)| c.except == Some(Who::Agent(AgentId(k as u32)))));
    }

    #[test]
    fn agents_of_a_small_crowd_have_lists_of_the_others() {
        let mut lists = Lists::default();
        let (first, second) = (lists.crowd(&without(3, 1)), lists.crowd(&without(3, 2)));
        assert_eq!((first.except, second.except), (None, None));
        assert_eq!(lists.all, [vec![0, 2], vec![0, 1]]);
        assert_eq!(lists.crowd(&without(3, 1)), first);
    }
}
