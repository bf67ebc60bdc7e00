//! Tables that find an item among those of a list that are equal to it, so that each is kept once.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Where items are in a list, by their hashes. What the list no longer has is not found, so a list may be cleared.
#[derive(Clone, Debug, Default)]
pub(crate) struct Interned {
    places: HashMap<u64, Vec<u32>>,
}

impl Interned {
    /// The place of an item in its list, and whether it is new there: then it has been added.
    pub(crate) fn place<T: Hash + PartialEq>(&mut self, list: &mut Vec<T>, item: T) -> (usize, bool) {
        self.place_said(list, item, "", |_| true)
    }

    /// The same of items that differ by how they are said, too; `is_said` tells whether that at a place is said so.
    pub(crate) fn place_said<T: Hash + PartialEq>(
        &mut self,
        list: &mut Vec<T>,
        item: T,
        text: &str,
        is_said: impl Fn(usize) -> bool,
    ) -> (usize, bool) {
        // The keys of this hasher are always the same.
        let mut hasher = DefaultHasher::new();
        item.hash(&mut hasher);
        text.hash(&mut hasher);
        let places = self.places.entry(hasher.finish()).or_default();
        let same = |place: usize| list.get(place) == Some(&item) && is_said(place);
        if let Some(&known) = places.iter().find(|&&place| same(place as usize)) {
            return (known as usize, false);
        }
        places.push(list.len() as u32);
        list.push(item);
        (list.len() - 1, true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_items_have_one_place_and_a_cleared_list_begins_anew() {
        let (mut table, mut list) = (Interned::default(), Vec::new());
        assert_eq!(table.place(&mut list, "a"), (0, true));
        assert_eq!(table.place(&mut list, "b"), (1, true));
        assert_eq!(table.place(&mut list, "a"), (0, false));
        list.clear();
        assert_eq!(table.place(&mut list, "b"), (0, true));
        assert_eq!(table.place(&mut list, "b"), (0, false));
        assert_eq!(list, ["b"]);
    }
}
