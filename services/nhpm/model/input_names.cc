#include "nhpm/model/input_names.h"

#include <fmt/format.h>

#include <array>

#include "common/runtime/demand.h"

namespace conav::nhpm {
namespace {

constexpr std::array kNames{std::pair("x", &InputSelection::belief),
                            std::pair("tau", &InputSelection::path),
                            std::pair("o", &InputSelection::view)};

std::string Names(const InputSelection& inputs, bool seen) {
  std::string text;
  for (const auto& [name, input] : kNames) {
    if (inputs.*input == seen) text += fmt::format("{}{}", text.empty() ? "" : ",", name);
  }
  return text;
}

}  // namespace

bool& InputOf(InputSelection& inputs, const std::string& name) {
  for (const auto& [known, input] : kNames) {
    if (name == known) return inputs.*input;
  }
  DEMAND(false, name);
  std::abort();
}

std::string SeenInputs(const InputSelection& inputs) {
  const std::string text = Names(inputs, true);
  return text.empty() ? "nothing" : text;
}

std::string MissingInputs(const InputSelection& inputs) { return Names(inputs, false); }

}  // namespace conav::nhpm
