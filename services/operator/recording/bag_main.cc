#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/cli/cli.h"
#include "common/cli/progress_line.h"
#include "common/runtime/text.h"
#include "operator/recording/mcap_file.h"

/// What is in a recording, for people and for programs.
namespace conav::bag {
namespace {

double Seconds(std::uint64_t nanoseconds) { return static_cast<double>(nanoseconds) * 1e-9; }

double Duration(const McapReader& reader) {
  return Seconds(reader.end_time() - reader.start_time());
}

/// "2026-11-21 09:05:31 UTC".
std::string TimeText(std::uint64_t nanoseconds) {
  const auto seconds = static_cast<std::time_t>(nanoseconds / 1'000'000'000);
  return UtcTime(seconds, "%Y-%m-%d %H:%M:%S UTC");
}

std::string SizeText(std::uint64_t bytes) {
  const auto value = static_cast<double>(bytes);
  if (bytes < 1'000'000) return fmt::format("{:.1f} kB", value / 1e3);
  return fmt::format("{:.1f} MB", value / 1e6);
}

std::string BagText(const McapReader& reader, const std::string& file) {
  std::string text = fmt::format("{}: {}, {} messages", file, SizeText(reader.file_size()),
                                 reader.message_count());
  if (reader.message_count() > 0) {
    text += fmt::format(", {:.1f} s from {} on", Duration(reader), TimeText(reader.start_time()));
  }
  if (reader.files() > 1) text += fmt::format(", in {} files", reader.files());
  std::size_t topic_width = 5;
  std::size_t type_width = 4;
  for (const RecordedTopic& topic : reader.topics()) {
    topic_width = std::max(topic_width, topic.channel.topic.size());
    type_width = std::max(type_width, topic.schema.name.size());
  }
  text += fmt::format("\n\n{:<{}}  {:<{}}  {:>8}\n", "topic", topic_width, "type", type_width,
                      "messages");
  for (const RecordedTopic& topic : reader.topics()) {
    text += fmt::format("{:<{}}  {:<{}}  {:>8}\n", topic.channel.topic, topic_width,
                        topic.schema.name, type_width, topic.message_count);
  }
  return text;
}

nlohmann::ordered_json BagJson(const McapReader& reader, const std::string& file) {
  nlohmann::ordered_json topics = nlohmann::ordered_json::array();
  for (const RecordedTopic& topic : reader.topics()) {
    topics.push_back({{"topic", topic.channel.topic},
                      {"type", topic.schema.name},
                      {"messages", topic.message_count}});
  }
  nlohmann::ordered_json metadata = nlohmann::ordered_json::object();
  for (const Metadata& record : reader.metadata()) metadata[record.name] = record.values;
  return {{"file", file},
          {"files", reader.files()},
          {"bytes", reader.file_size()},
          {"messages", reader.message_count()},
          {"start_s", Seconds(reader.start_time())},
          {"duration_s", Duration(reader)},
          {"finished", reader.cut_off().empty()},
          {"missing", reader.cut_off()},
          {"metadata", metadata},
          {"topics", topics}};
}

/// Arguments of `conav bag`; an empty path = not wanted.
struct BagArguments {
  std::filesystem::path run;  // run folder or MCAP file
  std::filesystem::path rosbag2;
  std::filesystem::path json;  // "-" = standard output
};

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

Result<void> Publish(const BagArguments& arguments, const McapReader& reader,
                     const fs::path& file) {
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

/// Prints what is in the recording on standard output, on standard error if that holds the JSON.
/// Exit code: 0 done, 1 failed, 2 wrong use.
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
  return ExitCode(kProgram, Publish(arguments, *reader, *file));
}

}  // namespace
}  // namespace conav::bag

// conav-bag: what is in a run's recording, and the same as a rosbag2 folder.

namespace {

constexpr const char* kAbout =
    R"(Lists the contents of a run's recording, and writes it as a rosbag2 folder.

RUN is a run folder (./conav demo leaves runs/<time>-seed<S>) or an MCAP file. A recording that was cut
off (its process was killed, the disk was full, or it is still being written) is read up to its last
whole chunk, with a warning. One that goes on in further files (recording-2.mcap) is read with them.
docs/recording.md says more.

Exit codes: 0 done; 1 RUN holds no recording, or one that cannot be read, or writing failed; 2 wrong use, or
no such RUN.

Examples:
  conav bag runs/20261121-172744-seed7
  conav bag runs/20261121-172744-seed7 --rosbag2 /tmp/bag && ros2 bag info /tmp/bag)";

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kAbout, "conav bag");
  conav::bag::BagArguments arguments;
  app.add_option("run", arguments.run, "The run")->required()->type_name("RUN");
  app.add_option(
         "--rosbag2", arguments.rosbag2,
         "Write all messages into this new folder: SQLite and metadata.yaml, as ROS 2 Humble "
         "and later ones read them")
      ->type_name("DIR");
  app.add_option(
      "--json", arguments.json,
      "Write what is printed to this file, too; - = standard output (the table then goes "
      "to standard error)");
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  return conav::bag::RunBag(arguments);
}
