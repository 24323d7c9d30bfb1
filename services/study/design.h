#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace conav::study {

/// Orders of `conditions` (at least 1), each a permutation of 0, 1, ...: an even number of
/// conditions has as many orders as conditions, an odd one twice as many. Over all of them every
/// condition is equally often at each place, and equally often right after each other one.
/// Source: E. J. Williams, "Experimental designs balanced for the estimation of residual effects of
///         treatments", 1949.
std::vector<std::vector<int>> WilliamsDesign(int conditions);

/// The layouts of the paper's user study (Appendix F), as seeds of mazes.
inline constexpr std::uint64_t kPaperLayouts[] = {234, 666, 9};

/// The number of distinguishable orientations of a layout.
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
  std::uint64_t seed = 0;  // for everything else that is random; below 2^31
};

struct Design {
  std::vector<std::string> methods;
  std::vector<std::string> subjects;             // "s01", ...
  std::vector<std::uint64_t> layouts;            // seeds of mazes
  std::vector<std::vector<std::string>> orders;  // [subject, session], methods
  std::vector<PlannedEpisode> episodes;          // in each subject's order
};

/// Within subjects: every subject does every method, in a session of its own, on every layout.
///
/// Orders of methods: rows of the Williams design, in blocks that use each row once and are
/// shuffled with the seed. Layouts: the paper's three, then mazes of random seeds, in random order
/// within a session. With k methods a layout returns k times, each time rotated differently: 0, 90,
/// 180 degrees (and 270 for the fourth). Each layout and each block starts with another rotation,
/// so that no method always has the same orientation.
Design MakeDesign(const DesignOptions& options);

}  // namespace conav::study
