#include <catch2/catch.hpp>
#include <map>
#include <nlohmann/json.hpp>

#include "support/program_runner.h"

namespace conav::statistics {
namespace {

TEST_CASE("conav audit paper says which printed statistics follow from the others",
          "[statistics]") {
  const auto json =
      nlohmann::json::parse(test::RunProgram("conav-audit", "paper --json -").out, nullptr, false);
  std::map<std::string, std::pair<std::string, std::string>> found;
  for (const auto& one : json["findings"]) {
    found[one["what"]] = {one["recomputed"], one["consistent"]};
  }
  using Row = std::pair<std::string, std::string>;
  // By hand and with scipy 1.10.1 (f.sf).
  CHECK(found["pupil dilation: p of F(2, 26) = 6.045, as printed"] == Row{"0.0070", "NO"});
  CHECK(found["pupil dilation: p of F(2, 39) = 6.045, of independent groups"] ==
        Row{"0.0052", "yes"});
  CHECK(found["fixation shifts: partial eta^2 of F(2, 26)"] == Row{"0.1921", "yes"});
  CHECK(found["blink rate, teleoperation: d = t / sqrt(14)"] == Row{"-0.9776", "yes"});
  CHECK(found["steps, instruction: size of t that means and SDs allow"] ==
        Row{"0.6117 to 1.124", "NO"});
  CHECK(found["instruction: mean steps of 42 episodes of whole steps"].second == "yes");
  CHECK(json["findings"].size() == 40);
  CHECK(test::RunProgram("conav-audit", "").exit_code == 2);
}

}  // namespace
}  // namespace conav::statistics
