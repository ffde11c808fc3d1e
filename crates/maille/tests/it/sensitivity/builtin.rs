//! All built-in designs, along three directions and at two l2, every number: the quick ones in each run, all with
//! `cargo nextest run --workspace --test it --run-ignored all -E 'test(sensitivity::builtin)'`.

use super::compare::{Tally, compare};

fn compared(name: &str, changed: usize, no_limit: usize) {
    let mut tally = Tally::default();
    compare(name, &[0.0, 10.0, 33.0], &[0.0, -0.05], &mut tally);
    println!("{name}: {tally:?}");
    assert!(tally.central + tally.sides > 0, "{tally:#?}");
    assert_eq!((tally.wrong, tally.changed, tally.no_limit), (0, changed, no_limit), "{tally:#?}");
}

macro_rules! designs {
    ($($(#[$slow:meta])* $test:ident: $name:literal, $changed:literal other contacts, $no_limit:literal no limit;)*) => {
        $(
            #[test]
            $(#[$slow])*
            fn $test() {
                compared($name, $changed, $no_limit);
            }
        )*

        #[test]
        fn every_builtin_design_is_compared() {
            // A chain has no derivatives across itself, and curves have none.
            let is_sheet = |builtin: &&maille_io::Builtin| {
                let design = maille_io::read_design(builtin.name, builtin.toml).unwrap();
                !design.lattice.single && design.elements.iter().all(|element| element.curves.is_empty())
            };
            let all: Vec<_> =
                maille_io::builtin_designs().iter().filter(is_sheet).map(|builtin| builtin.name).collect();
            assert_eq!(all, [$($name),*]);
        }
    };
}

designs! {
    design_1_1: "1.1", 0 other contacts, 0 no limit;
    design_1_2: "1.2", 0 other contacts, 0 no limit;
    #[ignore = "minutes"]
    design_1_3: "1.3", 0 other contacts, 0 no limit;
    #[ignore = "minutes"]
    design_1_3_small: "1.3-small", 0 other contacts, 0 no limit;
    design_2: "2", 0 other contacts, 0 no limit;
    #[ignore = "minutes"]
    design_2_oblong: "2-oblong", 0 other contacts, 0 no limit;
    design_3_1: "3.1", 0 other contacts, 0 no limit;
    design_3_2: "3.2", 0 other contacts, 0 no limit;
    #[ignore = "minutes"]
    design_3_3: "3.3", 0 other contacts, 0 no limit;
    #[ignore = "minutes"]
    design_3_4: "3.4", 0 other contacts, 0 no limit;
    design_4_1: "4.1", 0 other contacts, 0 no limit;
    #[ignore = "minutes"]
    design_4_2: "4.2", 0 other contacts, 0 no limit;
    #[ignore = "minutes"]
    design_4_3: "4.3", 0 other contacts, 0 no limit;
    #[ignore = "minutes"]
    design_5_1: "5.1", 0 other contacts, 48 no limit;
    #[ignore = "minutes"]
    design_5_2: "5.2", 0 other contacts, 48 no limit;
    #[ignore = "minutes"]
    european_4_in_1: "european-4-in-1", 0 other contacts, 0 no limit;
    #[ignore = "minutes"]
    european_6_in_1: "european-6-in-1", 0 other contacts, 0 no limit;
    japanese_4_in_1: "japanese-4-in-1", 0 other contacts, 0 no limit;
    japanese_6_in_1: "japanese-6-in-1", 0 other contacts, 0 no limit;
    #[ignore = "many minutes"]
    japanese_8_in_2: "japanese-8-in-2", 0 other contacts, 48 no limit;
    #[ignore = "many minutes"]
    japanese_12_in_2: "japanese-12-in-2", 0 other contacts, 48 no limit;
    #[ignore = "minutes"]
    kings_mail: "kings-mail", 0 other contacts, 0 no limit;
    design_1_1_chapter6: "1.1-chapter6", 0 other contacts, 0 no limit;
    design_1_2_chapter6: "1.2-chapter6", 0 other contacts, 0 no limit;
    #[ignore = "minutes"]
    design_2_chapter6: "2-chapter6", 0 other contacts, 0 no limit;
    #[ignore = "minutes"]
    design_3_1_chapter6: "3.1-chapter6", 0 other contacts, 0 no limit;
    design_3_2_chapter6: "3.2-chapter6", 0 other contacts, 0 no limit;
    #[ignore = "minutes"]
    design_3_4_chapter6: "3.4-chapter6", 0 other contacts, 0 no limit;
    design_4_1_chapter6: "4.1-chapter6", 0 other contacts, 0 no limit;
    #[ignore = "minutes"]
    design_4_3_chapter6: "4.3-chapter6", 0 other contacts, 0 no limit;
    #[ignore = "many minutes"]
    design_5_2_chapter6: "5.2-chapter6", 0 other contacts, 48 no limit;
}
