#include <algorithm>
#include <memory>
#include <thread>

#include "common/msg/planning.h"
#include "launcher/scenario.h"
#include "operator/simulated/synthetic_operator.h"
#include "sim/physics/camera.h"
#include "sim/world/episode.h"
#include "study/experiment/episode.h"
#include "study/experiment/search_experiment.h"
#include "study/python/binding.h"

// Scenarios and episodes of them with SIMULATED operators.

namespace conav::python {
namespace {

using planner::Decision;
using planner::Situation;

/// The scenario called `name` in `file`, with the keys of `changes`.
launcher::Scenario LoadScenario(const std::string& name, const std::string& file,
                                const py::dict& changes) {
  std::string names;
  for (launcher::Scenario& scenario : launcher::ReadScenarios(file)) {
    if (scenario.name == name) return Configured(changes, "scenario", std::move(scenario));
    names += " " + scenario.name;
  }
  throw PythonError(fmt::format("no scenario '{}'; there are{}", name, names));
}

/// The world of `conav experiment`.
sim::WorldSpec WorldOf(const launcher::Scenario& scenario, std::uint64_t seed) {
  sim::WorldOptions options;
  options.seed = seed;
  options.robots = scenario.robots;
  scenario.ApplyTo(options);
  return Take(sim::MakeWorldSpec(options));
}

py::dict ToDict(const planner::EpisodeResult& counts) {
  py::dict result;
  result["all_goals"] = counts.all_goals;
  result["goals_reached"] = counts.goals_reached;
  result["goals"] = counts.goals;
  result["moves"] = counts.moves;
  result["optimal_moves"] = counts.optimal_moves;
  result["blocked"] = counts.blocked;
  result["pictures"] = counts.snapshots;
  result["guidance"] = counts.guidance;
  result["edits"] = counts.edits;
  result["mapping_accuracy"] = counts.mapping_accuracy;
  result["turning_rad"] = counts.turning_rad;
  result["time_s"] = counts.time_s;
  result["low_level_steps"] = planner::EstimatedLowLevelSteps(counts.moves, counts.turning_rad);
  result["trajectory"] = counts.trajectory;
  return result;
}

/// `conav experiment` with one variant: the results by operator, then seed.
std::vector<py::dict> RunExperiment(const launcher::Scenario& scenario, const py::dict& variant,
                                    const std::vector<std::string>& kinds, std::uint64_t first_seed,
                                    int seeds, const std::shared_ptr<PerceptionModel>& model,
                                    int threads) {
  for (const std::string& kind : kinds) {
    Check(std::ranges::count(operators::OperatorKinds(), kind) == 1,
          "no kind of operator is called " + kind);
  }
  Check(!variant.contains("model"), "the model is an argument of its own");
  Check(seeds >= 1 && threads >= 1 && threads <= 256, "seeds or threads is out of range");
  planner::SearchExperiment experiment{
      .scenario = scenario,
      .variants = {Configured<planner::SearchVariant>(variant, "variant")},
      .operators = kinds,
      .seeds = seeds,
      .first_seed = first_seed,
      .threads = threads};
  std::vector<planner::ExperimentEpisode> episodes;
  {
    const py::gil_scoped_release release;
    episodes = Take(planner::RunSearchExperiment(experiment, model));
  }
  std::vector<py::dict> results;
  for (const planner::ExperimentEpisode& episode : episodes) {
    py::dict& result = results.emplace_back(ToDict(episode.result));
    result["operator"] = kinds[episode.person];
    result["seed"] = episode.seed;
  }
  return results;
}

/// The actions of an episode, for each robot: four moves (north, east, south, west), pictures towards kViews headings
/// (0 east, counter-clockwise), and to wait.
constexpr int kViews = 8;
constexpr int kWait = 4 + kViews;

using Plane = Grid<std::uint8_t>;

/// What happened to a robot during a step.
struct Events {
  int goals = 0;
  int moves = 0;
  int pictures = 0;
  int blocked = 0;
};

/// Renders what a robot's camera shows. MuJoCo and EGL start with the first picture.
class Photographer {
 public:
  Photographer(const sim::WorldSpec& spec, sim::CameraOptions options)
      : spec_(spec), options_(options) {}

  /// An OpenGL context belongs to one thread; on another one it is left behind.
  ~Photographer() {
    if (!camera_ || thread_ == std::this_thread::get_id()) return;
    (void)camera_.release();
    (void)physics_.release();
  }

  Photographer(const Photographer&) = delete;
  Photographer& operator=(const Photographer&) = delete;

  sim::RgbImage Render(const planner::CellWorld& cells, int robot) {
    if (!camera_) Open(cells);
    Check(thread_ == std::this_thread::get_id(),
          "pixels: an episode with them belongs to one thread");
    for (int i = 0; i < cells.robot_count(); ++i) {
      const RobotState& state = cells.state(i);
      physics_->Teleport(i, physics_->geometry().CellToPosition(state.cell), state.heading_rad);
    }
    for (std::size_t door = 0; door < spec_.doors.size(); ++door) {
      const Cell cell = spec_.doors[door].cell;
      if (physics_->world().truth[cell] != cells.truth()[cell]) {
        physics_->CloseDoor(static_cast<int>(door));
      }
    }
    HideReachedGoals(cells);
    return camera_->Render(robot);
  }

 private:
  void Open(const planner::CellWorld& cells) {
    std::vector<std::string> robots;
    for (int i = 0; i < cells.robot_count(); ++i) robots.push_back(cells.state(i).robot);
    physics_ = Take(sim::RobotWorld::Create(sim::PhysicsOf(spec_, robots)));
    camera_ = Take(sim::Camera::Open(*physics_, options_));
    thread_ = std::this_thread::get_id();
  }

  void HideReachedGoals(const planner::CellWorld& cells) {
    int goal = 0;  // in the order of PhysicsOf()
    for (int i = 0; i < (spec_.shared_goals ? 1 : cells.robot_count()); ++i) {
      for (const Cell cell : spec_.goals[static_cast<std::size_t>(i)]) {
        bool is_reached = false;
        for (int by = 0; by < cells.robot_count(); ++by) {
          if (!spec_.shared_goals && by != i) continue;
          is_reached = is_reached || Contains(cells.state(by).goals_reached, cell);
        }
        physics_->SetGoalVisible(goal++, !is_reached);
      }
    }
  }

  const sim::WorldSpec& spec_;
  sim::CameraOptions options_;
  std::unique_ptr<sim::RobotWorld> physics_;
  std::unique_ptr<sim::Camera> camera_;
  std::thread::id thread_;
};

/// An episode that Python steps. All robots act, and a step ends when the last of them is done.
class SteppedEpisode {
 public:
  /// Pictures have pixels where a size (height, width) is given.
  SteppedEpisode(const sim::WorldSpec& world, const py::dict& person, std::uint64_t seed,
                 const launcher::Scenario& scenario, bool streams,
                 const std::optional<std::pair<int, int>>& pixels)
      : spec_(world),
        scenario_(scenario),
        cells_(spec_, PersonOf(person), planner::PersonSeed(seed),
               OptionsOf(scenario, spec_, streams)),
        pixels_(world.starts.size()) {
    if (!pixels) return;
    Check(!streams, "pixels: only of pictures that are sent, not with streams");
    const auto [height, width] = *pixels;
    for (const int side : {height, width}) {
      Check(side >= 16 && side <= 4096, fmt::format("pixels: {} is out of range [16, 4096]", side));
    }
    for (sim::RgbImage& image : pixels_) {
      image = {width, height,
               std::vector<std::uint8_t>(static_cast<std::size_t>(3 * width * height))};
    }
    photographer_.emplace(spec_, sim::CameraOptions{width, height});
  }

  std::vector<Events> Step(const std::vector<int>& actions) {
    Check(static_cast<int>(actions.size()) == cells_.robot_count(),
          fmt::format("step: {} actions for {} robots", actions.size(), cells_.robot_count()));
    for (const int action : actions) {
      Check(action >= 0 && action <= kWait,
            fmt::format("step: action {} is out of range [0, {}]", action, kWait));
    }
    std::vector<Events> events(actions.size());
    Count(events, -1);
    for (std::size_t i = 0; i < actions.size(); ++i)
      Begin(static_cast<int>(i), actions[i], events[i]);
    const SimTime later = cells_.now() + std::chrono::hours(1);
    if (!IsAnyBusy()) cells_.Advance(cells_.now() + std::chrono::seconds(1));
    while (IsAnyBusy()) {
      const std::vector<std::uint64_t> before = Pictures();
      cells_.Advance(later);
      TakePixels(before);
    }
    Count(events, 1);
    return events;
  }

  void Ask(int robot, const Decision& decision) {
    CheckRobot(robot);
    Check(decision.attention.has_value(), "ask: the decision does not ask for the operator");
    AttentionRequest request;
    request.stamp = cells_.now();
    request.world = cells_.world_name();
    request.robot = cells_.state(robot).robot;
    request.sequence_number = ++asked_;
    request.reason = *decision.attention;
    request.cell = decision.attention_cell;
    request.newest_snapshot = cells_.state(robot).snapshots;
    cells_.Ask(request);
  }

  /// As RobotWorker::SituationFrom().
  Situation ProblemOf(int robot) const {
    CheckRobot(robot);
    Situation now{.state = cells_.state(robot),
                  .map = cells_.map(robot),
                  .belief = cells_.belief(),
                  .now = cells_.now()};
    const auto& guidance = cells_.guidance(robot);
    if (guidance) now.answered_snapshot = guidance->answers_snapshot;
    now.guided_before = guidance && !guidance->path.empty();
    if (now.guided_before && guidance->valid_until >= now.state.stamp) now.guidance = guidance;
    for (int other = 0; other < cells_.robot_count(); ++other) {
      const RobotState& state = cells_.state(other);
      if (other == robot) continue;
      now.neighbours.push_back({state.robot, state.cell, !state.goals_left.empty(), {}, {}});
    }
    planner::LimitKnowledge(now, scenario_.goal_knowledge);
    return now;
  }

  py::dict Observe(int robot) const {
    CheckRobot(robot);
    const RobotState& state = cells_.state(robot);
    const auto& guidance = cells_.guidance(robot);
    const auto& picture = cells_.picture(robot);
    std::vector<Cell> others;
    for (int other = 0; other < cells_.robot_count(); ++other) {
      if (other != robot) others.push_back(cells_.state(other).cell);
    }
    Plane shown = Mask({});
    if (picture) {
      for (const Cell cell : picture->visible.free) shown[cell] = 1;
      for (const Cell cell : picture->visible.walls) shown[cell] = 2;
    }
    const float row = static_cast<float>(state.cell.row);
    const float column = static_cast<float>(state.cell.column);
    py::array_t<float> pose(3);
    pose.mutable_at(0) = row;
    pose.mutable_at(1) = column;
    pose.mutable_at(2) = static_cast<float>(state.heading_rad);
    py::dict result;
    result["map"] = cells_.map(robot).cells;
    result["belief"] = cells_.belief().wall_probability;
    result["guidance"] = Mask(guidance ? guidance->path : std::vector<Cell>{});
    result["goals"] = Mask(state.goals_left);
    result["path"] = Mask(state.path);
    result["picture"] = shown;
    result["robots"] = Mask(others);
    result["pose"] = pose;
    if (photographer_) {
      const sim::RgbImage& image = pixels_[static_cast<std::size_t>(robot)];
      py::array_t<std::uint8_t> pixels({image.height, image.width, 3});
      std::ranges::copy(image.rgb, pixels.mutable_data());
      result["pixels"] = pixels;
    }
    return result;
  }

  /// 1 where an action may do something: moves but into known walls and other robots, and pictures. Waiting is for
  /// robots that are not alone, and for those that nothing else is left for.
  py::array_t<std::int8_t> ActionMask(int robot) const {
    CheckRobot(robot);
    py::array_t<std::int8_t> mask(kWait + 1);
    const auto set = [&](int action, bool is_legal) {
      mask.mutable_at(action) = is_legal ? std::int8_t{1} : std::int8_t{0};
    };
    for (int action = 0; action < kWait; ++action) set(action, true);
    const Cell here = cells_.state(robot).cell;
    for (int move = 0; move < 4; ++move) {
      const Cell target = here + kNeighbourOffsets[static_cast<std::size_t>(move)];
      bool taken = cells_.map(robot).cells[target] == Occupancy::kOccupied;
      for (int other = 0; other < cells_.robot_count(); ++other) {
        taken = taken || (other != robot && cells_.state(other).cell == target);
      }
      set(move, !taken);
    }
    set(kWait, cells_.robot_count() > 1);
    return mask;
  }

  py::dict Result() const { return ToDict(cells_.Result()); }

  int robots() const { return cells_.robot_count(); }
  bool is_done() const { return cells_.is_done(); }

 private:
  void CheckRobot(int robot) const {
    Check(robot >= 0 && robot < cells_.robot_count(),
          fmt::format("robot {} is out of range [0, {}]", robot, cells_.robot_count() - 1));
  }

  Plane Mask(const std::vector<Cell>& cells) const {
    Plane mask(spec_.truth.rows(), spec_.truth.columns());
    for (const Cell cell : cells) mask[cell] = 1;
    return mask;
  }

  static planner::EpisodeOptions OptionsOf(const launcher::Scenario& scenario,
                                           const sim::WorldSpec& world, bool streams) {
    planner::EpisodeOptions options = planner::OptionsOf(scenario, world);
    options.streams = streams;
    return options;
  }

  std::vector<std::uint64_t> Pictures() const {
    std::vector<std::uint64_t> pictures;
    for (int i = 0; i < cells_.robot_count(); ++i) pictures.push_back(cells_.state(i).snapshots);
    return pictures;
  }

  /// Of the robots that sent a picture since there were `before`.
  void TakePixels(const std::vector<std::uint64_t>& before) {
    if (!photographer_) return;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const int robot = static_cast<int>(i);
      if (cells_.state(robot).snapshots > before[i])
        pixels_[i] = photographer_->Render(cells_, robot);
    }
  }

  bool IsAnyBusy() const {
    for (int i = 0; i < cells_.robot_count(); ++i) {
      if (cells_.is_busy(i)) return true;
    }
    return false;
  }

  void Begin(int robot, int action, Events& events) {
    if (action == kWait) return;
    planner::Action begun{.kind = action < 4 ? CommandKind::kMove : CommandKind::kTransmitView};
    if (action < 4) {
      begun.target = cells_.state(robot).cell + kNeighbourOffsets[static_cast<std::size_t>(action)];
    } else {
      begun.heading_rad = HeadingFromIndex(action - 4, kViews);
    }
    cells_.Begin(robot, begun);
    if (!cells_.is_busy(robot)) ++events.blocked;
  }

  void Count(std::vector<Events>& events, int sign) const {
    for (std::size_t i = 0; i < events.size(); ++i) {
      const RobotState& state = cells_.state(static_cast<int>(i));
      events[i].goals += sign * static_cast<int>(state.goals_reached.size());
      events[i].moves += sign * static_cast<int>(state.cell_moves);
      events[i].pictures += sign * static_cast<int>(state.snapshots);
    }
  }

  operators::SyntheticOperatorParameters PersonOf(const py::dict& parameters) const {
    auto person = Configured<operators::SyntheticOperatorParameters>(parameters, "operator");
    scenario_.ApplyTo(person);
    return person;
  }

  sim::WorldSpec spec_;
  launcher::Scenario scenario_;
  planner::CellWorld cells_;
  std::uint64_t asked_ = 0;
  std::vector<sim::RgbImage> pixels_;  // of each robot's newest picture
  std::optional<Photographer> photographer_;
};

}  // namespace

void AddEpisodes(py::module_& module) {
  using Release = py::call_guard<py::gil_scoped_release>;
  using launcher::Scenario;
  py::class_<Scenario>(module, "Scenario")
      .def(py::init(&LoadScenario), py::arg("name"), py::arg("file"), py::arg("changes"))
      .def_readonly("name", &Scenario::name)
      .def_readonly("about", &Scenario::about)
      .def_readonly("robots", &Scenario::robots)
      .def_readonly("x_source", &Scenario::x_source);
  module.def("scenario_world", &WorldOf, py::arg("scenario"), py::arg("seed"), Release());
  module.def("run_experiment", &RunExperiment, py::arg("scenario"), py::arg("variant"),
             py::arg("operators"), py::arg("first_seed"), py::arg("seeds"), py::arg("model"),
             py::arg("threads"));
  module.def("operator_kinds", &operators::OperatorKinds);
  py::class_<Events>(module, "Events")
      .def_readonly("goals", &Events::goals)
      .def_readonly("moves", &Events::moves)
      .def_readonly("pictures", &Events::pictures)
      .def_readonly("blocked", &Events::blocked);
  py::class_<SteppedEpisode>(module, "Episode")
      .def(py::init<const sim::WorldSpec&, const py::dict&, std::uint64_t,
                    const launcher::Scenario&, bool, const std::optional<std::pair<int, int>>&>(),
           py::arg("world"), py::arg("operator"), py::arg("seed"), py::arg("scenario"),
           py::arg("streams") = false, py::arg("pixels") = py::none())
      .def("step", &SteppedEpisode::Step, py::arg("actions"), Release())
      .def("ask", &SteppedEpisode::Ask, py::arg("robot"), py::arg("decision"), Release())
      .def("problem", &SteppedEpisode::ProblemOf, py::arg("robot") = 0)
      .def("observe", &SteppedEpisode::Observe, py::arg("robot") = 0)
      .def("action_mask", &SteppedEpisode::ActionMask, py::arg("robot") = 0)
      .def("result", &SteppedEpisode::Result)
      .def_property_readonly("robots", &SteppedEpisode::robots)
      .def_property_readonly("is_done", &SteppedEpisode::is_done);
}

}  // namespace conav::python
