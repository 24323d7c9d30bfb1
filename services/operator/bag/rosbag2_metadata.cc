#include "operator/bag/rosbag2_metadata.h"

#include <yaml-cpp/yaml.h>

namespace conav::bag {
namespace {

constexpr int kVersion = 5;

YAML::Node TopicNode(const Rosbag2Topic& topic) {
  YAML::Node node;
  YAML::Node about = node["topic_metadata"];
  about["name"] = topic.name;
  about["type"] = topic.type;
  about["serialization_format"] = "cdr";
  about["offered_qos_profiles"] = topic.offered_qos;
  node["message_count"] = topic.message_count;
  return node;
}

void SetExtent(YAML::Node node, const Rosbag2Metadata& metadata) {
  node["duration"]["nanoseconds"] = metadata.duration;
  node["starting_time"]["nanoseconds_since_epoch"] = metadata.start_time;
  node["message_count"] = metadata.message_count;
}

}  // namespace

std::string Rosbag2MetadataText(const Rosbag2Metadata& metadata) {
  YAML::Node document;
  YAML::Node bag = document["rosbag2_bagfile_information"];
  bag["version"] = kVersion;
  bag["storage_identifier"] = "sqlite3";
  SetExtent(bag, metadata);
  bag["topics_with_message_count"] = YAML::Node(YAML::NodeType::Sequence);
  for (const Rosbag2Topic& topic : metadata.topics) {
    bag["topics_with_message_count"].push_back(TopicNode(topic));
  }
  bag["compression_format"] = "";
  bag["compression_mode"] = "";
  bag["relative_file_paths"].push_back(metadata.database);
  YAML::Node file;
  file["path"] = metadata.database;
  SetExtent(file, metadata);
  bag["files"].push_back(file);
  return YAML::Dump(document) + "\n";
}

}  // namespace conav::bag
