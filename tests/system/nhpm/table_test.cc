#include <nlohmann/json.hpp>
#include <string>

#include "support/program_runner.h"

namespace conav::nhpm {
namespace {

/// Segments of synthetic people, weights that learned from them, and table 1, made by the programs
/// as a user runs them.
class Workshop {
 public:
  Workshop() {
    Run("conav-dataset", "synthesize --trajectories 40 --seed 7 --out data.pb.zst");
    Run("conav-train", "--data data.pb.zst --out w.nhpm --width 16 --epochs 8 --json train.json");
  }

  /// It must succeed.
  void Run(const std::string& program, const std::string& arguments) const {
    const test::ProgramOutcome outcome = desk_.RunOther(program, arguments);
    INFO(program << " " << arguments << "\n" << outcome.text());
    REQUIRE(outcome.exit_code == 0);
  }
  nlohmann::json Json(const std::string& name) const {
    return nlohmann::json::parse(ReadFile(desk_ / name).value_or(""), nullptr, false);
  }

 private:
  test::ProgramRunner desk_{"conav-evaluate"};
};

TEST_CASE("people are synthesized, learned from and compared with all models", "[nhpm]") {
  const Workshop workshop;
  workshop.Run(
      "conav-evaluate",
      "--data data.pb.zst --weights w.nhpm --oracle-draws 2000 --without tau --json table.json");
  const auto table = workshop.Json("table.json");
  CHECK(table["data"]["origin"] == "synthetic");
  CHECK(table["data"]["train"]["trajectories"] == 38);
  CHECK(table["data"]["test"]["trajectories"] == 2);
  const auto loss = [&](const char* model) {
    return table["models"][model]["mbce_all"].get<double>();
  };
  CHECK(loss("oracle") < loss("glpf_test"));
  CHECK(loss("glpf_test") <= loss("glpf_train"));
  CHECK(loss("nhpm") < loss("nhpm_without_tau"));
  CHECK(table["bars"]["excess_share"]["limit"] == 0.2);

  SECTION("the evaluator and the trainer agree on what the weights are worth") {
    const double trained = workshop.Json("train.json")["test_mbce"].get<double>();
    CHECK(loss("nhpm") == Approx(trained).epsilon(1e-4));
  }
  SECTION("the test part in a file of its own gives the same figures") {
    workshop.Run("conav-dataset", "split data.pb.zst --out-prefix part");
    workshop.Run("conav-evaluate",
                 "--data part-test.pb.zst --all-test --weights w.nhpm --oracle-draws 2000 "
                 "--json part.json");
    const auto part = workshop.Json("part.json")["models"];
    for (const char* model : {"nhpm", "glpf_test", "oracle"}) {
      CHECK(part[model]["mbce_all"] == table["models"][model]["mbce_all"]);
      CHECK(part[model]["iou_best"] == table["models"][model]["iou_best"]);
    }
  }
}

}  // namespace
}  // namespace conav::nhpm
