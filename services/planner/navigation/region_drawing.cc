#include "planner/navigation/region_drawing.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace conav::planner {
namespace {

constexpr std::array<std::string_view, 7> kFills{
    R"(fill="#e3eef9")", R"(fill="#e8f3e1")", R"(fill="#fbefdc")", R"(fill="#f1e6f5")",
    R"(fill="#e0f2f0")", R"(fill="#fae5e3")", R"(fill="#f3f1dd")"};

/// Colours by vertex; where there are enough, neighbours differ.
std::vector<std::size_t> ChooseFills(const NavigationGraph& graph) {
  std::vector<std::size_t> fills;
  for (VertexId vertex = 0; vertex < graph.vertex_count(); ++vertex) {
    std::array<bool, kFills.size()> taken{};
    for (const Edge& edge : graph.EdgesFrom(vertex)) {
      if (edge.target < vertex) taken[fills[static_cast<std::size_t>(edge.target)]] = true;
    }
    const std::size_t own = static_cast<std::size_t>(vertex) % kFills.size();
    std::size_t fill = own;
    for (std::size_t i = 0; i < kFills.size() && taken[fill]; ++i) fill = (own + i) % kFills.size();
    fills.push_back(fill);
  }
  return fills;
}

/// One rectangle for each run of cells in a row.
void DrawCells(std::span<const Cell> cells, std::string_view style, const MapPanel& panel,
               double cell_pixels, SvgCanvas& canvas) {
  for (std::size_t first = 0; first < cells.size();) {
    std::size_t end = first + 1;
    while (end < cells.size() && cells[end] == cells[end - 1] + Cell{0, 1}) ++end;
    canvas.Rectangle(panel.Corner(cells[first]), static_cast<double>(end - first) * cell_pixels,
                     cell_pixels, style);
    first = end;
  }
}

}  // namespace

void DrawRegions(const NavigationGraph& graph, PixelPosition corner, double cell_pixels,
                 SvgCanvas& canvas) {
  const MapPanel panel(canvas, corner, cell_pixels);
  const std::vector<std::size_t> fills = ChooseFills(graph);
  for (VertexId vertex = 0; vertex < graph.vertex_count(); ++vertex) {
    DrawCells(graph.CellsOf(vertex), kFills[fills[static_cast<std::size_t>(vertex)]], panel,
              cell_pixels, canvas);
  }
  const double width = std::max(0.5, 0.2 * cell_pixels);
  const std::string sure = fmt::format(R"(stroke="#5b6f86" stroke-width="{:.2f}")", width);
  const std::string unsure = fmt::format(R"({} stroke-dasharray="{:.1f}")", sure, 3.0 * width);
  for (VertexId vertex = 0; vertex < graph.vertex_count(); ++vertex) {
    for (const Edge& edge : graph.EdgesFrom(vertex)) {
      if (edge.target < vertex) continue;
      canvas.Line(panel.Middle(graph.CellOf(vertex)), panel.Middle(graph.CellOf(edge.target)),
                  edge.feasibility < 1.0 ? unsure : sure);
    }
  }
  for (VertexId vertex = 0; vertex < graph.vertex_count(); ++vertex) {
    canvas.Circle(panel.Middle(graph.CellOf(vertex)), 0.45 * cell_pixels, R"(fill="#23364d")");
  }
}

}  // namespace conav::planner
