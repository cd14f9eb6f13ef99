//! The `canvas` solver against traces of the demo's own arithmetic, run in JavaScript: equal to the last bit.
//!
//! Each trace holds frame 1 and every tenth up to frame 300; the deltas stand in files beside them.

use std::fs;
use std::path::Path;

use carom::{DVec2, Scene, Simulation, Solver};

fn data(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn deltas(name: &str) -> Vec<f64> {
    data(name).lines().map(|line| line.parse().unwrap()).collect()
}

/// A ball's state as the trace gives it: frame, ball, bits of x, y, vx, vy, whether it collides.
type Row = (usize, usize, [u64; 4], bool);

fn rows(trace: &str) -> Vec<Row> {
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        let bits = |field: &str| field.parse::<f64>().unwrap().to_bits();
        let state = [bits(fields[2]), bits(fields[3]), bits(fields[4]), bits(fields[5])];
        (fields[0].parse().unwrap(), fields[1].parse().unwrap(), state, fields[6] == "1")
    };
    data(trace).lines().skip(1).map(row).collect()
}

fn state(simulation: &Simulation, frame: usize, ball: usize) -> Row {
    let it = &simulation.balls()[ball];
    let (p, v) = (it.position(), it.velocity());
    (frame, ball, [p.x, p.y, v.x, v.y].map(f64::to_bits), simulation.touching()[ball])
}

fn assert_same_bits(scene: &str, size: DVec2, deltas: &[f64], trace: &str) {
    let rows = rows(trace);
    assert_eq!(rows.len(), 465, "{trace} has 15 balls in 31 frames");
    let scene = Scene::load(scene).unwrap().with_solver(Solver::Canvas).with_size(size).unwrap();
    let mut simulation = scene.build().unwrap();
    let mut expected = rows.into_iter().peekable();
    for (frame, &delta) in (1..).zip(deltas) {
        simulation.advance(delta).unwrap();
        while let Some(row) = expected.next_if(|row| row.0 == frame) {
            assert_eq!(state(&simulation, frame, row.1), row, "{trace}, frame {frame}, ball {}", row.1);
        }
    }
    assert_eq!(expected.next(), None, "the whole trace was compared");
}

const WIDE: DVec2 = DVec2::new(1280.0, 720.0);

#[test]
fn elastic_equals_the_demo_bit_for_bit() {
    assert_same_bits(
        "elastic",
        WIDE,
        &deltas("deltas-irregular.txt"),
        "canvas-elastic-1280x720-irregular.csv",
    );
}

#[test]
fn inelastic_equals_the_demo_bit_for_bit() {
    assert_same_bits(
        "inelastic",
        WIDE,
        &deltas("deltas-irregular.txt"),
        "canvas-inelastic-1280x720-irregular.csv",
    );
}

#[test]
fn gravity_equals_the_demo_bit_for_bit() {
    assert_same_bits(
        "gravity",
        WIDE,
        &deltas("deltas-irregular.txt"),
        "canvas-gravity-1280x720-irregular.csv",
    );
}

#[test]
fn walls_at_another_size_equal_the_demo_bit_for_bit() {
    let size = DVec2::new(800.0, 600.0);
    assert_same_bits("walls", size, &deltas("deltas-60hz.txt"), "canvas-walls-800x600-60hz.csv");
}
