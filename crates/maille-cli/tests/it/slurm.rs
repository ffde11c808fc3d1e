//! The batch script of docs/guide/clusters.md, with a stand-in for SLURM that stops its tasks and starts them again.

use std::{
    fs,
    path::Path,
    process::{Command, Output, Stdio},
};

/// Half a second of work each, more or less.
const STUDY: &str = "directions = \"0:179:4\"\nl2 = \"-0.25:0.25:0.05\"\ncell = \"1x1\"\nstarts = 2\n\
                     [[designs]]\ndesign = \"european-4-in-1\"\n";

fn shell(folder: &Path, line: &str) -> Command {
    let program = Path::new(env!("CARGO_BIN_EXE_maille")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let mut command = Command::new("sh");
    command.args(["-c", line]).current_dir(folder).env("PATH", path).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn rows(folder: &Path) -> Vec<String> {
    let mut table = csv::Reader::from_path(folder.join("limits.csv")).unwrap();
    let names = ["record", "wall_s"].map(|name| table.headers().unwrap().iter().position(|h| h == name).unwrap());
    let row = |row: csv::StringRecord| {
        let kept = row.iter().enumerate().filter(|(k, _)| !names.contains(k)).map(|(_, cell)| cell.to_owned());
        kept.collect::<Vec<_>>().join(",")
    };
    table.records().map(|r| row(r.unwrap())).collect()
}

#[test]
fn tasks_of_a_job_array_are_stopped_and_requeued_until_they_are_done() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let guide = fs::read_to_string(here.join("../../docs/guide/clusters.md")).unwrap();
    let block = guide.split("```bash\n").find(|block| block.starts_with("#!/bin/bash\n#SBATCH")).unwrap();
    let script = block.split("```").next().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("job.sh"), script).unwrap();
    let radii = [0.5, 0.6];
    let studies = radii.map(|r| format!("r{r}.toml"));
    for (study, r) in studies.iter().zip(radii) {
        fs::write(folder.join(study), format!("{STUDY}minor_radius = {r}\n")).unwrap();
    }
    fs::write(folder.join("studies.txt"), studies.join("\n") + "\n").unwrap();
    let stand_in = here.join("tests/sbatch.sh");
    let task = |k: usize| shell(folder, &format!("sh '{}' job.sh {k} 0.2", stand_in.display())).spawn().unwrap();
    let tasks: Vec<Output> = [task(1), task(2)].into_iter().map(|child| child.wait_with_output().unwrap()).collect();
    for (done, r) in tasks.iter().zip(radii) {
        let (said, errors) = (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
        assert_eq!(done.status.code(), Some(0), "{said}{errors}");
        assert!(said.contains("run 1: exit code 130") && said.contains("run 2: exit code "), "{said}{errors}");
        let line = format!("sweep r{r}.toml --out whole-r{r} --threads 1 -q --allow-incomplete");
        let whole = shell(folder, &format!("maille {line}")).output().unwrap();
        assert!(whole.status.success(), "{}", String::from_utf8_lossy(&whole.stderr));
        let expected = rows(&folder.join(format!("whole-r{r}")));
        assert_eq!(expected.len(), 45 * 11);
        assert_eq!(rows(&folder.join(format!("maille-out/r{r}"))), expected);
    }
}
