#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/msg/method.h"
#include "common/runtime/result.h"
#include "launcher/demo_options.h"
#include "nhpm/dataset/annotators.h"
#include "operator/simulated/synthetic_operator.h"

namespace conav::study {

/// Orders of `conditions` (at least 1), each a permutation of 0, 1, ...: an even number of
/// conditions has as many orders as conditions, an odd one twice as many. Over all of them every
/// condition is equally often at each place, and equally often right after each other one.
/// Source: E. J. Williams, "Experimental designs balanced for the estimation of residual effects of
///         treatments", 1949.
std::vector<std::vector<int>> WilliamsDesign(int conditions);

/// The layouts of the paper's user study (Appendix F), as seeds of mazes.
inline constexpr std::uint64_t kPaperLayouts[] = {234, 666, 9};

/// The number of distinguishable orientations of a layout.
inline constexpr int kOrientations = 4;

/// The methods of the paper's user study.
inline constexpr std::array kStudyMethods{MethodKind::kIgMcts, MethodKind::kInstruction,
                                          MethodKind::kTeleop};

/// The names of --methods as methods. Errors: kInvalidArgument for none, one that is not `allowed`
/// and one that is named twice.
[[nodiscard]] Result<std::vector<MethodKind>> ParseMethods(const std::vector<std::string>& names,
                                                           std::span<const MethodKind> allowed);

/// A row of table 3: a method with its setting.
struct StudyRow {
  std::string name;  // "ig-mcts", "never-send", "paper-2000", "teleop-1.2"
  MethodKind method = MethodKind::kIgMcts;
  std::string communication = "search";  // as `conav demo --communication`
  double teleop_mps = 0.8;               // forward speed under teleop
  std::string search;                    // as `conav demo --search`; empty = StudyOptions::search
  bool operator==(const StudyRow&) const = default;
};

/// The search of a row as `conav demo --search`, empty for other methods than IG-MCTS.
std::string SearchOf(const StudyRow& row, const std::string& search_of_study);

/// Rows outside the order of methods, which is for what a person can tell apart. What the operator
/// is worth: the robot that ignores them, and IG-MCTS without pictures. Then the paper's searches.
inline constexpr std::array kReferences{"greedy", "never-send", "paper", "paper-2000"};

struct DesignOptions {
  int operators = 14;
  int layouts = 3;
  std::vector<MethodKind> methods{kStudyMethods.begin(),
                                  kStudyMethods.end()};  // kOrientations at most
  std::uint64_t seed = 1;
  std::vector<std::string> references;  // of kReferences
  std::vector<double> teleop_speeds{
      0.8};  // the first in the order of methods, each other a reference
};

/// One task of one simulated operator.
struct PlannedEpisode {
  std::string name;  // "s01-1-2-ig-mcts-666r90": subject, session, task, method, layout
  int subject = 0;   // all three count from 0
  int session = 0;   // of the subject, one per row
  int task = 0;      // of the session, one per layout
  StudyRow row;
  std::uint64_t maze_seed = 0;
  int rotation_deg = 0;
  std::uint64_t seed = 0;  // for everything else that is random; below 2^31
};

struct Design {
  std::vector<MethodKind> methods;
  std::vector<StudyRow> rows;                   // those of the methods, then references
  std::vector<std::string> subjects;            // "s01", ...
  std::vector<std::uint64_t> layouts;           // seeds of mazes
  std::vector<std::vector<MethodKind>> orders;  // [subject, session], methods
  std::vector<PlannedEpisode> episodes;         // in each subject's order
};

/// Within subjects: every subject does every method, in a session of its own, on every layout.
///
/// Orders of methods: rows of the Williams design, in blocks that use each row once and are
/// shuffled with the seed. Layouts: the paper's three, then mazes of random seeds, in random order
/// within a session. With k methods a layout returns k times, each time rotated differently: 0, 90,
/// 180 degrees (and 270 for the fourth). Each layout and each block starts with another rotation,
/// so that no method always has the same orientation. References come after all sessions, each layout
/// in the orientation in which the subject had it with the first method.
Design MakeDesign(const DesignOptions& options);

/// The default population: the careful people of annotators.yaml. It is the paper's population
/// after its filter (Appendix A), which drops those whose map stays wrong.
nhpm::AnnotatorPopulation DefaultPopulation();

/// A SYNTHETIC person, the same for equal seeds. The population gives how they read pictures; the
/// rest is bell-shaped (mean -+ SD, within limits):
///
///   planner.wall_crossing_cost      10 -+ 2, in 4 to 16 steps: of a path through a wall of their map
///   glance_rate                     0.03 -+ 0.005, in 0.01 to 0.05: share of streamed pictures seen
///   steering.slip_probability       0.02 -+ 0.008, in 0 to 0.05: a wrong key
///   steering.overshoot_probability  0.05 -+ 0.02, in 0 to 0.12: a key held one step too long
///
/// steering.reaction_steps is 2 low-level steps for one person in four, else 1. Everything else is
/// that of a "careful" simulated operator. These numbers are not fitted to data.
operators::SyntheticOperatorParameters DrawPerson(const nhpm::AnnotatorPopulation& population,
                                                  std::uint64_t seed);

/// The file of a person in the folder of the study.
std::filesystem::path PersonPath(const std::string& subject);

/// A file for `conav demo --operator` and `conav up simulated-operator`.
std::string PersonYaml(const operators::SyntheticOperatorParameters& person);

/// The options of `conav study`.
struct StudyOptions {
  DesignOptions design;
  int robots = 1;  // in the world, one operator for all
  int jobs = 1;    // episodes at a time
  /// Of a person, for HumanTimeOf(): the assumptions of `conav study --supervision`.
  operators::InteractionTimeParameters interaction{4.0, 6.0, 6.0, 0.5};
  std::string camera = "none";
  std::string dds;                   // as `conav demo --dds`
  std::filesystem::path weights;     // as `conav demo --weights`
  std::string search;                // as `conav demo --search`, of ig-mcts
  std::string scenario;              // as `conav demo --scenario`
  std::filesystem::path population;  // file like annotators.yaml; empty = DefaultPopulation()
  bool recording = false;            // of each episode, as in `conav demo`
  bool h264 = false;                 // H264Bytes() of each episode
  double time_limit_s = 300.0;       // wall time of an episode
  std::filesystem::path out;         // empty = DefaultOut()
  std::filesystem::path json;
  bool check = false;  // exit with an error when a bar is missed
};

/// "runs/study-14x3-seed1-0a1b2c3d": ends with the beginning of the design's fingerprint.
std::filesystem::path DefaultOut(const StudyOptions& options, const std::string& fingerprint);

/// The options that all episodes share.
launcher::DemoOptions BaseDemo(const StudyOptions& options);

/// Errors: kOutOfRange names the option, its value and the limits.
[[nodiscard]] Result<void> CheckRange(const char* option, double value, double low, double high);

/// Whether there can be so many concurrent pieces, each with a DDS domain. Errors: kOutOfRange as
/// above; kInvalidArgument when CONAV_DOMAIN leaves one domain for all of them.
[[nodiscard]] Result<void> CheckJobs(int jobs);

/// Rejects impossible options: names the option, its value and what is allowed.
[[nodiscard]] Result<void> Validate(const StudyOptions& options);

}  // namespace conav::study
