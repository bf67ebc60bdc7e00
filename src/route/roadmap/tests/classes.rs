//! Classes of paths against windings, other rays and all paths of a small graph.

use super::*;
use crate::base::geometry::cross;
use crate::base::math::atan2;
use std::collections::BTreeMap;

#[test]
fn the_map_of_two_triangles_has_three_classes() {
    let free = FreeSpace::new(&two_triangles(), 0.35);
    let goal = p(18.75, 1.25);
    for seed in 0..3 {
        let map = Roadmap::draw(&free, &prm(400, SamplingRule::Bridge, 0.3), stream(seed));
        let field = DistanceField::new(&map, &free, goal);
        for k in 0..8 {
            let [x, y] = stream(77).uniform_pair(k);
            let from = if k == 0 { p(2.0, 16.75) } else { p(0.5 + 3.0 * x, 14.0 + 5.5 * y) };
            let found = alternatives(&map, &free, &field, from, 9);
            // Above a triangle if its center lies to the right of the path, seen from the start to the goal.
            let is_above = |path: &[Vec2], center: Vec2| {
                let around = |w: &[Vec2]| {
                    let (a, b) = (w[0] - center, w[1] - center);
                    atan2(cross(a, b), a.dot(&b))
                };
                path.windows(2).map(around).sum::<f64>() < 0.0
            };
            let mut sides: Vec<_> = found
                .iter()
                .map(|a| (is_above(&a.path, p(7.0, 7.0)), is_above(&a.path, p(13.0, 13.0))))
                .collect();
            sides.sort_unstable();
            assert_eq!(sides, [(false, false), (true, false), (true, true)], "{from:?}");
            assert!(found.windows(2).all(|w| w[0].length <= w[1].length && w[0].class != w[1].class));
            let straight = field.path(&map, &free, from).unwrap();
            assert!((found[0].length - length(&straight)).abs() < 1e-9);
            for alternative in &found {
                assert_eq!(alternative.class, free.rays().word(&alternative.path));
                assert!((alternative.length - length(&alternative.path)).abs() < 1e-9);
                assert!(alternative.path.windows(2).all(|w| free.is_clear(w[0], w[1])));
            }
            assert_eq!(alternatives(&map, &free, &field, from, 2), found[..2]);
        }
    }
}

/// The rays of a scene in a direction.
fn rays(scene: &Scene, direction: Vec2) -> Rays {
    let solids = scene.barriers.iter().filter_map(|b| match &b.obstacle {
        Obstacle::Solid(shape) => Some(shape.clone()),
        Obstacle::Wall(_) => None,
    });
    Rays::new(FreeSpace::new(scene, 0.0).sight().pieces(), &solids.collect::<Vec<_>>(), direction)
}

#[test]
fn rays_in_any_direction_give_the_same_classes() {
    let mut same = 0;
    for seed in 0..12 {
        let scene = random_scene(seed);
        let free = FreeSpace::new(&scene, 0.1);
        let map = Roadmap::draw(&free, &prm(120, SamplingRule::Uniform, 0.0), stream(seed));
        let ends = [map.vertices()[0], map.vertices()[1]];
        // Random paths: over random vertices, with the same ends.
        let over = |k: u32| {
            let [a, b] = stream(90 + seed).uniform_pair(k).map(|u| map.vertices()[(u * 120.0) as usize]);
            let parts =
                [(ends[0], a), (a, b), (b, ends[1])].map(|(from, to)| shortest(&map, &free, from, to));
            parts.into_iter().collect::<Option<Vec<_>>>().map(|parts| parts.concat())
        };
        let paths: Vec<Vec<Vec2>> = (0..40).filter_map(over).collect();
        let others = [p(1.0, 0.0), p(0.0, -1.0), p(-0.8, 0.6)].map(|direction| rays(&scene, direction));
        assert!(others.iter().all(|other| other.count() == free.rays().count()));
        for (k, a) in paths.iter().enumerate() {
            for b in &paths[..k] {
                let is_one = |rays: &Rays| rays.word(a) == rays.word(b);
                same += usize::from(is_one(free.rays()));
                assert!(others.iter().all(|other| is_one(other) == is_one(free.rays())), "{seed}");
            }
        }
    }
    assert!(same > 100, "{same}");
}

#[test]
fn each_alternative_is_the_shortest_of_all_paths_of_its_class() {
    for seed in 0..12 {
        let barriers = vec![disc(4.0, 3.2, 0.8), disc(6.0, 6.4, 0.9), ring(0.0, 10.0)];
        let scene = scene(barriers);
        let free = FreeSpace::new(&scene, 0.2);
        let map = Roadmap::draw(&free, &prm(13, SamplingRule::Uniform, 1.0), stream(seed));
        let (from, to) = (p(1.0, 2.0), p(9.0, 8.0));
        let other = rays(&scene, p(0.0, 1.0));
        // All paths without a vertex twice, by class.
        let mut best: BTreeMap<Word, f64> = BTreeMap::new();
        let mut open: Vec<(Vec<Vec2>, Vec<u32>)> = vec![(vec![from], Vec::new())];
        while let Some((path, visited)) = open.pop() {
            let at = path[path.len() - 1];
            if free.is_clear(at, to) {
                let whole = [path.clone(), vec![to]].concat();
                let known = best.entry(other.word(&whole)).or_insert(f64::INFINITY);
                *known = known.min(length(&whole));
            }
            let next: Vec<u32> = match visited.last() {
                Some(last) => map.neighbours(*last).iter().map(|(k, _)| *k).collect(),
                None => (0..13).filter(|k| free.is_clear(from, map.vertices()[*k as usize])).collect(),
            };
            for k in next.into_iter().filter(|k| !visited.contains(k)) {
                let path = [path.clone(), vec![map.vertices()[k as usize]]].concat();
                if length(&path) < 22.0 {
                    open.push((path, [visited.clone(), vec![k]].concat()));
                }
            }
        }
        let field = DistanceField::new(&map, &free, to);
        let found = alternatives(&map, &free, &field, from, 20);
        let mut classes: Vec<Word> = found.iter().map(|a| other.word(&a.path)).collect();
        for (class, alternative) in classes.iter().zip(&found).filter(|(_, a)| a.length < 21.0) {
            assert!((best[class] - alternative.length).abs() < 1e-9, "{seed} {class:?}");
        }
        // Nobody needs a loop for a way so short.
        let shortest = best.values().copied().fold(f64::INFINITY, f64::min);
        let short: Vec<_> = best.iter().filter(|(_, length)| **length < 1.4 * shortest).collect();
        assert!(short.iter().all(|(class, _)| classes.contains(class)), "{seed} {short:?} {found:?}");
        classes.sort();
        classes.dedup();
        assert_eq!(classes.len(), found.len());
    }
}

#[test]
fn obstacles_that_share_a_point_are_one_and_what_encloses_is_none() {
    let count = |barriers: Vec<Barrier>| rays(&scene(barriers), Rays::DIRECTION).count();
    assert_eq!(count(vec![disc(0.0, 0.0, 1.0), disc(2.0, 0.0, 1.0), wall(&[(3.0, 0.0), (9.0, 0.0)])]), 1);
    assert_eq!(count(vec![disc(0.0, 0.0, 1.0), disc(2.1, 0.0, 1.0), wall(&[(0.0, 3.0), (9.0, 3.0)])]), 3);
    let mut hollow = Polygon::rectangle(p(0.0, 0.0), p(9.0, 9.0));
    hollow.holes = vec![Polygon::rectangle(p(3.0, 3.0), p(6.0, 6.0)).outline];
    let hollow = || solid(Shape::Polygon(hollow.clone()));
    // A disc in the solid part belongs to it, one in the hole does not.
    assert_eq!(count(vec![hollow(), disc(1.0, 1.0, 0.2)]), 1);
    assert_eq!(count(vec![hollow(), disc(4.5, 4.5, 0.2)]), 2);
    // Nobody inside a ring crosses its ray, nor that of walls joined to it, in any direction.
    let spur = wall(&[(0.0, 5.0), (6.0, 5.0)]);
    for direction in [Rays::DIRECTION, p(1.0, 0.0), p(0.0, -1.0)] {
        let rays = rays(&scene(vec![ring(0.0, 10.0), spur.clone()]), direction);
        assert_eq!(rays.count(), 1);
        for k in 0..200 {
            let inside = |draw| place(stream(5), draw, 10.0);
            assert_eq!(rays.crossings(inside(2 * k), inside(2 * k + 1)).count(), 0);
        }
    }
}
