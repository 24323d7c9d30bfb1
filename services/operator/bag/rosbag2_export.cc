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

/// What was written.
struct Copied {
  std::uint64_t messages = 0;
  std::uint64_t start_time = 0;
  std::uint64_t end_time = 0;
  std::vector<std::string> left_out;
};

/// In the order of log times, from which a damaged chunk may only take away.
void Count(Copied& copied, const RecordedMessage& message) {
  if (copied.messages == 0) copied.start_time = message.log_time;
  copied.end_time = std::max(copied.end_time, message.log_time);
  ++copied.messages;
}

Result<Copied> CopyMessages(McapReader& reader, Topics& topics, Rosbag2Database& database,
                            const std::function<void(std::uint64_t)>& progress) {
  reader.Seek(0);
  Copied copied;
  for (;;) {
    const auto message = reader.Next();
    if (!message && message.error().code != ErrorCode::kMalformed) {
      return tl::unexpected(message.error());
    }
    if (!message) {
      copied.left_out.push_back(message.error().text);
      continue;
    }
    if (!*message) return copied;
    const std::int64_t id = topics.ids.at((*message)->topic);
    auto added = database.AddMessage(id, (*message)->log_time, (*message)->data);
    if (!added) return tl::unexpected(added.error());
    ++topics.list[static_cast<std::size_t>(id) - 1].message_count;
    Count(copied, **message);
    if (copied.messages % kProgressEvery == 0) progress(copied.messages);
  }
}

Result<std::vector<std::string>> FillFolder(McapReader& reader, Topics& topics,
                                            const fs::path& folder,
                                            const std::function<void(std::uint64_t)>& progress) {
  const std::string name = fs::absolute(folder).lexically_normal().filename().string() + "_0.db3";
  auto database = Rosbag2Database::Create(folder / name);
  if (!database) return tl::unexpected(database.error());
  std::int64_t id = 0;
  for (const Rosbag2Topic& topic : topics.list) {
    if (auto added = database->AddTopic(++id, topic); !added) return tl::unexpected(added.error());
  }
  auto copied = CopyMessages(reader, topics, *database, progress);
  if (!copied) return tl::unexpected(copied.error());
  const std::string metadata =
      Rosbag2MetadataText({.database = name,
                           .start_time = copied->start_time,
                           .duration = copied->end_time - copied->start_time,
                           .message_count = copied->messages,
                           .topics = topics.list});
  if (auto committed = database->Commit(metadata); !committed) {
    return tl::unexpected(committed.error());
  }
  return WriteFile(folder / "metadata.yaml", metadata).map([&] {
    return std::move(copied->left_out);
  });
}

}  // namespace

Result<std::vector<std::string>> WriteRosbag2(McapReader& reader, const fs::path& folder,
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
