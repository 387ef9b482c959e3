// SPDX-License-Identifier: Apache-2.0
//
// Makes blind trials for a diagnosis: recordings of bearing tests that conceal one physical effect,
// an effect outside the library, or none. Shares no code with the diagnosis.
#include <charconv>
#include <chrono>
#include <fstream>
#include <iostream>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "answer.hpp"
#include "case_folder.hpp"

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kUsage =
    "trial_generator --seed S --cases N --out DIR [options]\n"
    "  --tier A|B|C|D|E  standard, small, noisy, pairs, wrong loop (A)\n"
    "  --only K          make only case K, the same as in the whole set\n"
    "  --truth           also compute information, separations, place and noise floor\n"
    "  --list            list the effect of each case without making it\n"
    "  --effects         list all effects\n"
    "  --motions DIR     ground motions (../shared/data/ground_motions)\n"
    "  --records DIR     used if the former are absent (examples/records)\n"
    "Writes case K to DIR/case_K and its answer to DIR/answers/case_K.json.\n";

struct Options {
  std::uint64_t seed = 1, cases = 0;
  std::optional<std::uint64_t> only;
  trial::Tier tier = trial::Tier::Standard;
  fs::path out, motions = "../shared/data/ground_motions", records = "examples/records";
  trial::TruthDepth depth = trial::TruthDepth::None;
  bool list = false, effects = false;
};

std::uint64_t number_of(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size())
    throw std::invalid_argument(std::string(text) + " is not a whole number");
  return number;
}

bool read_flag(std::string_view name, Options& options) {
  if (name == "--list") return options.list = true;
  if (name == "--effects") return options.effects = true;
  if (name != "--truth") return false;
  options.depth = trial::TruthDepth::Full;
  return true;
}

void read_value(std::string_view name, std::string_view value, Options& options) {
  if (name == "--seed")
    options.seed = number_of(value);
  else if (name == "--cases")
    options.cases = number_of(value);
  else if (name == "--only")
    options.only = number_of(value);
  else if (name == "--tier")
    options.tier = trial::tier_of(value.size() == 1 ? value[0] : ' ');
  else if (name == "--out")
    options.out = value;
  else if (name == "--motions")
    options.motions = value;
  else if (name == "--records")
    options.records = value;
  else
    throw std::invalid_argument("unknown option " + std::string(name));
}

Options read_options(std::span<char* const> arguments) {
  Options options;
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    if (read_flag(arguments[i], options)) continue;
    if (i + 1 == arguments.size())
      throw std::invalid_argument(std::string(arguments[i]) + " needs a value");
    read_value(arguments[i], arguments[i + 1], options);
    ++i;
  }
  if (options.only && *options.only >= options.cases) options.cases = *options.only + 1;
  return options;
}

std::string names_of(const trial::CaseId& id) {
  std::string names;
  for (const trial::Effect* hidden : trial::plan(id))
    names += (names.empty() ? "" : " + ") + std::string(hidden->name);
  return names.empty() ? "none" : names;
}

void list_effects() {
  for (const trial::Effect& effect : trial::effects())
    std::cout << effect.name << '\t' << effect.part << '\t' << effect.channel << '\t'
              << (effect.home == trial::Home::Library ? "library" : "outside") << '\n';
}

void make(const trial::CaseId& id, const std::vector<trial::GroundMotion>& motions,
          const Options& options) {
  const auto begin = std::chrono::steady_clock::now();
  const std::string name = "case_" + std::to_string(id.number);
  const trial::TrialCase made = trial::make_case(id, motions);
  trial::write_case_folder(made, options.out / name);
  fs::create_directories(options.out / "answers");
  std::ofstream file{options.out / "answers" / (name + ".json")};
  file << trial::answer(made, options.depth);
  if (!file.flush()) throw std::runtime_error("cannot write the answer of " + name);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  std::cout << name << '\t' << taken.count() << " s" << std::endl;
}

void run(const Options& options) {
  if (options.effects) return list_effects();
  std::cout << "seed " << options.seed << ", tier " << trial::letter_of(options.tier) << '\n';
  const std::uint64_t first = options.only.value_or(0);
  const std::uint64_t last = options.only ? *options.only + 1 : options.cases;
  if (options.list) {
    for (std::uint64_t k = first; k < last; ++k)
      std::cout << "case_" << k << '\t' << names_of({options.seed, k, options.tier}) << '\n';
    return;
  }
  if (options.out.empty() || last == first) throw std::invalid_argument(std::string(kUsage));
  if (!fs::is_directory(options.motions))
    std::cout << options.motions.string() << " is missing: uses variants of "
              << options.records.string() << " with modulated noise\n";
  const auto motions = trial::read_ground_motions(options.motions, options.records);
  for (std::uint64_t k = first; k < last; ++k)
    make({options.seed, k, options.tier}, motions, options);
}

}  // namespace

int main(int argument_count, char** arguments) {
  try {
    run(read_options({arguments, static_cast<std::size_t>(argument_count)}));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
