#include "common/cli/cli.h"

#include <catch2/catch.hpp>
#include <cstdint>

#include "common/runtime/file.h"
#include "support/temporary_folder.h"

namespace conav {
namespace {

/// What a user reads who gives `value` to an option that is checked so.
std::string Refusal(const CLI::Validator& check, const std::string& value) {
  CLI::App app;
  std::string taken;
  app.add_option("--option", taken)->check(check);
  try {
    app.parse(std::vector<std::string>{"--option=" + value});
    return "";
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
}

enum class Colour { kRed, kBlue };
constexpr std::array kColours{Colour::kRed, Colour::kBlue};
constexpr std::string_view Name(Colour colour) { return colour == Colour::kRed ? "red" : "blue"; }

TEST_CASE("an option with choices takes their names, and an error lists them", "[console]") {
  CLI::App app;
  Colour colour = Colour::kRed;
  AddChoice(app, "--colour", colour, kColours, "Colour of the robot");
  CHECK_THAT(app.help(), Catch::Contains("Colour of the robot: red, blue"));
  app.parse(std::vector<std::string>{"--colour=blue"});
  CHECK(colour == Colour::kBlue);
  CHECK_THROWS_WITH(app.parse(std::vector<std::string>{"--colour=green"}),
                    Catch::Contains("--colour green") && Catch::Contains("red, blue"));
  CHECK(colour == Colour::kBlue);
}

TEST_CASE("a whole number is refused in words", "[console]") {
  const CLI::Validator check = WholeNumber();
  for (const char* good : {"0", "7", "18446744073709551615"}) CHECK(Refusal(check, good).empty());
  for (const char* wrong : {"-1", "abc", "1.5", "7x", " 7", "18446744073709551616"}) {
    CHECK_THAT(Refusal(check, wrong), Catch::StartsWith("--option: '" + std::string(wrong) + "'"));
  }
}

TEST_CASE("a bounded number is a number between its bounds", "[console]") {
  for (const char* good : {"0", "0.5", "1"}) CHECK(Refusal(Between(0.0, 1.0), good).empty());
  for (const char* wrong : {"nan", "-nan", "NAN(7)", "inf", "-0.1", "1.1", "x"}) {
    CHECK_FALSE(Refusal(Between(0.0, 1.0), wrong).empty());
  }
  CHECK_FALSE(Refusal(Between(1, 9), "10").empty());
}

TEST_CASE("an output that cannot be written is refused, and none is left behind", "[console]") {
  const test::TemporaryFolder folder;
  const CLI::Validator check = WritableFile();
  CHECK(Refusal(check, "-").empty());
  CHECK(check(std::string()).empty());
  CHECK(Refusal(check, (folder / "a.json").string()).empty());
  CHECK(std::filesystem::is_empty(folder.path()));
  const std::string nowhere = (folder / "none/a.json").string();
  for (const std::string& file : {nowhere, folder.path().string()}) {
    CHECK_THAT(Refusal(check, file), Catch::StartsWith("--option: " + file + ": "));
  }
}

TEST_CASE("an unknown subcommand and a missing one give different errors", "[console]") {
  CLI::App app;
  app.add_subcommand("search");
  const auto is_unknown = [&](std::vector<const char*> words) {
    words.insert(words.begin(), "program");
    return NamesUnknownCommand(app, static_cast<int>(words.size()), words.data());
  };
  CHECK(is_unknown({"sweep"}));
  CHECK(is_unknown({"sweep", "search"}));
  CHECK_FALSE(is_unknown({"search", "sweep"}));
  CHECK_FALSE(is_unknown({"--help"}));
  CHECK_FALSE(is_unknown({}));
}

std::string Refusal(const std::vector<FileOption>& inputs, const std::vector<FileOption>& outputs) {
  const auto checked = CheckDistinct(inputs, outputs);
  return checked ? "" : checked.error().text;
}

TEST_CASE("an output that is an input or another output is refused, however it is written",
          "[file]") {
  const test::TemporaryFolder folder;
  const auto file = folder / "a";
  REQUIRE(WriteFile(file, "a"));
  std::filesystem::create_symlink(file, folder / "link");
  std::filesystem::create_hard_link(file, folder / "hard");
  for (const auto& output : {file, folder / "none/../a", folder / "./a", folder / "link",
                             folder / "hard", std::filesystem::relative(file)}) {
    CHECK_THAT(Refusal({{"--data", file}}, {{"--out", output}}),
               Catch::StartsWith("--out ") && Catch::Contains("--data"));
  }
  CHECK_THAT(Refusal({}, {{"--out", folder / "x"}, {"--json", folder / "y/../x"}}),
             Catch::StartsWith("--json ") && Catch::Contains("--out"));
}

TEST_CASE("options that lose nothing may come twice", "[file]") {
  CHECK(Refusal({{"--data", "/dev/null"}}, {{"--out", "/dev/null"}, {"--json", "/dev/null"}}) ==
        "");
  CHECK(Refusal({{"--data", ""}}, {{"--out", "-"}, {"--json", "-"}, {"--csv", ""}}) == "");
}

TEST_CASE("files that cannot be what they are given for are wrong use", "[console]") {
  const test::TemporaryFolder folder;
  const auto code = [&](const std::filesystem::path& output) {
    return CheckFiles("conav test", {{"--data", folder / "data"}}, {{"--json", output}});
  };
  REQUIRE(WriteFile(folder / "data", "kept"));
  CHECK(code("") == 0);
  CHECK(code("-") == 0);
  CHECK(code(folder / "new.json") == 0);
  CHECK(code(folder / "data") == 2);
  CHECK(code(folder / "none/new.json") == 2);
  CHECK(code(folder.path()) == 2);
  for (const char* input : {"none", "."}) {
    CHECK(CheckFiles("conav test", {{"--data", folder / input}}, {}) == 2);
  }
  CHECK(ReadFile(folder / "data").value() == "kept");
}

TEST_CASE("failures end a program with 1, wrong use with 2, on a full disk, too", "[console]") {
  CHECK(ExitCode("conav test", {}) == 0);
  CHECK(ExitCode("conav test", Fail(ErrorCode::kIo, "no")) == 1);
  CHECK(Refused("conav test", "no") == 2);
  const auto written = WriteOutput("/dev/full", "text");
  REQUIRE_FALSE(written);
  CHECK(written.error().code == ErrorCode::kIo);
  CHECK(ExitCode("conav test", written) == 1);
}

}  // namespace
}  // namespace conav
