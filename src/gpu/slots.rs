//! Slot map: places are reused, ids are not.

/// Id: a place, and the generation of its content.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Id {
    place: u32,
    generation: u32,
}

/// Slot map with as many places as there were elements at the same time.
pub(super) struct Slots<T> {
    /// Generation and element of each place; for an empty place, the generation of the next element.
    places: Vec<(u32, Option<T>)>,
    free: Vec<u32>,
    /// Kind of element, for panics about stale ids.
    what: &'static str,
}

impl<T> Slots<T> {
    pub fn new(what: &'static str) -> Self {
        Self { places: Vec::new(), free: Vec::new(), what }
    }

    pub fn add(&mut self, thing: T) -> Id {
        let place = self.free.pop().unwrap_or_else(|| {
            self.places.push((0, None));
            self.places.len() as u32 - 1
        });
        let (generation, content) = &mut self.places[place as usize];
        *content = Some(thing);
        Id { place, generation: *generation }
    }

    /// # Panics
    /// If the element was removed, even if its place is used again.
    pub fn get(&self, id: Id) -> &T {
        match &self.places[id.place as usize] {
            (generation, Some(thing)) if *generation == id.generation => thing,
            _ => panic!("{} {id:?} is used after it was freed", self.what),
        }
    }

    /// As [`Self::get`].
    pub fn get_mut(&mut self, id: Id) -> &mut T {
        match &mut self.places[id.place as usize] {
            (generation, Some(thing)) if *generation == id.generation => thing,
            _ => panic!("{} {id:?} is used after it was freed", self.what),
        }
    }

    /// # Panics
    /// If the element was already removed.
    pub fn remove(&mut self, id: Id) -> T {
        let (generation, content) = &mut self.places[id.place as usize];
        let own = if *generation == id.generation { content.take() } else { None };
        let Some(thing) = own else { panic!("{} {id:?} is freed twice", self.what) };
        // A place with exhausted generations stays empty.
        if let Some(next) = generation.checked_add(1) {
            *generation = next;
            self.free.push(id.place);
        }
        thing
    }

    /// Removes and returns all elements.
    pub fn take_all(&mut self) -> Vec<T> {
        self.free.clear();
        std::mem::take(&mut self.places).into_iter().filter_map(|(_, thing)| thing).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::{AssertUnwindSafe, catch_unwind};

    #[test]
    fn a_thousand_things_one_after_another_take_the_places_of_two() {
        let mut slots = Slots::new("thing");
        let first = slots.add(0);
        let mut ids = vec![first];
        for i in 1..=1000 {
            let id = slots.add(i);
            assert!(!ids.contains(&id), "{id:?} is given twice");
            assert_eq!((*slots.get(id), slots.remove(id)), (i, i));
            ids.push(id);
        }
        assert_eq!((slots.places.len(), *slots.get(first)), (2, 0));
        assert_eq!(slots.take_all(), [0]);
    }

    #[test]
    fn an_id_that_is_out_of_date_panics_even_where_something_else_lies_in_its_place() {
        let mut slots = Slots::new("thing");
        let stale = slots.add("old");
        slots.remove(stale);
        for thing in [None, Some("new")] {
            let fresh = thing.map(|thing| slots.add(thing));
            let message = |panics: &mut dyn FnMut()| *catch_unwind(AssertUnwindSafe(panics)).unwrap_err().downcast::<String>().unwrap();
            let used = "thing Id { place: 0, generation: 0 } is used after it was freed";
            assert_eq!(message(&mut || _ = slots.get(stale)), used);
            assert_eq!(message(&mut || _ = slots.get_mut(stale)), used);
            assert_eq!(message(&mut || _ = slots.remove(stale)), "thing Id { place: 0, generation: 0 } is freed twice");
            assert_eq!(fresh.map(|fresh| *slots.get(fresh)), thing);
        }
    }
}
