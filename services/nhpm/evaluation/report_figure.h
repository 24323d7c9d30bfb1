#pragma once

#include <string>

#include "nhpm/evaluation/evaluation.h"

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
