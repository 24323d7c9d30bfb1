#include "operator/supervision/workload.h"

#include <catch2/catch.hpp>

#include "unit/operator/supervision/attention_samples.h"

namespace conav::operators {
namespace {

AttentionItem Blocked(const std::string& robot, double since_s, double value_lost_per_s = 1.0) {
  return {.world = "w1",
          .robot = robot,
          .reason = AttentionReason::kBlocked,
          .since = At(since_s),
          .value_lost_per_s = value_lost_per_s};
}

/// Robot r1 asks at `asked_s`; anna selects it, edits, and has answered at `answered_s`.
void Answer(WorkloadMeter& meter, double asked_s, double selected_s, double answered_s) {
  AttentionItem item = Blocked("r1", asked_s, 2.0);
  meter.Arrived(item, At(asked_s));
  meter.Selected("anna", item, At(selected_s));
  item.selected_by = "anna";
  meter.Accepted("anna", "w1", At(answered_s - 0.5));
  meter.Left({item, At(answered_s), true});
}

TEST_CASE("Two answers: interaction, neglect and waiting times, by hand", "[operator][attention]") {
  WorkloadMeter meter({});
  meter.Advance(1, 0, At(0));
  Answer(meter, 10, 12, 18);  // waited 2, took 6
  Answer(meter, 38, 44, 48);  // neglected for 20, waited 6, took 4
  const OperatorWorkload workload = meter.Workload(At(50));
  CHECK(workload.interactions == 2);
  CHECK(workload.interaction_time_s == 5.0);
  CHECK(workload.neglect_time_s == 20.0);
  CHECK(workload.waiting_time_s == 4.0);
  CHECK(workload.waiting_time_p95_s == 6.0);
  CHECK(workload.busy_s == 10.0);
  CHECK(workload.observed_s == 50.0);
  CHECK(workload.utilisation == 0.2);
  CHECK(workload.value_lost == 2.0 * (8.0 + 10.0));
  CHECK(workload.fan_out == 5.0);
  CHECK(workload.fan_out_with_waits == Approx(20.0 / 9.0 + 1.0));
  CHECK(workload.predicted_utilisation == Approx(0.2));
  CHECK(workload.abandoned == 0);
}

TEST_CASE("Utilisation looks at the last window only, with what is still open",
          "[operator][attention]") {
  WorkloadMeter meter({.window_s = 20.0});
  meter.Advance(1, 0, At(0));
  Answer(meter, 0, 0, 18);
  meter.Selected("anna", Blocked("r1", 30), At(36));
  // 20 to 40: nothing of the first, 4 s of the second
  CHECK(meter.Workload(At(40)).utilisation == Approx(0.2));
}

TEST_CASE("A command soon after the answer makes the interaction longer, a late one does not",
          "[operator][attention]") {
  WorkloadMeter meter({.linger_s = 5.0});
  meter.Advance(1, 0, At(0));
  Answer(meter, 10, 12, 18);
  meter.Accepted("anna", "r1", At(20));
  meter.Accepted("bert", "r1", At(21));
  meter.Accepted("anna", "r2", At(22));
  CHECK(meter.Workload(At(22)).interaction_time_s == 8.0);
  meter.Accepted("anna", "w1", At(25.5));
  CHECK(meter.Workload(At(26)).interaction_time_s == 8.0);
  // anna's 6 + 2 s, bert's 5 s before his command, and 2 + 3.5 s of anna for others and too late
  CHECK(meter.Workload(At(26)).busy_s == 8.0 + 5.0 + 2.0 + 3.5);
}

TEST_CASE("Commands without a question count for the seconds before them, once",
          "[operator][attention]") {
  WorkloadMeter meter({.linger_s = 5.0});
  meter.Advance(1, 0, At(0));
  meter.Accepted("anna", "w1", At(2));  // nothing was observed before 0
  CHECK(meter.Workload(At(10)).busy_s == 2.0);
  meter.Accepted("anna", "r1", At(20));
  meter.Accepted("anna", "", At(22));
  CHECK(meter.Workload(At(25)).busy_s == 2.0 + 5.0 + 2.0);
  CHECK(meter.Workload(At(25)).interactions == 0);
  CHECK(meter.Workload(At(25)).utilisation == Approx(9.0 / 25.0));
  // A key that is held for longer than the spans that are kept.
  for (int step = 0; step < 4000; ++step) meter.Accepted("anna", "r1", At(30.0 + 0.25 * step));
  CHECK(meter.Workload(At(1029.75)).utilisation == Approx(1.0));
}

TEST_CASE("A command after the answer makes its own client's interaction longer, no other one",
          "[operator][attention]") {
  WorkloadMeter meter({});
  WorkloadMeter apart({});
  for (WorkloadMeter* each : {&meter, &apart}) {
    each->Advance(2, 0, At(0));
    Answer(*each, 10, 12, 18);  // anna: 6 s
  }
  AttentionItem snapshot = Blocked("r2", 10);
  snapshot.reason = AttentionReason::kSnapshot;
  meter.Selected("bert", snapshot, At(10));
  snapshot.selected_by = "bert";
  meter.Left({snapshot, At(19), true});  // bert: 9 s
  meter.Accepted("anna", "r1", At(21));  // anna: 9 s
  apart.Accepted("anna", "r1", At(21));
  CHECK(meter.times().Expected(AttentionReason::kBlocked) ==
        apart.times().Expected(AttentionReason::kBlocked));
}

TEST_CASE("Questions count with their wait so far, as abandoned when nobody answered",
          "[operator][attention]") {
  WorkloadMeter meter({});
  meter.Advance(1, 1, At(0));
  meter.Left({Blocked("r1", 0, 3.0), At(30), false});
  CHECK(meter.Workload(At(30)).abandoned == 1);
  CHECK(meter.Workload(At(30)).waiting_time_s == 30.0);
  CHECK(meter.Workload(At(30)).value_lost == 90.0);
  CHECK(meter.Workload(At(30)).interactions == 0);
  meter.Arrived(Blocked("r1", 45), At(45));
  CHECK(meter.Workload(At(45)).neglect_time_s == 15.0);
  WorkloadMeter waiting({});
  waiting.Advance(2, 0, At(0));
  waiting.Arrived(Blocked("r1", 0), At(0));
  waiting.Arrived(Blocked("r2", 10), At(10));
  CHECK(waiting.Workload(At(20)).waiting_time_s == 15.0);
  waiting.Selected("anna", Blocked("r1", 0), At(20));
  CHECK(waiting.Workload(At(40)).waiting_time_s == 25.0);
  CHECK(waiting.Workload(At(40)).waiting_time_p95_s == 30.0);
  waiting.Left({Blocked("r2", 10), At(40), false});
  CHECK(waiting.Workload(At(90)).waiting_time_s == 25.0);
}

TEST_CASE(
    "Selecting another robot ends the interaction, attended robots are those that do not wait",
    "[operator][attention]") {
  WorkloadMeter meter({});
  meter.Advance(2, 0, At(0));
  meter.Selected("anna", Blocked("r1", 0), At(1));
  meter.Selected("anna", Blocked("r1", 0), At(2));  // repeated
  meter.Selected("anna", Blocked("r2", 0), At(4));
  const OperatorWorkload workload = meter.Workload(At(5));
  CHECK(workload.interactions == 1);
  CHECK(workload.interaction_time_s == 0.0);
  CHECK(workload.busy_s == 4.0);
  CHECK(workload.fan_out == 0.0);
  WorkloadMeter attended({});
  attended.Advance(0, 0, At(5));  // nobody yet
  attended.Advance(4, 0, At(10));
  attended.Advance(4, 2, At(20));
  attended.Advance(4, 2, At(30));
  CHECK(attended.Workload(At(30)).attended_robots == 3.0);
  CHECK(attended.Workload(At(30)).observed_s == 20.0);
}

TEST_CASE("Measured times become the expectation of their reason", "[operator][attention]") {
  WorkloadMeter meter({});
  meter.Advance(1, 0, At(0));
  const double before = meter.times().Expected(AttentionReason::kBlocked);
  Answer(meter, 10, 12, 42);
  CHECK(meter.times().Expected(AttentionReason::kBlocked) > before);
}

TEST_CASE("Predictions for robots that wait for one operator, by hand", "[operator][attention]") {
  CHECK(FanOut(30.0, 10.0) == 4.0);
  CHECK(FanOut(0.0, 10.0) == 1.0);
  CHECK(FanOutWithWaits(30.0, 10.0, 5.0) == 3.0);
  CHECK(FanOut(30.0, 0.0) == 0.0);
  const auto one = PredictFiniteSource(1, 30.0, 10.0);
  CHECK(one.idle == Approx(0.75));
  CHECK(one.utilisation == Approx(0.25));
  CHECK(one.time_in_system == Approx(10.0));
  CHECK(one.waiting_time == Approx(0.0).margin(1e-12));
  CHECK(one.attended == Approx(1.0));
  for (int i = 0; i < 1000; ++i) {
    CHECK(PredictFiniteSource(1, 0.7 + 0.31 * i, 6.0 + 0.013 * i).waiting_time >= 0.0);
  }
  // P0 = 1 / (1 + 2 * 1/2 + 2 * 1/4) = 0.4; W = 2 / (0.1 * 0.6) - 20 = 13.333
  const auto two = PredictFiniteSource(2, 20.0, 10.0);
  CHECK(two.idle == Approx(0.4));
  CHECK(two.utilisation == Approx(0.6));
  CHECK(two.time_in_system == Approx(13.0 + 1.0 / 3.0));
  CHECK(two.waiting_time == Approx(10.0 / 3.0));
  CHECK(two.attended == Approx(1.8));  // 2 - 0.06 / s * 3.333 s
  // P0 = 1 / (1 + 4 + 12 + 24 + 24) = 1/65
  const auto four = PredictFiniteSource(4, 10.0, 10.0);
  CHECK(four.idle == Approx(1.0 / 65.0));
  CHECK(four.time_in_system == Approx(40.0 * 65.0 / 64.0 - 10.0));
  const auto many = PredictFiniteSource(400, 30.0, 10.0);
  CHECK(many.utilisation == Approx(1.0));
  CHECK(many.attended == Approx(FanOut(30.0, 10.0)));
  CHECK(PredictFiniteSource(3, 0.0, 10.0).waiting_time == Approx(20.0));
  CHECK(PredictFiniteSource(0, 30.0, 10.0).utilisation == 0.0);
  CHECK(PredictFiniteSource(5, 30.0, 0.0).waiting_time == 0.0);
  CHECK(PredictFiniteSource(5, 30.0, 0.0).attended == 5.0);
}

}  // namespace
}  // namespace conav::operators
