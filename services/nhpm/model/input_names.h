#pragma once

#include <string>

#include "nhpm/model/encoding.h"

/// The network's inputs by the paper's letters: "x" the map, "tau" the path, "o" the view.
namespace conav::nhpm {

/// Whether `inputs` has the input of that name. Requires one of the three names.
bool& InputOf(InputSelection& inputs, const std::string& name);

/// "x,tau,o", less what the network does not see; "nothing".
std::string SeenInputs(const InputSelection& inputs);

/// Those that it does not see, likewise; empty where it sees all.
std::string MissingInputs(const InputSelection& inputs);

}  // namespace conav::nhpm
