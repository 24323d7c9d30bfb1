#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "common/runtime/random.h"
#include "common/runtime/result.h"
#include "operator/simulated/snapshot_reader.h"

namespace conav {
class ConfigReader;
}

namespace conav::nhpm {

/// The distribution of one parameter over people: bell-shaped, clamped to the parameter's range.
struct ParameterSpread {
  double mean = 0.0;
  double deviation = 0.0;  // standard deviation; 0 = everybody is alike
  bool operator==(const ParameterSpread&) const = default;
};

/// How the people of one kind differ: a distribution for each of SnapshotReaderParameters (see there
/// for units and meanings), and for how long they continue.
struct AnnotatorKind {
  ParameterSpread edit_probability{0.88, 0.06};
  ParameterSpread decay_cells{9.0, 1.5};
  ParameterSpread path_removal_probability{0.96, 0.02};
  ParameterSpread far_centre_probability{0.9, 0.05};
  ParameterSpread far_cells{3.0, 0.0};
  ParameterSpread centre_deg{10.0, 0.0};
  ParameterSpread lateral_factor{0.5, 0.12};
  ParameterSpread lateral_deg{25.0, 0.0};
  ParameterSpread misplacement_probability{0.6, 0.12};
  ParameterSpread near_cells{4.0, 0.0};
  ParameterSpread lapse_probability{0.05, 0.02};
  ParameterSpread guess_probability{0.03, 0.01};
  ParameterSpread edit_limit{6.0, 1.0};  // rounded
  /// Pictures after the one of the last goal, rounded. Paper Appendix A: people may continue to
  /// refine the map.
  ParameterSpread extra_pictures{10.5, 2.0};
  /// Everybody's; `rate` and `amount` are drawn for others than "paper" only.
  operators::ReadingMechanism mechanism = operators::ReadingMechanism::kPaper;
  ParameterSpread rate;
  ParameterSpread amount;

  void Visit(ConfigReader& reader);
  bool operator==(const AnnotatorKind&) const = default;
};

/// People whose work mostly fails the filter of paper Appendix A.
AnnotatorKind CarelessKind();

/// One synthetic person.
struct Annotator {
  operators::SnapshotReaderParameters reader;
  int extra_pictures = 0;
};

/// SYNTHETIC people: these numbers are not fitted to data. They show the patterns that the paper
/// reports (section 6.1, figure 3; section 6.3): edits decrease with distance, near walls land one
/// cell off along the view, far walls at the image centre that continue a wall are preferred to
/// near lateral ones, the robot's path opens walls, people overlook, guess, and differ.
///
/// Configured in deploy/config/annotators.yaml, section `annotators:`; its values are the defaults
/// here.
struct AnnotatorPopulation {
  AnnotatorKind careful;
  AnnotatorKind careless = CarelessKind();
  double careless_share = 0.25;  // of all people

  void Visit(ConfigReader& reader);
  bool operator==(const AnnotatorPopulation&) const = default;
};

/// Throws StartupError with file, key, value and limit (an unknown key, a wrong type, a mean out of
/// the parameter's range, a negative deviation, no file, no section).
AnnotatorPopulation ReadPopulation(const std::filesystem::path& file);

/// Draws a person. Equal random numbers give the same person.
Annotator DrawAnnotator(const AnnotatorPopulation& population, Random& random);

/// SnapshotReaderParameters by their config names, as in Trajectory::annotator: the mechanism by its
/// number, and left out with its two values where it is "paper", as in files
/// from before them.
std::map<std::string, double> ToNamedValues(operators::SnapshotReaderParameters parameters);
/// The exact inverse. Errors: kInvalidArgument for a name that is missing or unknown and for a
/// value out of range.
[[nodiscard]] Result<operators::SnapshotReaderParameters> FromNamedValues(
    const std::map<std::string, double>& values);

}  // namespace conav::nhpm
