#pragma once

#include <string>

#include "nhpm/evaluation/evaluation.h"

/// Plots of the page, as SVG elements with the classes of its style sheet.
namespace conav::nhpm {

/// Share of outputs that were edited over the promised probability, a dot per bin that is not
/// empty, larger for more outputs; the diagonal is perfect.
std::string ReliabilityPlot(const ModelRow& row);

/// Edits made over edits expected, a dot per bin of segments; `largest` is the end of both axes.
std::string EditsPlot(const ModelRow& row, double largest);

/// The largest number of edits in the bins of a row.
double LargestEdits(const ModelRow& row);

}  // namespace conav::nhpm
