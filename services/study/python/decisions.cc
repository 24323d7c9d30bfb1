#include <cmath>
#include <memory>

#include "common/msg/planning.h"
#include "common/runtime/random.h"
#include "planner/methods/make_method.h"
#include "planner/perception/cached_model.h"
#include "study/python/binding.h"

// One decision of a robot: what it depends on, the methods, and what they answer.

namespace conav::python {
namespace {

using planner::Decision;
using planner::Situation;

/// A method with all that has to outlive it.
class OwnedMethod {
 public:
  OwnedMethod(const std::string& name, const py::dict& search, const py::dict& communication,
              const std::shared_ptr<PerceptionModel>& model, std::uint64_t seed,
              const std::string& x_source)
      : kind_(ParseMethod(name)) {
    Check(kind_ && *kind_ != MethodKind::kTeleop && *kind_ != MethodKind::kMapping,
          "method: expected one of ig-mcts, instruction, greedy, not " + name);
    Check(model != nullptr || *kind_ != MethodKind::kIgMcts, "method: ig-mcts needs a model");
    const auto cached = model ? std::make_shared<planner::CachedPerceptionModel>(model) : nullptr;
    std::shared_ptr<planner::BeliefEstimate> estimate;
    if (cached && x_source != "observed") {
      Check(x_source == "estimated" || x_source == "none",
            "method: x_source is one of observed, estimated, none, not " + x_source);
      estimate = std::make_shared<planner::BeliefEstimate>(cached, x_source == "none");
    }
    const auto options = Configured<planner::SearchConfig>(search, "search");
    if (options.options.time_budget_ms > 0.0) {
      clock_ = std::make_unique<SteadyClock>();
    } else {
      clock_ = std::make_unique<FakeClock>();
    }
    method_ = planner::MakeMethod(
        *kind_, {options, Configured<planner::CommunicationConfig>(communication, "communication")},
        seed, cached, estimate, *clock_);
  }

  /// Without a time budget the method's clock shows the problem's time, so that all is repeatable.
  Decision Decide(const Situation& situation) {
    if (auto* clock = dynamic_cast<FakeClock*>(clock_.get())) {
      const auto since_start = std::chrono::nanoseconds(situation.now.nanoseconds);
      clock->Advance(Clock::TimePoint(since_start) - clock->Now());
    }
    return method_->Decide(situation, StopToken());
  }

 private:
  std::optional<MethodKind> kind_;
  std::unique_ptr<Clock> clock_;
  std::unique_ptr<planner::Method> method_;
};

void CheckInside(const OccupancyGrid& map, const std::vector<Cell>& cells, const char* name) {
  for (const Cell cell : cells) {
    Check(map.Contains(cell), fmt::format("problem: {} cell {} is outside of the map", name, cell));
  }
}

/// As an episode poses it to the method of a robot that is alone.
Situation MakeProblem(OccupancyGrid map, BeliefGrid belief, Cell cell, std::vector<Cell> goals,
                      std::vector<Cell> path, double heading_rad,
                      std::optional<std::vector<Cell>> guidance, std::uint64_t pictures,
                      double cell_size_m) {
  Take(CheckBelief(belief));
  Check(map.rows() == belief.rows() && map.columns() == belief.columns(),
        "problem: map and belief have different sizes");
  Check(cell_size_m >= 0.1 && cell_size_m <= 100.0,
        "problem: cell_size_m is out of range [0.1, 100]");
  Check(std::isfinite(heading_rad), "problem: heading_rad is not a number");
  if (path.empty()) path = {cell};
  CheckInside(map, {cell}, "robot's");
  CheckInside(map, goals, "goal");
  CheckInside(map, path, "path");
  Check(path.back() == cell, "problem: the path does not end in the robot's cell");
  Situation problem;
  RobotState& state = problem.state;
  state.world = "w1";
  state.robot = "r1";
  state.cell = cell;
  state.heading_rad = heading_rad;
  state.goals_total = static_cast<std::uint32_t>(goals.size());
  state.goals_left = std::move(goals);
  state.path = std::move(path);
  state.snapshots = state.images = problem.answered_snapshot = pictures;
  problem.map.cells = std::move(map);
  problem.map.cell_size_m = problem.belief.cell_size_m = cell_size_m;
  problem.belief.world = state.world;
  problem.belief.wall_probability = std::move(belief);
  if (guidance) {
    CheckInside(problem.map.cells, *guidance, "guidance");
    problem.guided_before = true;
    problem.guidance.emplace();
    problem.guidance->world = state.world;
    problem.guidance->robot = state.robot;
    problem.guidance->revision = 1;
    problem.guidance->path = *std::move(guidance);
    problem.guidance->valid_until = SimTime::FromSeconds(1e6);
  }
  return problem;
}

const char* KindOf(const Decision& decision) {
  if (!decision.action) return "wait";
  return decision.action->kind == CommandKind::kMove ? "move" : "picture";
}

py::dict TermsOf(const RewardTerms& terms) {
  py::dict result;
  result["goals"] = terms.goals;
  result["steps"] = terms.steps;
  result["progress"] = terms.progress;
  result["guidance"] = terms.guidance;
  result["smoothness"] = terms.smoothness;
  result["information"] = terms.information;
  result["communication"] = terms.communication;
  return result;
}

void AddProblem(py::module_& module) {
  py::class_<Situation>(module, "Problem")
      .def(py::init(&MakeProblem), py::arg("map"), py::arg("belief"), py::arg("cell"),
           py::arg("goals"), py::arg("path") = std::vector<Cell>(), py::arg("heading_rad") = 0.0,
           py::arg("guidance") = py::none(), py::arg("pictures") = 0, py::arg("cell_size_m") = 2.0)
      .def_property_readonly("map", [](const Situation& now) { return now.map.cells; })
      .def_property_readonly("belief",
                             [](const Situation& now) { return now.belief.wall_probability; })
      .def_property_readonly("cell", [](const Situation& now) { return now.state.cell; })
      .def_property_readonly("heading_rad",
                             [](const Situation& now) { return now.state.heading_rad; })
      .def_property_readonly("goals", [](const Situation& now) { return now.state.goals_left; })
      .def_property_readonly("path", [](const Situation& now) { return now.state.path; })
      .def_property_readonly("pictures", [](const Situation& now) { return now.state.snapshots; })
      .def_property_readonly("guidance", [](const Situation& now) {
        return now.guidance ? std::optional(now.guidance->path) : std::nullopt;
      });
}

}  // namespace

void AddDecisions(py::module_& module) {
  AddProblem(module);
  py::class_<SearchAction>(module, "RootAction")
      .def_property_readonly("kind",
                             [](const SearchAction& action) {
                               return action.kind == CommandKind::kMove ? "move" : "picture";
                             })
      .def_readonly("target", &SearchAction::target)
      .def_readonly("heading_rad", &SearchAction::heading_rad)
      .def_readonly("visits", &SearchAction::visits)
      .def_readonly("mean_value", &SearchAction::mean_value)
      .def_readonly("information_gain", &SearchAction::information_gain)
      .def_readonly("feasibility", &SearchAction::feasibility)
      .def_property_readonly("terms",
                             [](const SearchAction& action) { return TermsOf(action.terms); });
  py::class_<Decision>(module, "Decision")
      .def_property_readonly("kind", &KindOf)
      .def_property_readonly("target",
                             [](const Decision& decision) -> std::optional<Cell> {
                               if (KindOf(decision) != std::string("move")) return std::nullopt;
                               return decision.action->target;
                             })
      .def_property_readonly("heading_rad",
                             [](const Decision& decision) -> std::optional<double> {
                               if (KindOf(decision) != std::string("picture")) return std::nullopt;
                               return decision.action->heading_rad;
                             })
      .def_readonly("plan", &Decision::plan)
      .def_readonly("expected_information", &Decision::expected_information)
      .def_property_readonly(
          "asks", [](const Decision& decision) { return decision.attention.has_value(); })
      .def_property_readonly("actions",
                             [](const Decision& decision) { return decision.report.actions; })
      .def_property_readonly("iterations",
                             [](const Decision& decision) { return decision.report.iterations; })
      .def_property_readonly("nodes",
                             [](const Decision& decision) { return decision.report.nodes; })
      .def_property_readonly("perception_queries", [](const Decision& decision) {
        return decision.report.perception_queries;
      });
  py::class_<OwnedMethod>(module, "Method")
      .def(py::init<const std::string&, const py::dict&, const py::dict&,
                    const std::shared_ptr<PerceptionModel>&, std::uint64_t, const std::string&>(),
           py::arg("name"), py::arg("search"), py::arg("communication"), py::arg("model"),
           py::arg("seed"), py::arg("x_source"))
      .def("decide", &OwnedMethod::Decide, py::arg("problem"),
           py::call_guard<py::gil_scoped_release>());
  module.def("derive_seed", &DeriveSeed, py::arg("seed"), py::arg("purpose"));
}

}  // namespace conav::python
