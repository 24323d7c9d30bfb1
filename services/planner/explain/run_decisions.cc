#include "planner/explain/run_decisions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "planner/record/decision_file.h"

namespace conav::planner {
namespace {

namespace fs = std::filesystem;

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
      query.pictures_only    ? fmt::format("no decision{} that sent a picture", whose)
      : query.range.is_one() ? fmt::format("no decision {}{}", query.range.first, whose)
      : robots.contains(query.robot) || query.robot.empty()
          ? fmt::format("no such decisions{}", whose)
          : fmt::format("no robot {}", query.robot);
  return {ErrorCode::kNotFound,
          fmt::format("{}: {}; recorded: {}", run.string(), what, fmt::join(known, ", "))};
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
    if (query_.pictures_only && !decision.sends_picture()) return;
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
