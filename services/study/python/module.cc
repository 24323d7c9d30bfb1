#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/grid/map_accuracy.h"
#include "common/grid/visibility.h"
#include "common/msg/planning.h"
#include "common/runtime/log.h"
#include "nhpm/model/load_model.h"
#include "operator/simulated/path_planner.h"
#include "sim/world/maze_presets.h"
#include "sim/world/world_spec.h"
#include "study/python/binding.h"

// The Python module: worlds, visibility and perception models stand here; decisions in decisions.cc, operators and
// episodes in episodes.cc.

namespace conav::python {
namespace {

/// A map with which robots never leave the grid, and views never end outside of it.
void CheckTruth(const OccupancyGrid& truth) {
  Check(truth.rows() >= 3 && truth.columns() >= 3,
        "world: the map needs at least 3 rows and columns");
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Cell cell = truth.CellAt(i);
    const Occupancy is = truth[cell];
    Check(is != Occupancy::kUnknown, fmt::format("world: cell {} is unknown", cell));
    Check(is == Occupancy::kOccupied || !truth.OnBorder(cell),
          fmt::format("world: cell {} on the border is not a wall", cell));
  }
}

sim::WorldSpec WorldOfMaps(OccupancyGrid truth, OccupancyGrid human_map, std::vector<Cell> starts,
                           std::vector<std::vector<Cell>> goals, double cell_size_m) {
  CheckTruth(truth);
  Check(human_map.rows() == truth.rows() && human_map.columns() == truth.columns(),
        "world: human_map has another size than truth");
  Check(!starts.empty() && starts.size() == goals.size(),
        "world: starts has no robot, or goals another number of them");
  Check(cell_size_m >= 0.1 && cell_size_m <= 100.0,
        "world: cell_size_m is out of range [0.1, 100]");
  for (std::size_t robot = 0; robot < starts.size(); ++robot) {
    const Cell start = starts[robot];
    Check(truth.Contains(start) && truth[start] == Occupancy::kFree,
          fmt::format("world: start {} is not a free cell", start));
    Check(std::count(starts.begin(), starts.end(), start) == 1,
          fmt::format("world: start {} is that of two robots", start));
    const std::set<Cell> reachable = ReachableCells(truth, start);
    Check(!goals[robot].empty(), fmt::format("world: robot {} has no goal", robot));
    for (const Cell goal : goals[robot]) {
      Check(reachable.contains(goal) && goal != start,
            fmt::format("world: no way leads from start {} to goal {}", start, goal));
    }
  }
  sim::WorldSpec world;
  world.truth = std::move(truth);
  world.human_map = std::move(human_map);
  world.starts = std::move(starts);
  world.goals = std::move(goals);
  world.cell_size_m = cell_size_m;
  return world;
}

sim::WorldSpec MakeWorld(const py::kwargs& arguments) {
  sim::WorldOptions options;
  const auto take = [&](const char* name, auto& value) {
    if (!arguments.contains(name)) return;
    value = Argument<std::decay_t<decltype(value)>>(std::string("world: ") + name, arguments[name]);
    arguments.attr("pop")(name);
  };
  const auto take_file = [&](const char* name, std::filesystem::path& value) {
    std::string text = value.string();
    take(name, text);
    value = text;
  };
  take("seed", options.seed);
  take("preset", options.preset);
  take_file("map", options.map_yaml);
  take_file("operator_map", options.operator_map_yaml);
  take("cell_size_m", options.cell_size_m);
  take("robots", options.robots);
  take("goals_per_robot", options.goals_per_robot);
  take("shared_goals", options.shared_goals);
  take("starts", options.starts);
  take("goals", options.goals);
  take("wrong_share", options.wrong_share);
  take("false_wall_share", options.false_wall_share);
  take("rotation_deg", options.rotation_deg);
  for (const auto& [name, value] : arguments) {
    throw PythonError("world: no option is called " + name.cast<std::string>());
  }
  const py::gil_scoped_release release;
  return Take(sim::MakeWorldSpec(options));
}

VisibleCells SeenAround(const OccupancyGrid& truth, Cell cell, double range_cells) {
  CheckTruth(truth);
  Check(truth.Contains(cell), fmt::format("cast_range: cell {} is outside of the map", cell));
  Check(range_cells >= 0.0 && range_cells <= 1000.0,
        "cast_range: range_cells is out of range [0, 1000]");
  return CastRange(truth, cell, range_cells);
}

ShownView SeenThrough(const OccupancyGrid& map, Cell cell, double heading_rad, double cell_size_m,
                      int width, int height) {
  Check(map.Contains(cell), fmt::format("cast_view: cell {} is outside of the map", cell));
  Check(std::isfinite(heading_rad), "cast_view: heading_rad is not a number");
  Check(cell_size_m >= 0.1 && cell_size_m <= 100.0,
        "cast_view: cell_size_m is out of range [0.1, 100]");
  Check(std::min(width, height) >= 1 && std::max(width, height) <= 4096,
        "cast_view: width and height are out of range [1, 4096]");
  return {.cell = cell,
          .heading_rad = heading_rad,
          .visible = CastView(map, ViewAt(cell, heading_rad, cell_size_m, width, height))};
}

std::pair<Grid<float>, Grid<float>> Predict(PerceptionModel& model, BeliefGrid belief,
                                            std::vector<Cell> path, const ShownView& view) {
  const PerceptionQuery query{std::move(belief), std::move(path), view.cell, view.heading_rad,
                              view.visible};
  auto answers = Take(model.Predict({&query, 1}));
  return {std::move(answers.front().add), std::move(answers.front().remove)};
}

std::vector<double> PredictEdits(PerceptionModel& model, BeliefGrid belief,
                                 const std::vector<Cell>& path, std::vector<ShownView> views) {
  for (ShownView& view : views) view.path = path;
  return Take(model.PredictEdits(std::make_shared<const BeliefGrid>(std::move(belief)), views));
}

py::dict IdentityOf(const PerceptionModel& model) {
  const ModelIdentity identity = model.identity();
  py::dict result;
  result["name"] = identity.name;
  result["version"] = identity.version;
  result["checksum"] = identity.checksum;
  return result;
}

/// What pybind's TypeError says, "1. SIGNATURE\n\nInvoked with: VALUES", in one line: arrays have many.
std::string WrongTypes(const std::string& text) {
  const auto signature = text.find(" 1. ");
  const auto values = text.find("\n\nInvoked with: ");
  if (signature == std::string::npos || values == std::string::npos) return text;
  const std::string given = text.substr(values + 16);
  return fmt::format("expected {}, not {}", text.substr(signature + 4, values - signature - 4),
                     given.substr(0, given.find('\n')));
}

}  // namespace

void AddWorlds(py::module_& module) {
  py::class_<sim::WorldSpec>(module, "World")
      .def(py::init(&MakeWorld))
      .def_static("from_maps", &WorldOfMaps, py::arg("truth"), py::arg("human_map"),
                  py::arg("starts"), py::arg("goals"), py::arg("cell_size_m") = 2.0)
      .def_readonly("truth", &sim::WorldSpec::truth)
      .def_readonly("human_map", &sim::WorldSpec::human_map)
      .def_readonly("starts", &sim::WorldSpec::starts)
      .def_readonly("goals", &sim::WorldSpec::goals)
      .def_readonly("shared_goals", &sim::WorldSpec::shared_goals)
      .def_readonly("cell_size_m", &sim::WorldSpec::cell_size_m)
      .def("__repr__", [](const sim::WorldSpec& world) {
        return fmt::format("<World {} x {} cells, {} robots>", world.truth.rows(),
                           world.truth.columns(), world.starts.size());
      });
  module.def("maze_presets", [] {
    std::vector<std::string> names;
    for (const auto& preset : sim::MazePresets()) names.push_back(preset.name);
    return names;
  });
  module.def(
      "mapping_accuracy",
      [](const OccupancyGrid& truth, const OccupancyGrid& initial, const BeliefGrid& belief) {
        for (const auto& [rows, columns] : {std::pair(initial.rows(), initial.columns()),
                                            std::pair(belief.rows(), belief.columns())}) {
          Check(rows == truth.rows() && columns == truth.columns(),
                "mapping_accuracy: the maps have different sizes");
        }
        Take(CheckBelief(belief));
        return CompareMaps(truth, initial, belief).mapping;
      },
      py::arg("truth"), py::arg("initial"), py::arg("belief"));
  py::class_<ShownView>(module, "View")
      .def(py::init(
               [](Cell cell, double heading_rad, std::vector<Cell> free, std::vector<Cell> walls) {
                 Check(std::isfinite(heading_rad), "view: heading_rad is not a number");
                 return ShownView{.cell = cell,
                                  .heading_rad = heading_rad,
                                  .visible = {std::move(free), std::move(walls)}};
               }),
           py::arg("cell"), py::arg("heading_rad"), py::arg("free"), py::arg("walls"))
      .def_readonly("cell", &ShownView::cell)
      .def_readonly("heading_rad", &ShownView::heading_rad)
      .def_property_readonly("free", [](const ShownView& view) { return view.visible.free; })
      .def_property_readonly("walls", [](const ShownView& view) { return view.visible.walls; });
  module.def(
      "cast_range",
      [](const OccupancyGrid& truth, Cell cell, double range_cells) {
        const VisibleCells seen = SeenAround(truth, cell, range_cells);
        return std::pair(seen.free, seen.walls);
      },
      py::arg("truth"), py::arg("cell"), py::arg("range_cells") = 2.0);
  module.def("cast_view", &SeenThrough, py::arg("map"), py::arg("cell"), py::arg("heading_rad"),
             py::arg("cell_size_m") = 2.0, py::arg("width") = 320, py::arg("height") = 192);
}

void AddModels(py::module_& module) {
  using Release = py::call_guard<py::gil_scoped_release>;
  py::class_<PerceptionModel, std::shared_ptr<PerceptionModel>>(module, "Model")
      .def("predict", &Predict, py::arg("belief"), py::arg("path"), py::arg("view"), Release())
      .def("predict_edits", &PredictEdits, py::arg("belief"), py::arg("path"), py::arg("views"),
           Release())
      .def_property_readonly("identity", &IdentityOf);
  module.def(
      "load_model",
      [](const std::string& kind, const std::string& weights, const py::dict& glpf) {
        const auto known = FindNamed(kPerceptionModels, kind);
        Check(known.has_value(), "load_model: no model is called " + kind);
        return Take(nhpm::LoadPerceptionModel(*known, weights,
                                              Configured<nhpm::GlpfParameters>(glpf, "glpf")));
      },
      py::arg("kind"), py::arg("weights"), py::arg("glpf") = py::dict());
}

/// Makes the functions of `owner`, a module or class, refuse arguments of wrong types with conav.Error, where pybind has
/// TypeError.
void RefuseWrongTypes(const py::object& owner) {
  py::options options;
  options.disable_function_signatures();  // that of the function is in its doc
  for (const auto& [key, value] : py::dict(owner.attr("__dict__").attr("copy")())) {
    const bool is_method = PyInstanceMethod_Check(value.ptr());
    const bool is_static = py::isinstance<py::staticmethod>(value);
    if (PyType_Check(value.ptr())) RefuseWrongTypes(py::reinterpret_borrow<py::object>(value));
    if (!is_method && !is_static && !PyCFunction_Check(value.ptr())) continue;
    const auto name = key.cast<std::string>();
    const auto shown = (name == "__init__" ? owner.attr("__name__") : key).cast<std::string>();
    const auto call = [shown, function = py::reinterpret_borrow<py::object>(value)](
                          const py::args& arguments, const py::kwargs& named) -> py::object {
      try {
        return function(*arguments, **named);
      } catch (const py::error_already_set& error) {
        if (!error.matches(PyExc_TypeError)) throw;
        throw PythonError(shown + ": " + WrongTypes(py::str(error.value()).cast<std::string>()));
      }
    };
    const auto doc = py::str(value.attr("__doc__")).cast<std::string>();
    py::object made;
    if (is_method) {
      made = py::cpp_function(call, py::name(shown.c_str()), py::doc(doc.c_str()),
                              py::is_method(owner));
    } else {
      made = py::cpp_function(call, py::name(shown.c_str()), py::doc(doc.c_str()));
    }
    owner.attr(name.c_str()) = is_static ? py::object(py::staticmethod(made)) : made;
  }
}

}  // namespace conav::python

PYBIND11_MODULE(_conav, module) {
  using namespace conav::python;
  conav::log::SetMinimumLevel(conav::log::Level::kError);  // a silent operator is no news here
  py::register_exception<PythonError>(module, "Error", PyExc_ValueError);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const conav::StartupError& error) {
      throw PythonError(error.what());
    }
  });
  AddWorlds(module);
  AddModels(module);
  AddDecisions(module);
  AddOperators(module);
  AddEpisodes(module);
  RefuseWrongTypes(module);
}
