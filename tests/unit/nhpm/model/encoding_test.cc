#include "nhpm/model/encoding.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

namespace conav::nhpm {
namespace {

PerceptionQuery SmallQuery() {
  PerceptionQuery query;
  query.belief = BeliefGrid(3, 4, 0.0F);
  query.belief[{0, 1}] = 1.0F;
  query.belief[{1, 2}] = 0.25F;
  query.path = {{1, 2}, {1, 1}, {1, 2}};
  query.cell = {2, 1};
  query.visible = {{{1, 1}}, {{2, 3}}};
  return query;
}

std::vector<float> Encode(const PerceptionQuery& query, const InputSelection& selection = {}) {
  std::vector<float> input(query.belief.size() * kInputChannels, -1.0F);
  EncodeInput(query, selection, input);
  return input;
}

TEST_CASE("the four channels hold belief, path, seen free and seen wall", "[encoding]") {
  const PerceptionQuery query = SmallQuery();
  const std::vector<float> input = Encode(query);
  const auto cell = [&](int row, int column) {
    const auto first =
        input.begin() + static_cast<std::ptrdiff_t>(query.belief.IndexOf({row, column}) * 4);
    return std::vector<float>(first, first + 4);
  };
  CHECK(cell(0, 0) == std::vector<float>{0, 0, 0, 0});
  CHECK(cell(0, 1) == std::vector<float>{1, 0, 0, 0});
  CHECK(cell(1, 2) == std::vector<float>{0.25F, 1, 0, 0});
  CHECK(cell(1, 1) == std::vector<float>{0, 1, 1, 0});  // next to the camera: depth 0
  CHECK(cell(2, 1) == std::vector<float>{0, 1, 0, 0});  // the camera's cell belongs to the path
  CHECK(cell(2, 3) == std::vector<float>{0, 0, 0, 819.0F / 1024.0F});  // depth 2: 0.8
}

TEST_CASE("a picture's cells count by their depth along the view axis", "[encoding]") {
  PerceptionQuery query;
  query.belief = BeliefGrid(5, 30, 0.0F);
  query.cell = {2, 2};
  const auto nearness = [&](Cell cell, double heading_deg) {
    query.heading_rad = heading_deg * std::numbers::pi / 180.0;
    query.visible = {{cell}, {}};
    return Encode(query)[query.belief.IndexOf(cell) * kInputChannels + 2];
  };
  CHECK(nearness({2, 2}, 0.0) == 1.0F);
  CHECK(nearness({2, 7}, 0.0) == 0.5F);
  CHECK(nearness({0, 7}, 0.0) == 0.5F);  // as deep, further to the side
  CHECK(nearness({2, 20}, 0.0) == Approx(0.2).margin(1e-3));
  CHECK(nearness({2, 1}, 0.0) == 1.0F);  // behind the camera's centre
  CHECK(nearness({0, 2}, 90.0) == Approx(0.8).margin(1e-3));
  CHECK(nearness({0, 4}, 45.0) == Approx(1.0 - 0.2 * std::numbers::sqrt2).margin(1e-3));
}

TEST_CASE("an input that is left out is zero", "[encoding]") {
  const auto sum_of = [&](const InputSelection& selection) {
    std::vector<float> sums(kInputChannels, 0.0F);
    const std::vector<float> input = Encode(SmallQuery(), selection);
    for (std::size_t i = 0; i < input.size(); ++i) sums[i % kInputChannels] += input[i];
    return sums;
  };
  constexpr float kWall = 819.0F / 1024.0F;
  CHECK(sum_of({}) == std::vector<float>{1.25F, 3, 1, kWall});
  CHECK(sum_of({.belief = false}) == std::vector<float>{0, 3, 1, kWall});
  CHECK(sum_of({.path = false}) == std::vector<float>{1.25F, 0, 1, kWall});
  CHECK(sum_of({.depth = false}) == std::vector<float>{1.25F, 3, 1, 1});  // plain masks
  CHECK(sum_of({.view = false}) == std::vector<float>{1.25F, 3, 0, 0});
}

TEST_CASE("the sigmoid is right to three units in the last place, and never out of range",
          "[encoding]") {
  double worst = 0.0;
  bool in_range = true;
  for (double x = -86.0; x <= 86.0; x += 0.00731) {
    const auto logit = static_cast<float>(x);
    const double exact = 1.0 / (1.0 + std::exp(-static_cast<double>(logit)));
    const double value = static_cast<double>(Sigmoid(logit));
    worst = std::max(worst, std::abs(value - exact) / exact);
    in_range = in_range && value >= 0.0 && value <= 1.0;
  }
  CHECK(worst < 3.0 * std::pow(2.0, -23));
  CHECK(in_range);
  CHECK(Sigmoid(0.0F) == 0.5F);
  CHECK(Sigmoid(1000.0F) == 1.0F);
  CHECK(Sigmoid(-1000.0F) < 1e-37F);
  CHECK(Sigmoid(-1000.0F) >= 0.0F);
  for (const float sign : {1.0F, -1.0F}) {
    CHECK(Sigmoid(std::copysign(std::nanf(""), sign)) >= 0.0F);
    CHECK(Sigmoid(std::copysign(std::nanf(""), sign)) <= 1.0F);
  }
}

TEST_CASE("answers are masked by the belief and by the border", "[encoding]") {
  BeliefGrid belief(3, 5, 0.0F);
  belief[{1, 1}] = 1.0F;
  belief[{1, 2}] = 0.25F;
  const std::vector<float> logits(belief.size() * kOutputChannels, 0.0F);  // 0.5 everywhere
  const PerceptionAnswer answer = MaskedAnswer(belief, logits);
  CHECK(answer.add[{1, 1}] == 0.0F);
  CHECK(answer.remove[{1, 1}] == 0.5F);
  CHECK(answer.add[{1, 2}] == 0.375F);
  CHECK(answer.remove[{1, 2}] == 0.125F);
  CHECK(answer.add[{1, 3}] == 0.5F);
  CHECK(answer.remove[{1, 3}] == 0.0F);
  CHECK(ExpectedEdits(answer) == 0.5 + 0.5 + 0.5);  // nothing on the border
}

}  // namespace
}  // namespace conav::nhpm
