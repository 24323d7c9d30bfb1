#pragma once

#include <filesystem>
#include <string>

#include "common/runtime/result.h"

// One user: waterway_main; reading runs and drawing them is apart from running them.

namespace conav::study {

/// Figure 7 of the paper from two runs of one waterway, as an SVG document: (a) the truth with the way
/// of greedy search and of IG-MCTS, (b) the operator's first map and what is wrong on it, (c) the
/// robot's map with its navigation graph, (d) a picture that IG-MCTS sent, (e) what the model predicts
/// that the operator edits after it. (c) to (e) are of the picture that the search expected most of; if
/// none was sent, (c) is of the last decision, and (d) and (e) are left out.
///
/// `greedy` and `guided` are run folders of conav demo with a recording and decisions. Errors: those of
/// reading the files; kMalformed: a recording without the robot's way or the maps.
[[nodiscard]] Result<std::string> WaterwayFigure(const std::filesystem::path& greedy,
                                                 const std::filesystem::path& guided);

}  // namespace conav::study
