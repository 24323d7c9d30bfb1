#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace conav::study {

/// Orders of `conditions` (at least 1), each a permutation of 0, 1, ...: an even number of
/// conditions has as many orders as conditions, an odd one twice as many. Over all of them every
/// condition is as often at each place, and as often right after each other one.
/// Source: E. J. Williams, "Experimental designs balanced for the estimation of residual effects of
/// treatments", 1949.
std::vector<std::vector<int>> WilliamsDesign(int conditions);

/// The layouts of the paper's user study (Appendix F), as seeds of mazes.
inline constexpr std::uint64_t kPaperLayouts[] = {234, 666, 9};

/// A layout has so many orientations that can be told apart.
inline constexpr int kOrientations = 4;

struct DesignOptions {
  int operators = 14;
  int layouts = 3;
  std::vector<std::string> methods{"ig-mcts", "instruction", "teleop"};  // at most kOrientations
  std::uint64_t seed = 1;
};

/// One task of one simulated operator.
struct PlannedEpisode {
  std::string name;  // "s01-1-2-ig-mcts-666r90": subject, session, task, method, layout
  int subject = 0;   // all three count from 0
  int session = 0;   // of the subject, one per method
  int task = 0;      // of the session, one per layout
  std::string method;
  std::uint64_t maze_seed = 0;
  int rotation_deg = 0;
  std::uint64_t seed = 0;  // of everything else that is random; below 2^31
};

struct Design {
  std::vector<std::string> methods;
  std::vector<std::string> subjects;             // "s01", ...
  std::vector<std::uint64_t> layouts;            // seeds of mazes
  std::vector<std::vector<std::string>> orders;  // [subject, session], methods
  std::vector<PlannedEpisode> episodes;          // in the order in which subjects have them
};

/// Within subjects: everybody has every method, in a session of its own, on every layout.
///
/// Orders of methods: rows of the Williams design, in blocks in which each row is used once, the
/// rows of a block shuffled with the seed. Layouts: the paper's three, then mazes of random seeds;
/// a session has them in random order. With k methods a layout comes back k times, each time turned
/// another way: 0, 90, 180 degrees (and 270 for the fourth), begun with another one for each layout
/// and each block, so that no method always has the same orientation.
Design MakeDesign(const DesignOptions& options);

}  // namespace conav::study
