#include "operator/commands/bag_report.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace conav::bag {
namespace {

double Seconds(std::uint64_t nanoseconds) { return static_cast<double>(nanoseconds) * 1e-9; }

double Duration(const McapReader& reader) {
  return Seconds(reader.end_time() - reader.start_time());
}

/// "2026-11-21 09:05:31 UTC".
std::string TimeText(std::uint64_t nanoseconds) {
  const auto seconds = static_cast<std::time_t>(nanoseconds / 1'000'000'000);
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC", fmt::gmtime(seconds));
}

std::string SizeText(std::uint64_t bytes) {
  const auto value = static_cast<double>(bytes);
  if (bytes < 1'000'000) return fmt::format("{:.1f} kB", value / 1e3);
  return fmt::format("{:.1f} MB", value / 1e6);
}

}  // namespace

std::string BagText(const McapReader& reader, const std::string& file) {
  std::string text = fmt::format("{}: {}, {} messages", file, SizeText(reader.file_size()),
                                 reader.message_count());
  if (reader.message_count() > 0) {
    text += fmt::format(", {:.1f} s from {} on", Duration(reader), TimeText(reader.start_time()));
  }
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
          {"bytes", reader.file_size()},
          {"messages", reader.message_count()},
          {"start_s", Seconds(reader.start_time())},
          {"duration_s", Duration(reader)},
          {"finished", reader.cut_off().empty()},
          {"metadata", metadata},
          {"topics", topics}};
}

}  // namespace conav::bag
