//! What a mesh file of a housing holds, and what it weighs; or writes the mesh of the default housing as a start.
//!
//! ```sh
//! cargo run --release -p planetary --example mesh_file my-housing.inp mm   # or si
//! cargo run --release -p planetary --example mesh_file my-housing.inp write
//! ```

use planetary::housing::inp::{Units, read, write};
use planetary::housing::{Casing, SolidMesh};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, what] = arguments.as_slice() else { return Err("needs a file, and mm, si or write".into()) };
    let mesh = match what.as_str() {
        "mm" => read(&std::fs::read_to_string(file)?, &Units::MILLIMETRE)?,
        "si" => read(&std::fs::read_to_string(file)?, &Units::SI)?,
        "write" => {
            let mesh = Casing::default().housing()?.mesh;
            std::fs::write(file, write(&mesh, &Units::SI))?;
            mesh
        }
        other => return Err(format!("`{other}` is not mm, si or write").into()),
    };
    print(&mesh)
}

fn print(mesh: &SolidMesh) -> Result<(), Box<dyn std::error::Error>> {
    mesh.validate()?;
    let inertia = mesh.inertia()?;
    println!("{} nodes, {} elements", mesh.nodes.len(), mesh.elements.len());
    println!("{:.4} kg, centre of mass {:.5?} m", inertia.mass, inertia.centre);
    let ends =
        |d: usize| mesh.nodes.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x[d]), b.max(x[d])]);
    for (d, name) in ["x", "y", "z"].into_iter().enumerate() {
        println!("{name} from {:.4} to {:.4} m", ends(d)[0], ends(d)[1]);
    }
    for (name, nodes) in &mesh.node_sets {
        let middle: Vec<f64> = (0..3)
            .map(|d| nodes.iter().map(|&n| mesh.nodes[n as usize][d]).sum::<f64>() / nodes.len() as f64)
            .collect();
        println!("node set {name}: {} nodes about {middle:.4?} m", nodes.len());
    }
    Ok(())
}
