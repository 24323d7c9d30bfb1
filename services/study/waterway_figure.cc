#include "study/waterway_figure.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "common/bus/topics.h"
#include "common/bus/type_support.h"
#include "common/msg/convert.h"
#include "common/plot/map_panel.h"
#include "nhpm/model/load_model.h"
#include "operator/recording/mcap_file.h"
#include "planner/config.h"
#include "planner/explain/explanation.h"
#include "planner/navigation/region_drawing.h"
#include "planner/navigation/region_graph.h"

namespace conav::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRobot = "r1";
constexpr const char* kWorld = "w1";

constexpr double kPanelPixels = 480.0;
constexpr double kMargin = 24.0;
constexpr double kTitlePixels = 30.0;

constexpr CellStyles kWater{
    .wall = "fill=\"#8a7f66\"", .free = "fill=\"#d6e8f5\"", .unknown = "fill=\"#ececec\""};
constexpr const char* kGreedyWay =
    "stroke=\"#D55E00\" stroke-width=\"2.5\" stroke-dasharray=\"7 4\" stroke-linejoin=\"round\"";
constexpr const char* kGuidedWay =
    "stroke=\"#0072B2\" stroke-width=\"2.5\" stroke-linejoin=\"round\"";
constexpr const char* kOperatorsPath =
    "stroke=\"#009E73\" stroke-width=\"2\" stroke-dasharray=\"2 4\" stroke-linejoin=\"round\"";
constexpr const char* kFalseLand = "fill=\"#D55E00\"";
constexpr const char* kFalseWater = "fill=\"#0072B2\"";
constexpr const char* kShown = "fill=\"#F0E442\" fill-opacity=\"0.45\"";
constexpr const char* kText = "font-size=\"13\" fill=\"#333333\"";
constexpr const char* kHeading = "font-size=\"16\" fill=\"#000000\"";
constexpr const char* kPlace = "fill=\"#0072B2\" stroke=\"#ffffff\" stroke-width=\"1\"";
constexpr const char* kGoal = "fill=\"#F0E442\" stroke=\"#000000\" stroke-width=\"1\"";
constexpr double kSignPixels = 24.0;  // of a cell as large as the signs

/// What a recording says of the robot and its world.
struct RecordedCrossing {
  std::optional<MapUpdate> truth;
  std::optional<MapUpdate> initial_map;
  std::vector<Position> way;
  std::optional<Position> goal;
  std::vector<Snapshot> snapshots;
};

/// Takes up a serialised message of one topic.
using TakeUp = std::function<void(std::span<const std::uint8_t>)>;

template <class T, class Use>
void On(std::map<std::string, TakeUp>& topics, const bus::Topic<T>& topic, const char* entity,
        Use use) {
  topics[topic.NameFor(entity)] = [use](std::span<const std::uint8_t> data) {
    T message;
    if (!bus::TypeSupportOf<T>().deserialize(data, &message)) return;
    if (auto value = ToDomain(message)) use(*std::move(value));
  };
}

std::map<std::string, TakeUp> TopicsOf(RecordedCrossing& crossing) {
  std::map<std::string, TakeUp> topics;
  On(topics, bus::kTruth, kWorld, [&](MapUpdate map) { crossing.truth = std::move(map); });
  On(topics, bus::kInitialMap, kWorld,
     [&](MapUpdate map) { crossing.initial_map = std::move(map); });
  On(topics, bus::kRobotState, kRobot, [&](const RobotState& state) {
    if (crossing.way.empty() || crossing.way.back() != state.position) {
      crossing.way.push_back(state.position);
    }
  });
  On(topics, bus::kRobotGoals, kRobot, [&](const RobotGoals& goals) {
    if (!goals.left.empty()) crossing.goal = goals.left.front();
  });
  On(topics, bus::kSnapshot, kRobot, [&](Snapshot snapshot) {
    if (!snapshot.streamed) crossing.snapshots.push_back(std::move(snapshot));
  });
  return topics;
}

Result<RecordedCrossing> ReadCrossing(const fs::path& run) {
  const auto file = bag::RecordingOf(run);
  if (!file) return tl::unexpected(file.error());
  auto reader = bag::McapReader::Open(*file);
  if (!reader) return tl::unexpected(reader.error());
  RecordedCrossing crossing;
  const auto topics = TopicsOf(crossing);
  for (;;) {
    const auto next = reader->Next();
    if (!next) return tl::unexpected(next.error());
    if (!*next) break;
    const auto topic = topics.find((*next)->topic->channel.topic);
    if (topic != topics.end()) topic->second((*next)->data);
  }
  if (crossing.truth && crossing.initial_map && crossing.goal && !crossing.way.empty()) {
    return crossing;
  }
  return Fail(ErrorCode::kMalformed,
              fmt::format("{}: holds no waterway that robot {} crossed", file->string(), kRobot));
}

/// The decision whose map the figure shows, and the picture that it sent, if it did.
struct ShownDecision {
  planner::DecisionRecord decision;
  std::optional<Snapshot> snapshot;
};

double ExpectedOf(const planner::DecisionRecord& decision) {
  const SearchAction* taken = planner::TakenAction(decision);
  return taken == nullptr ? 0.0 : taken->information_gain;
}

/// That of the picture that the search expected most of; the last one if none was sent.
Result<ShownDecision> DecisionToShow(const fs::path& run, const RecordedCrossing& crossing) {
  ShownDecision shown;
  const auto take = [&](planner::DecisionRecord&& decision) {
    const auto sent = std::ranges::find_if(crossing.snapshots, [&](const Snapshot& snapshot) {
      return decision.sends_snapshot() && snapshot.stamp >= decision.report.stamp;
    });
    const bool sends = sent != crossing.snapshots.end();
    if (shown.snapshot && (!sends || ExpectedOf(shown.decision) >= ExpectedOf(decision))) return;
    if (sends) shown.snapshot = *sent;
    shown.decision = std::move(decision);
  };
  const auto read = planner::ReadDecisions(run / "decisions.pb.zst", take);
  if (!read) return tl::unexpected(read.error());
  if (shown.decision.map.size() > 0) return shown;
  return Fail(ErrorCode::kMalformed, fmt::format("{}: holds no decision", run.string()));
}

/// One panel of the page, drawn over a map.
class Figure {
 public:
  explicit Figure(const MapUpdate& truth)
      : geometry_(truth.geometry()),
        cell_pixels_(kPanelPixels / std::max(geometry_.rows, geometry_.columns)) {}

  MapPanel Panel(int index, std::string_view title) {
    corner_ = {kMargin + (index % 3) * (kPanelPixels + kMargin),
               kMargin + kTitlePixels + (index / 3) * (kPanelPixels + kMargin + kTitlePixels)};
    canvas_.Text({corner_.x, corner_.y - 9}, title, kHeading);
    return {canvas_, corner_, cell_pixels_};
  }
  PixelPosition At(Position position) const {
    const Position origin = geometry_.origin();
    const double cell = geometry_.cell_size_m;
    return {corner_.x + (position.x_m - origin.x_m) / cell * cell_pixels_,
            corner_.y + (geometry_.rows - (position.y_m - origin.y_m) / cell) * cell_pixels_};
  }
  void DrawWay(const std::vector<Position>& way, const char* style) {
    std::vector<PixelPosition> line;
    for (const Position position : way) line.push_back(At(position));
    canvas_.Polyline(line, style);
  }
  void DrawStart(Position start) { Signs().DrawRing(At(start), 0.3, kPlace); }
  void DrawGoal(Position goal) { Signs().DrawStar(At(goal), kGoal); }
  void DrawHeading(const Snapshot& snapshot) {
    Signs().DrawArrow(At(snapshot.position), snapshot.heading_rad, {}, kPlace);
  }
  void Say(std::string_view text, double below) {
    canvas_.Text({corner_.x, corner_.y + below}, text, kText);
  }
  SvgCanvas& canvas() { return canvas_; }
  PixelPosition corner() const { return corner_; }
  double cell_pixels() const { return cell_pixels_; }
  std::string Document() const {
    return canvas_.Document(kMargin + 3 * (kPanelPixels + kMargin),
                            kMargin + 2 * (kPanelPixels + kMargin + kTitlePixels) + kTitlePixels,
                            "A waterway crossed with an outdated map");
  }

 private:
  MapPanel Signs() { return {canvas_, {}, kSignPixels}; }

  GridGeometry geometry_;
  double cell_pixels_;
  SvgCanvas canvas_;
  PixelPosition corner_;
};

double LengthOf(const std::vector<Position>& way) {
  double length = 0.0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    length += std::hypot(way[i].x_m - way[i - 1].x_m, way[i].y_m - way[i - 1].y_m);
  }
  return length;
}

void DrawTruth(Figure& figure, const RecordedCrossing& greedy, const RecordedCrossing& guided) {
  const MapPanel panel = figure.Panel(
      0, fmt::format("(a) truth; greedy {:.0f} m (dashed), IG-MCTS {:.0f} m, {} pictures",
                     LengthOf(greedy.way), LengthOf(guided.way), guided.snapshots.size()));
  panel.DrawMap(guided.truth->cells, kWater);
  figure.DrawWay(greedy.way, kGreedyWay);
  figure.DrawWay(guided.way, kGuidedWay);
  for (const Snapshot& snapshot : guided.snapshots) figure.DrawHeading(snapshot);
  figure.DrawStart(guided.way.front());
  figure.DrawGoal(*guided.goal);
}

void DrawOperatorsMap(Figure& figure, const RecordedCrossing& guided) {
  const MapPanel panel =
      figure.Panel(1, "(b) operator's first map; orange: false land, blue: false water");
  const OccupancyGrid& map = guided.initial_map->cells;
  const OccupancyGrid& truth = guided.truth->cells;
  panel.DrawMap(map, kWater);
  panel.DrawCells(map.rows(), map.columns(), [&](Cell cell) -> std::string_view {
    if (map[cell] == truth[cell]) return "";
    return map[cell] == Occupancy::kOccupied ? kFalseLand : kFalseWater;
  });
  figure.DrawStart(guided.way.front());
  figure.DrawGoal(*guided.goal);
}

Result<planner::RegionOptions> RegionsOf(const fs::path& run) {
  try {
    planner::PlannerConfig config;
    ReadConfig(LoadParameters(run / "config" / "planner.yaml", "planner"), "planner", config);
    return config.search.regions;
  } catch (const StartupError& error) {
    return Fail(ErrorCode::kMalformed, error.what());
  }
}

void DrawGraph(Figure& figure, const ShownDecision& shown, const planner::RegionGraph& graph) {
  const MapPanel panel =
      figure.Panel(2, fmt::format("(c) robot's map and graph at {:.0f} s; dotted: operator's path",
                                  shown.decision.report.stamp.ToSeconds()));
  panel.DrawMap(shown.decision.map, kWater);
  planner::DrawRegions(graph, figure.corner(), figure.cell_pixels(), figure.canvas());
  panel.DrawPath(shown.decision.guidance, kOperatorsPath);
  if (shown.snapshot) figure.DrawHeading(*shown.snapshot);
}

/// The path as the search sees it: all cells of the regions that it leads through.
std::vector<Cell> SweptBy(const std::vector<Cell>& path, const planner::RegionGraph& graph) {
  std::vector<Cell> swept;
  std::set<planner::VertexId> seen;
  for (const Cell cell : path) {
    const auto vertex = graph.VertexAt(cell);
    if (!vertex) {
      swept.push_back(cell);
    } else if (seen.insert(*vertex).second) {
      swept.insert(swept.end(), graph.CellsOf(*vertex).begin(), graph.CellsOf(*vertex).end());
    }
  }
  return swept;
}

void DrawPicture(Figure& figure, const Snapshot& snapshot) {
  figure.Panel(3, "(d) the picture sent");
  if (snapshot.jpeg.empty()) {
    figure.Say("the simulator ran without a camera", 20);
    return;
  }
  const double height = kPanelPixels * snapshot.height / snapshot.width;
  figure.canvas().Jpeg(figure.corner(), kPanelPixels, height, snapshot.jpeg);
}

Result<void> DrawPrediction(Figure& figure, const planner::DecisionRecord& decision,
                            const Snapshot& snapshot, const planner::RegionGraph& graph,
                            Position goal) {
  const auto model = nhpm::LoadPerceptionModel(PerceptionModelKind::kEncoderDecoder, {}, {});
  if (!model) return tl::unexpected(model.error());
  const PerceptionQuery query{decision.belief, SweptBy(decision.path, graph), snapshot.cell,
                              snapshot.heading_rad, snapshot.visible};
  const auto answers = (*model)->Predict(std::span(&query, 1));
  if (!answers) return tl::unexpected(answers.error());
  const PerceptionAnswer& answer = answers->front();
  const MapPanel panel =
      figure.Panel(4, "(e) predicted edits; orange: becomes land, blue: becomes water");
  panel.DrawMap(decision.belief, kWater);
  const auto shown = [&](const std::vector<Cell>& cells) {
    for (const Cell cell : cells) panel.DrawCell(cell, kShown);
  };
  shown(snapshot.visible.free);
  shown(snapshot.visible.walls);
  constexpr float kLikely = 0.5F;
  panel.DrawCells(decision.belief.rows(), decision.belief.columns(),
                  [&](Cell cell) -> std::string_view {
                    if (answer.add[cell] >= kLikely) return kFalseLand;
                    return answer.remove[cell] >= kLikely ? kFalseWater : "";
                  });
  figure.DrawHeading(snapshot);
  figure.DrawGoal(goal);
  figure.Say(
      fmt::format("{:.0f} cells expected; yellow: shown by the picture", ExpectedOf(decision)),
      kPanelPixels + 18);
  return {};
}

}  // namespace

Result<std::string> WaterwayFigure(const fs::path& greedy, const fs::path& guided) {
  const auto greedy_way = ReadCrossing(greedy);
  if (!greedy_way) return tl::unexpected(greedy_way.error());
  const auto crossing = ReadCrossing(guided);
  if (!crossing) return tl::unexpected(crossing.error());
  const auto shown = DecisionToShow(guided, *crossing);
  if (!shown) return tl::unexpected(shown.error());
  const auto regions = RegionsOf(guided);
  if (!regions) return tl::unexpected(regions.error());
  Figure figure(*crossing->truth);
  DrawTruth(figure, *greedy_way, *crossing);
  DrawOperatorsMap(figure, *crossing);
  planner::RegionGraph graph(*regions,
                             std::make_shared<planner::GridViews>(planner::GridViews::Options{}));
  graph.Update(shown->decision.map);
  DrawGraph(figure, *shown, graph);
  if (!shown->snapshot) {
    figure.Panel(3, "(d), (e): IG-MCTS sent no picture");
    return figure.Document();
  }
  DrawPicture(figure, *shown->snapshot);
  if (auto drawn =
          DrawPrediction(figure, shown->decision, *shown->snapshot, graph, *crossing->goal);
      !drawn) {
    return tl::unexpected(drawn.error());
  }
  return figure.Document();
}

}  // namespace conav::study
