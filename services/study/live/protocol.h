#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/msg/method.h"
#include "common/runtime/config.h"
#include "common/runtime/result.h"

/// What a study with people consists of, as a researcher writes it down (docs/study-protocol.md), and what one
/// participant goes through.
namespace conav::live_study {

/// What a maze is and how it is played. Keys of `maze:` of a protocol, for all of its mazes, and of
/// each part that has mazes.
struct MazeOptions {
  std::string preset = "conav13";
  int robots = 1;
  std::string camera = "egl";  // or "none"
  double speed = 2.0;          // simulation time over wall time
  double time_limit_s = 0.0;   // wall time since "Begin" without pauses; 0 = none
  bool feedback = true;        // goals left and the like while the maze runs
  bool show_scores = false;    // how well the participant corrected their maps

  void Visit(ConfigReader& reader);
};

/// A training maze is repeated, each time another one, until the mapping accuracy is reached.
struct Criterion {
  int attempts = 1;
  double mapping_accuracy = 0.0;

  void Visit(ConfigReader& reader) {
    reader.Field("attempts", attempts, 1, 20);
    reader.Field("mapping_accuracy", mapping_accuracy, 0.0, 1.0);
  }
};

/// One entry of `parts:`.
struct Part {
  enum class Kind {
    kForm,     // questions and texts of a SurveyJS file
    kText,     // a page with a text
    kRest,     // a calm screen for some time
    kMaze,     // one maze with one method, as for training
    kMethods,  // one method after the other in the participant's order
  };

  Kind kind = Kind::kForm;
  std::string where;  // in the file, for messages: "study.yaml: parts[2]"
  std::string id;     // unique; of methods the names of the methods
  std::string title;  // of methods with {part} and {parts}
  std::string form;   // of kForm, as written
  std::string text;   // of kText, kRest
  double rest_s = 60.0;
  MethodKind method = MethodKind::kIgMcts;  // of kMaze
  bool training = false;
  Criterion criterion;
  /// Seeds of the mazes: of kMaze one for each attempt, of kMethods those that are shared out.
  /// Empty = drawn for each participant.
  std::vector<std::uint64_t> layouts;
  int rotation_deg = 0;  // of kMaze
  std::vector<MethodKind> methods;
  int mazes_per_method = 1;
  bool repeat_layouts = false;  // each method gets all layouts, turned another way each time
  std::map<std::string, std::string> introductions;  // by method
  MazeOptions maze;
  std::vector<Part> before;  // of each method; forms, texts and rests
  std::vector<Part> after;

  bool is_page() const { return kind == Kind::kForm || kind == Kind::kText; }
  void Visit(ConfigReader& reader);
};

/// Section `eye_tracker:`. No address: there is none.
struct EyeTrackerOptions {
  std::string address;  // Pupil Remote: "tcp://127.0.0.1:50020"
  bool tags = false;    // AprilTags at the edges of the participant's page

  void Visit(ConfigReader& reader) {
    reader.Field("address", address);
    reader.Field("tags", tags);
  }
};

struct Protocol {
  std::filesystem::path file;
  std::string name = "study";  // of the folder: runs/study-NAME
  std::string language = "en";
  std::string words;       // file below forms/: the page's texts in that language; empty = English
  std::uint64_t seed = 1;  // of all that is drawn
  /// The last page shows it: "random" = another one for each participant, else this text; empty =
  /// none.
  std::string completion_code;
  bool experimenter = true;  // a second page may pause, abort, write notes
  EyeTrackerOptions eye_tracker;
  MazeOptions maze;
  std::vector<Part> parts;
  nlohmann::ordered_json document;           // the file, each value as its text
  std::map<std::string, std::string> forms;  // what each form that is named holds, and `words`

  void Visit(ConfigReader& reader);
};

/// Whether the text is 1 to 40 of A-Z a-z 0-9 and `more`.
bool IsCode(const std::string& text, const std::string& more);

/// The protocol that comes with conav.
std::filesystem::path ShippedProtocol();

/// Reads a protocol and its forms: a form is named relative to the file, or is one of those that
/// come with conav. Throws StartupError with file, line, key and value.
Protocol ReadProtocol(const std::filesystem::path& file);

/// What its forms leave for the researcher to fill, as those that come with conav do, with the form:
/// "forms/consent.json: [ethics board, number]".
std::vector<std::string> GapsOf(const Protocol& protocol);

/// Keeps the protocol and its forms in the folder of a study: `protocol.yaml` and the forms under
/// their names. Errors: kRefused: another protocol is there, the first difference is named; kIo.
[[nodiscard]] Result<void> KeepProtocol(const Protocol& protocol,
                                        const std::filesystem::path& folder);

/// SHA-256 of the protocol and its forms.
std::string FingerprintOf(const Protocol& protocol);

/// A text as a SurveyJS form: paragraphs are separated by empty lines.
std::string TextForm(const std::string& title, const std::string& text);

/// One run of the services: a page, a rest or a maze.
struct Step {
  std::string id;     // unique: "consent", "ig-mcts", "ig-mcts-nasa-tlx", "training-2"
  std::string title;  // for the participant
  Part::Kind kind = Part::Kind::kForm;
  std::string form;  // as Part
  std::string text;
  double rest_s = 0.0;
  std::optional<MethodKind> method;  // of a maze, and of the pages before and after it
  // Of a maze:
  MazeOptions maze;
  std::uint64_t seed = 0;
  int rotation_deg = 0;
  bool training = false;
  Criterion criterion;
  int attempt = 1;
  /// Which of the steps, for the participant; attempts share a number.
  int number = 1;
  int part = 0;  // which of the methods, from 1; 0 = none

  bool is_page() const { return kind == Part::Kind::kForm || kind == Part::Kind::kText; }
  bool is_maze() const { return kind == Part::Kind::kMaze; }
};

struct ParticipantPlan {
  std::string participant;
  std::string protocol;  // its name; empty = the mapping task
  std::string fingerprint;
  std::string language = "en";
  std::string words;  // as Protocol
  bool experimenter = true;
  EyeTrackerOptions eye_tracker;
  int order = 0;  // row of the Williams design, from 1; 0 = no methods
  std::vector<Step> steps;

  int count() const { return steps.empty() ? 0 : steps.back().number; }
};

/// A number for a participant: 0 for "P01", "1"; one less than the digits at the end of the code, or
/// drawn from a code without.
std::uint64_t NumberOf(const std::string& participant);

/// Expands the protocol. Participants of consecutive numbers get the rows of the Williams design in
/// turn, and over all rows and layouts each method has each layout equally often. With `order` = 1,
/// 2, ... that row. No two mazes of a participant have the same layout, in whatever rotation; in a
/// part with `repeat_layouts` they differ by the rotation. Drawn layouts are drawn again, given ones
/// are refused. Errors: kInvalidArgument, kOutOfRange with the part, its value and the reason.
[[nodiscard]] Result<ParticipantPlan> PlanParticipant(const Protocol& protocol,
                                                      const std::string& participant, int order);

/// Mazes of the mapping task (paper, Appendix A).
struct MappingOptions {
  std::string participant;
  int mazes = 3;
  std::vector<std::uint64_t> layouts;  // one for each maze; empty = drawn by `seed` and participant
  std::uint64_t seed = 1;
  MazeOptions maze{.speed = 6.0, .show_scores = true};
};

/// Errors: as PlanParticipant, with the option.
[[nodiscard]] Result<ParticipantPlan> PlanMappingTask(const MappingOptions& options);

/// As operator.task.kind: "form", "rest", "mapping" or "study".
std::string_view KindName(const Step& step);

/// What of a maze goes into its results: layout, rotation, seed, training, robots, preset.
nlohmann::ordered_json MazeFacts(const Step& step);

/// participant.json: all that the results depend on.
nlohmann::ordered_json DesignOf(const ParticipantPlan& plan);

/// The steps, a line each, for the researcher.
std::string Describe(const ParticipantPlan& plan);

}  // namespace conav::live_study
