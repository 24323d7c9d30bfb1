#include "operator/commands/bag_command.h"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/console/console.h"
#include "common/console/progress_line.h"
#include "operator/bag/rosbag2_export.h"
#include "operator/bag/run_recording.h"
#include "operator/commands/bag_report.h"

namespace conav::bag {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "conav bag";

Result<std::vector<std::string>> ExportWithProgress(McapReader& reader, const fs::path& folder) {
  ProgressLine line;
  const auto show = [&](std::uint64_t done) {
    line.ShowNowAndThen(fmt::format("{} of {} messages", done, reader.message_count()));
  };
  return WriteRosbag2(reader, folder, show);
}

Result<void> Export(McapReader& reader, const fs::path& folder) {
  if (folder.empty()) return {};
  const auto left_out = ExportWithProgress(reader, folder);
  if (!left_out) return tl::unexpected(left_out.error());
  for (const std::string& what : *left_out) Warn(kProgram, what + "; left out");
  return {};
}

Result<void> Tell(const BagArguments& arguments, const McapReader& reader, const fs::path& file) {
  std::string text = BagText(reader, file.string());
  if (!arguments.rosbag2.empty()) {
    text += fmt::format("\nwritten as rosbag2: {}\n", arguments.rosbag2.string());
  }
  if (arguments.json == "-") {
    fmt::print(stderr, "{}", text);
  } else if (auto printed = WriteStandardOutput(text); !printed) {
    return printed;
  }
  if (arguments.json.empty()) return {};
  auto json = BagJson(reader, file.string());
  if (!arguments.rosbag2.empty()) json["rosbag2"] = arguments.rosbag2.string();
  return WriteJsonOutput(arguments.json, json);
}

}  // namespace

int RunBag(const BagArguments& arguments) {
  const auto file = RecordingOf(arguments.run);
  if (!file) return Failed(kProgram, file.error());
  const int code = CheckFiles(kProgram, {{"RUN", *file}}, {{"--json", arguments.json}});
  if (code != 0) return code;
  std::error_code ignored;
  if (!arguments.rosbag2.empty() && fs::exists(arguments.rosbag2, ignored)) {
    return Refused(kProgram,
                   fmt::format("--rosbag2 {}: exists already", arguments.rosbag2.string()));
  }
  auto reader = McapReader::Open(*file);
  if (!reader) return Failed(kProgram, reader.error());
  if (!reader->cut_off().empty()) {
    Warn(kProgram, fmt::format("{}: {}", file->string(), reader->cut_off()));
  }
  if (const auto written = Export(*reader, arguments.rosbag2); !written) {
    return Failed(kProgram, written.error());
  }
  return ExitCode(kProgram, Tell(arguments, *reader, *file));
}

}  // namespace conav::bag
