#include <catch2/catch.hpp>

#include "common/cli/cli.h"
#include "common/runtime/file.h"
#include "support/temporary_folder.h"

namespace conav {
namespace {

std::string Refusal(const std::vector<FileOption>& inputs, const std::vector<FileOption>& outputs) {
  const auto checked = CheckDistinct(inputs, outputs);
  return checked ? "" : checked.error().text;
}

TEST_CASE("an output that is an input is refused, however it is written", "[runtime][file]") {
  const test::TemporaryFolder folder;
  const auto file = folder / "a";
  REQUIRE(WriteFile(file, "a"));
  std::filesystem::create_symlink(file, folder / "link");
  std::filesystem::create_hard_link(file, folder / "hard");
  for (const auto& output : {file, folder / "none/../a", folder / "./a", folder / "link",
                             folder / "hard", std::filesystem::relative(file)}) {
    CHECK_THAT(Refusal({{"--data", file}}, {{"--out", output}}),
               Catch::EndsWith(": is the input --data, too"));
  }
  CHECK(Refusal({{"--data", file}}, {{"--out", folder / "b"}}) == "");
}

TEST_CASE("two outputs of one name are refused before they exist", "[runtime][file]") {
  const test::TemporaryFolder folder;
  CHECK_THAT(Refusal({}, {{"--out", folder / "x"}, {"--json", folder / "y/../x"}}),
             Catch::StartsWith("--json ") && Catch::EndsWith(": is the output --out, too"));
}

TEST_CASE("what cannot be lost may come twice", "[runtime][file]") {
  CHECK(Refusal({{"--data", "/dev/null"}}, {{"--out", "/dev/null"}, {"--json", "/dev/null"}}) ==
        "");
  CHECK(Refusal({{"--data", ""}}, {{"--out", "-"}, {"--json", "-"}, {"--csv", ""}}) == "");
}

}  // namespace
}  // namespace conav
