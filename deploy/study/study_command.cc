#include "study/study_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/console/console.h"
#include "common/runtime/json.h"
#include "common/runtime/random.h"
#include "launcher/demo_weights.h"
#include "study/episode_player.h"
#include "study/people.h"
#include "study/report.h"
#include "study/study_console.h"
#include "study/study_folder.h"
#include "study/study_run.h"

namespace conav::study {
namespace {

constexpr const char* kProgram = "conav study";

/// Purpose for DeriveSeed.
constexpr std::uint64_t kPeopleSeed = 4;

/// A study before its first episode.
struct Plan {
  Design design;
  std::vector<std::string> people;  // YAML, as design.subjects
  nlohmann::ordered_json document;
};

std::vector<std::string> DrawPeople(const StudyOptions& options, std::size_t count) {
  const auto population =
      options.population.empty() ? DefaultPopulation() : nhpm::ReadPopulation(options.population);
  const std::uint64_t seed = DeriveSeed(options.design.seed, kPeopleSeed);
  std::vector<std::string> people;
  for (std::size_t subject = 0; subject < count; ++subject) {
    people.push_back(PersonYaml(DrawPerson(population, DeriveSeed(seed, subject))));
  }
  return people;
}

nlohmann::ordered_json EpisodesJson(const Design& design) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const PlannedEpisode& episode : design.episodes) {
    list.push_back({{"name", episode.name}, {"seed", episode.seed}});
  }
  return list;
}

/// Everything that results depend on, but the program itself.
Plan MakePlan(const StudyOptions& options) {
  Plan plan{.design = MakeDesign(options.design)};
  plan.people = DrawPeople(options, plan.design.subjects.size());
  plan.document = {{"operators", options.design.operators},
                   {"layouts", plan.design.layouts},
                   {"methods", plan.design.methods},
                   {"seed", options.design.seed},
                   {"robots", options.robots},
                   {"camera", options.camera},
                   {"dds", options.dds},
                   {"weights_checksum", launcher::WeightsChecksum(BaseDemo(options))},
                   {"time_limit_s", options.time_limit_s},
                   {"orders", plan.design.orders},
                   {"episodes", EpisodesJson(plan.design)},
                   {"people", plan.people}};
  return plan;
}

Result<void> WritePeople(const Plan& plan, const StudyFolder& folder) {
  for (std::size_t subject = 0; subject < plan.people.size(); ++subject) {
    const auto file =
        std::filesystem::relative(folder.person(plan.design.subjects[subject]), folder.path());
    if (auto written = folder.Write(file, plan.people[subject]); !written) return written;
  }
  return {};
}

Result<void> Play(const StudyOptions& options, const Plan& plan, const StudyFolder& folder,
                  EpisodeStore& store, const StopToken& stop) {
  const SteadyClock clock;
  const auto programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  std::vector<std::unique_ptr<DemoPlayer>> players;
  for (int job = 0; job < options.jobs; ++job) {
    players.push_back(std::make_unique<DemoPlayer>(programs, clock, stop));
  }
  const launcher::DemoOptions base = BaseDemo(options);
  const EpisodePlayer play = [&](int job, const PlannedEpisode& episode) {
    const std::string& subject = plan.design.subjects[static_cast<std::size_t>(episode.subject)];
    return players[static_cast<std::size_t>(job)]->Play(DemoFor(base, episode, subject, folder));
  };
  ProgressLine line;
  return RunEpisodes(plan.design.episodes, options.jobs, play, store, stop,
                     ShowOn(line, "episodes"));
}

Result<void> WriteReports(const StudyReport& report, const StudyFolder& folder,
                          const std::filesystem::path& json_file) {
  const auto json = StudyJson(report);
  auto written = folder.Write("episodes.csv", EpisodesCsv(report))
                     .and_then([&] { return folder.Write("report.html", StudyPage(report)); })
                     .and_then([&] { return folder.Write("results.json", JsonText(json)); });
  for (std::size_t m = 0; written && m < Measures().size(); ++m) {
    if (!WasMeasured(report, Measures()[m])) continue;
    written =
        folder.Write(std::filesystem::path("measures") / fmt::format("{}.csv", Measures()[m].key),
                     report.summary.analyses[m].csv);
  }
  return written ? WriteJsonOutput(json_file, json) : written;
}

Result<void> Tell(const StudyReport& report, const StudyFolder& folder,
                  const std::filesystem::path& json_file) {
  if (auto written = WriteReports(report, folder, json_file); !written) return written;
  const std::string text =
      fmt::format("{}\n{} holds report.html, episodes.csv, measures/, results.json and all runs\n",
                  StudyText(report), folder.path().string());
  return PrintTables(text, json_file);
}

bool AllMet(const StudySummary& summary) {
  return std::all_of(summary.bars.begin(), summary.bars.end(),
                     [](const Bar& bar) { return bar.met(); });
}

int Run(StudyOptions options, const Provenance& provenance, const StopToken& stop) {
  const Plan plan = MakePlan(options);
  if (options.out.empty()) options.out = DefaultOut(options, Fingerprint(plan.document));
  const auto folder = StudyFolder::Open(std::filesystem::absolute(options.out), plan.document);
  if (!folder) return RefusedFolder(kProgram, folder.error());
  auto store = OpenEpisodes(*folder);
  if (!store) return Failed(kProgram, store.error());
  const auto played = WritePeople(plan, *folder).and_then([&] {
    return Play(options, plan, *folder, *store, stop);
  });
  if (!played) return Failed(kProgram, played.error());
  if (stop.stop_requested()) {
    return Interrupted(kProgram, store->records().size(), plan.design.episodes.size(), "episodes",
                       *folder);
  }
  const StudySummary summary = Summarise(plan.design, store->records());
  const StudyReport report{
      plan.design, plan.document, store->records(), summary, options.camera != "none", provenance};
  if (const auto told = Tell(report, *folder, options.json); !told) {
    return Failed(kProgram, told.error());
  }
  return summary.failed.empty() && (!options.check || AllMet(summary)) ? 0 : 1;
}

}  // namespace

int RunStudy(const StudyOptions& options, const Provenance& provenance, const StopToken& stop) {
  if (const auto valid = Validate(options); !valid) return Refused(kProgram, valid.error().text);
  const int code =
      CheckFiles(kProgram, {{"--population", options.population}, {"--weights", options.weights}},
                 {{"--json", options.json}});
  if (code != 0) return code;
  try {
    return Run(options, provenance, stop);
  } catch (const StartupError& error) {
    return Failed(kProgram, {ErrorCode::kInvalidArgument, error.what()});
  }
}

}  // namespace conav::study
