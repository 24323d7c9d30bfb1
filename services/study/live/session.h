#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "common/runtime/threads.h"
#include "launcher/demo_options.h"
#include "operator/gateway/access.h"
#include "study/live/protocol.h"

/// Leads one participant through the steps of a plan, one after the other on one page.
namespace conav::live_study {

/// The options that the mapping task and a study share.
struct SessionOptions {
  std::string participant;  // a pseudonym
  int port = 8080;          // of the page; 0 = any free one
  std::string dds;          // empty = the bus's default
  std::optional<int> domain;
  std::filesystem::path out;
  /// As operator.console: for participants elsewhere. With another address than this machine's, or
  /// a public URL, pages need the tokens that the session prints.
  std::string address = "127.0.0.1";
  operators::ConsoleTls tls;
  bool insecure = false;
  std::string public_url;  // of a proxy or of this machine: "https://study.example.org"

  bool is_remote() const { return address != "127.0.0.1" || !public_url.empty(); }
};

void AddSessionOptions(CLI::App& app, SessionOptions& options);

/// Errors: names the option, its value and what is allowed.
[[nodiscard]] Result<void> Validate(const SessionOptions& options);

/// The launcher's options for a step; where it is no maze, those that all have.
launcher::DemoOptions DemoOf(const SessionOptions& options, const Step& step);

/// The files of a step:
///
///   NN-<step>/config/, logs/     of each process
///             operator.db        the person's map and requests
///             w1.checkpoint      where the robots are
///             result.json        once the step is finished
struct StepFolder {
  std::filesystem::path path;

  std::filesystem::path config(const std::string& service) const;
  std::filesystem::path log(const std::string& service) const;
  std::filesystem::path text_form() const { return path / "config/text.json"; }
  std::filesystem::path url() const { return path / "console.url"; }
  std::filesystem::path result() const { return path / "result.json"; }
};

/// The session's values for a step.
struct StepSetting {
  const ParticipantPlan& plan;
  const SessionOptions& options;
  const Step& step;
  StepFolder folder;
  std::filesystem::path participant_folder;
  std::filesystem::path forms;  // folder with the forms
  int domain = 0;
  int port = 0;
  std::filesystem::path token_file;  // empty = no tokens
  std::vector<double> earlier;       // mapping accuracies of earlier mazes
  std::string completion_code;       // of the last page
};

/// A service with its complete configuration.
struct PlannedService {
  std::string name;
  std::string config;  // YAML document
};

/// The services of a step in the order in which they start.
std::vector<PlannedService> PlanStep(const StepSetting& setting);

enum class StepEnd { kFinished, kInterrupted, kFailed };
using OpenListener = std::function<void(const std::string& url)>;
/// The step's result is there; its services may go on for a while.
using FinishListener = std::function<void()>;
using EventListener =
    std::function<void(const std::string& event, const nlohmann::ordered_json& more)>;

/// Runs the services of a step until its result is there, and starts those that die again. Tells
/// `opened` the address of the page, which becomes `setting.port`, and `report` what else happens.
/// All services have ended on return; unless the step is finished, the simulator keeps its
/// checkpoint. Throws StartupError if a service cannot start or a file cannot be written.
StepEnd RunStep(StepSetting& setting, const OpenListener& opened, const FinishListener& finished,
                const EventListener& report, const StopToken& stop);

/// Prints a line at once.
void Say(const std::string& line);

/// The result of a step as its operator service wrote it. Empty if the file does not exist yet.
/// Errors: kIo; kMalformed names the file.
[[nodiscard]] Result<std::optional<nlohmann::ordered_json>> ReadStepResult(
    const std::filesystem::path& file);

/// How far a participant is.
struct Progress {
  /// By index of the plan's steps; those that were left out have none.
  std::map<std::size_t, nlohmann::ordered_json> results;

  bool aborted() const;
  /// The step to do next; empty = all are done. After an abort only the last page follows, and a
  /// training maze is repeated only while its criterion is not reached.
  std::optional<std::size_t> Next(const ParticipantPlan& plan) const;
};

/// result.json of a participant: the results of the finished steps in their order, and, of the
/// mapping task, how many mazes are good enough to keep.
nlohmann::ordered_json ResultJson(const ParticipantPlan& plan, const Progress& progress,
                                  const std::string& completion_code);

/// A line for the terminal.
std::string ResultLine(const Step& step, const nlohmann::ordered_json& result);

/// The folder of step `index`: "03-training".
std::string FolderName(const ParticipantPlan& plan, std::size_t index);

/// What belongs to a study and not to one participant.
struct StudyFacts {
  std::filesystem::path folder;  // with the forms, and the secret of codes and tokens
  std::string completion_code;   // as Protocol
};

/// Leads the participant through the steps that are left, in `folder`:
///
///   participant.json  the design (DesignOf) and when it started
///   log.jsonl         what happened when
///   result.json       after each step (ResultJson)
///   segments.pb.zst   training data for perception models, with pictures/
///   NN-<step>/        see StepFolder
///
/// A service that dies is started again; a session that was interrupted or killed goes on in the
/// step where it was, with the same map, answers and robots. Returns the exit code; prints errors on
/// standard error.
int RunSession(const std::string& program, const ParticipantPlan& plan,
               const SessionOptions& options, const std::filesystem::path& folder,
               const StudyFacts& facts);

/// Runs `command`; what it throws becomes an exit code and a line on standard error.
int RunGuarded(const std::string& program, const std::function<int()>& command);

}  // namespace conav::live_study
