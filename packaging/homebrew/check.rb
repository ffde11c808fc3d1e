# Runs a formula without Homebrew, with the few parts of its language that ours uses:
#
#     ruby packaging/homebrew/check.rb FORMULA SOURCE PREFIX
#
# installs from the folder SOURCE, which stands for what the address brings, into PREFIX, and runs the formula's test
# in an empty folder. `brew audit` checks more, and needs Homebrew.
require "fileutils"
require "open3"
require "pathname"
require "tmpdir"

formula, source, prefix = ARGV.map { |path| File.expand_path(path) }
abort "check.rb FORMULA SOURCE PREFIX" unless prefix
PREFIX = prefix

class Pathname
  def install(*files)
    FileUtils.mkdir_p(to_s)
    abort "nothing to install into #{self}" if files.flatten.empty?
    FileUtils.cp_r(files.flatten.map(&:to_s), to_s)
  end
end

class Formula
  FACTS = {}
  TESTS = []

  class << self
    %i[desc homepage url sha256].each { |fact| define_method(fact) { |text| FACTS[fact] = text } }
    def license(any_of:) = FACTS[:license] = any_of
    def depends_on(needed) = FACTS[:needs] = needed
    def test(&steps) = TESTS << steps
  end

  def prefix = Pathname.new(PREFIX)
  def bin = prefix/"bin"
  def man1 = prefix/"share/man/man1"
  def std_cargo_args = ["--locked", "--root", PREFIX, "--path", "."]

  def system(*command)
    Kernel.system(*command.map(&:to_s)) || abort("failed: #{command.join(" ")}")
  end

  def shell_output(command)
    text, status = Open3.capture2(command)
    status.success? ? text : abort("failed: #{command}")
  end

  def generate_completions_from_executable(program, command)
    %w[bash zsh fish].each do |shell|
      text = shell_output("#{program} #{command} #{shell}")
      abort "no completions for #{shell}" if text.empty?
    end
  end

  def assert_match(wanted, text)
    text.include?(wanted) || abort("#{wanted} is not in:\n#{text}")
  end
end

load formula
{ desc: /\A\S.{10,79}\z/, homepage: %r{\Ahttps://}, url: %r{\Ahttps://.*-\d+\.\d+\.\d+\.crate\z}, sha256: /\A\h{64}\z/ }.each do |fact, form|
  abort "#{fact} is #{Formula::FACTS[fact].inspect}" unless form.match?(Formula::FACTS[fact].to_s)
end
maille = Maille.new
Dir.mktmpdir do |work|
  Dir.chdir(source) { maille.install }
  Dir.chdir(work) { Formula::TESTS.each { |steps| maille.instance_eval(&steps) } }
end
puts "#{formula}: installed and tested"
