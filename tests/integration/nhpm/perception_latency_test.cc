#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <iostream>

#include "conformance/perception_model_conformance.h"
#include "nhpm/model/glpf.h"
#include "planner/perception/remote_model.h"
#include "support/dds_participant.h"
#include "support/nhpm_process.h"

namespace conav::planner {
namespace {

struct Latency {
  double median_us;
  double p99_us;
};

Latency Measure(PerceptionModel& model, std::span<const PerceptionQuery> queries, int repeats) {
  std::vector<double> us;
  for (int i = 0; i < repeats; ++i) {
    const auto start = std::chrono::steady_clock::now();
    REQUIRE(model.Predict(queries));
    us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
                     .count());
  }
  std::sort(us.begin(), us.end());
  return {us[us.size() / 2], us[us.size() * 99 / 100]};
}

/// Hidden: `nhpm_integration_test [latency]` prints what a query to conav-nhpm, a process of its
/// own, costs over an embedded one.
TEST_CASE("Latency of remote queries", "[.][latency]") {
  const std::vector<PerceptionQuery> queries(8, conformance::MakeQuery(1, 13, 13));
  for (const std::string vendor : {"cyclonedds", "fastdds"}) {
    const test::NhpmProcess service(vendor);
    const auto participant = test::OverDds(vendor)("planner");
    RemotePerceptionModel remote(*participant, {.timeout = std::chrono::seconds(60)});
    nhpm::Glpf embedded;
    Measure(remote, queries, 200);  // discovery, warm caches
    for (const std::size_t size : {std::size_t{1}, queries.size()}) {
      const auto batch = std::span(queries).first(size);
      const Latency far = Measure(remote, batch, 5000);
      const Latency near = Measure(embedded, batch, 5000);
      std::cout << fmt::format(
          "{}: batch {}: remote median {:.0f} us, p99 {:.0f} us; embedded {:.1f} us; {} repeats\n",
          vendor, size, far.median_us, far.p99_us, near.median_us, remote.repeats());
    }
  }
}

}  // namespace
}  // namespace conav::planner
