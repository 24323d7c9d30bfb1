#pragma once

#include <string>
#include <string_view>

#include "launcher/run_log.h"

// One user: the demo; what draws episode.svg is looked for by name.

namespace conav::launcher {

/// The picture of a run as an SVG document. For each world three maps side by side: the truth with
/// trajectories, goals, starts and an arrow for each picture sent; the operator's map before; and
/// after, with the cells that differ from the truth marked. Plus a legend. Colours are those of
/// Okabe and Ito, which people with every common colour blindness can tell apart; each robot also
/// has its own dash pattern, each kind of error its own sign. A robot's own goals have its colour
/// and, among several robots, its name.
std::string EpisodeSvg(const Episode& episode, std::string_view title);

}  // namespace conav::launcher
