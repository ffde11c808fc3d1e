//! Distance, gap and linking number of two rings of wire.
//!
//! `cargo run -p maille-geometry --example two_rings`

use maille_geometry::{Circle, Torus, Vec3, linking_number, torus_gaps};

fn main() {
    // Two rings of radius 1 and wire radius 0.1, linked like two links of a chain, the second one slightly turned.
    let wire = 0.1;
    let normal = nalgebra::UnitVector3::new_normalize(Vec3::new(0.1, 1.0, 0.2));
    let a = Torus { circle: Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0), minor_radius: wire };
    let b = Torus { circle: Circle::new(Vec3::new(0.8, 0.0, 0.1), normal, 1.0), minor_radius: wire };

    let (minima, gaps) = torus_gaps(&a, &b);
    println!("distance of the core circles: {:.6}", minima.closest().distance);
    println!("linking number: {}", linking_number(&a.circle, &b.circle));
    println!("local minima of the distance:");
    for (minimum, gap) in minima.as_slice().iter().zip(gaps) {
        let [p, q] = [minimum.point_a, minimum.point_b];
        println!(
            "  distance {:.6}, gap {gap:.6}, between ({:.3}, {:.3}, {:.3}) and ({:.3}, {:.3}, {:.3})",
            minimum.distance, p.x, p.y, p.z, q.x, q.y, q.z,
        );
    }
}
