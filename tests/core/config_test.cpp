// SPDX-License-Identifier: Apache-2.0
#include <sys/stat.h>

#include <filesystem>

#include <gtest/gtest.h>

#include <rths/core/config.hpp>
#include <rths/core/text.hpp>

#include "support/files.hpp"

namespace rths {
namespace {

Config parse(const std::string& text) { return Config::parse(text, "lab.toml"); }

TEST(Config, AcceptsAnIntegerAsANumber) { EXPECT_EQ(parse("gain = 2").number("gain"), 2.0); }

TEST(Config, ReportsThePositionOfAValueOfTheWrongType) {
  const Config config = parse("\n  gain = \"two\"");

  EXPECT_EQ(test::error_of([&] { static_cast<void>(config.number("gain")); }),
            "lab.toml:2:10: gain is a string, expected a number");
}

TEST(Config, RefusesNaNAndInfinity) {
  EXPECT_EQ(test::error_of([] { static_cast<void>(parse("gain = nan").number("gain")); }),
            "lab.toml:1:8: gain is nan, expected a finite number");
  EXPECT_EQ(test::error_of([] { static_cast<void>(parse("gain = [1, -inf]").numbers("gain")); }),
            "lab.toml:1:12: gain is -inf, expected a finite number");
}

TEST(Config, RefusesControlCharacters) {
  for (const char* text : {"name = \"a\\u001b[31mb\"", "name = [\"a\\u001b[31mb\"]",
                           "[node.a]\nname = \"a\\u001b[31mb\"", "\"a\\u001b[31mb\" = 1"})
    EXPECT_NE(test::error_of([&] {
                static_cast<void>(parse(text));
              }).find("the text 'a\\x1b[31mb' has control characters, expected printable ones"),
              std::string::npos)
        << text;
  EXPECT_EQ(parse("text = \"two\\nlines\\tand a tab\"").text("text"), "two\nlines\tand a tab");
}

TEST(Config, ReadsRowsOfEqualLength) {
  const auto rows = parse("mass = [[1, 2.5], [3, 4]]").rows("mass");

  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0][1], 2.5);
  EXPECT_EQ(test::error_of([] { static_cast<void>(parse("mass = [[1], [3, 4]]").rows("mass")); }),
            "lab.toml:1:14: mass has a row of 2 numbers, the first has 1");
  EXPECT_EQ(test::error_of([] { static_cast<void>(parse("mass = [1, 2]").rows("mass")); }),
            "lab.toml:1:9: mass is an integer, expected a row of numbers");
}

TEST(Config, NamesAMissingKey) {
  const Config config = parse("gain = 1");

  EXPECT_EQ(test::error_of([&] { static_cast<void>(config.number("stroke_m")); }),
            "lab.toml:1:1: 'stroke_m' is missing");
}

TEST(Config, SuggestsTheKeyForAMisspeltOne) {
  const Config config = parse("stifness_N_per_m = 1");

  EXPECT_EQ(test::error_of([&] { static_cast<void>(config.number("stiffness_N_per_m")); }),
            "lab.toml:1:20: unknown key 'stifness_N_per_m' (did you mean 'stiffness_N_per_m'?)");
}

TEST(Config, RefusesKeysThatNoGetterRead) {
  const Config config = parse("gain = 1\ngian = 2");
  static_cast<void>(config.number("gain"));

  EXPECT_EQ(test::error_of([&] { config.reject_unknown_keys(); }),
            "lab.toml:2:8: unknown key 'gian' (did you mean 'gain'?)");
}

TEST(Config, NamesBothEndsOfARange) {
  const Config config = parse("fraction = 1.5");

  EXPECT_EQ(test::error_of([&] { static_cast<void>(config.number_in("fraction", 0, 1)); }),
            "lab.toml:1:12: fraction is 1.5, expected 0 to 1");
}

TEST(Config, RefusesNaNForANumberInARange) {
  EXPECT_THROW(static_cast<void>(parse("fraction = nan").number_in("fraction", 0, 1)), Error);
}

TEST(Config, FallsBackToDefaults) {
  const Config config = parse("");

  EXPECT_EQ(config.number("a", 1.5), 1.5);
  EXPECT_EQ(config.integer("b", 2), 2);
  EXPECT_EQ(config.text("c", "x"), "x");
  EXPECT_TRUE(config.flag("d", true));
  EXPECT_EQ(config.numbers("e", {1, 2}).size(), 2U);
  EXPECT_TRUE(config.tables("f").empty());
  EXPECT_TRUE(config.table_or_empty("g").keys().empty());
}

TEST(Config, ReadsTablesInOrder) {
  const auto tables = parse("[[block]]\nname = \"b\"\n[[block]]\nname = \"a\"").tables("block");

  ASSERT_EQ(tables.size(), 2U);
  EXPECT_EQ(tables[0].text("name"), "b");
  EXPECT_EQ(tables[1].where(), "lab.toml:3:1");
}

TEST(Config, SetsAnOverrideAtItsDottedPath) {
  Config config = parse("[motion]\nscale = 1.0");
  config.set("motion.scale", "2.5");
  config.set("node.xpc.tune.gain", "3");

  EXPECT_EQ(config.table("motion").number("scale"), 2.5);
  EXPECT_EQ(config.table("node").table("xpc").table("tune").integer("gain"), 3);
}

TEST(Config, ReportsABadOverrideAsAnErrorOfTheCommandLine) {
  Config config = parse("scale = 1.0");
  config.set("scale", "\"big\"");

  EXPECT_EQ(test::error_of([&] { static_cast<void>(config.number("scale")); }),
            "--set scale: scale is a string, expected a number");
  EXPECT_EQ(test::error_of([&] { config.set("scale.x", "1"); }),
            "--set scale.x: 'scale' is a string, expected a table");
}

TEST(Config, ReportsWhyAFileCannotBeRead) {
  EXPECT_EQ(test::error_of([] { static_cast<void>(Config::load("/no/such.toml")); }),
            "/no/such.toml: cannot be read: No such file or directory");
}

TEST(Config, RefusesDirectoriesDevicesAndPipes) {
  const test::TemporaryFolder folder;
  const auto pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);

  EXPECT_EQ(test::error_of([] { static_cast<void>(Config::load("/dev/zero")); }),
            "/dev/zero: cannot be read: it is a device or a pipe, expected a file");
  EXPECT_EQ(test::error_of([&] { static_cast<void>(Config::load(pipe)); }),
            pipe.string() + ": cannot be read: it is a device or a pipe, expected a file");
  EXPECT_EQ(test::error_of([&] { static_cast<void>(Config::load(folder.path())); }),
            folder.path().string() + ": cannot be read: it is a directory");
}

TEST(Config, RefusesAFileThatIsTooLarge) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("large.toml", "a = 1");
  std::filesystem::resize_file(file, std::uint64_t{1} << 40U);

  EXPECT_EQ(
      test::error_of([&] { static_cast<void>(Config::load(file)); }),
      file.string() + ": cannot be read: it has 1099511627776 bytes, expected at most 4194304");
}

// Each would overflow the stack of the parser or of a destructor.
TEST(Config, RefusesKeysAndValuesThatAreNestedTooDeeply) {
  std::string key = "a";
  for (int i = 0; i < 100'000; ++i) key += i % 2 == 0 ? ".a" : " . \"a\"";
  const std::string brackets(100'000, '[');
  for (const auto& text : {key + " = 1", "[" + key + "]", "x = {" + key + " = 1}",
                           "[[" + key + "]]", "x = " + brackets})
    EXPECT_EQ(test::error_of([&] { static_cast<void>(parse("b = 1\n" + text)); }),
              "lab.toml:2: a key or value is nested too deeply, expected at most 32 levels");
  Config config;
  EXPECT_EQ(test::error_of([&] { config.set(key, "1"); }), "--set: a key has more than 32 parts");
}

TEST(Config, AcceptsDotsAndBracketsInTextAndNumbers) {
  const std::string dots(1000, '.');
  const std::string brackets(1000, '[');
  std::string numbers = "1.5";
  for (int i = 0; i < 1000; ++i) numbers += ", 1.5";

  const Config config = parse("a = [" + numbers + "]\nb = \"\\\"" + dots + brackets + "\"  # " +
                              dots + brackets + "\nc = \"\"\"" + dots + "\n\"" + brackets +
                              "\"\"\"\nd = '" + dots + "'\ne.f.g = [[1]]");

  EXPECT_EQ(config.numbers("a").size(), 1001U);
  EXPECT_EQ(config.text("b"), "\"" + dots + brackets);
  EXPECT_EQ(config.text("c"), dots + "\n\"" + brackets);
  EXPECT_EQ(config.table("e").table("f").rows("g").size(), 1U);
}

TEST(Config, ReadsAnEmptyFile) {
  const test::TemporaryFolder folder;

  EXPECT_TRUE(Config::load(folder.write("empty.toml", "")).keys().empty());
}

TEST(Config, ResolvesPathsRelativeToTheFile) {
  const test::TemporaryFolder folder;
  const Config config = Config::load(folder.write("lab.toml", ""));

  EXPECT_EQ(config.resolve("a/b.csv"), folder.path() / "a/b.csv");
  EXPECT_EQ(config.resolve("/a/b.csv"), "/a/b.csv");
}

TEST(Config, AddsThePositionOfTheKeyToAnErrorWithoutOne) {
  const Config config = parse("cutoff_Hz = 900");

  EXPECT_EQ(
      test::error_of([&] {
        static_cast<void>(config.placed("cutoff_Hz", []() -> int { throw Error{"too high"}; }));
      }),
      "lab.toml:1:13: too high");
}

TEST(Nearest, FindsAWordOfSimilarSpellingOnly) {
  EXPECT_EQ(nearest("lenght", {"length", "width"}), "length");
  EXPECT_EQ(nearest("temperature", {"length", "width"}), std::nullopt);
}

TEST(DidYouMean, SuggestsAWordOfSimilarSpellingOnly) {
  EXPECT_EQ(did_you_mean("lenght", {"length", "width"}), " (did you mean 'length'?)");
  EXPECT_EQ(did_you_mean("temperature", {"length", "width"}), "");
}

TEST(Config, MergesChangesIntoATableKeyByKey) {
  const Config base = parse("[slider]\nfriction = 0.1\nstiffness = 2\n[spring]\nstiffness = 3");
  const Config changes = Config::parse("[slider]\nfriction = \"none\"\n[stop]\ngap = 4", "c.toml");

  const Config both = base.overlaid(changes);

  EXPECT_EQ(both.table("slider").number("stiffness"), 2);
  EXPECT_EQ(both.table("slider").text("friction"), "none");
  EXPECT_EQ(both.table("slider").where("friction"), "c.toml:2:12");
  EXPECT_EQ(both.table("spring").number("stiffness"), 3);
  EXPECT_EQ(both.table("stop").number("gap"), 4);
  EXPECT_FALSE(base.has("stop"));
}

TEST(Config, WritesTomlThatReadsBackTheSame) {
  Config config = parse(
      "title = \"a \\\"b\\\"\"\ncount = 3\nwhole = 2.0\nsmall = 1e-7\non = true\n"
      "pair = [5100, 8600.5]\n[a.\"b c\"]\nx = 1\n[[row]]\ny = 2\n[[row]]\ny = 3");
  config.set("slider", parse("friction = 0.1"));

  config.put("dotted.key", 0.1 + 0.2);
  config.put("list", std::vector<std::string>{"tab\t", "back\\slash"});

  const Config again = Config::parse(config.to_toml(), "again.toml");

  EXPECT_EQ(again.number("dotted.key"), 0.1 + 0.2);
  EXPECT_EQ(again.texts("list"), (std::vector<std::string>{"tab\t", "back\\slash"}));
  EXPECT_EQ(again.text("title"), "a \"b\"");
  EXPECT_EQ(again.integer("count"), 3);
  EXPECT_EQ(test::error_of([&] { static_cast<void>(again.integer("whole")); }).empty(), false);
  EXPECT_EQ(again.number("small"), 1e-7);
  EXPECT_TRUE(again.flag("on", false));
  EXPECT_EQ(again.numbers("pair"), (std::vector<double>{5100, 8600.5}));
  EXPECT_EQ(again.table("a").table("b c").number("x"), 1);
  EXPECT_EQ(again.tables("row")[1].number("y"), 3);
  EXPECT_EQ(again.table("slider").number("friction"), 0.1);
}

TEST(Config, WritesShortNumbersInTheirTables) {
  const Config config = parse("b = 4000.15\n[t]\n[[t.row]]\nx = [1, 2.5]\n[t.row.in]\ny = 1e20");

  EXPECT_EQ(config.to_toml(),
            "b = 4000.15\n\n[t]\n\n[[t.row]]\nx = [1, 2.5]\n\n[t.row.in]\ny = 1e+20\n");
}

TEST(Config, LimitsTheSizesOfItsNumbers) {
  const auto error = [](const std::string& text) {
    return test::error_of([&] { parse(text).limit_sizes(1e-9, 1e9); });
  };
  EXPECT_EQ(error("a = 0.0\nb = [-1e9, 1e-9]\nc = inf\nd = 10_000_000_000"), "");
  EXPECT_EQ(error("[t]\nb = [1, -1e10]"),
            "lab.toml:2:9: b is -10000000000, expected 0 or a size from 1e-09 to 1000000000");
  EXPECT_EQ(error("[[t]]\nb = 1e-10"),
            "lab.toml:2:5: b is 1e-10, expected 0 or a size from 1e-09 to 1000000000");
}

TEST(Config, FindsTheFilesThatItsTextsName) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a", "b", "c"}) folder.write(name, "");
  const auto file = folder.write("x.toml",
                                 "k = \"a\"\nn = 1\nlost = \"none\"\nd = \".\"\n"
                                 "[t]\nl = [\"b\"]\n[[u]]\nv = \"c\"\n");

  EXPECT_EQ(Config::load(file).named_files(),
            (std::vector{folder.path() / "a", folder.path() / "b", folder.path() / "c"}));
}

TEST(Config, StartsPathsInAnotherFolder) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("a.toml", "folder = \"../b\"\nfile = \"x\"\n");

  const Config config = Config::load(file).in_its_folder();

  EXPECT_EQ(std::filesystem::weakly_canonical(config.resolve(config.text("file"))),
            std::filesystem::weakly_canonical(folder.path().parent_path() / "b/x"));
  config.reject_unknown_keys();
}

TEST(TomlList, ReadsBackTheSame) {
  const std::vector<std::string> texts{"a", "with \"quotes\" and \\", "line\nbreak", "é"};
  Config table;
  table.set("texts", toml_list(texts));

  EXPECT_EQ(table.texts("texts"), texts);
  EXPECT_EQ(toml_list({}), "[]");
}

TEST(KeyValue, EndsTheKeyAtTheFirstEqualsSign) {
  EXPECT_EQ(key_value("a.b=c=d"), (KeyValue{"a.b", "c=d"}));
  EXPECT_EQ(key_value("a="), (KeyValue{"a", ""}));
  EXPECT_EQ(key_value("=c"), std::nullopt);
  EXPECT_EQ(key_value("a"), std::nullopt);
}

}  // namespace
}  // namespace rths
