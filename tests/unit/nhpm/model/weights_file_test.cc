#include "nhpm/model/weights_file.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <utility>

#include "common/runtime/file.h"
#include "support/refusal.h"
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
  model.inputs = {.belief = true, .path = false, .view = true, .depth = false};
  model.rows = 13;
  model.columns = 15;
  model.data_origin = "synthetic";
  model.training = {{"seed", "7"}, {"epochs", "200"}};
  model.learned_from = {3, 5, 0xfedcba9876543210ULL};
  return model;
}

/// A file of these bytes is refused by its path and what `names` says.
void CheckRefused(const std::string& bytes, const std::string& names) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "weights.nhpm";
  REQUIRE(WriteFile(file, bytes));
  test::CheckRefusal(ReadWeightsFile(file),
                     Catch::StartsWith(file.string() + ": ") && Catch::Contains(names),
                     ErrorCode::kMalformed);
}

std::string BytesOfSomeModel() {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "weights.nhpm";
  REQUIRE(WriteWeightsFile(file, SomeModel()));
  return ReadFile(file).value();
}

TEST_CASE("A weights file is read as it was written, equal models give equal files", "[weights]") {
  const test::TemporaryFolder folder;
  std::vector<NetworkModel> models{SomeModel()};
  for (const int width : {16, 32, 64}) {
    models.emplace_back().weights = InitialWeights({width}, 1);  // all else at its default
  }
  for (const int width : {4, 32}) {
    models.emplace_back().weights = InitialWeights({width, Architecture::kEncoderDecoder}, 1);
  }
  for (const NetworkModel& model : models) {
    REQUIRE(WriteWeightsFile(folder / "weights.nhpm", model));
    CHECK((ReadWeightsFile(folder / "weights.nhpm").value() == model));
  }
  CHECK((BytesOfSomeModel() == BytesOfSomeModel()));
}

TEST_CASE("The checksum is over all that changes answers, and nothing else", "[weights]") {
  NetworkModel zero;
  zero.weights = ZeroWeights({16});  // what sha256sum says of the zero network
  CHECK(ChecksumOf(zero) == "baf93c68ba38f46c41b677473073548695d27a52ef8a89b91d1944b97ce7fc3f");
  const NetworkModel model = SomeModel();
  const std::string checksum = ChecksumOf(model);
  const auto changed = [&](const std::function<void(NetworkModel&)>& change) {
    NetworkModel other = model;
    change(other);
    return ChecksumOf(other) != checksum;
  };
  CHECK(changed([](NetworkModel& m) { m.weights.weights[2].back() += 1.0F; }));
  CHECK(changed([](NetworkModel& m) { m.weights.biases[3][1] += 1.0F; }));
  CHECK(changed([](NetworkModel& m) { m.weights = InitialWeights({32}, 7); }));
  CHECK(changed(
      [](NetworkModel& m) { m.weights.shape.architecture = Architecture::kEncoderDecoder; }));
  CHECK(changed([](NetworkModel& m) { m.inputs.path = true; }));
  CHECK(changed([](NetworkModel& m) { m.inputs.depth = true; }));
  CHECK(changed([](NetworkModel& m) { std::swap(m.rows, m.columns); }));
  CHECK_FALSE(changed([](NetworkModel& m) { m.version = "another"; }));
  CHECK_FALSE(changed([](NetworkModel& m) { m.training.clear(); }));
}

TEST_CASE("A weights file that is missing is not found, one that cannot be written is named",
          "[weights]") {
  const std::string file = "/nonexistent/a.nhpm";
  CHECK(ReadWeightsFile(file).error().code == ErrorCode::kNotFound);
  test::CheckRefusal(WriteWeightsFile(file, SomeModel()), Catch::StartsWith(file), ErrorCode::kIo);
}

TEST_CASE("A file that is cut off anywhere, damaged or something else is refused", "[weights]") {
  const std::string bytes = BytesOfSomeModel();
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    INFO(at);
    REQUIRE_FALSE(Unframe(kKind, std::string_view(bytes).substr(0, at)));
    if (at >= 100 && at % 97 != 0) continue;
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    REQUIRE_FALSE(Unframe(kKind, damaged));
  }
  std::string damaged = bytes;
  damaged.back() = static_cast<char>(damaged.back() ^ 1);
  const FrameKind later{.magic = "CNVW", .version = 2, .name = "weights file"};
  for (const auto& [changed, names] : std::vector<std::pair<std::string, std::string>>{
           {"", "empty"},
           {bytes.substr(0, 3), "no weights file"},
           {bytes.substr(0, 30), "30 bytes of its header"},
           {bytes.substr(0, bytes.size() - 1), "cut off"},
           {bytes + "x", "extra bytes"},
           {damaged, "damaged"},
           {"#!/bin/sh\n" + std::string(200, 'x'), "no weights file"},
           {Frame(kKind, "\xff\xff\xff"), "not a Weights message"},
           {Frame(later, ""), "version 2; this program reads version 1"},
       }) {
    CheckRefused(changed, names);
  }
}

TEST_CASE("Contents that no network can have are refused by layer and value", "[weights]") {
  using Message = proto::Weights;
  const std::pair<const char*, void (*)(Message&)> rows[] = {
      {"3 layers", [](Message& m) { m.mutable_layers()->RemoveLast(); }},
      {"weights of layer 1: 2303 values",
       [](Message& m) { m.mutable_layers(1)->mutable_weights()->RemoveLast(); }},
      {"biases of layer 3: 3 values", [](Message& m) { m.mutable_layers(3)->add_biases(0.0F); }},
      {"weights of layer 0: 576 values", [](Message& m) { m.set_width(32); }},
      {"width 0,", [](Message& m) { m.set_width(0); }},
      {"width 48,", [](Message& m) { m.set_width(48); }},
      {"width 4294967295,", [](Message& m) { m.set_width(4294967295U); }},
      {"weights of layer 2: value 5", [](Message& m) { m.mutable_layers(2)->set_weights(5, NAN); }},
      {"biases of layer 0: value 0",
       [](Message& m) { m.mutable_layers(0)->set_biases(0, -INFINITY); }},
      {"grid size 0 x 15", [](Message& m) { m.set_rows(0); }},
      {"grid size 13 x 4000000000", [](Message& m) { m.set_columns(4000000000); }},
      {"architecture 2", [](Message& m) { m.set_architecture(proto::Architecture(2)); }},
      {"grid size 13 x 15", [](Message& m) { m.set_architecture(proto::ENCODER_DECODER); }},
      {"4 layers instead of 13",
       [](Message& m) {
         m.set_architecture(proto::ENCODER_DECODER);
         m.clear_rows();
         m.clear_columns();
       }},
      {"width 64, not 4, 8, 16 or 32",
       [](Message& m) {
         m.set_architecture(proto::ENCODER_DECODER);
         m.clear_rows();
         m.clear_columns();
         m.set_width(64);
       }},
  };
  const std::string bytes = BytesOfSomeModel();
  const std::string_view payload = Unframe(kKind, bytes).value();
  for (const auto& [names, change] : rows) {
    Message message;
    REQUIRE(message.ParseFromArray(payload.data(), static_cast<int>(payload.size())));
    change(message);
    CheckRefused(Frame(kKind, BytesOf(message)), names);
  }
}

}  // namespace
}  // namespace conav::nhpm
