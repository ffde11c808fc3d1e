//! What is planted in the columns of waves.

use super::specimen::Specimen;

#[test]
fn waves_that_were_emptied_or_invented_are_found() {
    for (cells, check, words) in [
        (vec![("wave_curvature", "4.2")], "waves", "wave_curvature is 4.2"),
        (vec![("wave_curvature", "0.01")], "waves", "wave_curvature is 0.01"),
        (vec![("wave_q1", "0.31")], "waves", "wave_curvature is -4.2"),
        (vec![("wave_curvature", ""), ("wave_q1", ""), ("wave_q2", "")], "waves", "wave_curvature is empty"),
        (vec![("wave_q2", "")], "status", "a row that is local has 2 of wave_curvature, wave_q1, wave_q2"),
        // True of this wave, but another one is lower.
        (
            vec![
                ("wave_curvature", "-1.3416983802665732"),
                ("wave_q1", "0.3333333333333333"),
                ("wave_q2", "-0.3333333333333333"),
            ],
            "waves",
            "but the wave with q = 2π [0.5, 0.0] has -4.23",
        ),
    ] {
        let specimen = Specimen::of("european-6-in-1 --directions 45 --l2=-0.25 --cell 1x1");
        specimen.forge_row(&cells);
        specimen.found_by(4, check, words);
    }
}
