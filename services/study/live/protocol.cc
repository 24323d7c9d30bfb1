#include "study/live/protocol.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>

#include "common/plot/svg.h"
#include "common/runtime/file.h"
#include "common/runtime/text.h"
#include "operator/console/participant_task.h"
#include "study/design.h"
#include "study/record_store.h"

namespace conav::live_study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kShipped = "config";
constexpr const char* kCopy = "protocol.yaml";
constexpr int kMostRobots = 32;
constexpr double kDayS = 86400.0;

struct KindKey {
  const char* key;
  Part::Kind kind;
};
/// `text` last: a rest may have one, too.
constexpr std::array kKindKeys{
    KindKey{"form", Part::Kind::kForm}, KindKey{"rest", Part::Kind::kRest},
    KindKey{"maze", Part::Kind::kMaze}, KindKey{"methods", Part::Kind::kMethods},
    KindKey{"text", Part::Kind::kText}};

int LineIn(const YAML::Node& node) { return node.Mark().line + 1; }

Part::Kind KindOf(const YAML::Node& node, const std::string& where) {
  for (const auto& [key, kind] : kKindKeys) {
    if (node.IsMap() && node[key]) return kind;
  }
  throw StartupError(fmt::format("{}: has none of form, text, rest, maze, methods (line {})", where,
                                 LineIn(node)));
}

/// A list of parts; `inside`: of `before` or `after`.
std::vector<Part> ReadParts(const YAML::Node& list, const std::string& where,
                            const MazeOptions& maze, bool inside) {
  std::vector<Part> parts;
  if (!list || list.IsNull()) return parts;
  if (!list.IsSequence()) {
    throw StartupError(fmt::format("{}: is not a list (line {})", where, LineIn(list)));
  }
  for (const YAML::Node& node : list) {
    Part part;
    part.where = fmt::format("{}[{}]", where, parts.size() + 1);
    part.kind = KindOf(node, part.where);
    part.maze = maze;
    ReadConfig(node, part.where, part);
    const bool has_mazes = part.kind == Part::Kind::kMaze || part.kind == Part::Kind::kMethods;
    if (inside && has_mazes) {
      throw StartupError(fmt::format("{}: only forms, texts and rests may be here (line {})",
                                     part.where, LineIn(node)));
    }
    part.before = ReadParts(node["before"], part.where + ".before", maze, true);
    part.after = ReadParts(node["after"], part.where + ".after", maze, true);
    parts.push_back(std::move(part));
  }
  return parts;
}

/// A value as its text, so that two files are alike if they say the same.
nlohmann::ordered_json Plain(const YAML::Node& node) {
  if (node.IsMap()) {
    auto json = nlohmann::ordered_json::object();
    for (const auto& entry : node) json[YAML::Dump(entry.first)] = Plain(entry.second);
    return json;
  }
  if (node.IsSequence()) {
    auto json = nlohmann::ordered_json::array();
    for (const YAML::Node& entry : node) json.push_back(Plain(entry));
    return json;
  }
  return node.IsScalar() ? nlohmann::ordered_json(node.Scalar()) : nullptr;
}

fs::path FormFile(const fs::path& folder, const std::string& form) {
  std::error_code ignored;
  const fs::path own = folder / form;
  return fs::exists(own, ignored) ? own : ShippedFile(fs::path(kShipped) / form);
}

/// `key`: of the file that names it.
const std::string& ReadForm(Protocol& protocol, const std::string& key, const std::string& form) {
  const fs::path name(form);
  const bool leaves = *name.begin() != "forms" || std::ranges::find(name, "..") != name.end();
  if (leaves) {
    throw StartupError(fmt::format("{} = {}: is not below forms/ next to the protocol", key, form));
  }
  auto text = ReadFile(FormFile(protocol.file.parent_path(), form));
  if (!text) {
    throw StartupError(
        fmt::format("{} = {}: is no file next to the protocol, and none of conav's forms ({})", key,
                    form, text.error().text));
  }
  if (!nlohmann::json::parse(*text, nullptr, false).is_object()) {
    throw StartupError(fmt::format("{} = {}: is not a form in JSON (SurveyJS)", key, form));
  }
  return protocol.forms[form] = *std::move(text);
}

void ReadWords(Protocol& protocol) {
  if (protocol.words.empty()) return;
  const std::string key = protocol.file.string() + ": protocol.words";
  const auto words = operators::ParsePageWords(ReadForm(protocol, key, protocol.words));
  if (words) return;
  throw StartupError(fmt::format("{} = {}: {}", key, protocol.words, words.error().text));
}

void ReadForms(Protocol& protocol, const std::vector<Part>& parts) {
  for (const Part& part : parts) {
    if (part.kind == Part::Kind::kForm) ReadForm(protocol, part.where + ".form", part.form);
    ReadForms(protocol, part.before);
    ReadForms(protocol, part.after);
  }
}

}  // namespace

void MazeOptions::Visit(ConfigReader& reader) {
  reader.Field("preset", preset);
  reader.Field("robots", robots, 1, kMostRobots);
  reader.Choice("camera", camera, {"egl", "none"});
  reader.Field("speed", speed, 0.01, 1000.0);
  reader.Field("time_limit_s", time_limit_s, 0.0, kDayS);
  reader.Field("feedback", feedback);
  reader.Field("show_scores", show_scores);
}

namespace {

void VisitMethods(ConfigReader& reader, Part& part) {
  std::vector<std::string> names;
  reader.Field("methods", names);
  const auto methods = study::ParseMethods(names, study::kStudyMethods);
  if (reader.reading() && !methods) reader.Refuse("methods", "is wrong: " + methods.error().text);
  if (methods) part.methods = *methods;
  reader.Field("mazes_per_method", part.mazes_per_method, 1, 20);
  reader.Field("repeat_layouts", part.repeat_layouts);
  reader.Field("introductions", part.introductions);
  for (const auto& [name, text] : part.introductions) {
    const auto method = ParseMethod(name);
    if (!method || std::ranges::find(part.methods, *method) == part.methods.end()) {
      reader.Refuse("introductions", fmt::format("has {}, which is none of the methods", name));
    }
  }
  // ReadParts reads them.
  YAML::Node before;  // not one node for both: assigning to a node changes what it stands for
  YAML::Node after;
  reader.Field("before", before);
  reader.Field("after", after);
  const std::size_t needed =
      part.repeat_layouts ? static_cast<std::size_t>(part.mazes_per_method)
                          : part.methods.size() * static_cast<std::size_t>(part.mazes_per_method);
  if (!part.layouts.empty() && part.layouts.size() < needed) {
    reader.Refuse("layouts", fmt::format("are fewer than the {} mazes of a participant", needed));
  }
  if (part.repeat_layouts && part.layouts.empty()) {
    reader.Refuse("repeat_layouts", "needs layouts");
  }
  if (part.repeat_layouts && part.methods.size() > study::kOrientations) {
    reader.Refuse("repeat_layouts", "has more methods than a maze has orientations");
  }
}

void VisitMaze(ConfigReader& reader, Part& part) {
  reader.Choice("maze", part.method, study::kStudyMethods);
  reader.Field("training", part.training);
  if (part.training) {
    reader.Section("criterion", part.criterion);
    part.id = "training";
  }
  reader.Field("text", part.text);
  reader.Field("rotation_deg", part.rotation_deg, 0, 270);
  if (part.rotation_deg % 90 != 0) reader.Refuse("rotation_deg", "is not 0, 90, 180 or 270");
  const auto attempts = static_cast<std::size_t>(part.criterion.attempts);
  if (!part.layouts.empty() && part.layouts.size() < attempts) {
    reader.Refuse("layouts", fmt::format("are fewer than the {} attempts", attempts));
  }
}

}  // namespace

void Part::Visit(ConfigReader& reader) {
  const bool has_mazes = kind == Kind::kMaze || kind == Kind::kMethods;
  if (has_mazes) {
    maze.Visit(reader);
    reader.Field("layouts", layouts);
  }
  switch (kind) {
    case Kind::kForm:
      reader.Field("form", form);
      id = fs::path(form).stem();
      break;
    case Kind::kText:
      reader.Field("text", text);
      id = "text";
      break;
    case Kind::kRest:
      reader.Field("rest", rest_s, 0.1, kDayS);
      reader.Field("text", text);
      id = "rest";
      break;
    case Kind::kMaze:
      id = "maze";
      VisitMaze(reader, *this);
      break;
    case Kind::kMethods:
      title = "Part {part} of {parts}";
      VisitMethods(reader, *this);
      break;
  }
  reader.Field("title", title);
  if (kind == Kind::kMethods) return;
  reader.Field("id", id);
  if (!IsCode(id, "-"))
    reader.Refuse("id", fmt::format("'{}' is not 1 to 40 of A-Z a-z 0-9 -", id));
}

void Protocol::Visit(ConfigReader& reader) {
  reader.Field("name", name);
  if (!IsCode(name, "-_")) reader.Refuse("name", "is not 1 to 40 of A-Z a-z 0-9 _ -");
  reader.Field("language", language);
  if (!IsCode(language, "-")) reader.Refuse("language", "is no language such as en or de");
  reader.Field("words", words);
  reader.Field("seed", seed);
  reader.Field("completion_code", completion_code);
  reader.Field("experimenter", experimenter);
  reader.Section("eye_tracker", eye_tracker);
  reader.Section("maze", maze);
  // ReadParts reads them.
  YAML::Node list;
  reader.Field("parts", list);
}

bool IsCode(const std::string& text, const std::string& more) {
  constexpr std::size_t kLongest = 40;
  const auto is_good = [&](char letter) {
    return (letter >= 'A' && letter <= 'Z') || (letter >= 'a' && letter <= 'z') ||
           (letter >= '0' && letter <= '9') || more.find(letter) != std::string::npos;
  };
  return !text.empty() && text.size() <= kLongest && std::ranges::all_of(text, is_good);
}

std::filesystem::path ShippedProtocol() { return ShippedFile("config/study.yaml"); }

Protocol ReadProtocol(const std::filesystem::path& file) {
  const auto document = ReadYamlFile(file);
  if (!document) throw StartupError(document.error().text);
  Protocol protocol;
  protocol.file = file;
  ReadConfig(*document, file.string() + ": protocol", protocol);
  protocol.document = Plain(*document);
  protocol.parts = ReadParts((*document)["parts"], file.string() + ": parts", protocol.maze, false);
  if (protocol.parts.empty()) throw StartupError(file.string() + ": parts: there are none");
  if (!protocol.completion_code.empty() && !protocol.parts.back().is_page()) {
    throw StartupError(
        file.string() +
        ": protocol.completion_code: the last part is no form or text that shows it");
  }
  ReadForms(protocol, protocol.parts);
  ReadWords(protocol);
  return protocol;
}

namespace {

/// "[ethics board, number]": what begins with a small letter.
std::vector<std::string> BracketsOf(const std::string& text) {
  std::vector<std::string> brackets;
  for (auto open = text.find('['); open != text.npos; open = text.find('[', open + 1)) {
    const auto close = text.find(']', open);
    const bool is_gap = std::islower(static_cast<unsigned char>(text[open + 1])) != 0;
    if (is_gap && close != text.npos) brackets.push_back(text.substr(open, close + 1 - open));
  }
  return brackets;
}

}  // namespace

std::vector<std::string> GapsOf(const Protocol& protocol) {
  std::vector<std::string> gaps;
  for (const auto& [name, text] : protocol.forms) {
    const auto form = nlohmann::json::parse(text).flatten();
    for (const auto& value : form) {
      if (!value.is_string()) continue;
      for (const std::string& gap : BracketsOf(value.get<std::string>())) {
        gaps.push_back(fmt::format("{}: {}", name, gap));
      }
    }
  }
  return gaps;
}

Result<void> KeepProtocol(const Protocol& protocol, const std::filesystem::path& folder) {
  std::error_code ignored;
  if (fs::exists(folder / kCopy, ignored)) {
    const auto there = ReadYamlFile(folder / kCopy);
    if (!there) return tl::unexpected(there.error());
    std::string difference = study::Difference(Plain(*there), protocol.document);
    for (const auto& [name, text] : protocol.forms) {
      const bool same = ReadFile(folder / name).value_or("") == text;
      if (difference.empty() && !same) difference = name + " has other questions there";
    }
    if (difference.empty()) return {};
    return Fail(ErrorCode::kRefused,
                fmt::format("{} belongs to another protocol: {}; choose another name or --out",
                            folder.string(), difference));
  }
  for (const auto& [name, text] : protocol.forms) {
    std::error_code error;
    fs::create_directories((folder / name).parent_path(), error);
    if (auto written = WriteFile(folder / name, text); !written) return written;
  }
  return ReadFile(protocol.file).and_then([&](const std::string& text) {
    return WriteFile(folder / kCopy, text);  // last: a folder with it is complete
  });
}

std::string FingerprintOf(const Protocol& protocol) {
  nlohmann::ordered_json all = protocol.document;
  all["forms"] = protocol.forms;
  // The order of keys says nothing: nlohmann::json sorts them.
  return study::Fingerprint(nlohmann::json::parse(all.dump()));
}

std::string TextForm(const std::string& title, const std::string& text) {
  std::string html;
  std::string paragraph;
  const auto end_paragraph = [&] {
    if (!paragraph.empty()) html += "<p>" + EscapeXml(paragraph) + "</p>";
    paragraph.clear();
  };
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) {
      end_paragraph();
    } else {
      paragraph += (paragraph.empty() ? "" : "\n") + line;
    }
  }
  end_paragraph();
  nlohmann::ordered_json form;
  if (!title.empty()) form["title"] = title;
  const nlohmann::ordered_json element{{"type", "html"}, {"name", "text"}, {"html", html}};
  form["elements"] = nlohmann::ordered_json::array();
  form["elements"].push_back(element);
  return JsonText(form);
}

}  // namespace conav::live_study
