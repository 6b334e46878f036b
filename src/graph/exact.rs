//! Contraction: what several shaders work out to the same bits has no operation that a compiler may contract in one of them alone.

use super::{Library, Variant};
use std::collections::{BTreeMap, BTreeSet};

const NAME: u32 = 5;
const FUNCTION: u32 = 54;
const FUNCTION_END: u32 = 56;
const CALL: u32 = 57;
const DECORATE: u32 = 71;
const NO_CONTRACTION: u32 = 42;
/// Operations that a compiler may contract: FAdd, FSub, FMul, FDiv, and products of vectors and matrices.
const CONTRACTED: [u32; 10] = [129, 131, 133, 136, 142, 143, 144, 145, 146, 148];

/// Operations that a compiler may contract in a function and all that it calls: of each function, how many are exact, and how many are not.
fn operations(words: &[u32], of: &str) -> BTreeMap<String, [usize; 2]> {
    let (mut names, mut exact, mut functions) = (BTreeMap::new(), BTreeSet::new(), BTreeMap::<u32, (Vec<u32>, Vec<u32>)>::new());
    let (mut at, mut function) = (5, None);
    while at < words.len() {
        let (length, code) = ((words[at] >> 16) as usize, words[at] & 0xffff);
        let instruction = &words[at..at + length];
        match code {
            NAME => {
                let bytes: Vec<u8> = instruction[2..].iter().flat_map(|word| word.to_le_bytes()).take_while(|byte| *byte != 0).collect();
                names.insert(instruction[1], String::from_utf8(bytes).unwrap());
            }
            DECORATE if instruction[2] == NO_CONTRACTION => drop(exact.insert(instruction[1])),
            FUNCTION => function = Some(instruction[2]),
            FUNCTION_END => function = None,
            CALL => functions.entry(function.unwrap()).or_default().0.push(instruction[3]),
            code if CONTRACTED.contains(&code) => functions.entry(function.unwrap()).or_default().1.push(instruction[2]),
            _ => {}
        }
        at += length;
    }
    let mut reached: Vec<u32> = names.iter().filter(|(_, name)| name.starts_with(&format!("{of}("))).map(|(id, _)| *id).collect();
    let mut found = BTreeMap::new();
    while let Some(id) = reached.pop() {
        let (calls, results) = functions.get(&id).cloned().unwrap_or_default();
        let exactly = results.iter().filter(|result| exact.contains(result)).count();
        if found.insert(names[&id].clone(), [exactly, results.len() - exactly]).is_none() {
            reached.extend(calls);
        }
    }
    found
}

#[test]
fn importance_is_worked_out_by_operations_that_no_compiler_contracts() {
    let mut library = Library::new().unwrap();
    let parts = vec![("importance", "vpls/importance-view"), ("gloss", "vpls/gloss-lobe"), ("floor", "vpls/floor-power")];
    for path in ["vpls/importance-map.comp", "vpls/proposals.comp", "vpls/floor.comp"] {
        let variant = Variant { path: path.into(), parts: parts.clone() };
        library.prepare(&BTreeSet::from([variant.clone()])).unwrap();
        let found = operations(&library.get(&variant).words, "importances");
        let all: usize = found.values().map(|[exactly, _]| exactly).sum();
        assert!(found.len() > 10 && all > 50, "{path}: {found:?}");
        let loose: Vec<_> = found.iter().filter(|(_, [_, loosely])| *loosely > 0).collect();
        assert!(loose.is_empty(), "{path}: operations that are exact, and that are not, in {loose:?}");
    }
}
