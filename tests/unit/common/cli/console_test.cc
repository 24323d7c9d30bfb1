#include <catch2/catch.hpp>

#include "common/cli/cli.h"
#include "common/runtime/file.h"
#include "support/temporary_folder.h"

namespace conav {
namespace {

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
  CHECK(ReadFile(folder / "data").value() == "kept");
}

}  // namespace
}  // namespace conav
