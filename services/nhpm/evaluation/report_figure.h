#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "nhpm/evaluation/evaluation.h"

namespace conav::nhpm {

/// A test segment to be shown, and why.
struct FigureSegment {
  std::size_t index = 0;  // among all test segments, from 0
  std::string reason;
};

/// A wall up to 3 cells away that the picture shows was put one cell farther or nearer along the
/// line of sight instead. Paper figure 3, first case.
bool ShowsMisplacedNearWall(const Segment& segment);

/// A missing wall 3 cells away or more, within 12 degrees of the view axis, was added, and a nearer
/// one more than 25 degrees to the side was not. Paper figure 3, second case.
bool ShowsPreferredFarWall(const Segment& segment);

/// Up to `count` segments for the page's figure: one third of each of the paper's two cases, where
/// the two models differ most among them, then those where they differ most of all. The difference
/// is the sum over all cells of |P - P'|.
std::vector<FigureSegment> ChooseFigureSegments(const EvaluationData& data, const ModelRow& first,
                                                const ModelRow& second, std::size_t count = 6);

/// Sum over all cells of what two answers differ by, in edits.
double Difference(const PerceptionAnswer& a, const PerceptionAnswer& b);

}  // namespace conav::nhpm

/// Panels of the paper's figure 3, as SVG elements with the classes of the page's style sheet.
namespace conav::nhpm {

/// The operator's map before the picture.
std::string BeforePanel(const Segment& segment);

/// The path since the last picture, the cells that the picture shows, and the camera.
std::string ViewPanel(const Segment& segment);

/// The probabilities of a model on the map: the stronger the colour the likelier the edit, in
/// percent from 5 % on.
std::string PredictionPanel(const Segment& segment, const PerceptionAnswer& answer,
                            const std::string& title);

/// What the person did: + where a wall was added, a minus sign where one was removed.
std::string TruthPanel(const Segment& segment);

}  // namespace conav::nhpm
