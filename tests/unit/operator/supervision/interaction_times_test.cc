#include <catch2/catch.hpp>
#include <cmath>

#include "operator/supervision/attention_queue.h"

namespace conav::operators {
namespace {

constexpr InteractionPriors kPriors{.picture_s = 8.0, .log_sd = 0.5, .weight = 3.0};

TEST_CASE("Without a history the expected time is the mean of the prior's log-normal",
          "[operator][attention]") {
  const InteractionTimes times(kPriors);
  CHECK(times.Expected(AttentionReason::kPicture) == Approx(8.0 * std::exp(0.125)));
  CHECK(times.Expected(AttentionReason::kBlocked) == Approx(10.0 * std::exp(0.125)));
}

TEST_CASE("One interaction moves the expectation of its reason only, by hand",
          "[operator][attention]") {
  InteractionTimes times(kPriors);
  times.Add(AttentionReason::kPicture, 2.0);
  // m = (3 log 8 + log 2) / 4 = 2.5 log 2; E log^2 = (3 (0.25 + 9 log^2 2) + log^2 2) / 4
  const double log2 = std::log(2.0);
  const double variance = (0.75 + 28.0 * log2 * log2) / 4.0 - 6.25 * log2 * log2;
  CHECK(times.Expected(AttentionReason::kPicture) == Approx(std::exp(2.5 * log2 + variance / 2.0)));
  CHECK(times.Expected(AttentionReason::kBlocked) == Approx(10.0 * std::exp(0.125)));
}

TEST_CASE("A long history outweighs the prior", "[operator][attention]") {
  InteractionTimes times(kPriors);
  for (int i = 0; i < 3000; ++i) times.Add(AttentionReason::kPicture, 20.0);
  CHECK(times.Expected(AttentionReason::kPicture) == Approx(20.0).epsilon(0.01));
}

TEST_CASE("A replaced interaction counts once, and no time is below a millisecond",
          "[operator][attention]") {
  InteractionTimes replaced(kPriors);
  replaced.Add(AttentionReason::kBlocked, 3.0);
  replaced.Replace(AttentionReason::kBlocked, 3.0, 6.0);
  InteractionTimes added(kPriors);
  added.Add(AttentionReason::kBlocked, 6.0);
  CHECK(replaced.Expected(AttentionReason::kBlocked) ==
        Approx(added.Expected(AttentionReason::kBlocked)));
  added.Add(AttentionReason::kBlocked, 0.0);
  CHECK(std::isfinite(added.Expected(AttentionReason::kBlocked)));
}

}  // namespace
}  // namespace conav::operators
