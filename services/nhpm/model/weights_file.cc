#include "nhpm/model/weights_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "common/runtime/file.h"
#include "common/runtime/sha256.h"
#include "nhpm/model/frame.h"
#include "nhpm/model/weights_message.h"

namespace conav::nhpm {
namespace {

static_assert(std::endian::native == std::endian::little, "checksums are over little-endian bytes");

constexpr FrameKind kWeightsFile{.magic = "CNVW", .version = 1, .name = "weights file"};
constexpr std::uint32_t kMostCells = 4096;  // rows or columns

template <class T>
void Add(Sha256& digest, const std::vector<T>& values) {
  digest.Update(std::as_bytes(std::span(values)));
}

proto::Weights ToMessage(const NetworkModel& model) {
  proto::Weights message;
  message.set_name(model.name);
  message.set_version(model.version);
  message.set_width(static_cast<std::uint32_t>(model.weights.shape.width));
  AddLayers(model.weights, *message.mutable_layers());
  message.set_sees_belief(model.inputs.belief);
  message.set_sees_path(model.inputs.path);
  message.set_sees_view(model.inputs.view);
  message.set_rows(static_cast<std::uint32_t>(model.rows));
  message.set_columns(static_cast<std::uint32_t>(model.columns));
  message.set_data_origin(model.data_origin);
  for (const auto& [name, text] : model.training) {
    proto::NamedText& entry = *message.add_training();
    entry.set_name(name);
    entry.set_text(text);
  }
  message.mutable_learned_from()->Assign(model.learned_from.begin(), model.learned_from.end());
  return message;
}

Result<void> CheckGridSize(const proto::Weights& message) {
  const bool any = message.rows() == 0 && message.columns() == 0;
  const bool one = message.rows() != 0 && message.columns() != 0;
  if ((any || one) && message.rows() <= kMostCells && message.columns() <= kMostCells) return {};
  return Fail(ErrorCode::kMalformed,
              fmt::format("impossible grid size {} x {}", message.rows(), message.columns()));
}

NetworkModel ModelFrom(const proto::Weights& message, NetworkWeights weights) {
  NetworkModel model;
  model.name = message.name();
  model.version = message.version();
  model.weights = std::move(weights);
  model.inputs = {message.sees_belief(), message.sees_path(), message.sees_view()};
  model.rows = static_cast<int>(message.rows());
  model.columns = static_cast<int>(message.columns());
  model.data_origin = message.data_origin();
  for (const proto::NamedText& entry : message.training()) {
    model.training[entry.name()] = entry.text();
  }
  model.learned_from.assign(message.learned_from().begin(), message.learned_from().end());
  std::ranges::sort(model.learned_from);  // a file may come from elsewhere
  return model;
}

Result<NetworkModel> FromPayload(std::string_view payload) {
  proto::Weights message;
  if (!message.ParseFromArray(payload.data(), static_cast<int>(payload.size()))) {
    return Fail(ErrorCode::kMalformed, "its contents are no Weights message");
  }
  if (const auto checked = CheckGridSize(message); !checked) {
    return tl::unexpected(checked.error());
  }
  return WeightsFrom(message.width(), message.layers()).map([&](NetworkWeights&& weights) {
    return ModelFrom(message, std::move(weights));
  });
}

}  // namespace

std::string ChecksumOf(const NetworkModel& model) {
  Sha256 digest;
  Add(digest, std::vector<std::uint32_t>{static_cast<std::uint32_t>(model.weights.shape.width),
                                         model.inputs.belief, model.inputs.path, model.inputs.view,
                                         static_cast<std::uint32_t>(model.rows),
                                         static_cast<std::uint32_t>(model.columns)});
  for (const auto& values : model.weights.weights) Add(digest, values);
  for (const auto& values : model.weights.biases) Add(digest, values);
  return digest.Hex();
}

Result<void> WriteWeightsFile(const std::filesystem::path& path, const NetworkModel& model) {
  return WriteFile(path, Frame(kWeightsFile, BytesOf(ToMessage(model))));
}

Result<NetworkModel> ReadWeightsFile(const std::filesystem::path& path) {
  const auto bytes = ReadFile(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return Unframe(kWeightsFile, *bytes).and_then(FromPayload).map_error([&](const Error& error) {
    return Error{error.code, fmt::format("{}: {}", path.string(), error.text)};
  });
}

std::string UnknownLearning(const std::filesystem::path& weights) {
  return fmt::format(
      "{}: does not name the trajectories that it learned from, as weights of before conav train "
      "kept them: it may have seen what it is tested on",
      weights.string());
}

}  // namespace conav::nhpm
