#include "planner/explain/explanation.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>

#include "common/grid/geometry.h"
#include "common/msg/method.h"
#include "common/runtime/text.h"

namespace conav::planner {
namespace {

namespace fs = std::filesystem;

constexpr double kSameRad = 1e-6;

std::string StepName(Cell step) {
  constexpr std::array kNames{"north", "east", "south", "west"};  // as kNeighbourOffsets
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNeighbourOffsets[i] == step) return fmt::format("{} ", kNames[i]);
  }
  return "";
}

bool ReadNumber(std::string_view text, std::uint64_t& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && number >= 1;
}

bool IsBetter(const SearchAction& a, const SearchAction& b) {
  if (a.visits != b.visits) return a.visits > b.visits;
  return a.mean_value > b.mean_value;
}

bool IsSnapshot(const SearchAction& action) { return action.kind == CommandKind::kTransmitView; }

/// The best of the actions that `admits`; null when none was tried.
template <class Predicate>
const SearchAction* BestOf(const SearchReport& report, Predicate&& admits) {
  const SearchAction* best = nullptr;
  for (const SearchAction& action : report.actions) {
    if (action.visits == 0 || !admits(action)) continue;
    if (best == nullptr || IsBetter(action, *best)) best = &action;
  }
  return best;
}

std::string NoSearch(const DecisionRecord& decision) {
  if (decision.report.method == Name(MethodKind::kIgMcts) && decision.sends_snapshot()) {
    return "No search was made for this decision: the communication policy wanted a picture.";
  }
  if (decision.report.method == Name(MethodKind::kIgMcts)) {
    return "No search was made for this decision: the robot made room for another robot.";
  }
  return fmt::format(
      "Method {} makes no search: it compares no actions, so there are no values to explain.",
      decision.report.method);
}

/// "12.30 less", "0.50 more".
std::string Difference(double difference) {
  return fmt::format("{:.2f} {}", std::abs(difference), difference < 0.0 ? "less" : "more");
}

/// The terms that make `other` worth less than `taken`, or more, the largest first; two at most.
std::string WhichTerms(const SearchAction& taken, const SearchAction& other) {
  NamedTerms differences = Named(other.terms);
  const NamedTerms of_taken = Named(taken.terms);
  for (std::size_t i = 0; i < differences.size(); ++i) differences[i].second -= of_taken[i].second;
  const double sign = other.mean_value < taken.mean_value ? -1.0 : 1.0;
  std::sort(differences.begin(), differences.end(),
            [&](const auto& a, const auto& b) { return sign * a.second > sign * b.second; });
  std::string text;
  for (std::size_t i = 0; i < 2 && sign * differences[i].second >= 0.005; ++i) {
    text += fmt::format("{}{} ({:+.2f})", text.empty() ? "" : " and ", differences[i].first,
                        differences[i].second);
  }
  return text.empty() ? text : ", most by " + text;
}

std::string Choice(const DecisionRecord& decision, const SearchAction& taken) {
  const SearchReport& report = decision.report;
  std::uint32_t visits = 0;
  for (const SearchAction& action : report.actions) visits += action.visits;
  std::string text =
      fmt::format("Taken: {}, visited {} of {} times, worth {:.2f}.",
                  ActionName(taken, report.cell), taken.visits, visits, taken.mean_value);
  const SearchAction* preferred =
      report.chosen < 0 ? nullptr : &report.actions[static_cast<std::size_t>(report.chosen)];
  if (preferred != nullptr && !IsSameCommand(*preferred, taken)) {
    text += fmt::format(" The search preferred {}, visited {} times; the method decided otherwise.",
                        ActionName(*preferred, report.cell), preferred->visits);
  }
  return text;
}

std::string AgainstRunnerUp(const DecisionRecord& decision, const SearchAction& taken) {
  const SearchAction* other = RunnerUp(decision);
  if (other == nullptr) return "No other action was tried.";
  const double difference = other->mean_value - taken.mean_value;
  std::string text =
      fmt::format("The runner-up, {} ({} visits), is worth {}",
                  ActionName(*other, decision.report.cell), other->visits, Difference(difference));
  if (decision.report.has_terms) text += WhichTerms(taken, *other);
  return text + (difference > 0.0 ? "; the search takes the most visited action, not the one with "
                                    "the highest mean."
                                  : ".");
}

/// What a picture was worth, and its price.
std::string Price(const SearchAction& snapshot) {
  return fmt::format(
      "brings information worth {:.2f} and costs {:.2f}, its turn and the operator's path still "
      "ahead included",
      snapshot.information_gain, snapshot.information_gain - snapshot.mean_value);
}

std::string NoSnapshots(const SearchReport& report) {
  double most = -1.0;
  for (const SearchAction& action : report.actions) {
    if (IsSnapshot(action)) most = std::max(most, action.information_gain);
  }
  if (most < 0.0) return "No picture was offered here: each was sent, and nothing changed since.";
  return fmt::format(
      "No picture was considered: each promised too little, or less than it costs; {:.2f} "
      "at most.",
      most);
}

std::string AgainstMove(const DecisionRecord& decision, const SearchAction& snapshot,
                        const SearchAction& move) {
  return fmt::format("Moving on ({}) was worth {:.2f}: {} than the picture{}.",
                     ActionName(move, decision.report.cell), move.mean_value,
                     Difference(move.mean_value - snapshot.mean_value),
                     decision.report.has_terms ? WhichTerms(snapshot, move) : "");
}

std::string AboutSnapshots(const DecisionRecord& decision, const SearchAction& taken) {
  const SearchReport& report = decision.report;
  if (IsSnapshot(taken)) {
    const SearchAction* move =
        BestOf(report, [](const auto& action) { return !IsSnapshot(action); });
    std::string text = fmt::format("The picture {}.", Price(taken));
    if (move == nullptr) return text + " No move was tried.";
    // A runner-up has been compared already.
    return move == RunnerUp(decision) ? text : text + " " + AgainstMove(decision, taken, *move);
  }
  const SearchAction* snapshot = nullptr;
  for (const SearchAction& action : report.actions) {
    if (!IsSnapshot(action) || action.visits == 0) continue;
    if (snapshot == nullptr || action.mean_value > snapshot->mean_value) snapshot = &action;
  }
  if (snapshot == nullptr) return NoSnapshots(report);
  const double difference = snapshot->mean_value - taken.mean_value;
  return fmt::format("The best picture, to the {}, {}. It is worth {:.2f}, {} than the move{}.",
                     HeadingName(snapshot->heading_rad), Price(*snapshot), snapshot->mean_value,
                     Difference(difference), difference < 0.0 ? "; it was not worth its cost" : "");
}

/// How many decisions there are of a robot, and up to which number.
struct Extent {
  std::uint64_t first = UINT64_MAX;
  std::uint64_t last = 0;
};
using Extents = std::map<std::string, Extent>;

bool IsDecisionFile(const fs::path& file) {
  const std::string name = file.filename().string();
  return name.starts_with("decisions") && name.ends_with(".pb.zst");
}

Result<std::vector<fs::path>> DecisionFiles(const fs::path& run) {
  std::error_code error;
  if (fs::is_regular_file(run, error)) return std::vector{run};
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(run, error), end; !error && entry != end;
       entry.increment(error)) {
    if (IsDecisionFile(entry->path())) files.push_back(entry->path());
  }
  if (error) {
    return Fail(ErrorCode::kNotFound, fmt::format("{}: no run folder can be read here: {}",
                                                  run.string(), error.message()));
  }
  if (files.empty()) {
    return Fail(
        ErrorCode::kNotFound,
        fmt::format("{}: no decisions*.pb.zst in it: the run was made before decisions were "
                    "recorded, or its planner does not record them (planner.decision_file)",
                    run.string()));
  }
  std::sort(files.begin(), files.end());
  return files;
}

Error NothingFound(const fs::path& run, const DecisionQuery& query, const Extents& robots) {
  if (robots.empty()) {
    return {ErrorCode::kNotFound, fmt::format("{}: it holds no decision yet", run.string())};
  }
  std::vector<std::string> known;
  for (const auto& [robot, extent] : robots) {
    known.push_back(fmt::format("{} {}..{}", robot, extent.first, extent.last));
  }
  const std::string whose = query.robot.empty() ? "" : " of " + query.robot;
  const std::string what =
      query.snapshots_only   ? fmt::format("no decision{} that sent a picture", whose)
      : query.range.is_one() ? fmt::format("no decision {}{}", query.range.first, whose)
      : robots.contains(query.robot) || query.robot.empty()
          ? fmt::format("no such decisions{}", whose)
          : fmt::format("no robot {}", query.robot);
  return {ErrorCode::kNotFound,
          fmt::format("{}: {}; recorded: {}", run.string(), what, Join(known, ", "))};
}

class Collection {
 public:
  explicit Collection(const DecisionQuery& query) : query_(query) {}

  void Take(DecisionRecord&& decision) {
    const SearchReport& report = decision.report;
    Extent& extent = robots_[report.robot];
    extent.first = std::min(extent.first, report.decision);
    extent.last = std::max(extent.last, report.decision);
    if (!query_.robot.empty() && report.robot != query_.robot) return;
    if (!query_.range.Contains(report.decision)) return;
    if (query_.snapshots_only && !decision.sends_snapshot()) return;
    found_.list.push_back(Summarise(decision));
    ++found_.found;
    if (query_.range.is_one()) found_.one = std::move(decision);
  }
  void Note(std::string note) { found_.notes.push_back(std::move(note)); }

  Result<RunDecisions> Finish(const fs::path& run) {
    if (found_.found == 0) return tl::unexpected(NothingFound(run, query_, robots_));
    return std::move(found_);
  }

 private:
  const DecisionQuery& query_;
  Extents robots_;
  RunDecisions found_;
};

}  // namespace

std::string HeadingName(double heading_rad) {
  constexpr std::array kNames{"east", "north-east", "north", "north-west",
                              "west", "south-west", "south", "south-east"};
  constexpr double kEighth = std::numbers::pi / 4.0;
  const auto eighth = static_cast<int>(std::lround(heading_rad / kEighth));
  if (std::abs(WrapAngle(heading_rad - eighth * kEighth)) < kSameRad) {
    return kNames[static_cast<std::size_t>((eighth % 8 + 8) % 8)];
  }
  return fmt::format("{:.0f} degrees", heading_rad * 180.0 / std::numbers::pi);
}

std::string ActionName(const SearchAction& action, Cell robot) {
  if (action.kind == CommandKind::kTransmitView) {
    return fmt::format("picture to the {}", HeadingName(action.heading_rad));
  }
  if (action.kind == CommandKind::kDrive) return "low-level action";
  return fmt::format("move {}to {}", StepName(action.target - robot), action.target);
}

bool IsSameCommand(const SearchAction& a, const SearchAction& b) {
  if (a.kind != b.kind) return false;
  if (a.kind == CommandKind::kMove) return a.target == b.target;
  return std::abs(WrapAngle(a.heading_rad - b.heading_rad)) < kSameRad;
}

Result<DecisionRange> ParseDecisionRange(std::string_view text) {
  const std::size_t dots = text.find("..");
  DecisionRange range;
  const bool read = ReadNumber(text.substr(0, dots), range.first) &&
                    ReadNumber(dots == text.npos ? text : text.substr(dots + 2), range.last);
  if (read && range.first <= range.last) return range;
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("'{}' is neither a decision, 12, nor a range of them, 12..20", text));
}

NamedTerms Named(const RewardTerms& terms) {
  return {{{"goals", terms.goals},
           {"steps", terms.steps},
           {"progress", terms.progress},
           {"guidance", terms.guidance},
           {"smoothness", terms.smoothness},
           {"information", terms.information},
           {"communication", terms.communication}}};
}

std::vector<SearchAction> RankedActions(const SearchReport& report) {
  std::vector<SearchAction> actions = report.actions;
  std::stable_sort(actions.begin(), actions.end(), IsBetter);
  return actions;
}

const SearchAction* TakenAction(const DecisionRecord& decision) {
  for (const SearchAction& action : decision.report.actions) {
    if (IsSameCommand(action, decision.taken)) return &action;
  }
  return nullptr;
}

const SearchAction* RunnerUp(const DecisionRecord& decision) {
  return BestOf(decision.report,
                [&](const SearchAction& action) { return !IsSameCommand(action, decision.taken); });
}

double Margin(const DecisionRecord& decision) {
  const SearchAction* taken = TakenAction(decision);
  const SearchAction* other = RunnerUp(decision);
  if (taken == nullptr || other == nullptr) return 0.0;
  return taken->mean_value - other->mean_value;
}

std::vector<std::string> Why(const DecisionRecord& decision) {
  if (!decision.has_search()) return {NoSearch(decision)};
  const SearchAction* taken = TakenAction(decision);
  if (taken == nullptr) {
    return {
        fmt::format("The command, {}, is none of the search's actions: the method "
                    "decided otherwise.",
                    ActionName(decision.taken, decision.report.cell))};
  }
  return {Choice(decision, *taken), AgainstRunnerUp(decision, *taken),
          AboutSnapshots(decision, *taken)};
}

Result<RunDecisions> ReadRun(const fs::path& run, const DecisionQuery& query) {
  const auto files = DecisionFiles(run);
  if (!files) return tl::unexpected(files.error());
  Collection collection(query);
  for (const fs::path& file : *files) {
    const auto torn = ReadDecisions(
        file, [&](DecisionRecord&& decision) { collection.Take(std::move(decision)); });
    if (!torn) return tl::unexpected(torn.error());
    if (*torn) {
      collection.Note(
          fmt::format("{} ends inside of a decision: its planner was killed or is still running",
                      file.string()));
    }
  }
  return collection.Finish(run);
}

}  // namespace conav::planner
