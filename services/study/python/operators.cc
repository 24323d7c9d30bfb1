#include <memory>
#include <variant>

#include "common/msg/planning.h"
#include "operator/simulated/synthetic_operator.h"
#include "study/python/binding.h"

// SIMULATED operators, shown one thing after the other.

namespace conav::python {
namespace {

/// What an operator did.
struct Reaction {
  std::vector<std::pair<Cell, bool>> edits;  // a cell, and whether it is a wall now
  BeliefGrid belief;                         // with them
  std::optional<std::vector<Cell>> path;     // none: no path was drawn
};

/// One SYNTHETIC person with one robot, shown one thing after the other.
class ShownPerson {
 public:
  ShownPerson(const py::dict& parameters, std::uint64_t seed)
      : person_(Configured<operators::SyntheticOperatorParameters>(parameters, "operator"), seed,
                {{"r1", "w1"}}) {}

  Reaction ShowStart(BeliefGrid belief, Cell cell, std::vector<Cell> goals) {
    Show(std::move(belief), cell, std::move(goals));
    return Answers();
  }

  Reaction ShowPicture(BeliefGrid belief, const ShownView& view, std::vector<Cell> path,
                       std::vector<Cell> goals) {
    Show(std::move(belief), view.cell, goals);
    Snapshot snapshot;
    snapshot.stamp = state_.stamp;
    snapshot.world = state_.world;
    snapshot.robot = state_.robot;
    snapshot.sequence_number = ++pictures_;
    snapshot.cell = view.cell;
    snapshot.heading_rad = view.heading_rad;
    snapshot.visible = view.visible;
    snapshot.path = std::move(path);
    snapshot.goals_left = std::move(goals);
    person_.Receive(snapshot, clock_.Now());
    return Answers();
  }

  Reaction ShowBlocked(BeliefGrid belief, Cell cell, Cell wall, std::vector<Cell> goals) {
    Show(std::move(belief), cell, std::move(goals));
    AttentionRequest request;
    request.stamp = state_.stamp;
    request.world = state_.world;
    request.robot = state_.robot;
    request.sequence_number = ++asked_;
    request.reason = AttentionReason::kBlocked;
    request.cell = wall;
    request.newest_snapshot = pictures_;
    person_.Receive(request, clock_.Now());
    return Answers();
  }

 private:
  void Show(BeliefGrid belief, Cell cell, std::vector<Cell> goals) {
    Take(CheckBelief(belief));
    Check(belief.Contains(cell), fmt::format("operator: cell {} is outside of the map", cell));
    for (const Cell goal : goals) {
      Check(belief.Contains(goal), fmt::format("operator: goal {} is outside of the map", goal));
    }
    state_.stamp = state_.stamp + std::chrono::seconds(1);
    state_.world = belief_.world = "w1";
    state_.robot = "r1";
    state_.cell = cell;
    state_.goals_left = std::move(goals);
    belief_.wall_probability = std::move(belief);
    ++belief_.revision;
    person_.Receive(belief_);
    person_.Receive(state_);
  }

  Reaction Answers() {
    Reaction reaction;
    while (const auto ask = person_.Next(clock_.Now())) {
      if (const auto* edit = std::get_if<EditRequest>(&ask->body)) {
        for (const auto& [cell, wall] : edit->edits) {
          belief_.wall_probability[cell] = wall ? 1.0F : 0.0F;
          reaction.edits.emplace_back(cell, wall);
        }
        ++belief_.revision;
        person_.Receive(belief_);
      } else {
        reaction.path = std::get<GuideRequest>(ask->body).path;
      }
      person_.Answered(OperatorReply{.accepted = true, .revision = belief_.revision}, clock_.Now());
    }
    reaction.belief = belief_.wall_probability;
    return reaction;
  }

  FakeClock clock_;  // nobody waits here
  operators::SyntheticOperator person_;
  RobotState state_;
  Belief belief_;
  std::uint64_t pictures_ = 0;
  std::uint64_t asked_ = 0;
};

}  // namespace

void AddOperators(py::module_& module) {
  using Release = py::call_guard<py::gil_scoped_release>;
  py::class_<Reaction>(module, "Reaction")
      .def_readonly("edits", &Reaction::edits)
      .def_readonly("belief", &Reaction::belief)
      .def_readonly("path", &Reaction::path);
  py::class_<ShownPerson>(module, "Operator")
      .def(py::init<const py::dict&, std::uint64_t>(), py::arg("parameters"), py::arg("seed"))
      .def("show_start", &ShownPerson::ShowStart, py::arg("belief"), py::arg("cell"),
           py::arg("goals"), Release())
      .def("show_picture", &ShownPerson::ShowPicture, py::arg("belief"), py::arg("view"),
           py::arg("path"), py::arg("goals"), Release())
      .def("show_blocked", &ShownPerson::ShowBlocked, py::arg("belief"), py::arg("cell"),
           py::arg("wall"), py::arg("goals"), Release());
}

}  // namespace conav::python
