#include "operator/foxglove/foxglove_messages.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace conav::foxglove {
namespace {

using namespace std::string_literals;
using nlohmann::json;

}  // namespace

TEST_CASE("operations are read as the protocol writes them", "[operator][foxglove]") {
  const auto subscribe =
      std::get<Subscribe>(ParseText(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3},)"
                                    R"({"id":4294967295,"channelId":5,"more":[]}]})")
                              .value());
  REQUIRE(subscribe.subscriptions.size() == 2);
  CHECK(subscribe.subscriptions[0].channel == 3);
  CHECK(subscribe.subscriptions[1].id == 4294967295U);
  const auto unsubscribe =
      std::get<Unsubscribe>(ParseText(R"({"op":"unsubscribe","subscriptionIds":[0,1]})").value());
  CHECK(unsubscribe.ids == std::vector<std::uint32_t>{0, 1});
  const auto advertise = std::get<ClientAdvertise>(
      ParseText(R"({"op":"advertise","channels":[{"id":1,"topic":"/r1/goal_pose",)"
                R"("encoding":"cdr","schemaName":"geometry_msgs/PoseStamped"}]})")
          .value());
  REQUIRE(advertise.channels.size() == 1);
  CHECK(advertise.channels[0].topic == "/r1/goal_pose");
  CHECK(advertise.channels[0].schema_name == "geometry_msgs/PoseStamped");
  const auto get = std::get<GetParameters>(
      ParseText(R"({"op":"getParameters","parameterNames":["/a"],"id":"q"})").value());
  CHECK(get.names == std::vector<std::string>{"/a"});
  CHECK(get.id == "q");
  const auto set = std::get<SetParameters>(
      ParseText(R"({"op":"setParameters","parameters":[{"name":"/a","value":{"b":[1]}}]})")
          .value());
  CHECK(set.names == std::vector<std::string>{"/a"});
  CHECK_FALSE(set.id);
  CHECK(std::get<WatchGraph>(ParseText(R"({"op":"subscribeConnectionGraph"})").value()).on);
  const auto fetch = std::get<FetchAsset>(
      ParseText(R"({"op":"fetchAsset","uri":"package://a/b","requestId":9})").value());
  CHECK(fetch.uri == "package://a/b");
  CHECK(fetch.request_id == 9);
}

TEST_CASE("binary messages are read to their last byte", "[operator][foxglove]") {
  const auto publish = std::get<ClientPublish>(ParseBinary("\1\2\3\0\0payload"s).value());
  CHECK(publish.channel == 0x302);
  CHECK(publish.payload == "payload");
  CHECK(std::get<ClientPublish>(ParseBinary("\1\1\0\0\0"s).value()).payload.empty());
  const auto call = std::get<CallService>(ParseBinary("\2\1\0\0\0\2\0\0\0\4\0\0\0json{}"s).value());
  CHECK(call.service == 1);
  CHECK(call.call == 2);
  CHECK(call.encoding == "json");
  CHECK(call.payload == "{}");
}

TEST_CASE("what is not as the protocol wants it is refused", "[operator][foxglove]") {
  const auto [text, part] = GENERATE(table<std::string, std::string>({
      {"", "JSON"},
      {"[1]", "JSON"},
      {"{", "JSON"},
      {"{}", "op"},
      {R"({"op":1})", "op"},
      {R"({"op":"subscribe"})", "subscriptions"},
      {R"({"op":"subscribe","subscriptions":{}})", "subscriptions"},
      {R"({"op":"subscribe","subscriptions":[7]})", "no object"},
      {R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})", "id"},
      {R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":4294967296}]})", "channelId"},
      {R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":1}]})", "id"},
      {R"({"op":"unsubscribe","subscriptionIds":["a"]})", "subscriptionIds"},
      {R"({"op":"advertise","channels":[{"id":1,"topic":1}]})", "topic"},
      {R"({"op":"getParameters","parameterNames":[1]})", "parameterNames"},
      {R"({"op":"getParameters","parameterNames":[],"id":{}})", "id"},
      {R"({"op":"fetchAsset","uri":")" + std::string(1025, 'x') + R"(","requestId":1})", "uri"},
  }));
  CAPTURE(text);
  const auto read = ParseText(text);
  REQUIRE_FALSE(read);
  CHECK(read.error().code == ErrorCode::kMalformed);
  CHECK_THAT(read.error().text, Catch::Contains(part));
  CHECK(ParseText(R"({"op":"playbackControl"})").error().code == ErrorCode::kNotFound);
}

TEST_CASE("a binary message that is cut off anywhere is refused", "[operator][foxglove]") {
  const std::string call = "\2\1\0\0\0\2\0\0\0\4\0\0\0json"s;
  REQUIRE(ParseBinary(call));
  for (std::size_t size = 0; size < call.size(); ++size) {
    CAPTURE(size);
    CHECK_FALSE(ParseBinary(call.substr(0, size)));
  }
  for (std::size_t size = 1; size < 5; ++size)
    CHECK_FALSE(ParseBinary("\1\1\0\0\0"s.substr(0, size)));
  CHECK_FALSE(ParseBinary("\3"));
  CHECK_FALSE(ParseBinary("\2\1\0\0\0\2\0\0\0\377\377\377\377json"s));
}

TEST_CASE("bytes for clients are laid out as the protocol says", "[operator][foxglove]") {
  CHECK(MessageHead(0x01020304, 5) == "\1\4\3\2\1\5\0\0\0\0\0\0\0"s);
  CHECK(TimeBytes(0x0102) == "\2\2\1\0\0\0\0\0\0"s);
  const CallService in_cdr{1, 2, "cdr", ""};
  CHECK(TriggerResponseBytes(in_cdr, true, "ab") ==
        "\3\1\0\0\0\2\0\0\0\3\0\0\0cdr\0\1\0\0\1\0\0\0\3\0\0\0ab\0"s);
  const CallService in_json{1, 2, "json", ""};
  CHECK(TriggerResponseBytes(in_json, false, "no") ==
        "\3\1\0\0\0\2\0\0\0\4\0\0\0json"s + R"({"message":"no","success":false})");
  CHECK(AssetBytes(7, "<r/>") == "\4\7\0\0\0\0\0\0\0\0<r/>"s);
  CHECK(AssetErrorBytes(7, "no") == "\4\7\0\0\0\1\2\0\0\0no"s);
}

TEST_CASE("texts for clients are JSON, whatever is in them", "[operator][foxglove]") {
  const json status = json::parse(StatusText(StatusLevel::kWarning, "\xff\"", "a"));
  CHECK(status["level"] == 1);
  CHECK(status["id"] == "a");
  const json info = json::parse(ServerInfoText("conav", "run"));
  CHECK(info["supportedEncodings"] == json{"cdr", "json"});
  CHECK(info["metadata"].is_object());
  const json channels = json::parse(AdvertiseText({{1, "/clock", "rosgraph_msgs/msg/Clock", "x"}}));
  CHECK(channels["channels"][0]["schemaEncoding"] == "ros2msg");
  const Parameters all{{"/a", "1"}, {"/b", R"(["x","y"])"}};
  CHECK(json::parse(ParameterValuesText(all, {}, std::nullopt))["parameters"].size() == 2);
  const json one = json::parse(ParameterValuesText(all, {"/b", "/c"}, "q"));
  CHECK(one["id"] == "q");
  CHECK(one["parameters"] == json{{{"name", "/b"}, {"value", {"x", "y"}}}});
  const json graph = json::parse(GraphText({{{"/a", {"/n", "/m"}}}, {}, {}}));
  CHECK(graph["publishedTopics"] == json{{{"name", "/a"}, {"publisherIds", {"/m", "/n"}}}});
  CHECK(graph["subscribedTopics"].empty());
}

TEST_CASE("a goal in JSON needs a place, and takes either form of a time", "[operator][foxglove]") {
  const auto pose =
      PoseFromJson(R"({"header":{"frame_id":"map","stamp":{"sec":2,"nsec":7}},)"
                   R"("pose":{"position":{"x":1,"y":-2.5},"orientation":{"z":1,"w":0}}})");
  REQUIRE(pose);
  CHECK(pose->frame == "map");
  CHECK(pose->stamp_s == 2);
  CHECK(pose->stamp_ns == 7);
  CHECK(pose->position == std::array{1.0, -2.5, 0.0});
  CHECK(pose->orientation == std::array{0.0, 0.0, 1.0, 0.0});
  CHECK(PoseFromJson(R"({"pose":{"position":{}}})")->orientation[3] == 1.0);
  const std::string wrong = GENERATE(
      R"({})", R"([])", R"({"pose":7})", R"({"pose":{"position":{"x":"1"}}})",
      R"({"pose":{"position":{"x":1e999}}})", R"({"header":{"frame_id":7},"pose":{"position":{}}})",
      R"({"header":{"stamp":{"sec":-1}},"pose":{"position":{}}})",
      R"({"header":{"stamp":{"nanosec":1e9}},"pose":{"position":{}}})",
      R"({"pose":{"position":{},"orientation":[]}})");
  CAPTURE(wrong);
  CHECK_FALSE(PoseFromJson(wrong));
}

TEST_CASE("a text in CDR is read, and nothing behind its end", "[operator][foxglove]") {
  CHECK(TextFromCdr("\0\1\0\0\3\0\0\0ab\0"s).value() == "ab");
  CHECK(TextFromCdr("\0\1\0\0\1\0\0\0\0padding"s).value().empty());
  const std::string wrong =
      GENERATE(""s, "\0\1\0"s, "\0\0\0\0\3\0\0\0ab\0"s, "\0\1\0\0\0\0\0\0"s,
               "\0\1\0\0\4\0\0\0ab\0"s, "\0\1\0\0\2\0\0\0ab"s, "\0\1\0\0\377\377\377\377ab\0"s);
  CHECK_FALSE(TextFromCdr(wrong));
}

}  // namespace conav::foxglove
