#include "closed_loop.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <queue>

#include "common/grid/visibility.h"
#include "planner/search/grid_graph.h"

namespace conav::planner::closed_loop {
namespace {

void CarveRooms(OccupancyGrid& maze, Random& random) {
  const int half = (maze.rows() - 1) / 2;
  for (int room = 0; room < 3; ++room) {
    const Cell corner{static_cast<int>(random.Uniform(0, half - 2)) * 2 + 1,
                      static_cast<int>(random.Uniform(0, half - 2)) * 2 + 1};
    for (int i = 0; i < 9; ++i) maze[corner + Cell{i / 3, i % 3}] = Occupancy::kFree;
  }
}

void CarveMaze(OccupancyGrid& maze, Random& random) {
  std::vector<Cell> stack{{1, 1}};
  Grid<std::uint8_t> done(maze.rows(), maze.columns(), 0);
  done[{1, 1}] = 1;
  maze[{1, 1}] = Occupancy::kFree;
  while (!stack.empty()) {
    const Cell cell = stack.back();
    std::vector<Cell> offsets(kNeighbourOffsets.begin(), kNeighbourOffsets.end());
    random.Shuffle(offsets);
    const auto next = std::find_if(offsets.begin(), offsets.end(), [&](Cell offset) {
      const Cell to = cell + offset + offset;
      return maze.Contains(to) && done[to] == 0;
    });
    if (next == offsets.end()) {
      stack.pop_back();
      continue;
    }
    maze[cell + *next] = Occupancy::kFree;
    maze[cell + *next + *next] = Occupancy::kFree;
    done[cell + *next + *next] = 1;
    stack.push_back(cell + *next + *next);
  }
}

void OpenLoops(OccupancyGrid& maze, Random& random) {
  for (int row = 1; row < maze.rows() - 1; ++row) {
    for (int column = 1; column < maze.columns() - 1; ++column) {
      const bool between = (row + column) % 2 == 1;
      if (between && random.Chance(0.08)) maze[{row, column}] = Occupancy::kFree;
    }
  }
}

std::vector<Cell> DrawFreeCells(const OccupancyGrid& maze, int count, Random& random) {
  std::vector<Cell> cells;
  while (static_cast<int>(cells.size()) < count) {
    const Cell cell = maze.CellAt(
        static_cast<std::size_t>(random.Uniform(0, static_cast<std::int64_t>(maze.size()) - 1)));
    const bool taken = std::find(cells.begin(), cells.end(), cell) != cells.end();
    if (maze[cell] == Occupancy::kFree && !taken) cells.push_back(cell);
  }
  return cells;
}

/// Cheapest ways from one cell to all others on the operator's map.
struct Ways {
  Grid<double> cost;
  Grid<Cell> before;

  Ways(const BeliefGrid& belief, Cell from)
      : cost(belief.rows(), belief.columns(), std::numeric_limits<double>::infinity()),
        before(belief.rows(), belief.columns()) {
    using Item = std::pair<double, Cell>;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
    cost[from] = 0.0;
    queue.emplace(0.0, from);
    while (!queue.empty()) {
      const auto [so_far, cell] = queue.top();
      queue.pop();
      if (so_far > cost[cell]) continue;
      for (const Cell offset : kNeighbourOffsets) {
        const Cell to = cell + offset;
        if (!belief.Contains(to) || belief.OnBorder(to)) continue;
        const double next = so_far + (belief[to] > 0.5F ? 11.0 : 1.0);
        if (next >= cost[to]) continue;
        cost[to] = next;
        before[to] = cell;
        queue.emplace(next, to);
      }
    }
  }

  void AppendTo(Cell target, Cell from, std::vector<Cell>& path) const {
    const auto first = static_cast<std::ptrdiff_t>(path.size());
    for (Cell cell = target; cell != from; cell = before[cell]) path.push_back(cell);
    std::reverse(path.begin() + first, path.end());
  }
};

class Episode {
 public:
  Episode(const World& world, const SearchOptions& search, PerceptionModel& model,
          std::uint64_t seed, const EpisodeOptions& options)
      : world_(world),
        options_(options),
        planner_(search, model),
        search_random_(DeriveSeed(seed, 1)),
        human_random_(DeriveSeed(seed, 2)),
        known_(world.truth.rows(), world.truth.columns(), Occupancy::kUnknown),
        belief_(world.belief),
        cell_(world.start),
        goals_(world.goals),
        path_{world.start},
        views_(
            std::make_shared<const GridViews>(GridViews::Options{.headings = options.headings})) {
    Look();
    guidance_ = DrawGuidance(belief_, cell_, goals_, options_.guidance_goals);
  }

  EpisodeResult Run() {
    for (int i = 0; i < options_.action_limit && !goals_.empty(); ++i) Turn();
    result_.all_goals = goals_.empty();
    return result_;
  }

 private:
  void Turn() {
    const auto start = std::chrono::steady_clock::now();
    const GridGraph graph(known_, {}, views_, {});
    const SearchProblem problem{.graph = graph,
                                .start = graph.VertexAt(cell_).value(),
                                .path = path_,
                                .goals_left = goals_,
                                .guidance = guidance_,
                                .guided_before = true,
                                .belief = belief_,
                                .sent_views = SentViewsNow()};
    const SearchResult decided = planner_.Decide(problem, search_random_).value();
    const std::chrono::duration<double, std::milli> duration =
        std::chrono::steady_clock::now() - start;
    result_.decision_ms.push_back(duration.count());
    result_.perception_calls += decided.perception_calls;
    result_.perception_queries += decided.perception_queries;
    ++result_.decisions;
    if (decided.chosen < 0) return;
    const SearchAction& action = decided.actions[static_cast<std::size_t>(decided.chosen)];
    if (action.kind == CommandKind::kMove) {
      Move(action.target);
    } else {
      Send(action.heading_rad);
    }
  }

  void Move(Cell target) {
    if (world_.truth[target] == Occupancy::kOccupied) {
      known_[target] = Occupancy::kOccupied;
      ++result_.blocked;
      return;
    }
    cell_ = target;
    ++result_.moves;
    path_.push_back(cell_);
    result_.trajectory.push_back(cell_);
    std::erase(goals_, cell_);
    Look();
  }

  void Look() {
    const VisibleCells seen = CastRange(world_.truth, cell_, options_.range_cells);
    for (const Cell cell : seen.free) known_[cell] = Occupancy::kFree;
    for (const Cell cell : seen.walls) known_[cell] = Occupancy::kOccupied;
  }

  void Send(double heading_rad) {
    ++result_.messages;
    const VisibleCells view = CastView(world_.truth, {.cell = cell_, .heading_rad = heading_rad});
    for (const Cell cell : view.free) Mend(cell, 0.0F);
    for (const Cell cell : view.walls) Mend(cell, 1.0F);
    for (const Cell cell : path_) {
      if (belief_[cell] != 0.0F && human_random_.Chance(options_.path_edit_probability)) {
        Edit(cell, 0.0F);
      }
    }
    path_ = {cell_};
    guidance_ = DrawGuidance(belief_, cell_, goals_, options_.guidance_goals);
    std::vector<Cell> cells = view.free;
    cells.insert(cells.end(), view.walls.begin(), view.walls.end());
    sent_.push_back({{cell_, heading_rad}, cells, ValuesOf(cells)});
  }

  void Mend(Cell cell, float truth) {
    if (belief_[cell] == truth || belief_.OnBorder(cell)) return;
    const double distance = std::hypot(cell.row - cell_.row, cell.column - cell_.column);
    const double probability =
        options_.edit_probability * std::exp(-options_.edit_decay * distance);
    if (human_random_.Chance(probability)) Edit(cell, truth);
  }

  void Edit(Cell cell, float value) {
    belief_[cell] = value;
    ++result_.edits;
  }

  std::vector<float> ValuesOf(const std::vector<Cell>& cells) const {
    std::vector<float> values;
    for (const Cell cell : cells) values.push_back(belief_[cell]);
    return values;
  }

  std::vector<SentView> SentViewsNow() {
    std::erase_if(sent_, [&](const Sent& sent) { return ValuesOf(sent.cells) != sent.belief; });
    std::vector<SentView> views;
    for (const Sent& sent : sent_) views.push_back(sent.view);
    return views;
  }

  struct Sent {
    SentView view;
    std::vector<Cell> cells;
    std::vector<float> belief;
  };

  const World& world_;
  EpisodeOptions options_;
  IgMcts planner_;
  Random search_random_;
  Random human_random_;
  OccupancyGrid known_;
  BeliefGrid belief_;
  Cell cell_;
  std::vector<Cell> goals_;
  std::vector<Cell> path_;
  std::vector<Cell> guidance_;
  std::vector<Sent> sent_;
  std::shared_ptr<const GridViews> views_;
  EpisodeResult result_;
};

}  // namespace

World MakeWorld(std::uint64_t seed, int size, int wrong_cells) {
  Random random(seed);
  World world;
  world.truth = OccupancyGrid(size, size, Occupancy::kOccupied);
  CarveMaze(world.truth, random);
  CarveRooms(world.truth, random);
  OpenLoops(world.truth, random);
  std::vector<Cell> cells = DrawFreeCells(world.truth, 5, random);
  world.start = cells.back();
  cells.pop_back();
  world.goals = cells;
  world.belief = BeliefGrid(size, size, 0.0F);
  std::vector<Cell> editable;
  for (std::size_t i = 0; i < world.truth.size(); ++i) {
    const Cell cell = world.truth.CellAt(i);
    if (world.truth[cell] == Occupancy::kOccupied) world.belief[cell] = 1.0F;
    const bool fixed = world.truth.OnBorder(cell) || cell == world.start ||
                       std::find(cells.begin(), cells.end(), cell) != cells.end();
    if (!fixed) editable.push_back(cell);
  }
  random.Shuffle(editable);
  editable.resize(static_cast<std::size_t>(wrong_cells));
  for (const Cell cell : editable) world.belief[cell] = 1.0F - world.belief[cell];
  return world;
}

std::vector<Cell> DrawGuidance(const BeliefGrid& belief, Cell from, const std::vector<Cell>& goals,
                               int goal_limit) {
  std::map<Cell, Ways> ways;
  ways.emplace(from, Ways(belief, from));
  for (const Cell goal : goals) ways.emplace(goal, Ways(belief, goal));
  std::vector<Cell> order = goals;
  std::sort(order.begin(), order.end());
  std::vector<Cell> best = order;
  double best_cost = std::numeric_limits<double>::infinity();
  do {
    double cost = 0.0;
    Cell at = from;
    for (const Cell goal : order) {
      cost += ways.at(at).cost[goal];
      at = goal;
    }
    if (cost < best_cost) {
      best_cost = cost;
      best = order;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  std::vector<Cell> path{from};
  Cell at = from;
  for (const Cell goal : best) {
    if (goal_limit-- <= 0) break;
    ways.at(at).AppendTo(goal, at, path);
    at = goal;
  }
  return path;
}

EpisodeResult RunEpisode(const World& world, const SearchOptions& search, PerceptionModel& model,
                         std::uint64_t seed, const EpisodeOptions& options) {
  return Episode(world, search, model, seed, options).Run();
}

}  // namespace conav::planner::closed_loop
