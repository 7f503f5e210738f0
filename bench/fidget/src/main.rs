//! Meshes an expression in [-1, 1]³ with fidget's JIT, one thread: what `bench/race.py` compares Outcrop with.
//!
//! Usage: fidget-race EXPRESSION DEPTH [MESH.obj]
//! Prints CPU seconds of the octree and of the walk over it, and what they made, as a line of JSON.

use fidget::{context::Context, jit::JitShape, mesh};
use std::{env, error::Error, fs::File, io::BufWriter, io::Write};

/// CPU time of the process, all threads.
fn cpu_seconds() -> f64 {
    let mut t = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the call only writes to `t`.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut t) };
    t.tv_sec as f64 + 1e-9 * t.tv_nsec as f64
}

fn write_obj(mesh: &mesh::Mesh, path: &str) -> std::io::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    for v in &mesh.vertices {
        writeln!(out, "v {} {} {}", v.x, v.y, v.z)?;
    }
    for t in &mesh.triangles {
        writeln!(out, "f {} {} {}", t.x + 1, t.y + 1, t.z + 1)?;
    }
    out.flush()
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [expression, depth, output @ ..] = &arguments[..] else {
        return Err("usage: fidget-race EXPRESSION DEPTH [MESH.obj]".into());
    };
    let (context, root) = Context::from_text(File::open(expression)?)?;
    let shape = JitShape::new(&context, root)?.try_into()?;
    let settings = mesh::Settings { depth: depth.parse()?, threads: None, ..Default::default() };

    let start = cpu_seconds();
    let octree = mesh::Octree::build(&shape, &settings).ok_or("cancelled")?;
    let built = cpu_seconds();
    let mesh = octree.walk_dual();
    let end = cpu_seconds();

    println!(
        "{{\"seconds\": [{:.4}, {:.4}, {:.4}], \"triangles\": {}}}",
        end - start,
        built - start,
        end - built,
        mesh.triangles.len()
    );
    if let [path, ..] = output {
        write_obj(&mesh, path)?;
    }
    Ok(())
}
