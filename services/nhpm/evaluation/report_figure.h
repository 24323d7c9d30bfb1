#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "nhpm/evaluation/evaluation.h"

/// The paper's figure 3: chooses its segments and draws its panels, as SVG elements with the classes
/// of the page's style sheet.
namespace conav::nhpm {

/// A test segment for the page, and the reason for the choice.
struct FigureSegment {
  std::size_t index = 0;  // among all test segments, from 0
  std::string reason;
};

/// The person put a wall that is up to 3 cells away in the picture one cell farther or nearer along
/// the line of sight. Paper figure 3, first case.
bool ShowsMisplacedNearWall(const Segment& segment);

/// The person added a missing wall 3 cells away or more, within 12 degrees of the view axis, but
/// not a nearer one more than 25 degrees to the side. Paper figure 3, second case.
bool ShowsPreferredFarWall(const Segment& segment);

/// Up to `count` segments for the page's figure: one third of each of the paper's two cases, where
/// the two models differ most among them, then those where they differ most of all. The difference
/// is the sum over all cells of |P - P'|.
std::vector<FigureSegment> ChooseFigureSegments(const EvaluationData& data, const ModelRow& first,
                                                const ModelRow& second, std::size_t count = 6);

/// Sum over all cells of the difference between two answers, in edits.
double Difference(const PerceptionAnswer& a, const PerceptionAnswer& b);

/// The operator's map before the picture.
std::string BeforePanel(const Segment& segment);

/// The path since the last picture, the cells in the picture, and the camera.
std::string ViewPanel(const Segment& segment);

/// The probabilities of a model on the map: the stronger the colour the likelier the edit, in
/// percent from 5 % on.
std::string PredictionPanel(const Segment& segment, const PerceptionAnswer& answer,
                            const std::string& title);

/// The person's edits: + for an added wall, a minus sign for a removed one.
std::string TruthPanel(const Segment& segment);

}  // namespace conav::nhpm
