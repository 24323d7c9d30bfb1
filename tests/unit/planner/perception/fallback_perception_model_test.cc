#include <catch2/catch.hpp>

#include "planner/perception/cached_model.h"

namespace conav::planner {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Answers with one grid per query, or fails as long as `failure` is set.
class ScriptedModel final : public PerceptionModel {
 public:
  ScriptedModel(std::string name, float value) : name_(std::move(name)), value_(value) {}

  Result<std::vector<PerceptionAnswer>> Predict(std::span<const PerceptionQuery> queries) override {
    ++calls;
    if (failure) return tl::unexpected(*failure);
    return std::vector<PerceptionAnswer>(
        queries.size(), PerceptionAnswer{Grid<float>(1, 1, value_), Grid<float>(1, 1)});
  }
  ModelIdentity identity() const override { return {name_, "", ""}; }

  int calls = 0;
  std::optional<Error> failure;

 private:
  std::string name_;
  float value_;
};

struct FallbackBench {
  FakeClock clock;
  std::shared_ptr<ScriptedModel> primary = std::make_shared<ScriptedModel>("remote", 0.25F);
  std::shared_ptr<ScriptedModel> fallback = std::make_shared<ScriptedModel>("glpf", 0.75F);
  std::vector<std::string> switches;
  FallbackPerceptionModel model{
      primary,
      fallback,
      {.first_pause = seconds(1), .longest_pause = seconds(3)},
      clock,
      [this](const std::optional<Error>& why) { switches.push_back(why ? why->text : "back"); }};

  void Fail(ErrorCode code, const std::string& text = "gone") {
    primary->failure = Error{code, text};
  }
  /// The value that came, or -1 for a failure.
  float Ask() {
    const std::vector<PerceptionQuery> queries(1);
    const auto answers = model.Predict(queries);
    return answers ? answers->at(0).add[{0, 0}] : -1.0F;
  }
};

TEST_CASE("The primary answers while it can, then the fallback, and it is said once",
          "[planner][perception]") {
  FallbackBench bench;
  CHECK(bench.Ask() == 0.25F);
  CHECK(bench.model.identity().name == "remote");
  CHECK(bench.fallback->calls == 0);
  CHECK(bench.switches.empty());
  bench.Fail(ErrorCode::kTimeout, "no reply");
  CHECK(bench.Ask() == 0.75F);
  CHECK(bench.Ask() == 0.75F);
  CHECK(bench.model.identity().name == "fallback: glpf");
  CHECK(bench.primary->calls == 1 + 1);
  CHECK(bench.switches == std::vector<std::string>{"no reply"});
}

TEST_CASE("Edits are asked of the same model, as edits", "[planner][perception]") {
  FallbackBench bench;
  const auto belief = std::make_shared<const BeliefGrid>(1, 1);
  const std::vector<ShownView> views(2);
  CHECK(bench.model.PredictEdits(belief, views) == std::vector<double>{0.25, 0.25});
  bench.Fail(ErrorCode::kTimeout);
  CHECK(bench.model.PredictEdits(belief, views) == std::vector<double>{0.75, 0.75});
  CHECK(bench.model.PredictEdits(belief, views) == std::vector<double>{0.75, 0.75});
  CHECK(bench.primary->calls == 1 + 1);
}

TEST_CASE("The pause doubles with each try that fails, up to a limit", "[planner][perception]") {
  FallbackBench bench;
  bench.Fail(ErrorCode::kTimeout);
  bench.Ask();
  int calls = 1;
  for (const auto pause : {seconds(1), seconds(2), seconds(3), seconds(3)}) {
    bench.clock.Advance(pause - milliseconds(1));
    CHECK(bench.Ask() == 0.75F);
    CHECK(bench.primary->calls == calls);
    bench.clock.Advance(milliseconds(1));
    CHECK(bench.Ask() == 0.75F);
    CHECK(bench.primary->calls == ++calls);
  }
  CHECK(bench.switches.size() == 1);
}

TEST_CASE("The primary is taken back when it answers, and then the pause starts again",
          "[planner][perception]") {
  FallbackBench bench;
  bench.Fail(ErrorCode::kTimeout);
  bench.Ask();
  bench.clock.Advance(seconds(1));
  bench.Ask();
  bench.primary->failure.reset();
  bench.clock.Advance(seconds(2));
  CHECK(bench.Ask() == 0.25F);
  CHECK(bench.model.identity().name == "remote");
  bench.Fail(ErrorCode::kTimeout, "gone again");
  CHECK(bench.Ask() == 0.75F);
  bench.primary->failure.reset();
  bench.clock.Advance(seconds(1));
  CHECK(bench.Ask() == 0.25F);
  CHECK(bench.switches == std::vector<std::string>{"gone", "back", "gone again", "back"});
}

TEST_CASE("An impossible query is refused by the primary alone, and says nothing about it",
          "[planner][perception]") {
  FallbackBench bench;
  bench.Fail(ErrorCode::kInvalidArgument, "bad query");
  CHECK(bench.Ask() == -1.0F);
  CHECK(bench.fallback->calls == 0);
  CHECK(bench.switches.empty());
  bench.Fail(ErrorCode::kUnavailable);
  bench.Ask();
  bench.clock.Advance(seconds(1));
  bench.Fail(ErrorCode::kInvalidArgument, "bad query");
  CHECK(bench.Ask() == -1.0F);
  CHECK(bench.model.identity().name == "fallback: glpf");
  CHECK(bench.switches == std::vector<std::string>{"gone"});
  bench.primary->failure.reset();
  CHECK(bench.Ask() == 0.25F);  // the try is still due
}

TEST_CASE("When both fail, the fallback's error is given", "[planner][perception]") {
  FallbackBench bench;
  bench.Fail(ErrorCode::kTimeout);
  bench.fallback->failure = Error{ErrorCode::kInvalidArgument, "bad query"};
  const std::vector<PerceptionQuery> queries(1);
  CHECK(bench.model.Predict(queries).error().code == ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace conav::planner
