#include "sim/world/maze_connections.h"

#include <algorithm>
#include <map>
#include <utility>

namespace conav::sim {
namespace {

using RegionPair = std::pair<int, int>;  // the smaller region first
using Candidates = std::map<RegionPair, std::vector<MazeLink>>;

Candidates FindCandidates(const Grid<int>& regions) {
  Candidates candidates;
  for (int row = 1; row < regions.rows(); row += 2) {
    for (int column = 1; column < regions.columns(); column += 2) {
      const Cell cell{row, column};
      for (const Cell direction : kMazeDirections) {
        const Cell far = cell + direction + direction;
        if (!regions.Contains(far) || regions[far] <= regions[cell]) continue;
        candidates[{regions[cell], regions[far]}].push_back({cell + direction, direction});
      }
    }
  }
  return candidates;
}

bool NextToLink(Cell cell, const Grid<char>& entities) {
  return std::any_of(kMazeDirections.begin(), kMazeDirections.end(), [&](Cell direction) {
    const Cell neighbour = cell + direction;
    return entities.Contains(neighbour) && entities[neighbour] == kMazeLinkMark;
  });
}

}  // namespace

std::vector<MazeLink> ConnectRegions(double extra_connection_probability, Random& random,
                                     MazeDraft& draft) {
  const Candidates candidates = FindCandidates(draft.regions);
  std::vector<MazeLink> links;
  const auto add = [&](const MazeLink& link) {
    draft.entities[link.cell] = kMazeLinkMark;
    links.push_back(link);
  };
  for (const auto& [pair, places] : candidates) {
    const auto drawn = random.Uniform(0, static_cast<std::int64_t>(places.size()) - 1);
    add(places[static_cast<std::size_t>(drawn)]);
  }
  for (const auto& [pair, places] : candidates) {
    for (const MazeLink& place : places) {
      // Drawn for every candidate, also when the probability is 0: the draws that follow count.
      const bool wanted = random.Unit() <= extra_connection_probability;
      if (wanted && !NextToLink(place.cell, draft.entities)) add(place);
    }
  }
  return links;
}

void ResolveLinks(const std::vector<MazeLink>& links, bool has_doors, Grid<char>& entities) {
  for (const MazeLink& link : links) {
    if (entities[link.cell + link.direction] == kMazeWall) {
      entities[link.cell] = kMazeWall;
    } else if (has_doors) {
      entities[link.cell] = link.direction.row != 0 ? kMazeVerticalDoor : kMazeHorizontalDoor;
    } else {
      entities[link.cell] = kMazeFree;
    }
  }
}

}  // namespace conav::sim
