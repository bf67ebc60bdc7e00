//! Roadmaps and shortest paths against oracles: many places of an edge, lengths of all pairs.

mod classes;
mod figures;
mod measurements;

use super::nearest::VertexGrid;
use super::*;
use crate::base::geometry::{Bounds, Polygon, Segment, Shape, Vec2};
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::model::{Barrier, Obstacle, Scene};

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
