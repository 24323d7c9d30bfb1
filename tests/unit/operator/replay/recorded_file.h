#pragma once

#include <catch2/catch.hpp>
#include <filesystem>
#include <map>
#include <string>

#include "common/bus/topics.h"
#include "common/bus/type_support.h"
#include "operator/recording/mcap_file.h"

namespace conav::operators {

/// A recording that a test writes as the recorder does.
class RecordedFile {
 public:
  explicit RecordedFile(const std::filesystem::path& path,
                        const bag::TextMap& facts = {{"robots", "w1/r1"}, {"run", "a-run"}})
      : writer_(Create(path, facts)) {}

  template <class T>
  void Write(const bus::Topic<T>& topic, const std::string& entity, double at_s, const T& message) {
    const bus::TypeSupport& type = bus::TypeSupportOf<T>();
    bag::Bytes data(type.serialized_size(&message));
    data.resize(type.serialize(&message, data));
    WriteBytes(topic.NameFor(entity), at_s, data);
  }
  void WriteBytes(const std::string& topic, double at_s, const bag::Bytes& data,
                  const bag::Schema& schema = {0, "a/msg/Type", "ros2msg", ""}) {
    if (!channels_.contains(topic)) {
      channels_[topic] = writer_.AddChannel(schema, {0, 0, topic, "cdr", {}});
    }
    const auto time = static_cast<std::uint64_t>(at_s * 1e9);
    REQUIRE(writer_.Write(channels_[topic], time, time, data));
  }
  void Finish() { REQUIRE(writer_.Finish()); }

 private:
  static bag::McapWriter Create(const std::filesystem::path& path, const bag::TextMap& facts) {
    auto writer = bag::McapWriter::Create(path, {}, {{"conav", facts}});
    REQUIRE(writer);
    return *std::move(writer);
  }

  bag::McapWriter writer_;
  std::map<std::string, std::uint16_t> channels_;
};

}  // namespace conav::operators
