#include "study/gaze/eye_recording.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace conav::gaze {
namespace {

using nlohmann::json;

json Pupil(double time, double diameter, bool is_3d) {
  json message = {{"id", 0}, {"timestamp", time}, {"confidence", 0.9}, {"diameter", 40.0}};
  if (is_3d) message["diameter_3d"] = diameter;
  return message;
}

void AddAll(EyeCollector& collector, const std::string& topic, const std::vector<json>& messages) {
  for (const json& message : messages) REQUIRE(collector.Add(topic, message));
}

TEST_CASE("the 3d model's diameters replace those of the 2d detector", "[study][gaze]") {
  EyeCollector only_2d;
  AddAll(only_2d, "pupil.0.2d", {Pupil(1.0, 0.0, false), Pupil(2.0, 0.0, false)});
  const EyeRecording pixels = std::move(only_2d).Finish();
  CHECK_FALSE(pixels.in_mm);
  CHECK(pixels.pupils.size() == 2);

  EyeCollector both;
  AddAll(both, "pupil.0.2d", {Pupil(1.0, 0.0, false)});
  AddAll(both, "pupil.0.3d", {Pupil(2.0, 3.6, true), Pupil(1.0, 3.5, true)});
  AddAll(both, "pupil.0.2d", {Pupil(2.0, 0.0, false)});
  const EyeRecording mm = std::move(both).Finish();
  CHECK(mm.in_mm);
  REQUIRE(mm.pupils.size() == 2);
  CHECK(mm.pupils[0].diameter == 3.5);  // by time
}

TEST_CASE("an onset and the offsets that follow it are one blink, however often they repeat",
          "[study][gaze]") {
  const auto blink = [](double time, const char* type) {
    return json{{"timestamp", time}, {"type", type}, {"confidence", 0.6}};
  };
  EyeCollector collector;
  AddAll(collector, "blinks",
         {blink(1.00, "onset"), blink(1.03, "onset"), blink(1.10, "offset"), blink(1.13, "offset"),
          blink(1.40, "onset"), blink(1.50, "offset"),  // soon after the first
          blink(3.00, "onset"),                         // its offset was lost
          blink(9.00, "onset"), blink(9.10, "offset"), blink(20.0, "offset")});
  const auto blinks = std::move(collector).Finish().blinks;
  REQUIRE(blinks.size() == 3);
  CHECK(blinks[0].begin_s == 1.00);
  CHECK(blinks[0].end_s == 1.13);
  CHECK(blinks[1].begin_s == 1.40);
  CHECK(blinks[2].begin_s == 9.00);
}

TEST_CASE("messages with one fixation's id are one fixation, and the last one counts",
          "[study][gaze]") {
  const auto fixation = [](int id, double time, double ms) {
    return json{{"id", id}, {"timestamp", time}, {"duration", ms}, {"norm_pos", {0.2, 0.4}}};
  };
  EyeCollector collector;
  AddAll(collector, "fixations",
         {fixation(1, 5.0, 100), fixation(1, 5.0, 240), fixation(2, 6, 90)});
  AddAll(collector, "surfaces.page",
         {{{"name", "page"}, {"fixations_on_surfaces", {fixation(1, 5.0, 100)}}},
          {{"name", "page"}, {"fixations_on_surfaces", {fixation(1, 5.0, 240)}}}});
  const EyeRecording recording = std::move(collector).Finish();
  REQUIRE(recording.fixations.size() == 2);
  CHECK(recording.fixations[0].duration_s == Approx(0.24));
  REQUIRE(recording.surfaces.at("page").fixations.size() == 1);
  CHECK(recording.surfaces.at("page").fixations[0].duration_s == Approx(0.24));
}

TEST_CASE("gaze next to a surface is not on it, and topics end with a dot", "[study][gaze]") {
  const json here = {{"norm_pos", {0.1, 0.9}}, {"confidence", 1.0}, {"timestamp", 1.0}};
  json beside = here;
  beside["norm_pos"] = {1.4, 0.5};
  EyeCollector collector;
  AddAll(collector, "surfaces.map", {{{"name", "map"}, {"gaze_on_surfaces", {here, beside}}}});
  AddAll(collector, "gaze.3d.01.", {here});
  AddAll(collector, "notify.recording.started", {{{"subject", "recording.started"}}});
  const EyeRecording recording = std::move(collector).Finish();
  CHECK(recording.surfaces.at("map").gaze.size() == 1);
  CHECK(recording.gaze.size() == 1);
}

TEST_CASE("annotations keep the keys that a study gave them", "[study][gaze]") {
  EyeCollector collector;
  AddAll(collector, "annotation",
         {{{"label", "trial begin"},
           {"timestamp", 4.0},
           {"duration", 0.0},
           {"topic", "annotation"},
           {"method", "ig-mcts"},
           {"part", 2}}});
  const Mark mark = std::move(collector).Finish().marks.at(0);
  CHECK(mark.label == "trial begin");
  CHECK(mark.keys == std::map<std::string, std::string>{{"method", "ig-mcts"}, {"part", "2"}});
}

TEST_CASE("ids of fixations begin again when Pupil does, and a mark that is sent again counts once",
          "[study][gaze]") {
  const auto fixation = [](double time) {
    return json{{"id", 1}, {"timestamp", time}, {"duration", 100}, {"norm_pos", {0.2, 0.4}}};
  };
  const auto mark = [](double time, const char* method) {
    return json{{"label", "trial begin"}, {"timestamp", time}, {"method", method}};
  };
  EyeCollector collector;
  AddAll(collector, "fixations", {fixation(5.0), fixation(5.01), fixation(500.0)});
  AddAll(collector, "annotation",
         {mark(1.0, "a"), mark(1.001, "a"), mark(1.0, "b"), mark(2.0, "a")});
  const EyeRecording recording = std::move(collector).Finish();
  CHECK(recording.fixations.size() == 2);
  CHECK(recording.marks.size() == 3);
}

TEST_CASE("what is no map of MessagePack, or nested too deeply, is refused", "[study][gaze]") {
  const auto nested = [](std::size_t depth) {
    std::vector<std::uint8_t> bytes{0x81, 0xa1, 'a'};
    bytes.resize(bytes.size() + depth, 0x91);  // a list of one
    bytes.push_back(0xc0);
    return bytes;
  };
  CHECK(ParseMessage(nested(kMessageDepth - 1)).value().contains("a"));
  const std::vector<std::vector<std::uint8_t>> rows = {
      {},
      {0x01},
      {0x81, 0xa1},
      nested(kMessageDepth),
      nested(1000000),
      std::vector<std::uint8_t>(kMessageLimit + 1, 0xc0)};
  for (const auto& bytes : rows) {
    const auto message = ParseMessage(bytes);
    REQUIRE_FALSE(message);
    CHECK(message.error().code == ErrorCode::kMalformed);
  }
}

TEST_CASE("a message without a needed field is refused by its topic", "[study][gaze]") {
  const std::vector<std::pair<std::string, json>> rows = {
      {"pupil.0.3d", {{"id", 0}, {"timestamp", 1.0}}},
      {"gaze.2d.0.", {{"timestamp", 1.0}, {"confidence", 1.0}, {"norm_pos", {0.5}}}},
      {"blinks", {{"timestamp", 1.0}}},
      {"fixations", {{"id", "one"}, {"timestamp", 1.0}}},
      {"surfaces.a", {{"gaze_on_surfaces", json::array()}}},
      {"annotation", {{"timestamp", 1.0}}}};
  for (const auto& [topic, message] : rows) {
    EyeCollector collector;
    const auto added = collector.Add(topic, message);
    REQUIRE_FALSE(added);
    CHECK(added.error().code == ErrorCode::kMalformed);
    CHECK_THAT(added.error().text, Catch::Contains(topic));
  }
}

}  // namespace
}  // namespace conav::gaze
