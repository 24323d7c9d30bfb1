#include "nhpm/model/weights_file.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>

#include "common/runtime/file.h"
#include "support/temporary_folder.h"

namespace conav::nhpm {
namespace {

constexpr FrameKind kKind{.magic = "CNVW", .version = 1, .name = "weights file"};

/// No field at its default.
NetworkModel SomeModel() {
  NetworkModel model;
  model.name = "tester";
  model.version = "of today";
  model.weights = InitialWeights({16}, 7);
  model.inputs = {.belief = true, .path = false, .view = true};
  model.rows = 13;
  model.columns = 15;
  model.data_origin = "synthetic";
  model.training = {{"seed", "7"}, {"epochs", "200"}};
  model.learned_from = {3, 5, 0xfedcba9876543210ULL};
  return model;
}

/// The error of reading a file of these bytes.
Error ErrorOf(const std::string& bytes) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "weights.nhpm";
  REQUIRE(WriteFile(file, bytes));
  const auto read = ReadWeightsFile(file);
  REQUIRE_FALSE(read);
  CHECK(read.error().code == ErrorCode::kMalformed);
  CHECK_THAT(read.error().text, Catch::StartsWith(file.string() + ": "));
  return read.error();
}

std::string BytesOfSomeModel() {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "weights.nhpm";
  REQUIRE(WriteWeightsFile(file, SomeModel()));
  return ReadFile(file).value();
}

/// The error of a file that is whole, but whose message was changed.
std::string ErrorOfMessage(const std::function<void(proto::Weights&)>& change) {
  const std::string bytes = BytesOfSomeModel();
  const std::string_view payload = Unframe(kKind, bytes).value();
  proto::Weights message;
  REQUIRE(message.ParseFromArray(payload.data(), static_cast<int>(payload.size())));
  change(message);
  return ErrorOf(Frame(kKind, BytesOf(message))).text;
}

TEST_CASE("A weights file is read as it was written", "[nhpm][model][weights]") {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "weights.nhpm";
  const NetworkModel model = SomeModel();
  REQUIRE(WriteWeightsFile(file, model));
  const auto read = ReadWeightsFile(file);
  REQUIRE(read);
  CHECK((*read == model));
}

TEST_CASE("Equal models give equal files", "[nhpm][model][weights]") {
  CHECK((BytesOfSomeModel() == BytesOfSomeModel()));
}

TEST_CASE("All widths are kept, default values too", "[nhpm][model][weights]") {
  for (const int width : {16, 32, 64}) {
    const test::TemporaryFolder folder;
    const std::filesystem::path file = folder / "weights.nhpm";
    NetworkModel model;
    model.weights = InitialWeights({width}, 1);
    REQUIRE(WriteWeightsFile(file, model));
    CHECK((ReadWeightsFile(file).value() == model));
  }
}

TEST_CASE("The checksum is over all that changes answers, and nothing else",
          "[nhpm][model][weights]") {
  const NetworkModel model = SomeModel();
  const std::string checksum = ChecksumOf(model);
  CHECK(checksum.size() == 64);
  const auto changed = [&](const std::function<void(NetworkModel&)>& change) {
    NetworkModel other = model;
    change(other);
    return ChecksumOf(other) != checksum;
  };
  CHECK(changed([](NetworkModel& m) { m.weights.weights[2].back() += 1.0F; }));
  CHECK(changed([](NetworkModel& m) { m.weights.biases[3][1] += 1.0F; }));
  CHECK(changed([](NetworkModel& m) { m.weights = InitialWeights({32}, 7); }));
  CHECK(changed([](NetworkModel& m) { m.inputs.path = true; }));
  CHECK(changed([](NetworkModel& m) { std::swap(m.rows, m.columns); }));
  CHECK_FALSE(changed([](NetworkModel& m) { m.version = "another"; }));
  CHECK_FALSE(changed([](NetworkModel& m) { m.training.clear(); }));
}

TEST_CASE("The checksum of the zero network of width 16 is what sha256sum says",
          "[nhpm][model][weights]") {
  NetworkModel model;
  model.weights = ZeroWeights({16});
  CHECK(ChecksumOf(model) == "baf93c68ba38f46c41b677473073548695d27a52ef8a89b91d1944b97ce7fc3f");
}

TEST_CASE("A missing weights file is not found", "[nhpm][model][weights]") {
  const auto read = ReadWeightsFile("/nonexistent/a.nhpm");
  REQUIRE_FALSE(read);
  CHECK(read.error().code == ErrorCode::kNotFound);
  CHECK(read.error().text == "/nonexistent/a.nhpm: no such file");
}

TEST_CASE("Weights that cannot be written are an error with the path", "[nhpm][model][weights]") {
  const auto written = WriteWeightsFile("/nonexistent/a.nhpm", SomeModel());
  REQUIRE_FALSE(written);
  CHECK(written.error().code == ErrorCode::kIo);
  CHECK_THAT(written.error().text, Catch::StartsWith("/nonexistent/a.nhpm: cannot write: "));
}

TEST_CASE("A weights file cut off anywhere is refused", "[nhpm][model][weights]") {
  const std::string bytes = BytesOfSomeModel();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    INFO(size);
    REQUIRE_FALSE(Unframe(kKind, std::string_view(bytes).substr(0, size)));
  }
  CHECK_THAT(ErrorOf("").text, Catch::EndsWith("empty, so no weights file"));
  CHECK_THAT(ErrorOf(bytes.substr(0, 3)).text, Catch::EndsWith("no weights file"));
  CHECK_THAT(ErrorOf(bytes.substr(0, 30)).text, Catch::EndsWith("after 30 bytes of its header"));
  CHECK_THAT(ErrorOf(bytes.substr(0, bytes.size() - 1)).text, Catch::EndsWith("cut off"));
  CHECK_THAT(ErrorOf(bytes + "x").text, Catch::EndsWith("something was appended"));
}

TEST_CASE("A weights file with a byte that changed is refused", "[nhpm][model][weights]") {
  std::string bytes = BytesOfSomeModel();
  for (std::size_t at = 0; at < bytes.size(); at += at < 100 ? 1 : 97) {
    INFO(at);
    bytes[at] = static_cast<char>(bytes[at] ^ 4);
    REQUIRE_FALSE(Unframe(kKind, bytes));
    bytes[at] = static_cast<char>(bytes[at] ^ 4);
  }
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  CHECK_THAT(ErrorOf(bytes).text, Catch::Contains("damaged"));
}

TEST_CASE("A file that is something else is refused", "[nhpm][model][weights]") {
  CHECK_THAT(ErrorOf("#!/bin/sh\n" + std::string(200, 'x')).text,
             Catch::EndsWith("no weights file"));
  CHECK_THAT(ErrorOf(Frame(kKind, "\xff\xff\xff")).text,
             Catch::EndsWith("its contents are no Weights message"));
}

TEST_CASE("A weights file of a later format is refused by version", "[nhpm][model][weights]") {
  const FrameKind later{.magic = "CNVW", .version = 2, .name = "weights file"};
  CHECK_THAT(ErrorOf(Frame(later, "")).text,
             Catch::EndsWith("of format version 2; this program reads version 1"));
}

TEST_CASE("A weights file with wrong counts is refused", "[nhpm][model][weights]") {
  CHECK_THAT(ErrorOfMessage([](auto& m) { m.mutable_layers()->RemoveLast(); }),
             Catch::EndsWith("3 layers instead of 4"));
  CHECK_THAT(ErrorOfMessage([](auto& m) { m.mutable_layers(1)->mutable_weights()->RemoveLast(); }),
             Catch::EndsWith("weights of layer 1: 2303 values instead of 2304"));
  CHECK_THAT(ErrorOfMessage([](auto& m) { m.mutable_layers(3)->add_biases(0.0F); }),
             Catch::EndsWith("biases of layer 3: 3 values instead of 2"));
  CHECK_THAT(ErrorOfMessage([](auto& m) { m.set_width(32); }),
             Catch::EndsWith("weights of layer 0: 576 values instead of 1152"));
}

TEST_CASE("A weights file of an unknown width is refused", "[nhpm][model][weights]") {
  for (const std::uint32_t width : {0U, 48U, 4294967295U}) {
    CHECK_THAT(ErrorOfMessage([&](auto& m) { m.set_width(width); }),
               Catch::EndsWith("width " + std::to_string(width) + ", not 16, 32 or 64"));
  }
}

TEST_CASE("A weights file with a value that is not finite is refused", "[nhpm][model][weights]") {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  CHECK_THAT(ErrorOfMessage([](auto& m) { m.mutable_layers(2)->set_weights(5, std::nanf("")); }),
             Catch::EndsWith("weights of layer 2: value 5 is not finite (nan)"));
  CHECK_THAT(ErrorOfMessage([](auto& m) { m.mutable_layers(0)->set_biases(0, -kInfinity); }),
             Catch::EndsWith("biases of layer 0: value 0 is not finite (-inf)"));
}

TEST_CASE("A weights file for an impossible grid size is refused", "[nhpm][model][weights]") {
  CHECK_THAT(ErrorOfMessage([](auto& m) { m.set_rows(0); }),
             Catch::EndsWith("impossible grid size 0 x 15"));
  CHECK_THAT(ErrorOfMessage([](auto& m) { m.set_columns(4000000000); }),
             Catch::EndsWith("impossible grid size 13 x 4000000000"));
}

}  // namespace
}  // namespace conav::nhpm
