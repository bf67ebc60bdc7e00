//! Measurements on the map of two triangles: coverage, short edges and the narrow passage (Li, Li, Ge 2019, Figures 9 and 10).

use super::figures::{hull_area, largest_radius, short_edges};
use super::*;

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
