#include "planner/navigation/region_graph.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>

#include "common/runtime/result.h"
#include "planner/navigation/cell_line.h"

namespace conav::planner {
namespace {

/// The cell nearest to the centroid of `cells`, the first of equals.
int NearestToCentroid(std::span<const Cell> cells) {
  std::int64_t rows = 0;
  std::int64_t columns = 0;
  for (const Cell cell : cells) {
    rows += cell.row;
    columns += cell.column;
  }
  const auto count = static_cast<std::int64_t>(cells.size());
  const auto distance = [&](Cell cell) {
    const std::int64_t down = count * cell.row - rows;
    const std::int64_t right = count * cell.column - columns;
    return down * down + right * right;
  };
  return static_cast<int>(std::ranges::min_element(cells, {}, distance) - cells.begin());
}

}  // namespace

RegionGraph::RegionGraph(const RegionOptions& options, std::shared_ptr<const GridViews> views)
    : partition_(options),
      camera_(std::move(views)),
      step_length_cells_(options.step_length_cells),
      first_edge_{0} {}

void RegionGraph::Update(const OccupancyGrid& known, std::span<const Cell> taken) {
  const bool same_taken = std::ranges::equal(taken, taken_);
  if (same_taken && known == this->known()) return;
  taken_.assign(taken.begin(), taken.end());
  const bool other_size =
      known.rows() != this->known().rows() || known.columns() != this->known().columns();
  const RegionPartition::Changes& changes = partition_.Update(known);
  views_.clear();
  if (other_size) {
    regions_.clear();
    in_order_.clear();
    part_of_.assign(known.size(), RegionPartition::kNone);
    number_.assign(known.size(), 0);
  }
  for (const int seed : changes.regions) MakeRegion(seed);
  if (!changes.regions.empty()) {
    in_order_.clear();
    for (auto& [seed, region] : regions_) in_order_.push_back(&region);
  }
  for (const int seed : changes.borders) {
    const auto region = regions_.find(seed);
    if (region != regions_.end()) FindContacts(region->second);
  }
  JoinRegions();
  const std::vector<Link> detours = AddDetours();
  SplitRegions(detours);
  NumberVertices();
  NumberEdges(detours);
  for (Region* region : in_order_) region->changed = false;
}

/// Or takes it away, if there is none any more.
void RegionGraph::MakeRegion(int seed) {
  if (!partition_.IsSeed(seed)) {
    regions_.erase(seed);
    return;
  }
  Region& region = regions_[seed];
  region.seed = seed;
  region.changed = true;
  region.parts.clear();
  region.cells.clear();
  region.north_west = region.south_east = CellAt(seed);
  for (const int index : partition_.CellsOf(seed)) {
    const Cell cell = CellAt(index);
    region.cells.push_back(cell);
    region.north_west = {std::min(region.north_west.row, cell.row),
                         std::min(region.north_west.column, cell.column)};
    region.south_east = {std::max(region.south_east.row, cell.row),
                         std::max(region.south_east.column, cell.column)};
  }
  region.node = IndexOf(region.cells[At(NearestToCentroid(region.cells))]);
}

/// Keeps what is known of those that touched before.
void RegionGraph::FindContacts(Region& region) {
  std::vector<int> seeds;
  for (const Cell cell : region.cells) {
    partition_.ForNeighbours(IndexOf(cell), [&](int index) {
      const int seed = partition_.RegionOf(index);
      if (seed > region.seed && (seeds.empty() || seeds.back() != seed)) seeds.push_back(seed);
    });
  }
  std::sort(seeds.begin(), seeds.end());
  seeds.erase(std::unique(seeds.begin(), seeds.end()), seeds.end());
  std::vector<Contact> contacts(seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const auto before = std::ranges::find(region.contacts, seeds[i], &Contact::seed);
    if (before != region.contacts.end()) contacts[i] = std::move(*before);
    contacts[i].seed = seeds[i];
    contacts[i].other = &regions_.at(seeds[i]);
  }
  region.contacts = std::move(contacts);
}

/// Joins the regions whose contact or cell is new, and those with a change on the way.
void RegionGraph::JoinRegions() {
  for (Region* region : in_order_) region->joined.clear();
  for (Region* region : in_order_) {
    for (Contact& contact : region->contacts) {
      Join(*region, contact);
      if (!contact.is_clear) continue;
      region->joined.push_back(contact.seed);
      contact.other->joined.push_back(region->seed);
    }
  }
}

void RegionGraph::Join(const Region& region, Contact& contact) const {
  const Region& other = *contact.other;
  const Cell north_west{std::min(region.north_west.row, other.north_west.row),
                        std::min(region.north_west.column, other.north_west.column)};
  const Cell south_east{std::max(region.south_east.row, other.south_east.row),
                        std::max(region.south_east.column, other.south_east.column)};
  if (!contact.is_new && !region.changed && !other.changed &&
      !partition_.ChangedNear(north_west, south_east)) {
    return;
  }
  const auto link = LinkBetween(region.node, other.node);
  contact.is_new = false;
  contact.is_clear = link.has_value();
  contact.is_seen = link && link->is_seen;
  contact.detour_known = false;
}

std::optional<RegionGraph::Link> RegionGraph::LinkBetween(int from, int to) const {
  bool is_seen = true;
  const bool is_clear = WalkLine(CellAt(from), CellAt(to), [&](Cell cell) {
    const int index = IndexOf(cell);
    is_seen = is_seen && known().values()[At(index)] == Occupancy::kFree;
    return partition_.RegionOf(index) != RegionPartition::kNone;
  });
  if (!is_clear) return std::nullopt;
  return Link{from, to, is_seen};
}

/// Of all contacts that are not connected otherwise.
std::vector<RegionGraph::Link> RegionGraph::AddDetours() {
  std::vector<Link> detours;
  for (Region* region : in_order_) {
    for (Contact& contact : region->contacts) {
      if (contact.is_clear || HasJoinedNeighbour(*region, *contact.other)) continue;
      if (!contact.detour_known) {
        contact.detour = Detour(*region, *contact.other);
        contact.detour_known = true;
      }
      detours.insert(detours.end(), contact.detour.begin(), contact.detour.end());
    }
  }
  return detours;
}

bool RegionGraph::HasJoinedNeighbour(const Region& a, const Region& b) const {
  auto of_a = a.joined.begin();
  auto of_b = b.joined.begin();
  while (of_a != a.joined.end() && of_b != b.joined.end()) {
    if (*of_a == *of_b) return true;
    ++(*of_a < *of_b ? of_a : of_b);
  }
  return false;
}

/// Lines along a shortest path, each as long as it can be.
std::vector<RegionGraph::Link> RegionGraph::Detour(const Region& from, const Region& to) const {
  const std::vector<int> path = ShortestPath(from, to);
  std::vector<Link> detour;
  std::size_t at = 0;
  while (at + 1 < path.size()) {
    Link longest = LinkBetween(path[at], path[at + 1]).value();  // neighbours
    std::size_t end = at + 1;
    for (; end + 1 < path.size(); ++end) {
      const auto link = LinkBetween(path[at], path[end + 1]);
      if (!link) break;
      longest = *link;
    }
    detour.push_back(longest);
    at = end;
  }
  return detour;
}

/// Indices of the cells from one region's node to the other's, inside the two.
std::vector<int> RegionGraph::ShortestPath(const Region& from, const Region& to) const {
  std::unordered_map<int, int> next{{to.node, to.node}};  // on the way to the end
  std::vector<int> cells{to.node};
  for (std::size_t i = 0; i < cells.size() && !next.contains(from.node); ++i) {
    partition_.ForNeighbours(cells[i], [&](int index) {
      const int seed = partition_.RegionOf(index);
      if (seed != from.seed && seed != to.seed) return;
      if (next.emplace(index, cells[i]).second) cells.push_back(index);
    });
  }
  std::vector<int> path{from.node};
  while (path.back() != to.node) path.push_back(next.at(path.back()));
  return path;
}

void RegionGraph::SplitRegions(const std::vector<Link>& detours) {
  std::vector<std::pair<int, int>> nodes;  // seed, index of a cell
  for (const Link& link : detours) {
    nodes.emplace_back(partition_.RegionOf(link.from), link.from);
    nodes.emplace_back(partition_.RegionOf(link.to), link.to);
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  auto at = nodes.begin();
  std::vector<int> of_region;
  for (Region* region : in_order_) {
    of_region.assign({region->node});
    for (; at != nodes.end() && at->first == region->seed; ++at) {
      if (at->second != region->node) of_region.push_back(at->second);
    }
    const bool is_split = std::ranges::equal(of_region, region->parts, {}, {}, &Part::node);
    if (!is_split) Split(*region, of_region);
  }
}

/// Gives each of the region's cells to the nearest of `nodes`, by steps inside the region.
void RegionGraph::Split(Region& region, std::span<const int> nodes) {
  for (const Cell cell : region.cells) part_of_[At(IndexOf(cell))] = RegionPartition::kNone;
  std::vector<int> reached(nodes.begin(), nodes.end());
  for (const int node : nodes) part_of_[At(node)] = node;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    partition_.ForNeighbours(reached[i], [&](int index) {
      if (partition_.RegionOf(index) != region.seed) return;
      if (part_of_[At(index)] != RegionPartition::kNone) return;
      part_of_[At(index)] = part_of_[At(reached[i])];
      reached.push_back(index);
    });
  }
  if (region.parts.size() > 1) std::sort(region.cells.begin(), region.cells.end());
  region.parts.clear();
  for (const int node : nodes) region.parts.push_back({node, 0, 0});
  if (nodes.size() > 1) {
    std::ranges::stable_sort(region.cells, {}, [&](Cell cell) {
      return std::ranges::find(region.parts, part_of_[At(IndexOf(cell))], &Part::node);
    });
  }
  std::size_t first = 0;
  for (Part& part : region.parts) {
    part.first = part.end = first;
    while (part.end < region.cells.size() &&
           part_of_[At(IndexOf(region.cells[part.end]))] == part.node) {
      ++part.end;
    }
    first = part.end;
  }
}

/// By the region's seed; its own node first.
void RegionGraph::NumberVertices() {
  vertices_.clear();
  for (const Region* region : in_order_) {
    const std::span cells(region->cells);
    for (const Part& part : region->parts) {
      number_[At(part.node)] = vertex_count();
      vertices_.push_back({CellAt(part.node), cells.subspan(part.first, part.end - part.first)});
    }
  }
}

/// By vertex: whether its region holds a taken cell.
std::vector<std::uint8_t> RegionGraph::TakenVertices() const {
  std::vector<std::uint8_t> is_taken(vertices_.size(), 0);
  for (const Cell cell : taken_) {
    if (const auto vertex = VertexAt(cell)) is_taken[At(*vertex)] = 1;
  }
  return is_taken;
}

void RegionGraph::NumberEdges(const std::vector<Link>& detours) {
  std::vector<Pair> pairs;
  const auto add = [&](const Link& link) {
    const auto [smaller, larger] = std::minmax(number_[At(link.from)], number_[At(link.to)]);
    pairs.push_back({smaller, larger, link.is_seen});
  };
  for (const Region* region : in_order_) {
    for (const Contact& contact : region->contacts) {
      if (contact.is_clear) add({region->node, contact.other->node, contact.is_seen});
    }
  }
  const auto contacts = static_cast<std::ptrdiff_t>(pairs.size());  // in order
  for (const Link& link : detours) add(link);
  std::sort(pairs.begin() + contacts, pairs.end());
  std::inplace_merge(pairs.begin(), pairs.begin() + contacts, pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  uncertainty_count_ = static_cast<int>(pairs.size());
  FillEdges(pairs);
}

void RegionGraph::FillEdges(std::span<const Pair> pairs) {
  const std::vector<std::uint8_t> is_taken = TakenVertices();
  first_edge_.assign(vertices_.size() + 1, 0);
  for (const auto& [smaller, larger, is_seen] : pairs) {
    first_edge_[At(smaller) + 1] += is_taken[At(larger)] == 0;
    first_edge_[At(larger) + 1] += is_taken[At(smaller)] == 0;
  }
  for (std::size_t i = 1; i < first_edge_.size(); ++i) first_edge_[i] += first_edge_[i - 1];
  edges_.assign(first_edge_.back(), {});
  std::vector<std::size_t> next(first_edge_.begin(), first_edge_.end() - 1);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& [smaller, larger, is_seen] = pairs[i];
    const Cell way = CellOf(larger) - CellOf(smaller);
    const Edge edge{
        .feasibility = is_seen ? 1.0 : kUnseenFeasibility,
        .uncertainty = static_cast<int>(i),
        .length = std::sqrt(way.row * way.row + way.column * way.column) / step_length_cells_};
    const auto add_edge = [&](VertexId from, VertexId to) {
      if (is_taken[At(to)] != 0) return;
      edges_[next[At(from)]] = edge;
      edges_[next[At(from)]++].target = to;
    };
    add_edge(smaller, larger);
    add_edge(larger, smaller);
  }
}

std::optional<VertexId> RegionGraph::VertexAt(Cell cell) const {
  if (!partition_.IsTraversable(cell)) return std::nullopt;
  return number_[At(part_of_[At(IndexOf(cell))])];
}

std::span<const Edge> RegionGraph::EdgesFrom(VertexId vertex) const {
  const std::size_t first = first_edge_[At(vertex)];
  return std::span(edges_).subspan(first, first_edge_[At(vertex) + 1] - first);
}

std::span<const double> RegionGraph::HeadingsAt(VertexId /*vertex*/) const {
  return camera_->headings();
}

const VisibleCells& RegionGraph::ViewFrom(VertexId vertex, int index) const {
  const std::size_t number = At(vertex) * camera_->headings().size() + At(index);
  const std::lock_guard lock(mutex_);
  const auto [view, is_new] = views_.try_emplace(number);
  if (is_new) view->second = camera_->Cast(known(), CellOf(vertex), index);
  return view->second;
}

}  // namespace conav::planner
