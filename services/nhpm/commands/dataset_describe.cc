#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/console/option_checks.h"
#include "common/runtime/file.h"
#include "common/segments/segment_file.h"
#include "nhpm/commands/dataset_commands.h"
#include "nhpm/dataset/segment_picture.h"
#include "nhpm/dataset/set_summary.h"

namespace conav::nhpm {
namespace {

constexpr std::size_t kShownInText = 2;
constexpr std::size_t kShownInSvg = 5;

struct Arguments {
  std::string file;
  std::string json;
  std::string svg;
  std::vector<std::size_t> segments;
  bool recover = false;
};

Result<std::vector<ChosenSegment>> Choose(const Arguments& arguments, const SegmentSet& set,
                                          std::size_t count) {
  if (arguments.segments.empty()) return ChooseSegments(set, count);
  return ChooseSegments(set, arguments.segments);
}

Result<void> WriteSvg(const Arguments& arguments, const SegmentSet& set,
                      const std::string& origin) {
  return Choose(arguments, set, kShownInSvg).and_then([&](const auto& chosen) {
    const std::string name = std::filesystem::path(arguments.file).filename().string();
    return WriteFile(arguments.svg,
                     SegmentsSvg(chosen, fmt::format("{}: edits made by {}", name, origin)));
  });
}

int Describe(const Arguments& arguments) {
  const int code = CheckFiles(kDatasetProgram, {{"file", arguments.file}},
                              {{"--json", arguments.json}, {"--svg", arguments.svg}});
  if (code != 0) return code;
  const auto set =
      ReadSegmentFile(arguments.file, arguments.recover ? TornEnd::kDrop : TornEnd::kRefuse);
  if (!set) return Failed(set.error());
  const auto chosen = Choose(arguments, *set, kShownInText);
  if (!chosen) return Refused(kDatasetProgram, chosen.error().text);
  const SetSummary summary = Summarize(*set);
  if (!arguments.svg.empty()) {
    const auto drawn = WriteSvg(arguments, *set, summary.origin);
    if (!drawn) return Failed(drawn.error());
  }
  const auto written = WriteJsonOutput(arguments.json, ToJson(summary));
  if (!written || arguments.json == "-") return ExitCode(written);
  std::string text = ToText(summary);
  for (const ChosenSegment& one : *chosen) text += "\n" + SegmentText(one);
  return ExitCode(WriteStandardOutput(text));
}

}  // namespace

void AddDescribeCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "describe",
      "Prints what a segment file holds: who made the edits, counts, edits per segment, how right\n"
      "the maps were, and a few segments drawn with characters:\n"
      "  before: # wall, o path, > ^ < v camera; shown: . seen free, # seen wall;\n"
      "  after: + wall added, - wall removed");
  command->add_option("file", arguments->file, "one segment file (.pb.zst)")->required();
  command->add_option("--json", arguments->json,
                      "write the numbers to this file, - = standard output");
  command->add_option("--svg", arguments->svg, "draw a few segments to this file");
  command
      ->add_option(
          "--segments", arguments->segments,
          "which ones to draw, by their numbers from 0 on: 3,14,15 (default: some with edits)")
      ->check(WholeNumber())
      ->delimiter(',');
  command->add_flag("--recover", arguments->recover,
                    "of a recording that was cut off, take what is complete");
  command->callback([arguments, &exit_code] { exit_code = Describe(*arguments); });
}

}  // namespace conav::nhpm
