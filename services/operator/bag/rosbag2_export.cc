#include "operator/bag/rosbag2_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "common/runtime/file.h"
#include "operator/bag/rosbag2_database.h"

namespace conav::bag {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kProgressEvery = 1000;
constexpr const char* kQosKey = "offered_qos_profiles";

/// The topics of a bag, and which one each of the recording's is; several channels may share one.
struct Topics {
  std::vector<Rosbag2Topic> list;  // id - 1 is the index
  std::map<const RecordedTopic*, std::int64_t> ids;
};

Result<Topics> TopicsOf(const McapReader& reader) {
  Topics topics;
  for (const RecordedTopic& recorded : reader.topics()) {
    const Channel& channel = recorded.channel;
    if (channel.message_encoding != "cdr" || recorded.schema.encoding != "ros2msg") {
      return Fail(ErrorCode::kRefused,
                  fmt::format("topic {}: messages in '{}' described by '{}'; rosbag2 takes cdr and "
                              "ros2msg",
                              channel.topic, channel.message_encoding, recorded.schema.encoding));
    }
    auto same = std::find_if(topics.list.begin(), topics.list.end(),
                             [&](const auto& topic) { return topic.name == channel.topic; });
    if (same == topics.list.end()) {
      const auto qos = channel.metadata.find(kQosKey);
      same = topics.list.insert(same,
                                {channel.topic, recorded.schema.name,
                                 qos == channel.metadata.end() ? std::string() : qos->second, 0});
    }
    if (same->type != recorded.schema.name) {
      return Fail(ErrorCode::kRefused,
                  fmt::format("topic {} has two types, {} and {}", channel.topic, same->type,
                              recorded.schema.name));
    }
    topics.ids[&recorded] = same - topics.list.begin() + 1;
  }
  return topics;
}

Result<void> CopyMessages(McapReader& reader, Topics& topics, Rosbag2Database& database,
                          const std::function<void(std::uint64_t)>& progress) {
  reader.Seek(0);
  for (std::uint64_t done = 0;; ++done) {
    const auto message = reader.Next();
    if (!message) return tl::unexpected(message.error());
    if (!*message) return {};
    const std::int64_t id = topics.ids.at((*message)->topic);
    auto added = database.AddMessage(id, (*message)->log_time, (*message)->data);
    if (!added) return added;
    ++topics.list[static_cast<std::size_t>(id) - 1].message_count;
    if ((done + 1) % kProgressEvery == 0) progress(done + 1);
  }
}

Result<void> FillFolder(McapReader& reader, Topics& topics, const fs::path& folder,
                        const std::function<void(std::uint64_t)>& progress) {
  const std::string name = fs::absolute(folder).lexically_normal().filename().string() + "_0.db3";
  auto database = Rosbag2Database::Create(folder / name);
  if (!database) return tl::unexpected(database.error());
  std::int64_t id = 0;
  for (const Rosbag2Topic& topic : topics.list) {
    if (auto added = database->AddTopic(++id, topic); !added) return added;
  }
  if (auto copied = CopyMessages(reader, topics, *database, progress); !copied) return copied;
  const std::string metadata =
      Rosbag2MetadataText({.database = name,
                           .start_time = reader.start_time(),
                           .duration = reader.end_time() - reader.start_time(),
                           .message_count = reader.message_count(),
                           .topics = topics.list});
  if (auto committed = database->Commit(metadata); !committed) return committed;
  return WriteFile(folder / "metadata.yaml", metadata);
}

}  // namespace

Result<void> WriteRosbag2(McapReader& reader, const fs::path& folder,
                          const std::function<void(std::uint64_t)>& progress) {
  auto topics = TopicsOf(reader);
  if (!topics) return tl::unexpected(topics.error());
  // "bag/" has no name of its own.
  const fs::path target = folder.has_filename() ? folder : folder.parent_path();
  std::error_code error;
  const bool made = fs::create_directory(target, error);
  if (error) return Fail(ErrorCode::kIo, fmt::format("{}: {}", target.string(), error.message()));
  if (!made) return Fail(ErrorCode::kRefused, target.string() + ": exists already");
  auto filled = FillFolder(reader, *topics, target, progress);
  if (!filled) fs::remove_all(target, error);
  return filled;
}

}  // namespace conav::bag
