#include "nhpm/model/encoding.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "common/runtime/result.h"

namespace conav::nhpm {
namespace {

/// exp(x) for x in [-87, 0], within 2 units in the last place: 2^n exp(r) with |r| <= ln(2) / 2,
/// the latter by its Taylor series. Without branches, so that compilers vectorise loops over it.
inline float ExpOfNegative(float x) {
  constexpr float kLog2E = 1.44269504F;
  constexpr float kRounding = 12582912.0F;  // 1.5 * 2^23: adding it rounds to an integer
  constexpr float kLn2High = 0.693359375F;  // few bits, so that n * kLn2High is exact
  constexpr float kLn2Low = -2.12194440e-4F;
  const float shifted = x * kLog2E + kRounding;
  const float n = shifted - kRounding;
  const float r = (x - n * kLn2High) - n * kLn2Low;
  float sum = 1.0F / 5040.0F;
  sum = sum * r + 1.0F / 720.0F;
  sum = sum * r + 1.0F / 120.0F;
  sum = sum * r + 1.0F / 24.0F;
  sum = sum * r + 1.0F / 6.0F;
  sum = sum * r + 0.5F;
  sum = sum * r + 1.0F;
  sum = sum * r + 1.0F;
  const auto power = std::bit_cast<std::uint32_t>(shifted) << 23;  // low bits of n, as an exponent
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(sum) + power);
}

/// exp(-|x|) / (1 + exp(-|x|)) below 0, else 1 / (1 + exp(-|x|)). Selects by bits, because branches
/// would keep compilers from vectorising.
inline float SigmoidOf(float logit) {
  constexpr auto kLargest = std::bit_cast<std::int32_t>(87.0F);
  const auto bits = std::bit_cast<std::int32_t>(logit);
  const std::int32_t below_zero = bits >> 31;  // all ones or all zeros
  const std::int32_t magnitude = std::min(bits & INT32_MAX, kLargest);
  const float e = ExpOfNegative(std::bit_cast<float>(magnitude | INT32_MIN));
  const std::int32_t numerator = (std::bit_cast<std::int32_t>(e) & below_zero) |
                                 (std::bit_cast<std::int32_t>(1.0F) & ~below_zero);
  return std::bit_cast<float>(numerator) / (1.0F + e);
}

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

NearnessInView::NearnessInView(Cell camera, double heading_rad, double depth_range)
    : camera_(camera),
      east_(std::cos(heading_rad)),
      north_(std::sin(heading_rad)),
      depth_range_(depth_range) {}

float NearnessInView::Of(Cell cell) const {
  constexpr double kLeastNearness = 0.2;
  constexpr double kSteps = 1024.0;  // rounding hides the last bits of mathematical libraries
  const double depth = east_ * (cell.column - camera_.column) + north_ * (camera_.row - cell.row);
  const double nearness = std::clamp(1.0 - depth / depth_range_, kLeastNearness, 1.0);
  return static_cast<float>(std::round(nearness * kSteps) / kSteps);
}

bool AreFinite(std::span<const float> logits) {
  return std::ranges::all_of(logits, [](float logit) { return std::isfinite(logit); });
}

float Sigmoid(float logit) { return SigmoidOf(logit); }

void EncodeInput(const PerceptionQuery& query, const InputSelection& selection,
                 std::span<float> input, double depth_range) {
  const BeliefGrid& belief = query.belief;
  DEMAND(input.size() == belief.size() * kInputChannels, input.size(), belief.size());
  std::fill(input.begin(), input.end(), 0.0F);
  if (selection.belief) {
    const auto values = belief.values();
    for (std::size_t i = 0; i < values.size(); ++i) input[i * kInputChannels] = values[i];
  }
  EncodeShown(query, selection, depth_range, [&](Cell cell, std::size_t channel, float value) {
    input[belief.IndexOf(cell) * kInputChannels + channel] = value;
  });
}

std::pair<float, float> MaskedEdits(float wall_probability, const float* logits) {
  return {SigmoidOf(logits[0]) * (1.0F - wall_probability),
          SigmoidOf(logits[1]) * wall_probability};
}

PerceptionAnswer MaskedAnswer(const BeliefGrid& belief, std::span<const float> logits) {
  const int rows = belief.rows();
  const int columns = belief.columns();
  DEMAND(logits.size() == belief.size() * kOutputChannels, logits.size(), belief.size());
  PerceptionAnswer answer{Grid<float>(rows, columns), Grid<float>(rows, columns)};
  const auto x = belief.values();
  const auto add = answer.add.values();
  const auto remove = answer.remove.values();
  for (int row = 1; row < rows - 1; ++row) {
    const std::size_t first = belief.IndexOf({row, 0});
    const std::size_t last = belief.IndexOf({row, columns - 1});
    for (std::size_t i = first + 1; i < last; ++i) {
      add[i] = SigmoidOf(logits[2 * i]) * (1.0F - x[i]);
      remove[i] = SigmoidOf(logits[2 * i + 1]) * x[i];
    }
  }
  return answer;
}

bool& InputOf(InputSelection& inputs, const std::string& name) {
  for (const auto& [known, input] : kNames) {
    if (name == known) return inputs.*input;
  }
  DEMAND(false, name);
  std::abort();
}

std::string SeenInputs(const InputSelection& inputs) {
  const std::string text = Names(inputs, true);
  return (text.empty() ? "nothing" : text) + (inputs.depth ? "" : ",mask");
}

std::string MissingInputs(const InputSelection& inputs) { return Names(inputs, false); }

}  // namespace conav::nhpm
