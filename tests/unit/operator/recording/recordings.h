#pragma once

#include <catch2/catch.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "common/runtime/file.h"
#include "operator/recording/mcap_file.h"
#include "support/temporary_folder.h"

namespace conav::bag {

/// A message of std_msgs/String.
inline Bytes TextMessage(const std::string& text) {
  Bytes bytes{0, 1, 0, 0};
  ByteWriter writer(bytes);
  writer.Put(std::string_view(text.c_str(), text.size() + 1));
  return bytes;
}

inline Schema TextSchema() { return {0, "std_msgs/msg/String", "ros2msg", "string data\n"}; }

inline Channel TextChannel(const std::string& topic) {
  return {0, 0, topic, "cdr", {{"offered_qos_profiles", "- depth: 1\n"}}};
}

inline McapWriter MustCreate(const std::filesystem::path& path, McapWriter::Options options = {}) {
  auto writer = McapWriter::Create(path, options, {{"conav", {{"version", "1.2"}}}});
  REQUIRE(writer);
  return *std::move(writer);
}

inline McapReader MustOpen(const std::filesystem::path& path) {
  auto reader = McapReader::Open(path);
  INFO((reader ? "" : reader.error().text));
  REQUIRE(reader);
  return *std::move(reader);
}

/// Every message in the order of the reader.
inline std::vector<RecordedMessage> AllMessages(McapReader& reader) {
  std::vector<RecordedMessage> messages;
  for (;;) {
    auto next = reader.Next();
    INFO((next ? "" : next.error().text));
    REQUIRE(next);
    if (!*next) return messages;
    messages.push_back(**next);
  }
}

/// Two topics with three and two messages in two chunks, and a summary; times 10, 20, ... 50.
inline void WriteSmallRecording(const std::filesystem::path& path) {
  McapWriter writer = MustCreate(path);
  const auto a = writer.AddChannel(TextSchema(), TextChannel("/a"));
  const auto b = writer.AddChannel(TextSchema(), TextChannel("/b"));
  REQUIRE(writer.Write(a, 10, 1, TextMessage("one")));
  REQUIRE(writer.Write(b, 20, 2, TextMessage("two")));
  REQUIRE(writer.Flush());
  REQUIRE(writer.Write(a, 30, 3, TextMessage("three")));
  REQUIRE(writer.Write(a, 40, 4, TextMessage("four")));
  REQUIRE(writer.Write(b, 50, 5, TextMessage("five")));
  REQUIRE(writer.Finish());
}

inline Bytes BytesOf(const std::filesystem::path& path) {
  const auto text = ReadFile(path);
  REQUIRE(text);
  return {text->begin(), text->end()};
}

/// Where record number `number` of this kind begins, outside of chunks.
inline std::size_t PlaceOf(const Bytes& file, Opcode opcode, int number) {
  ByteSpan rest = ByteSpan(file).subspan(kMagicSize);
  for (;;) {
    const std::size_t at = file.size() - rest.size();
    const auto record = TakeRecord(rest);
    REQUIRE(record);
    if (record->opcode == opcode && --number == 0) return at;
  }
}

inline void Store(const std::filesystem::path& path, ByteSpan bytes) {
  REQUIRE(WriteFile(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
}

}  // namespace conav::bag
