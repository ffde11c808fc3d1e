# The program for Homebrew, from its source on crates.io. `cargo xtask recipes` fills in the texts between @.
class Maille < Formula
  desc "How far a chainmail-like weave stretches before it locks, with proofs"
  homepage "@REPOSITORY@"
  url "https://static.crates.io/crates/maille-cli/maille-cli-@VERSION@.crate"
  sha256 "@SHA256_CRATE@"
  license any_of: ["MIT", "Apache-2.0"]

  depends_on "rust" => :build

  def install
    system "cargo", "install", "--features", "view", *std_cargo_args
    generate_completions_from_executable(bin/"maille", "completions")
    system bin/"maille", "man", "manuals"
    man1.install Dir["manuals/*.1"]
  end

  test do
    system bin/"maille", "characterize", "1.1", "--directions", "0", "--l2", "0"
    assert_match "0.44", shell_output("#{bin}/maille table 1.1")
    system bin/"maille", "verify", "maille-out/1.1"
  end
end
