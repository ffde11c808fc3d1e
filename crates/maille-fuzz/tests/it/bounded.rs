//! A bounded run of every target, with inputs that their seeds determine.

use maille_fuzz::{TARGETS, mutate, sound};

#[test]
fn no_input_breaks_a_target() {
    for (target, run) in TARGETS {
        let sound = sound(target);
        let made = ["circles", "pieces"].contains(&target);
        assert!(made || !sound.is_empty(), "{target} has no sound input");
        sound.iter().for_each(|input| run(input));
        let inputs = if made { 200_000 } else { 4_000 };
        (0..inputs).for_each(|seed| run(&mutate::input(target, &sound, seed)));
    }
}
