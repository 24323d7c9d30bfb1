#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <sstream>

#include "common/grid/map_accuracy.h"
#include "common/plot/map_panel.h"
#include "planner/explain/decision_text.h"
#include "planner/explain/explanation.h"

namespace conav::planner {
namespace {

using Tree = std::vector<ReportedNode>;

std::size_t Index(int number) { return static_cast<std::size_t>(number); }

std::vector<int> Depths(const Tree& tree) {
  std::vector<int> depths(tree.size(), 0);
  for (std::size_t i = 1; i < tree.size(); ++i) depths[i] = depths[Index(tree[i].parent)] + 1;
  return depths;
}

SearchAction ActionOf(const ReportedNode& node) {
  return {.kind = node.kind, .target = node.target, .heading_rad = node.heading_rad};
}

/// Nodes to draw, ascending. A parent has at least as many visits as its children and comes first.
std::vector<std::size_t> Chosen(const Tree& tree, const std::vector<int>& depths, std::size_t limit,
                                int depth) {
  std::vector<std::size_t> nodes;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (depths[i] <= depth) nodes.push_back(i);
  }
  std::stable_sort(nodes.begin(), nodes.end(),
                   [&](std::size_t a, std::size_t b) { return tree[a].visits > tree[b].visits; });
  if (nodes.size() > limit) nodes.resize(limit);
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

class Layout {
 public:
  Layout(const DecisionRecord& decision, std::size_t limit, int depth)
      : tree_(decision.report.tree), depths_(Depths(tree_)) {
    for (const std::size_t node : Chosen(tree_, depths_, limit, depth)) Add(node);
    MarkLine(decision.taken);
    if (!layout_.nodes.empty()) Place(0);
  }

  TreeLayout Take() { return std::move(layout_); }

 private:
  void Add(std::size_t node) {
    const auto at = [&](const PlacedNode& placed) {
      return static_cast<int>(placed.node) == tree_[node].parent;
    };
    const auto parent = std::find_if(layout_.nodes.begin(), layout_.nodes.end(), at);
    const int index =
        parent == layout_.nodes.end() ? -1 : static_cast<int>(parent - layout_.nodes.begin());
    layout_.nodes.push_back({.node = node, .parent = index, .depth = depths_[node]});
    layout_.depth = std::max(layout_.depth, depths_[node]);
  }

  std::vector<std::size_t> ChildrenOf(std::size_t placed) const {
    std::vector<std::size_t> children;
    for (std::size_t i = placed + 1; i < layout_.nodes.size(); ++i) {
      if (layout_.nodes[i].parent == static_cast<int>(placed)) children.push_back(i);
    }
    std::stable_sort(children.begin(), children.end(),
                     [&](std::size_t a, std::size_t b) { return Visits(a) > Visits(b); });
    return children;
  }

  std::uint32_t Visits(std::size_t placed) const {
    return tree_[layout_.nodes[placed].node].visits;
  }

  void MarkLine(const SearchAction& taken) {
    if (layout_.nodes.empty()) return;
    layout_.nodes[0].on_line = true;
    std::size_t node = 0;
    for (const std::size_t child : ChildrenOf(0)) {
      if (IsSameCommand(ActionOf(tree_[layout_.nodes[child].node]), taken)) node = child;
    }
    while (node != 0) {
      layout_.nodes[node].on_line = true;
      const auto children = ChildrenOf(node);
      node = children.empty() ? 0 : children.front();
    }
  }

  void Place(std::size_t placed) {
    const auto children = ChildrenOf(placed);
    if (children.empty()) {
      layout_.nodes[placed].row = layout_.rows++;
      return;
    }
    for (const std::size_t child : children) Place(child);
    layout_.nodes[placed].row =
        std::midpoint(layout_.nodes[children.front()].row, layout_.nodes[children.back()].row);
  }

  const Tree& tree_;
  std::vector<int> depths_;
  TreeLayout layout_;
};

}  // namespace

TreeLayout LayOut(const DecisionRecord& decision, std::size_t limit, int depth) {
  return Layout(decision, limit, depth).Take();
}

namespace {

constexpr double kMargin = 24.0;
constexpr double kTop = 64.0;
constexpr double kMapPixels = 468.0;  // of the longer side
constexpr double kLegendRow = 20.0;
constexpr double kLegendWidth = 300.0;
constexpr double kSentenceRow = 18.0;
constexpr double kCharacterWidth = 7.5;  // of kText, rather too wide
constexpr double kTreeStep = 164.0;
constexpr double kTreeRow = 22.0;
constexpr std::size_t kDrawnNodes = 48;
constexpr int kDrawnDepth = 6;
constexpr double kLeastShown = 0.02;  // of the largest information gain

// Okabe and Ito's palette: distinct with every common colour blindness.
constexpr const char* kText = "font-size=\"13\" fill=\"#000000\"";
constexpr const char* kSmall = "font-size=\"11\" fill=\"#333333\"";
constexpr const char* kGuidance =
    "stroke=\"#009E73\" stroke-width=\"3\" stroke-dasharray=\"6 4\" stroke-linejoin=\"round\"";
constexpr const char* kPath = "stroke=\"#777777\" stroke-width=\"2\" stroke-linejoin=\"round\"";
constexpr const char* kPlan = "stroke=\"#D55E00\" stroke-width=\"3\" stroke-linejoin=\"round\"";
constexpr const char* kView = "fill=\"#0072B2\" fill-opacity=\"0.8\"";
constexpr const char* kTaken = "fill=\"none\" stroke=\"#D55E00\" stroke-width=\"2\"";
constexpr const char* kRobot = "fill=\"#ffffff\" stroke=\"#000000\" stroke-width=\"2.5\"";
constexpr const char* kGoal = "fill=\"#F0E442\" stroke=\"#000000\" stroke-width=\"1\"";
constexpr const char* kFalseWall = "stroke=\"#CC79A7\" stroke-width=\"2\"";
constexpr const char* kMissingWall = "stroke=\"#CC79A7\" stroke-width=\"2\" fill=\"none\"";

// --- the map -----------------------------------------------------------------------------------

/// Where the operator's map, if it was received, contradicts what the robot knows.
void DrawMistakes(const MapPanel& panel, const DecisionRecord& decision) {
  if (decision.belief.size() == 0) return;
  for (std::size_t i = 0; i < decision.map.size(); ++i) {
    const Occupancy known = decision.map.values()[i];
    if (known == Occupancy::kUnknown) continue;
    const bool believed = decision.belief.values()[i] >= kWallThreshold;
    if (believed == (known == Occupancy::kOccupied)) continue;
    const PixelPosition middle = panel.Middle(decision.map.CellAt(i));
    if (believed) {
      panel.DrawCross(middle, 0.36, kFalseWall);
    } else {
      panel.DrawRing(middle, 0.36, kMissingWall);
    }
  }
}

double MostInformation(const std::vector<ReportedView>& views) {
  double most = 0.0;
  for (const ReportedView& view : views) most = std::max(most, view.information_gain);
  return most;
}

/// The longest leads to the edge of its cell.
ArrowShape ViewShape(double share) {
  return {.length = 0.5 * share, .half_width = 0.03 + 0.05 * share};
}

/// Numbers of rows and columns next to the map.
void DrawScales(SvgCanvas& canvas, const MapPanel& panel, const OccupancyGrid& map) {
  constexpr const char* kStyle = "font-size=\"8\" text-anchor=\"middle\" fill=\"#666666\"";
  const double cell = panel.Middle({0, 1}).x - panel.Middle({0, 0}).x;
  for (int row = 0; row < map.rows(); ++row) {
    const PixelPosition at = panel.Middle({row, 0});
    canvas.Text({at.x - 0.5 * cell - 7, at.y + 3}, std::to_string(row), kStyle);
  }
  for (int column = 0; column < map.columns(); ++column) {
    const PixelPosition at = panel.Middle({map.rows() - 1, column});
    canvas.Text({at.x, at.y + 0.5 * cell + 9}, std::to_string(column), kStyle);
  }
}

void DrawViews(SvgCanvas& canvas, const MapPanel& panel, const std::vector<ReportedView>& views) {
  const double most = MostInformation(views);
  for (const ReportedView& view : views) {
    if (most <= 0.0 || view.information_gain < kLeastShown * most) continue;
    canvas.BeginGroup(fmt::format("picture from {} to the {}: information {:.2f}", view.cell,
                                  HeadingName(view.heading_rad), view.information_gain));
    panel.DrawArrow(panel.Middle(view.cell), view.heading_rad,
                    ViewShape(view.information_gain / most), kView);
    canvas.EndGroup();
  }
}

void DrawMapPanel(SvgCanvas& canvas, const MapPanel& panel, const DecisionRecord& decision) {
  const Cell robot = decision.report.cell;
  panel.DrawMap(decision.map);
  DrawScales(canvas, panel, decision.map);
  DrawMistakes(panel, decision);
  panel.DrawPath(decision.path, kPath);
  panel.DrawPath(decision.guidance, kGuidance, 3.0);
  std::vector<Cell> plan{robot};
  plan.insert(plan.end(), decision.plan.begin(), decision.plan.end());
  panel.DrawPath(plan, kPlan, -3.0);
  for (const Cell goal : decision.goals_left) panel.DrawStar(panel.Middle(goal), kGoal);
  panel.DrawRing(panel.Middle(robot), 0.3, kRobot);
  if (decision.sends_snapshot()) {
    panel.DrawArrow(panel.Middle(robot), decision.taken.heading_rad,
                    {.length = 0.9, .half_width = 0.26}, kTaken);
  }
  DrawViews(canvas, panel, decision.report.views);
}

/// Entries in two columns below the map.
class Legend {
 public:
  Legend(SvgCanvas& canvas, double top) : canvas_(canvas), top_(top), signs_(canvas, {}, 26.0) {}

  /// Where the sign of the next entry has its middle; its text is written.
  PixelPosition Next(std::string_view text) {
    const double x = kMargin + (count_ % 2) * kLegendWidth;
    const double y = top_ + (count_ / 2) * kLegendRow;
    ++count_;
    canvas_.Text({x + 30, y + 4}, text, kSmall);
    return {x + 12, y};
  }
  void Line(std::string_view text, std::string_view style) {
    const PixelPosition middle = Next(text);
    canvas_.Polyline({{middle.x - 12, middle.y}, {middle.x + 12, middle.y}}, style);
  }
  const MapPanel& signs() const { return signs_; }

 private:
  SvgCanvas& canvas_;
  double top_;
  MapPanel signs_;
  int count_ = 0;
};

constexpr int kLegendRows = 5;

void DrawLegend(SvgCanvas& canvas, const DecisionRecord& decision, double top) {
  Legend legend(canvas, top);
  const MapPanel& signs = legend.signs();
  signs.DrawRing(legend.Next("robot"), 0.3, kRobot);
  signs.DrawStar(legend.Next("goal left"), kGoal);
  legend.Line("path since the last picture", kPath);
  legend.Line("the operator's path", kGuidance);
  legend.Line("plan: the most visited line", kPlan);
  const PixelPosition snapshot = legend.Next("picture taken");
  signs.DrawArrow({snapshot.x - 8, snapshot.y}, 0.0, {.length = 0.7, .half_width = 0.26}, kTaken);
  signs.DrawCross(legend.Next("the operator sees a wall, the robot none"), 0.3, kFalseWall);
  signs.DrawRing(legend.Next("the robot sees a wall, the operator none"), 0.3, kMissingWall);
  const PixelPosition view =
      legend.Next(fmt::format("information gain of a picture; the longest: {:.2f}",
                              MostInformation(decision.report.views)));
  signs.DrawArrow({view.x - 7, view.y}, 0.0, ViewShape(1.0), kView);
}

// --- the tree ----------------------------------------------------------------------------------

class TreePicture {
 public:
  TreePicture(SvgCanvas& canvas, const DecisionRecord& decision, PixelPosition corner)
      : canvas_(canvas),
        tree_(decision.report.tree),
        layout_(LayOut(decision, kDrawnNodes, kDrawnDepth)),
        corner_(corner) {}

  double width() const { return (layout_.depth + 1) * kTreeStep; }
  double height() const { return layout_.rows * kTreeRow; }
  std::size_t nodes() const { return layout_.nodes.size(); }

  void Draw() const {
    for (const bool on_line : {false, true}) {  // the chosen line lies above the others
      for (const PlacedNode& node : layout_.nodes) {
        if (node.on_line == on_line && node.parent >= 0) DrawEdge(node);
      }
    }
    for (const PlacedNode& node : layout_.nodes) DrawNode(node);
  }

 private:
  PixelPosition At(const PlacedNode& node) const {
    return {corner_.x + 8 + node.depth * kTreeStep, corner_.y + (node.row + 0.5) * kTreeRow};
  }
  const PlacedNode& ParentOf(const PlacedNode& node) const {
    return layout_.nodes[static_cast<std::size_t>(node.parent)];
  }

  void DrawEdge(const PlacedNode& placed) const {
    const ReportedNode& node = tree_[placed.node];
    const double share = static_cast<double>(node.visits) / std::max(1U, tree_[0].visits);
    const PixelPosition from = At(ParentOf(placed));
    const PixelPosition to = At(placed);
    canvas_.Polyline(
        {from, {from.x + 24, to.y}, to},
        fmt::format("stroke=\"{}\" stroke-width=\"{:.1f}\" stroke-linejoin=\"round\"{}",
                    placed.on_line ? "#D55E00" : "#b0b0b0", 1.0 + 9.0 * share,
                    node.feasibility < 1.0 ? " stroke-dasharray=\"5 3\"" : ""));
  }

  void DrawNode(const PlacedNode& placed) const {
    const ReportedNode& node = tree_[placed.node];
    const PixelPosition at = At(placed);
    const Cell from = placed.parent < 0 ? node.target : tree_[ParentOf(placed).node].target;
    const std::string name = placed.parent < 0 ? "now" : ActionName(ActionOf(node), from);
    canvas_.BeginGroup(fmt::format("{}: {} visits, value {:.2f}, feasible {:.2f}", name,
                                   node.visits, node.mean_value, node.feasibility));
    const char* fill = placed.on_line ? "fill=\"#D55E00\"" : "fill=\"#555555\"";
    if (node.kind == CommandKind::kTransmitView) {
      MapPanel(canvas_, {}, kTreeRow).DrawArrow(at, node.heading_rad, {0.5, 0.22}, fill);
    } else {
      canvas_.Circle(at, 4.0, fill);
    }
    canvas_.Text({at.x + 8, at.y - 3}, Label(node, placed.parent < 0), kSmall);
    canvas_.EndGroup();
  }

  static std::string Label(const ReportedNode& node, bool is_root) {
    const std::string what = is_root ? "now"
                             : node.kind == CommandKind::kMove
                                 ? fmt::format("{}", node.target)
                                 : "picture " + HeadingName(node.heading_rad);
    return fmt::format("{} {} | {:.1f}", what, node.visits, node.mean_value);
  }

  SvgCanvas& canvas_;
  const std::vector<ReportedNode>& tree_;
  TreeLayout layout_;
  PixelPosition corner_;
};

/// `text` in lines of at most `limit` characters, broken between words.
std::vector<std::string> Lines(const std::string& text, std::size_t limit) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (lines.empty() || lines.back().size() + 1 + word.size() > limit) {
      lines.push_back(word);
    } else {
      lines.back() += " " + word;
    }
  }
  return lines;
}

std::string TreeTitle(const DecisionRecord& decision, std::size_t drawn) {
  const SearchReport& report = decision.report;
  if (!decision.has_search()) return "no search was made";
  if (report.tree.empty()) return "the tree was not recorded (planner.search.report: tree)";
  return fmt::format("search tree: {} of {} nodes; visits | value; dashed: may be blocked", drawn,
                     report.nodes);
}

}  // namespace

std::string DecisionSvg(const DecisionRecord& decision) {
  const SearchReport& report = decision.report;
  SvgCanvas canvas;
  const std::string title = fmt::format("{}, decision {}: {}", report.robot, report.decision,
                                        ActionName(decision.taken, report.cell));
  const double cell = kMapPixels / std::max(decision.map.rows(), decision.map.columns());
  const PixelPosition tree_corner{kMargin + std::max(kMapPixels, 2 * kLegendWidth) + kMargin, kTop};
  const TreePicture tree(canvas, decision, tree_corner);
  canvas.Text({kMargin, 30}, title, "font-size=\"18\" fill=\"#000000\"");
  canvas.Text({kMargin, kTop - 10}, "what the robot knows, and what a picture would tell", kText);
  DrawMapPanel(canvas, MapPanel(canvas, {kMargin, kTop}, cell), decision);
  canvas.Text({tree_corner.x, kTop - 10}, TreeTitle(decision, tree.nodes()), kText);
  tree.Draw();
  const double legend_top = kTop + decision.map.rows() * cell + 1.5 * kLegendRow;
  DrawLegend(canvas, decision, legend_top);
  double bottom = std::max(legend_top + kLegendRows * kLegendRow, kTop + tree.height() + kMargin);
  const double width = tree_corner.x + std::max(tree.width(), 3 * kTreeStep) + kMargin;
  const auto characters = static_cast<std::size_t>((width - 2 * kMargin) / kCharacterWidth);
  for (const std::string& sentence : Why(decision)) {
    for (const std::string& line : Lines(sentence, characters)) {
      bottom += kSentenceRow;
      canvas.Text({kMargin, bottom}, line, kText);
    }
  }
  return canvas.Document(width, bottom + kMargin, title);
}

}  // namespace conav::planner
