#pragma once

#include <atomic>
#include <catch2/catch.hpp>
#include <functional>
#include <string_view>
#include <vector>

#include "common/msg/perception_model.h"
#include "planner/search/paper_preset.h"
#include "planner/search/parallel_search.h"

namespace conav::planner {

/// Two ways from the left to the right: the upper one is shorter.
inline const std::vector<std::string_view> kRing{"#######", "#     #", "# ### #", "#     #",
                                                 "#######"};

/// A map from text: '#' wall, '?' unknown, anything else free. Rows of equal length.
inline OccupancyGrid MapFrom(const std::vector<std::string_view>& rows) {
  OccupancyGrid map(static_cast<int>(rows.size()), static_cast<int>(rows.at(0).size()));
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell cell = map.CellAt(i);
    const char mark =
        rows[static_cast<std::size_t>(cell.row)][static_cast<std::size_t>(cell.column)];
    map[cell] = mark == '#'   ? Occupancy::kOccupied
                : mark == '?' ? Occupancy::kUnknown
                              : Occupancy::kFree;
  }
  return map;
}

/// What an operator believes who takes '#' for walls and all else for free.
inline BeliefGrid BeliefFrom(const std::vector<std::string_view>& rows) {
  const OccupancyGrid map = MapFrom(rows);
  BeliefGrid belief(map.rows(), map.columns(), 0.0F);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.values()[i] == Occupancy::kOccupied) belief.values()[i] = 1.0F;
  }
  return belief;
}

/// Cells of `rows` that show `mark`, row by row.
inline std::vector<Cell> CellsMarked(const std::vector<std::string_view>& rows, char mark) {
  std::vector<Cell> cells;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (std::size_t column = 0; column < rows[row].size(); ++column) {
      if (rows[row][column] == mark) {
        cells.push_back({static_cast<int>(row), static_cast<int>(column)});
      }
    }
  }
  return cells;
}

/// For worlds in which only moves are offered.
inline const GridViews::Options kNoViews{.headings = 0};

/// A small world: S start, G goals; the operator believes what the robot knows.
struct TextWorld {
  explicit TextWorld(std::vector<std::string_view> rows, const GridViews::Options& options = {})
      : TextWorld(rows, rows, options) {}
  TextWorld(const std::vector<std::string_view>& rows,
            const std::vector<std::string_view>& believed, const GridViews::Options& options = {})
      : graph(MapFrom(rows), {}, std::make_shared<const GridViews>(options)),
        belief(std::make_shared<const BeliefGrid>(BeliefFrom(believed))),
        problem{.graph = graph,
                .start = graph.VertexAt(CellsMarked(rows, 'S').at(0)).value(),
                .path = {},
                .goals_left = CellsMarked(rows, 'G'),
                .guidance = {},
                .belief = belief,
                .sent_views = {}} {}
  TextWorld(const TextWorld&) = delete;

  VertexId At(int row, int column) const { return graph.VertexAt({row, column}).value(); }
  /// The edge between two neighbouring cells.
  Edge EdgeBetween(Cell from, Cell to) const {
    for (const Edge& edge : graph.EdgesFrom(graph.VertexAt(from).value())) {
      if (graph.CellOf(edge.target) == to) return edge;
    }
    FAIL("no edge");
    return {};
  }

  GridGraph graph;
  SharedBelief belief;
  SearchProblem problem;
};

/// Single expansion, fixed order, the paper's rewards, half as much each step: what can be worked
/// out by hand.
inline SearchOptions ByHand(int iterations) {
  SearchOptions options = PaperOptions();
  options.iterations = iterations;
  options.discount = 0.5;
  return options;
}

/// Answers as the test says, which gets the number of calls so far.
class ScriptedPerception final : public PerceptionModel {
 public:
  using Answers = Result<std::vector<PerceptionAnswer>>;
  using OnQueries = std::function<Answers(int calls, std::span<const PerceptionQuery>)>;

  explicit ScriptedPerception(OnQueries on_queries) : on_queries_(std::move(on_queries)) {}

  Answers Predict(std::span<const PerceptionQuery> queries) override {
    return on_queries_(++calls, queries);
  }
  ModelIdentity identity() const override { return {"scripted", "", ""}; }

  std::atomic<int> calls{0};

 private:
  OnQueries on_queries_;
};

inline SearchResult Decide(const SearchProblem& problem, const SearchOptions& options = {},
                           std::uint64_t seed = 1, std::vector<SearchMemory>* memory = nullptr) {
  FakePerceptionModel model;
  Random random(seed);
  return ParallelSearch(options, model).Decide(problem, random, {}, memory).value();
}

}  // namespace conav::planner
