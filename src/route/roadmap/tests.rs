//! Roadmaps against oracles: many places of an edge, lengths of all pairs, all paths of a small graph, other rays. And the
//! measurements on the map of two triangles (Li, Li, Ge 2019, Figures 9 and 10).

use super::figures::{hull_area, largest_radius, short_edges};
use super::nearest::VertexGrid;
use super::*;
use crate::base::geometry::{Bounds, Polygon, Segment, Shape, Vec2, cross};
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::model::{Barrier, Obstacle, Scene};
use std::collections::BTreeMap;

fn p(x: f64, y: f64) -> Vec2 {
    Vec2::new(x, y)
}

fn wall(points: &[(f64, f64)]) -> Barrier {
    let segments = points.windows(2).map(|w| Segment::new(p(w[0].0, w[0].1), p(w[1].0, w[1].1))).collect();
    Barrier { name: String::new(), obstacle: Obstacle::Wall(segments) }
}

fn solid(shape: Shape) -> Barrier {
    Barrier { name: String::new(), obstacle: Obstacle::Solid(shape) }
}

fn disc(x: f64, y: f64, radius: f64) -> Barrier {
    solid(Shape::Circle { centre: p(x, y), radius })
}

fn triangle(corners: [(f64, f64); 3]) -> Barrier {
    solid(Shape::Polygon(Polygon::new(corners.map(|(x, y)| p(x, y)).to_vec())))
}

fn scene(barriers: Vec<Barrier>) -> Scene {
    Scene { barriers, ..Scene::default() }
}

fn ring(low: f64, high: f64) -> Barrier {
    wall(&[(low, low), (high, low), (high, high), (low, high), (low, low)])
}

fn two_triangles() -> Scene {
    scene(vec![
        triangle([(4.0, 4.0), (14.0, 4.0), (4.0, 14.0)]),
        triangle([(16.0, 16.0), (6.0, 16.0), (16.0, 6.0)]),
        ring(0.0, 20.0),
    ])
}

fn stream(seed: u64) -> Stream {
    Stream::of(TrialKey { seed, index: 0, branch: 0 }, 0, Purpose::Test)
}

fn prm(samples: usize, sampling: SamplingRule, separation: f64) -> Sampler {
    Sampler::Prm(Prm { samples, sampling, separation, neighbours: 6 })
}

fn rrt(samples: usize, step: f64, bias: f64) -> Sampler {
    Sampler::Rrt(Rrt { root: p(0.5, 19.5), samples, step, bias, target: Some(p(24.0, -4.0)) })
}

fn length(path: &[Vec2]) -> f64 {
    path.windows(2).map(|w| (w[1] - w[0]).norm()).sum()
}

/// A place of a square with a corner in the origin.
fn place(stream: Stream, draw: u32, side: f64) -> Vec2 {
    let [x, y] = stream.uniform_pair(draw);
    p(x, y) * side
}

/// A square of 10 m with walls, discs and a polygon with a hole.
fn random_scene(seed: u64) -> Scene {
    let stream = stream(seed);
    let at = |draw| place(stream, draw, 10.0);
    let mut barriers: Vec<Barrier> =
        (0..3).map(|k| (at(k), at(10 + k))).map(|(a, b)| wall(&[(a.x, a.y), (b.x, b.y)])).collect();
    barriers.extend((20..23).map(|k| disc(at(k).x, at(k).y, 0.2 + stream.uniform(10 + k))));
    let (low, size) = (at(40), p(2.5, 2.5));
    let mut polygon = Polygon::rectangle(low, low + size);
    polygon.holes = vec![Polygon::rectangle(low + 0.2 * size, low + 0.8 * size).outline];
    barriers.push(solid(Shape::Polygon(polygon)));
    barriers.push(ring(0.0, 10.0));
    scene(barriers)
}

/// Distance to the nearest barrier, m; negative inside a solid.
fn distance(scene: &Scene, p: Vec2) -> f64 {
    scene.barriers.iter().map(|b| b.obstacle.distance(p)).fold(f64::INFINITY, f64::min)
}

#[test]
fn an_edge_is_free_if_each_of_its_places_is() {
    let (mut clear, mut blocked) = (0, 0);
    for seed in 0..40 {
        let (scene, stream) = (random_scene(seed), stream(1000 + seed));
        let reach = 0.4 * stream.uniform(0);
        let free = FreeSpace::new(&scene, reach);
        let places: Vec<Vec2> = (1..25).map(|k| place(stream, k, 10.0)).collect();
        for p in &places {
            assert_eq!(free.is_free(*p), distance(&scene, *p) >= free.reach() - 1e-9, "{p:?}");
        }
        let places: Vec<Vec2> = places.into_iter().filter(|p| free.is_free(*p)).collect();
        for (k, &a) in places.iter().enumerate() {
            for &b in &places[..k] {
                let at = |step: u32| distance(&scene, a + (b - a) * (f64::from(step) / 200.0));
                let least = (0..=200).map(at).fold(f64::INFINITY, f64::min);
                let half_a_step = (b - a).norm() / 400.0;
                if free.is_clear(a, b) {
                    clear += 1;
                    assert!(least >= reach - 1e-8, "{a:?} {b:?}: {least}");
                } else {
                    blocked += 1;
                    assert!(least < reach + half_a_step, "{a:?} {b:?}: {least}");
                }
            }
        }
    }
    assert!(clear > 300 && blocked > 300, "{clear} {blocked}");
}

#[test]
fn a_line_that_touches_a_wall_is_not_free_even_for_a_point() {
    let free = FreeSpace::new(&scene(vec![wall(&[(0.0, 0.0), (0.0, 4.0)]), disc(5.0, 0.0, 1.0)]), 0.0);
    assert!(!free.is_clear(p(-1.0, 2.0), p(1.0, 2.0)));
    assert!(!free.is_clear(p(-1.0, 4.0), p(1.0, 4.0)));
    assert!(free.is_clear(p(-1.0, 4.01), p(1.0, 4.01)));
    assert!(!free.is_free(p(5.0, 0.5)) && !free.is_free(p(0.0, 1.0)) && free.is_free(p(0.1, 1.0)));
}

#[test]
fn the_nearest_vertices_are_those_of_a_look_at_all() {
    let (stream, bounds) = (stream(3), Bounds { low: p(0.0, 0.0), high: p(10.0, 2.0) });
    let mut grid = VertexGrid::new(bounds, 300);
    let mut found = Vec::new();
    for k in 0..400 {
        // Places beyond the rim, and pairs of equal ones.
        let q = place(stream, 1000 + k, 14.0) - p(2.0, 2.0);
        let mut all: Vec<(f64, u32)> =
            (0..k).map(|j| ((grid.places()[j as usize] - q).norm_squared(), j)).collect();
        all.sort_by(|a, b| a.partial_cmp(b).unwrap());
        for count in [1, 7] {
            let expected = &all[..count.min(all.len())];
            assert_eq!(grid.nearest(q, count, &mut found), expected);
        }
        let [x, y] = stream.uniform_pair(k / 2);
        grid.insert(p(10.5 * x, 2.0 * y));
    }
}

/// Lengths of the shortest ways between all pairs (Floyd 1962).
fn all_pairs(places: &[Vec2], is_joined: impl Fn(usize, usize) -> bool) -> Vec<Vec<f64>> {
    let n = places.len();
    let direct = |a: usize, b: usize| {
        if a == b || is_joined(a, b) { (places[a] - places[b]).norm() } else { f64::INFINITY }
    };
    let mut lengths: Vec<Vec<f64>> = (0..n).map(|a| (0..n).map(|b| direct(a, b)).collect()).collect();
    for k in 0..n {
        for a in 0..n {
            for b in 0..n {
                lengths[a][b] = lengths[a][b].min(lengths[a][k] + lengths[k][b]);
            }
        }
    }
    lengths
}

#[test]
fn shortest_paths_have_the_lengths_of_all_pairs() {
    let (mut bent, mut none) = (0, 0);
    for seed in 0..30 {
        let scene = random_scene(seed);
        let free = FreeSpace::new(&scene, 0.2);
        let map = Roadmap::draw(&free, &prm(50, SamplingRule::Uniform, 0.0), stream(seed));
        let ends =
            (0..200).map(|k| place(stream(500 + seed), k, 10.0)).filter(|p| distance(&scene, *p) > 0.1);
        let ends: Vec<Vec2> = ends.take(4).collect();
        let n = map.vertices().len();
        for &from in &ends {
            for &to in &ends {
                let places = [map.vertices(), &[from, to]].concat();
                let is_joined = |a: usize, b: usize| {
                    let (low, high) = (a.min(b), a.max(b));
                    map.edges().contains(&(low as u32, high as u32))
                        || (high >= n && free.is_clear(places[low], places[high]))
                };
                let expected = all_pairs(&places, is_joined)[n][n + 1];
                let field = DistanceField::new(&map, &free, to);
                for path in [shortest(&map, &free, from, to), field.path(&map, &free, from)] {
                    let found = path.as_deref().map_or(f64::INFINITY, length);
                    assert!(found == expected || (found - expected).abs() < 1e-9, "{found} {expected}");
                    let Some(path) = path else {
                        none += 1;
                        continue;
                    };
                    assert!(path.windows(2).all(|w| free.is_clear(w[0], w[1])));
                    assert_eq!((path.first(), path.last()), (Some(&from), Some(&to)));
                    bent += usize::from(path.len() > 2);
                }
            }
        }
    }
    assert!(bent > 100 && none > 10, "{bent} {none}");
}

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
                    crate::base::math::atan2(cross(a, b), a.dot(&b))
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

#[test]
fn a_path_leaves_a_place_at_a_wall_and_enters_no_closed_room() {
    let room = [(4.0, 4.0), (6.0, 4.0), (6.0, 6.0), (4.0, 6.0), (4.0, 4.0)];
    let free = FreeSpace::new(&scene(vec![ring(0.0, 10.0), wall(&room)]), 0.3);
    let map = Roadmap::draw(&free, &prm(200, SamplingRule::Uniform, 0.2), stream(1));
    let at_wall = p(3.95, 5.0);
    let field = DistanceField::new(&map, &free, p(8.0, 5.0));
    let path = field.path(&map, &free, at_wall).unwrap();
    assert!(length(&path) > 6.0 && path == shortest(&map, &free, at_wall, p(8.0, 5.0)).unwrap());
    assert_eq!(alternatives(&map, &free, &field, at_wall, 5).len(), 2);
    let field = DistanceField::new(&map, &free, p(5.0, 5.0));
    assert_eq!(field.path(&map, &free, at_wall), None);
    assert_eq!(shortest(&map, &free, at_wall, p(5.0, 5.0)), None);
    assert!(alternatives(&map, &free, &field, at_wall, 5).is_empty());
}

#[test]
fn a_roadmap_is_a_function_of_its_stream_and_its_edges_are_free() {
    let free = FreeSpace::new(&two_triangles(), 0.3);
    let samplers =
        [prm(150, SamplingRule::Bridge, 0.2), prm(150, SamplingRule::Uniform, 0.0), rrt(150, 0.5, 0.1)];
    for sampler in &samplers {
        let map = Roadmap::draw(&free, sampler, stream(1));
        assert_eq!(map, Roadmap::draw(&free, sampler, stream(1)));
        assert_ne!(map, Roadmap::draw(&free, sampler, stream(2)));
        assert_eq!(map.vertices().len(), 150);
        let vertex = |k: u32| map.vertices()[k as usize];
        assert!(map.vertices().iter().all(|p| free.is_free(*p)));
        assert!(map.edges().iter().all(|&(a, b)| a < b && free.is_clear(vertex(a), vertex(b))));
        assert!(map.edges().is_sorted_by(|a, b| a < b));
        for (k, p) in (0..150).zip(map.vertices()) {
            for (other, edge) in map.neighbours(k) {
                assert!(map.edges().contains(&(k.min(*other), k.max(*other))));
                assert_eq!(*edge, (vertex(*other) - p).norm());
            }
        }
        let ends: usize = (0..150).map(|k| map.neighbours(k).len()).sum();
        assert_eq!(ends, 2 * map.edges().len());
    }
    let tree = Roadmap::draw(&free, &samplers[2], stream(1));
    assert_eq!(tree.edges().len(), 149);
}

#[test]
fn a_scene_without_room_gives_few_vertices() {
    let free = FreeSpace::new(&scene(vec![ring(0.0, 1.0)]), 0.3);
    let map = |separation| Roadmap::draw(&free, &prm(100, SamplingRule::Bridge, separation), stream(1));
    assert_eq!(map(0.0).vertices().len(), 100);
    assert!((1..10).contains(&map(0.3).vertices().len()));
    let closed = FreeSpace::new(&scene(vec![ring(0.0, 1.0)]), 0.6);
    assert_eq!(Roadmap::draw(&closed, &prm(100, SamplingRule::Uniform, 0.0), stream(1)).vertices().len(), 0);
    let empty = FreeSpace::new(&Scene::default(), 0.3);
    let map = Roadmap::draw(&empty, &prm(20, SamplingRule::Bridge, 0.0), stream(1));
    assert_eq!(shortest(&map, &empty, p(0.0, 0.0), p(5.0, 5.0)).unwrap().len(), 2);
}

#[test]
fn figures_of_simple_shapes() {
    let square = [p(0.0, 0.0), p(2.0, 0.0), p(1.0, 1.0), p(2.0, 2.0), p(0.0, 2.0), p(1.0, 0.0)];
    assert_eq!(hull_area(&square), 4.0);
    assert_eq!(hull_area(&square[..2]), 0.0);
    // A right angle: the tangent length is the radius.
    assert!((largest_radius(p(0.0, 0.0), p(4.0, 0.0), p(4.0, 3.0)) - 1.5).abs() < 1e-12);
    assert_eq!(largest_radius(p(0.0, 0.0), p(4.0, 0.0), p(9.0, 0.0)), f64::INFINITY);
    assert_eq!(largest_radius(p(0.0, 0.0), p(4.0, 0.0), p(1.0, 0.0)), 0.0);
    let places = vec![p(0.0, 0.0), p(0.3, 0.0), p(0.3, 0.4), p(0.8, 0.4)];
    let map = Roadmap::new(places, vec![(0, 1), (0, 2), (1, 2), (2, 3)]);
    let count = short_edges(&map, 0.5);
    assert_eq!((count.shorter, count.at_most, count.forest), (2, 4, 2));
}

/// Mean coverage, %, and mean numbers of vertices, of edges shorter than 0.5 m and of those in the forest.
fn measure(sampler: &Sampler, repeats: u64) -> [f64; 4] {
    let free = FreeSpace::new(&two_triangles(), 0.0);
    let mut sum = [0.0; 4];
    for seed in 0..repeats {
        let map = Roadmap::draw(&free, sampler, stream(1000 + seed));
        let edges = short_edges(&map, 0.5);
        let counts = [map.vertices().len(), edges.shorter, edges.forest].map(|count| count as f64);
        let figures = [hull_area(map.vertices()) / 4.0, counts[0], counts[1], counts[2]];
        sum.iter_mut().zip(figures).for_each(|(sum, figure)| *sum += figure / repeats as f64);
    }
    sum
}

/// The table of Li, Li, Ge's comparison: coverage, %, of 100, 500 and 1000 vertices.
fn check_coverage(columns: &[usize], repeats: u64) {
    for &column in columns {
        let samples = [100, 500, 1000][column];
        let rows = [
            (prm(samples, SamplingRule::Bridge, 0.0), [89.5, 97.7, 98.9]),
            (prm(samples, SamplingRule::Uniform, 0.0), [89.6, 97.1, 98.6]),
            (rrt(samples, 0.5, 0.0), [21.8, 85.5, 95.3]),
        ];
        for (sampler, expected) in rows {
            let [coverage, ..] = measure(&sampler, repeats);
            assert!((coverage - expected[column]).abs() < 2.0, "{sampler:?}: {coverage}");
        }
    }
}

#[test]
fn coverage_is_that_of_the_paper() {
    check_coverage(&[1], 6);
}

#[test]
#[ignore = "long: 180 roadmaps"]
fn coverage_is_that_of_the_paper_at_all_sizes() {
    check_coverage(&[0, 1, 2], 20);
}

#[test]
fn a_separation_leaves_no_short_edges_and_covers_the_map() {
    let [coverage, vertices, short, _] = measure(&prm(700, SamplingRule::Uniform, 0.5), 3);
    assert!(vertices == 700.0 && short == 0.0 && coverage >= 99.0, "{coverage} {vertices} {short}");
    // Without one, many edges are short, and most of a forest.
    let [_, _, short, forest] = measure(&prm(700, SamplingRule::Bridge, 0.0), 3);
    assert!(short > 800.0 && forest > 400.0, "{short} {forest}");
}

/// Share of the vertices in the diagonal passage, 14.14 m by 2.83 m, and share of the roadmaps that join its ends within it.
fn passage(sampler: impl Fn() -> Sampler, repeats: u64) -> (f64, f64) {
    let free = FreeSpace::new(&two_triangles(), 0.0);
    let is_inside = |p: &Vec2| (p.x + p.y - 20.0).abs() <= 2.0 && (p.x - p.y).abs() <= 10.0;
    let (mut inside, mut all, mut joined) = (0, 0, 0);
    for seed in 0..repeats {
        let map = Roadmap::draw(&free, &sampler(), stream(7000 + seed));
        let places = map.vertices();
        all += places.len();
        inside += places.iter().filter(|p| is_inside(p)).count();
        // From the upper end along edges inside.
        let is_start = |p: &Vec2| is_inside(p) && p.x - p.y < -8.0;
        let mut reached: Vec<bool> = places.iter().map(is_start).collect();
        let mut open: Vec<u32> = (0_u32..).zip(&reached).filter_map(|(k, r)| r.then_some(k)).collect();
        while let Some(at) = open.pop() {
            for &(next, _) in map.neighbours(at) {
                if !reached[next as usize] && is_inside(&places[next as usize]) {
                    reached[next as usize] = true;
                    open.push(next);
                }
            }
        }
        joined += usize::from(places.iter().zip(&reached).any(|(p, reached)| *reached && p.x - p.y > 8.0));
    }
    (inside as f64 / all as f64, joined as f64 / repeats as f64)
}

#[test]
fn bridges_gather_in_the_narrow_passage() {
    let (bridge, _) = passage(|| prm(200, SamplingRule::Bridge, 0.0), 20);
    let (uniform, _) = passage(|| prm(200, SamplingRule::Uniform, 0.0), 20);
    // Uniform samples have the share of the area: 40 m² of 300 m².
    assert!((uniform - 40.0 / 300.0).abs() < 0.02, "{uniform}");
    assert!(bridge > 1.6 * uniform, "{bridge}");
}

#[test]
#[ignore = "long: 600 roadmaps"]
fn uniform_samples_join_the_ends_of_the_passage_more_often_than_bridges() {
    // Bridges lie in clusters, whose six nearest neighbours are in the same cluster. Samples apart from each other have none.
    let joined = |sampling, separation| passage(|| prm(200, sampling, separation), 200).1;
    let (bridge, uniform) = (joined(SamplingRule::Bridge, 0.0), joined(SamplingRule::Uniform, 0.0));
    let apart = joined(SamplingRule::Uniform, 0.5);
    assert!(bridge < uniform && uniform < apart && apart > 0.85, "{bridge} {uniform} {apart}");
}
