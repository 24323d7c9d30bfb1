#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "common/runtime/random.h"
#include "common/runtime/text.h"
#include "launcher/demo_plan.h"
#include "study/design.h"
#include "study/live/protocol.h"

namespace conav::live_study {
namespace {

constexpr std::uint64_t kSeedRange = 1'000'000'000;  // people can read these seeds out
constexpr int kMostDraws = 1000;
constexpr int kMostMazes = 100;

std::uint64_t HashOf(const std::string& participant) {
  return std::stoull(Sha256Hex(participant).substr(0, 16), nullptr, 16);
}

/// A maze of the participant, to compare others with.
struct UsedMaze {
  std::string layout;  // the same for all rotations
  int rotation_deg = 0;
  const Part* part = nullptr;
};

/// Builds the maze as its simulator will. Errors: those of the launcher.
Result<std::string> LayoutOf(const MazeOptions& maze, std::uint64_t seed) {
  launcher::DemoOptions demo;
  demo.seed = seed;
  demo.preset = maze.preset;
  demo.robots = maze.robots;
  if (auto ok = launcher::CheckWorlds(demo); !ok) return tl::unexpected(ok.error());
  std::string layout;
  for (int quarter = 0; quarter < study::kOrientations; ++quarter) {
    demo.rotation_deg = 90 * quarter;
    const auto spec = sim::MakeWorldSpec(launcher::WorldOptionsOf(demo, 0));
    if (!spec) return tl::unexpected(spec.error());
    std::string cells = fmt::format("{} ", spec->truth.columns());
    for (const Occupancy cell : spec->truth.values()) {
      cells += cell == Occupancy::kOccupied ? '#' : '.';
    }
    layout = quarter == 0 ? cells : std::min(layout, cells);
  }
  return layout;
}

/// The mazes of one participant, all different.
class MazeDraw {
 public:
  MazeDraw(std::uint64_t seed, const std::string& participant)
      : seed_(DeriveSeed(seed, HashOf(participant))) {}

  /// Takes the maze of `step`, which the researcher named. Errors: kInvalidArgument: an earlier one
  /// is the same; those of LayoutOf.
  Result<void> Take(const Part& part, const Step& step) {
    auto layout = LayoutOf(step.maze, step.seed);
    if (!layout) return Fail(layout.error().code, part.where + ": " + layout.error().text);
    if (Has(*layout, step.rotation_deg, part)) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}.layouts: maze {} is the same as another one of the participant",
                              part.where, step.seed));
    }
    used_.push_back({*std::move(layout), step.rotation_deg, &part});
    return {};
  }
  /// Draws the maze of `step`.
  Result<void> Draw(const Part& part, Step& step) {
    for (int draw = 0; draw < kMostDraws; ++draw) {
      step.seed = DeriveSeed(seed_, next_++) % kSeedRange;
      auto layout = LayoutOf(step.maze, step.seed);
      if (!layout) return Fail(layout.error().code, part.where + ": " + layout.error().text);
      if (Has(*layout, step.rotation_deg, part)) continue;
      used_.push_back({*std::move(layout), step.rotation_deg, &part});
      return {};
    }
    return Fail(
        ErrorCode::kInvalidArgument,
        part.where + ": there are not so many different mazes of preset " + step.maze.preset);
  }

 private:
  bool Has(const std::string& layout, int rotation_deg, const Part& part) const {
    return std::ranges::any_of(used_, [&](const UsedMaze& used) {
      const bool repeats = part.repeat_layouts && used.part == &part;
      return used.layout == layout && !(repeats && used.rotation_deg != rotation_deg);
    });
  }

  std::uint64_t seed_;
  std::uint64_t next_ = 0;
  std::vector<UsedMaze> used_;
};

void Replace(std::string& text, const std::string& what, const std::string& with) {
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size())) {
    text.replace(at, what.size(), with);
  }
}

/// Expands the parts of a protocol in their order.
class Expansion {
 public:
  Expansion(const Protocol& protocol, const std::string& participant, int order)
      : protocol_(protocol), number_(NumberOf(participant)), order_(order) {
    plan_.participant = participant;
    plan_.protocol = protocol.name;
    plan_.fingerprint = FingerprintOf(protocol);
    plan_.language = protocol.language;
    plan_.words = protocol.words;
    plan_.experimenter = protocol.experimenter;
    plan_.eye_tracker = protocol.eye_tracker;
  }

  Result<ParticipantPlan> Run() {
    for (const Part& part : protocol_.parts) {
      const auto added = part.kind == Part::Kind::kMethods ? AddMethods(part) : AddPart(part);
      if (!added) return tl::unexpected(added.error());
    }
    return ChooseMazes().map([this] { return std::move(plan_); });
  }

 private:
  struct Choice {
    std::size_t step;  // in the plan
    const Part* part;
  };

  Result<void> Add(Step step, const Part& part) {
    if (!ids_.insert(step.id).second) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: there is another step '{}'; give one of them an id", part.where,
                              step.id));
    }
    if (step.attempt == 1) ++last_number_;
    step.number = last_number_;
    if (step.is_maze()) mazes_.push_back({plan_.steps.size(), &part});
    plan_.steps.push_back(std::move(step));
    return {};
  }

  Result<void> AddPart(const Part& part) {
    Step step{.id = part.id, .title = part.title, .kind = part.kind, .form = part.form};
    step.text = part.text;
    step.rest_s = part.rest_s;
    if (part.kind != Part::Kind::kMaze) return Add(std::move(step), part);
    step.method = part.method;
    step.maze = part.maze;
    step.training = part.training;
    step.criterion = part.criterion;
    step.rotation_deg = part.rotation_deg;
    for (int attempt = 1; attempt <= part.criterion.attempts; ++attempt) {
      step.id = attempt == 1 ? part.id : fmt::format("{}-{}", part.id, attempt);
      step.attempt = attempt;
      const auto index = static_cast<std::size_t>(attempt) - 1;
      if (!part.layouts.empty()) step.seed = part.layouts[index];
      if (auto added = Add(step, part); !added) return added;
    }
    return {};
  }

  Result<void> AddPages(const std::vector<Part>& pages, MethodKind method, int part) {
    for (const Part& page : pages) {
      Step step{.id = fmt::format("{}-{}", Name(method), page.id),
                .title = page.title,
                .kind = page.kind,
                .form = page.form};
      step.text = page.text;
      step.rest_s = page.rest_s;
      step.method = method;
      step.part = part;
      if (auto added = Add(std::move(step), page); !added) return added;
    }
    return {};
  }

  Result<void> AddMethods(const Part& part) {
    const auto orders = study::WilliamsDesign(static_cast<int>(part.methods.size()));
    if (order_ > static_cast<int>(orders.size())) {
      return Fail(ErrorCode::kOutOfRange,
                  fmt::format("--order {}: {} has {} orders", order_, part.where, orders.size()));
    }
    const std::size_t row = order_ > 0 ? static_cast<std::size_t>(order_) - 1
                                       : static_cast<std::size_t>(number_ % orders.size());
    plan_.order = static_cast<int>(row) + 1;
    const auto block = static_cast<std::size_t>(number_ / orders.size());
    for (std::size_t place = 0; place < orders[row].size(); ++place) {
      const auto method = static_cast<std::size_t>(orders[row][place]);
      if (auto added = AddMethod(part, method, place, row + block); !added) return added;
    }
    return {};
  }

  /// `shift`: by how much the layouts are shifted for this participant.
  Result<void> AddMethod(const Part& part, std::size_t index, std::size_t place,
                         std::size_t shift) {
    const MethodKind method = part.methods[index];
    const int number = static_cast<int>(place) + 1;
    if (auto added = AddPages(part.before, method, number); !added) return added;
    const auto mazes = static_cast<std::size_t>(part.mazes_per_method);
    for (std::size_t maze = 0; maze < mazes; ++maze) {
      Step step{.id = std::string(Name(method)), .title = part.title, .kind = Part::Kind::kMaze};
      if (mazes > 1) step.id += fmt::format("-{}", maze + 1);
      Replace(step.title, "{part}", std::to_string(number));
      Replace(step.title, "{parts}", std::to_string(part.methods.size()));
      const auto text = part.introductions.find(std::string(Name(method)));
      if (text != part.introductions.end()) step.text = text->second;
      step.method = method;
      step.maze = part.maze;
      step.part = number;
      const std::size_t own = part.repeat_layouts ? maze : index * mazes + maze;
      const std::size_t layouts = std::max<std::size_t>(1, part.layouts.size());
      const std::size_t layout = (own + shift) % layouts;
      if (!part.layouts.empty()) step.seed = part.layouts[layout];
      step.rotation_deg = 90 * static_cast<int>((place + layout + shift) % study::kOrientations);
      if (auto added = Add(std::move(step), part); !added) return added;
    }
    return AddPages(part.after, method, number);
  }

  /// The given ones first, so that drawn ones can keep clear of them.
  Result<void> ChooseMazes() {
    MazeDraw draw(protocol_.seed, plan_.participant);
    for (const bool drawn : {false, true}) {
      for (const auto& [index, part] : mazes_) {
        if (part->layouts.empty() != drawn) continue;
        Step& step = plan_.steps[index];
        auto chosen = drawn ? draw.Draw(*part, step) : draw.Take(*part, step);
        if (!chosen) return chosen;
      }
    }
    return {};
  }

  const Protocol& protocol_;
  const std::uint64_t number_;
  const int order_;
  ParticipantPlan plan_;
  std::set<std::string> ids_;
  std::vector<Choice> mazes_;
  int last_number_ = 0;
};

}  // namespace

std::uint64_t NumberOf(const std::string& participant) {
  constexpr std::size_t kMostDigits = 9;
  const std::size_t last = participant.find_last_not_of("0123456789");
  const std::string digits = participant.substr(last == std::string::npos ? 0 : last + 1);
  const bool counts = !digits.empty() && digits.size() <= kMostDigits;
  const std::uint64_t number = counts ? std::stoull(digits) : HashOf(participant);
  return number > 0 ? number - 1 : 0;
}

Result<ParticipantPlan> PlanParticipant(const Protocol& protocol, const std::string& participant,
                                        int order) {
  return Expansion(protocol, participant, order).Run();
}

Result<ParticipantPlan> PlanMappingTask(const MappingOptions& options) {
  if (auto ok = study::CheckRange("--mazes", options.mazes, 1, kMostMazes); !ok) {
    return tl::unexpected(ok.error());
  }
  const auto given = static_cast<int>(options.layouts.size());
  if (given != 0 && given != options.mazes) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--maze-seed: {} seeds for {} mazes", given, options.mazes));
  }
  Part part;
  part.where = given == 0 ? "--seed" : "--maze-seed";
  MazeDraw draw(options.seed, options.participant);
  ParticipantPlan plan;
  plan.participant = options.participant;
  plan.experimenter = false;
  for (int number = 1; number <= options.mazes; ++number) {
    Step step{.id = fmt::format("maze-{}", number), .kind = Part::Kind::kMaze};
    step.method = MethodKind::kMapping;
    step.maze = options.maze;
    step.number = number;
    if (given > 0) step.seed = options.layouts[static_cast<std::size_t>(number) - 1];
    const auto chosen = given > 0 ? draw.Take(part, step) : draw.Draw(part, step);
    if (!chosen) return tl::unexpected(chosen.error());
    plan.steps.push_back(std::move(step));
  }
  return plan;
}

std::string_view KindName(const Step& step) {
  if (step.kind == Part::Kind::kRest) return "rest";
  if (step.is_page()) return "form";
  return step.method == MethodKind::kMapping ? "mapping" : "study";
}

nlohmann::ordered_json MazeFacts(const Step& step) {
  return {{"layout", std::to_string(step.seed)},
          {"rotation", step.rotation_deg},
          {"seed", step.seed},
          {"training", step.training},
          {"robots", step.maze.robots},
          {"preset", step.maze.preset}};
}

namespace {

nlohmann::ordered_json StepJson(const Step& step) {
  nlohmann::ordered_json json{{"step", step.id}, {"kind", KindName(step)}};
  if (step.kind == Part::Kind::kForm) json["form"] = step.form;
  if (step.kind == Part::Kind::kRest) json["rest_s"] = step.rest_s;
  if (step.method) json["method"] = Name(*step.method);
  if (step.part > 0) json["part"] = step.part;
  if (step.is_maze()) json.update(MazeFacts(step));
  return json;
}

}  // namespace

nlohmann::ordered_json DesignOf(const ParticipantPlan& plan) {
  nlohmann::ordered_json json{{"participant", plan.participant}};
  if (!plan.protocol.empty()) {
    json["protocol"] = plan.protocol;
    json["protocol_fingerprint"] = plan.fingerprint;
    json["order"] = plan.order;
    json["language"] = plan.language;
  }
  json["parts"] = nlohmann::ordered_json::array();
  for (const Step& step : plan.steps) json["parts"].push_back(StepJson(step));
  return json;
}

std::string Describe(const ParticipantPlan& plan) {
  std::string text = fmt::format("participant {}  protocol {}  order {}  {} steps\n",
                                 plan.participant, plan.protocol, plan.order, plan.count());
  for (const Step& step : plan.steps) {
    text += fmt::format("{:>3}  {:<28} ", step.number, step.id);
    if (step.attempt > 1) text += fmt::format("if attempt {} was not enough: ", step.attempt - 1);
    if (step.kind == Part::Kind::kForm) text += step.form;
    if (step.kind == Part::Kind::kText) text += "text";
    if (step.kind == Part::Kind::kRest) text += fmt::format("rest of {} s", step.rest_s);
    if (step.is_maze()) {
      text += fmt::format("maze {} of {}, {} degrees, {} robot(s)", step.seed, step.maze.preset,
                          step.rotation_deg, step.maze.robots);
    }
    text += '\n';
  }
  return text;
}

}  // namespace conav::live_study
