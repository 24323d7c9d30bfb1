#include <catch2/catch.hpp>

#include "operator/supervision/attention_queue.h"
#include "unit/operator/supervision/attention_samples.h"

namespace conav::operators {
namespace {

AttentionItem Item(AttentionReason reason, double score, double since_s, double deadline_s = 0.0) {
  AttentionItem item;
  item.robot = "r1";
  item.reason = reason;
  item.tier = TierOf(reason);
  item.score = score;
  item.since = At(since_s);
  item.deadline = At(deadline_s);
  return item;
}

AttentionOptions Order(const std::string& name) {
  AttentionOptions options;
  options.order = name;
  return options;
}

TEST_CASE("Tiers: stopped, link lost, asking, picture, information", "[operator][attention]") {
  CHECK(TierOf(AttentionReason::kCommandFailed) == 1);
  CHECK(TierOf(AttentionReason::kLinkLost) == 2);
  CHECK(TierOf(AttentionReason::kBlocked) == 3);
  CHECK(TierOf(AttentionReason::kNoGuidance) == 3);
  CHECK(TierOf(AttentionReason::kFirstPath) == 3);
  CHECK(TierOf(AttentionReason::kPicture) == 4);
  CHECK(TierOf(AttentionReason::kGoalsReached) == 5);
  CHECK(IsQuestion(AttentionReason::kPicture));
  CHECK_FALSE(IsQuestion(AttentionReason::kLinkLost));
}

TEST_CASE("Priority: the tier first, then the score, then age", "[operator][attention]") {
  const AttentionOptions options = Order("priority");
  const AttentionItem blocked = Item(AttentionReason::kBlocked, 0.1, 9.0);
  const AttentionItem picture = Item(AttentionReason::kPicture, 5.0, 1.0);
  const AttentionItem better_picture = Item(AttentionReason::kPicture, 6.0, 2.0);
  CHECK(ComesBefore(blocked, picture, options));
  CHECK(ComesBefore(better_picture, picture, options));
  CHECK_FALSE(ComesBefore(picture, better_picture, options));
  CHECK(ComesBefore(picture, Item(AttentionReason::kPicture, 5.0, 3.0), options));
}

TEST_CASE("FIFO: age alone", "[operator][attention]") {
  const AttentionItem blocked = Item(AttentionReason::kBlocked, 9.0, 2.0);
  const AttentionItem picture = Item(AttentionReason::kPicture, 1.0, 1.0);
  CHECK(ComesBefore(picture, blocked, Order("fifo")));
}

TEST_CASE("Nearest deadline: stated, assumed for questions that wait, none for notices",
          "[operator][attention]") {
  AttentionOptions options = Order("nearest_deadline");
  options.default_deadline_s = 100.0;
  const AttentionItem picture = Item(AttentionReason::kPicture, 1.0, 30.0, 90.0);
  const AttentionItem blocked = Item(AttentionReason::kBlocked, 1.0, 0.0);  // 100 s
  const AttentionItem older = Item(AttentionReason::kBlocked, 1.0, -20.0);  // 80 s
  const AttentionItem notice = Item(AttentionReason::kGoalsReached, 9.0, -500.0);
  CHECK(ComesBefore(picture, blocked, options));
  CHECK(ComesBefore(older, picture, options));
  CHECK(ComesBefore(blocked, notice, options));
  AttentionItem by_wall_clock = Item(AttentionReason::kPicture, 1.0, 30.0);
  by_wall_clock.gives_up_after_s = 40.0;
  CHECK(ComesBefore(by_wall_clock, older, options));
}

}  // namespace
}  // namespace conav::operators
