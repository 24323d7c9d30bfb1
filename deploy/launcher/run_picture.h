#pragma once

#include <string>
#include <string_view>

#include "launcher/run_log.h"

namespace conav::launcher {

/// The picture of a run as an SVG document: for each world three maps side by side - the truth with
/// trajectories, goals, starts and an arrow for each picture that was sent; the operator's map
/// before, and after - the cells that differ from the truth marked - and a legend. Colours are
/// those of Okabe and Ito (told apart with every common colour blindness); each robot also has its
/// own dash pattern, each kind of mistake its own sign. Goals that are a robot's own have its colour
/// and, among several robots, its name.
std::string EpisodeSvg(const Episode& episode, std::string_view title);

}  // namespace conav::launcher
