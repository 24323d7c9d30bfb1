#include <nlohmann/json.hpp>
#include <string>

#include "support/program_runner.h"

namespace conav::nhpm {
namespace {

/// The programs as a user runs them; each must succeed.
struct Workshop {
  void Run(const std::string& program, const std::string& arguments) const {
    const test::ProgramOutcome outcome = desk.RunOther(program, arguments);
    INFO(program << " " << arguments << "\n" << outcome.text());
    REQUIRE(outcome.exit_code == 0);
  }
  nlohmann::json Json(const std::string& name) const {
    return nlohmann::json::parse(ReadFile(desk / name).value_or(""), nullptr, false);
  }

  test::ProgramRunner desk{"conav-evaluate"};
};

TEST_CASE("people are synthesized, learned from and compared with all models", "[nhpm]") {
  const Workshop workshop;
  workshop.Run("conav-dataset", "synthesize --trajectories 40 --seed 7 --out data.pb.zst");
  workshop.Run("conav-train",
               "--data data.pb.zst --out w.nhpm --width 16 --epochs 8 --json train.json");
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
  // The evaluator and the trainer agree on what the weights are worth.
  const double trained = workshop.Json("train.json")["test_mbce"].get<double>();
  CHECK(loss("nhpm") == Approx(trained).epsilon(1e-4));
}

}  // namespace
}  // namespace conav::nhpm
