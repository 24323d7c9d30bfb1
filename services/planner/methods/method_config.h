#pragma once

#include <array>
#include <string>
#include <string_view>

#include "common/runtime/config.h"
#include "planner/navigation/region_partition.h"
#include "planner/search/grid_steps.h"
#include "planner/search/paper_preset.h"
#include "planner/search/search_options.h"
#include "planner/search/search_tree.h"

namespace conav::planner {

/// The policies that decide when method ig-mcts sends a picture (docs/tradeoff.md): the search, or,
/// for comparison, a rule; then the search decides the moves only.
inline constexpr std::array kCommunicationPolicies{"search", "never",        "random",
                                                   "every",  "when_blocked", "threshold"};

/// Section `communication` of the planner.
struct CommunicationConfig {
  std::string policy = "search";  // one of kCommunicationPolicies
  double probability = 0.2;       // random: of a picture, per decision
  int every_moves = 5;            // every: a picture is due when so many moves were made since
  double threshold_cells = 1.0;   // threshold: expected edits that make a view worth sending
  /// Expected edits that a radian of turning outweighs when a rule's heading is chosen; 0 = the
  /// most informative view, wherever it looks.
  double turn_cost = 0.0;

  void Visit(ConfigReader& reader) {
    reader.Choice("policy", policy, {kCommunicationPolicies.begin(), kCommunicationPolicies.end()});
    reader.Field("probability", probability, 0.0, 1.0);
    reader.Field("every_moves", every_moves, 1, 1'000'000);
    reader.Field("threshold_cells", threshold_cells, 0.0, 1e6);
    reader.Field("turn_cost", turn_cost, 0.0, 1e6);
  }
};

/// What a robot decides on: the cells of its map, or regions of them (navigation/region_graph.h).
enum class SearchGraph { kCells, kRegions };
inline constexpr std::array kSearchGraphs{SearchGraph::kCells, SearchGraph::kRegions};
constexpr std::string_view Name(SearchGraph graph) {
  return graph == SearchGraph::kCells ? "cells" : "regions";
}

/// Headings that fit the search's actions besides the moves, four between cells; a region hardly has
/// more than twenty neighbours.
inline constexpr int kMostCellHeadings = kMaxActions - 4;
inline constexpr int kMostRegionHeadings = 24;

inline constexpr std::array kSearchPresets{"default",       "paper",    "paper-2000",
                                           "paper-literal", "building", "waterway"};

/// The search of method ig-mcts; greedy takes `graph` and `regions`.
struct SearchConfig {
  /// One of kSearchPresets: "default"; "paper" and "paper-literal" are what the paper prints,
  /// "paper-2000" the same with 2000 iterations instead of 100 (search/paper_preset.h); "building" is
  /// for floors of many rooms (UseBuilding()), "waterway" for open water (UseWaterway()).
  /// Other keys of this section change single values of it.
  std::string preset = "default";
  SearchGraph graph = SearchGraph::kCells;
  /// Of `graph: regions`. Then information is map area: expected edits times the area of a cell in
  /// m2, so that communication_cost and min_information mean the same at any resolution.
  RegionOptions regions;
  /// How far a picture shows the map, in its cells; 0 = as far as nothing is in the way.
  double view_range_cells = 0.0;
  /// Camera headings offered per place; with the moves they must fit the search's 64 actions.
  int headings = 8;
  /// Prior of the operator's measured reliability, in edits of the operator's map
  /// (OperatorReliability); 0 = nothing is measured, pictures are worth what the perception model
  /// says.
  double reliability_prior = 1.0;
  /// Whether an operator's path still guides once the robot knows of a wall on it (the paper has no
  /// rule), also behind the robot. If not, it counts as none until the operator draws another:
  /// otherwise the penalty for being off the path holds the robot to a path that it cannot follow.
  bool blocked_path_guides = false;
  /// Additions to the paper for worlds in which a detour is long: how often a step into what the robot
  /// has not seen counts on the way to a goal if the operator's map has a wall there, and a step off
  /// the operator's path (SearchProblem).
  int believed_wall_steps = 1;
  int off_guidance_steps = 1;
  /// Reward units that a corrected cell of the operator's map is worth (the paper: 1): the dial between
  /// a right map and few pictures. `min_information` and `communication_cost` compare with the product.
  /// 0.5 was chosen in mazes (docs/search.md); buildings, open water and the paper's presets keep 1.
  double mapping_value = 0.5;
  SearchOptions options;

  /// Buildings: ways are the operator's rather than those through what nobody has seen. A wall on the
  /// operator's map counts as much as the simulated operator's doubt of one; the operator's path may be
  /// three times as long as the way that the robot would take.
  void UseBuilding() {
    believed_wall_steps = 10;
    off_guidance_steps = 3;
    mapping_value = kPaperMappingValue;
  }

  /// Open water on pixels of about a metre (paper section 6.3): regions, a range of 50 pixels, a
  /// picture at a fixed cost of 60 (A39), and time instead of iterations.
  void UseWaterway() {
    UseBuilding();
    graph = SearchGraph::kRegions;
    view_range_cells = 50.0;
    options.iterations = 100'000;
    options.time_budget_ms = 500.0;
    options.min_information = 10.0;
    options.reward.communication_cost = 60.0;
    options.reward.communication_guidance = 0.0;
  }

  void Visit(ConfigReader& reader) {
    reader.Choice("preset", preset, {kSearchPresets.begin(), kSearchPresets.end()});
    if (reader.reading()) StartFrom(preset);
    reader.Choice("graph", graph, kSearchGraphs);
    reader.Section("regions", regions);
    reader.Field("view_range_cells", view_range_cells, 0.0, 1e6);
    const bool has_regions = graph == SearchGraph::kRegions;
    reader.Field("headings", headings, 1, has_regions ? kMostRegionHeadings : kMostCellHeadings);
    reader.Field("reliability_prior", reliability_prior, 0.0, 1e6);
    reader.Field("blocked_path_guides", blocked_path_guides);
    reader.Field("believed_wall_steps", believed_wall_steps, 1, kMostStepCount);
    reader.Field("off_guidance_steps", off_guidance_steps, 1, kMostStepCount);
    reader.Field("mapping_value", mapping_value, 0.0, 1e6);
    options.Visit(reader);
    if (has_regions && options.tree_reuse != TreeReuse::kNone) {
      reader.Refuse("tree_reuse",
                    "does not go together with graph = regions: their numbers change");
    }
    if (reader.is_base()) return;
    SearchConfig base;
    base.StartFrom(preset);
    reader.FromPreset(base);
  }

  /// All values are those of `name` from now on, one of kSearchPresets.
  void StartFrom(std::string name) {
    *this = {};
    preset = name;
    if (name == "waterway") return UseWaterway();
    if (name == "building") return UseBuilding();
    if (name == "default") return;
    options = name == "paper-literal" ? LiteralPaperOptions() : PaperOptions();
    if (name == "paper-2000") options.iterations = SearchOptions().iterations;
    reliability_prior = kPaperReliabilityPrior;
    blocked_path_guides = kPaperBlockedPathGuides;
    mapping_value = kPaperMappingValue;
  }
};

/// `name` is a preset, or a YAML file with a map `search: {keys of planner.search}`. Throws
/// StartupError that says which presets there are, or names the file, the key and the limit.
SearchConfig SearchFrom(const std::string& name);

/// How methods ig-mcts and greedy are set up; the others need nothing.
struct MethodConfig {
  SearchConfig search;
  CommunicationConfig communication;
};

}  // namespace conav::planner
