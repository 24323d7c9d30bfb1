#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "operator/bag/mcap_reader.h"

/// What is in a recording, for people and for programs.
namespace conav::bag {

std::string BagText(const McapReader& reader, const std::string& file);

nlohmann::ordered_json BagJson(const McapReader& reader, const std::string& file);

}  // namespace conav::bag
