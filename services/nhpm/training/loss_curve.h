#pragma once

#include <span>
#include <string>

#include "nhpm/training/trainer.h"

namespace conav::nhpm {

/// An SVG document: training and validation loss over the epochs, on a logarithmic scale, with the
/// best epoch marked. Requires at least one epoch and best_epoch among them.
std::string LossCurve(const TrainingState& state, const std::string& title);

}  // namespace conav::nhpm
