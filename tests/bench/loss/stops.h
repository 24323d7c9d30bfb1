#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "support/network_hosts.h"

// One user: the benchmark's main file, which has the rest of the links.

namespace conav::bench {

/// ns of a clock that all processes of a machine share.
inline std::int64_t Now() { return std::chrono::steady_clock::now().time_since_epoch().count(); }

/// One case of stops: how long robots went on after a person asked for their stop.
struct StopCase {
  const char* name;
  double loss;           // share of the packets
  int planner_signal;    // sent to the planner right before; 0 = none
  double least_pause_s;  // between two rounds: a demo ends with the fifth death in 60 s
};
extern const StopCase kStopCases[4];

/// A person on the operator's host stops the robots of a demo on three hosts, until `stops` of them
/// moved when it was asked for. Returns the times, in seconds, from asking until the robot's last
/// movement, as a reader of its odometry (50 Hz) on its own host sees it.
/// Throws std::runtime_error where the demo ends or a robot drives on for 20 s.
std::vector<double> MeasureStops(test::NetworkHosts& hosts, const std::string& vendor,
                                 const StopCase& stop_case, const test::LinkFaults& faults,
                                 int stops);

/// The processes that MeasureStops starts: asks for "stop" and "resume", one a line of its input.
void RunPerson(const std::string& vendor);
/// Answers each line of its input with one of numbers: for each robot when it moved last, ns.
void RunWitness(const std::string& vendor);

}  // namespace conav::bench
