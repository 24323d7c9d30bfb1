#include "nhpm/model/encoding.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "common/runtime/demand.h"

namespace conav::nhpm {
namespace {

/// exp(x) for x in [-87, 0], within 2 units in the last place: 2^n exp(r) with |r| <= ln(2) / 2, the
/// latter by its Taylor series. Without branches, so that loops over it become vector code.
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

inline float SigmoidOf(float logit) {
  const float magnitude = std::min(logit < 0.0F ? -logit : logit, 87.0F);
  const float e = ExpOfNegative(-magnitude);
  const float of_magnitude = 1.0F / (1.0F + e);
  return logit < 0.0F ? e * of_magnitude : of_magnitude;
}

}  // namespace

float Sigmoid(float logit) { return SigmoidOf(logit); }

void EncodeInput(const PerceptionQuery& query, const InputSelection& selection,
                 std::span<float> input) {
  const BeliefGrid& belief = query.belief;
  DEMAND(input.size() == belief.size() * kInputChannels, input.size(), belief.size());
  std::fill(input.begin(), input.end(), 0.0F);
  const auto set = [&](Cell cell, std::size_t channel, float value) {
    input[belief.IndexOf(cell) * kInputChannels + channel] = value;
  };
  if (selection.belief) {
    const auto values = belief.values();
    for (std::size_t i = 0; i < values.size(); ++i) input[i * kInputChannels] = values[i];
  }
  if (selection.path) {
    for (const Cell cell : query.path) set(cell, 1, 1.0F);
    set(query.cell, 1, 1.0F);
  }
  if (selection.view) {
    for (const Cell cell : query.visible.free) set(cell, 2, 1.0F);
    for (const Cell cell : query.visible.walls) set(cell, 3, 1.0F);
  }
}

PerceptionAnswer MaskedAnswer(const BeliefGrid& belief, std::span<const float> logits) {
  const int rows = belief.rows();
  const int columns = belief.columns();
  DEMAND(logits.size() == belief.size() * kOutputChannels, logits.size(), belief.size());
  PerceptionAnswer answer{Grid<float>(rows, columns), Grid<float>(rows, columns)};
  const float* x = belief.values().data();
  float* add = answer.add.values().data();
  float* remove = answer.remove.values().data();
  for (int row = 1; row < rows - 1; ++row) {
    const std::ptrdiff_t first = std::ptrdiff_t{row} * columns;
    for (std::ptrdiff_t i = first + 1; i < first + columns - 1; ++i) {
      add[i] = SigmoidOf(logits[static_cast<std::size_t>(2 * i)]) * (1.0F - x[i]);
      remove[i] = SigmoidOf(logits[static_cast<std::size_t>(2 * i + 1)]) * x[i];
    }
  }
  return answer;
}

}  // namespace conav::nhpm
