#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace conav::bag {

struct Rosbag2Topic {
  std::string name;
  std::string type;         // "std_msgs/msg/String"
  std::string offered_qos;  // YAML list of profiles; may be empty
  std::uint64_t message_count = 0;
};

/// What metadata.yaml of a rosbag2 folder with one database says. Times are nanoseconds.
struct Rosbag2Metadata {
  std::string database;  // name of the file
  std::uint64_t start_time = 0;
  std::uint64_t duration = 0;
  std::uint64_t message_count = 0;
  std::vector<Rosbag2Topic> topics;
};

/// In version 5, as Humble writes it and all later ones read it.
std::string Rosbag2MetadataText(const Rosbag2Metadata& metadata);

}  // namespace conav::bag
