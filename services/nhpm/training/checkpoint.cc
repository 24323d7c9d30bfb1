#include "nhpm/training/checkpoint.h"

#include <fmt/core.h>

#include <cmath>

#include "checkpoint.pb.h"
#include "common/runtime/file.h"
#include "nhpm/model/weights_file.h"

namespace conav::nhpm {
namespace {

constexpr FrameKind kCheckpoint{.magic = "CNVC", .version = 1, .name = "checkpoint"};

proto::Checkpoint ToMessage(const Checkpoint& checkpoint) {
  proto::Checkpoint message;
  for (const auto& [name, text] : checkpoint.settings) {
    proto::NamedText& entry = *message.add_settings();
    entry.set_name(name);
    entry.set_text(text);
  }
  const TrainingState& state = checkpoint.state;
  message.set_width(static_cast<std::uint32_t>(state.weights.shape.width));
  message.set_architecture(ToMessage(state.weights.shape.architecture));
  AddLayers(state.weights, *message.mutable_weights());
  AddLayers(state.adam.first, *message.mutable_first_moments());
  AddLayers(state.adam.second, *message.mutable_second_moments());
  message.set_steps(state.adam.steps);
  AddLayers(state.best, *message.mutable_best());
  message.set_best_epoch(static_cast<std::uint32_t>(state.best_epoch));
  for (const EpochReport& report : state.epochs) {
    proto::Epoch& epoch = *message.add_epochs();
    epoch.set_train_loss(report.train_loss);
    epoch.set_validation_loss(report.validation_loss);
  }
  return message;
}

Result<std::vector<EpochReport>> EpochsOf(const proto::Checkpoint& message) {
  std::vector<EpochReport> epochs;
  for (const proto::Epoch& epoch : message.epochs()) {
    if (!std::isfinite(epoch.train_loss()) || !std::isfinite(epoch.validation_loss())) {
      return Fail(ErrorCode::kMalformed,
                  fmt::format("the losses of epoch {} are not finite", epochs.size() + 1));
    }
    epochs.push_back(
        {static_cast<int>(epochs.size()) + 1, epoch.train_loss(), epoch.validation_loss()});
  }
  const bool any = !epochs.empty();
  if (message.best_epoch() > epochs.size() || (message.best_epoch() > 0) != any) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("best epoch {} of {}", message.best_epoch(), epochs.size()));
  }
  return epochs;
}

Result<TrainingState> StateFrom(const proto::Checkpoint& message) {
  TrainingState state;
  state.adam.steps = message.steps();
  state.best_epoch = static_cast<int>(message.best_epoch());
  const auto architecture = ArchitectureFrom(message.architecture());
  if (!architecture) return tl::unexpected(architecture.error());
  for (const auto& [what, layers, target] :
       {std::tuple("weights", &message.weights(), &state.weights),
        std::tuple("first moments", &message.first_moments(), &state.adam.first),
        std::tuple("second moments", &message.second_moments(), &state.adam.second),
        std::tuple("best weights", &message.best(), &state.best)}) {
    auto weights = WeightsFrom(message.width(), *architecture, *layers);
    if (!weights) {
      return Fail(ErrorCode::kMalformed, fmt::format("{}: {}", what, weights.error().text));
    }
    *target = *std::move(weights);
  }
  auto epochs = EpochsOf(message);
  if (!epochs) return tl::unexpected(epochs.error());
  state.epochs = *std::move(epochs);
  return state;
}

Result<Checkpoint> FromPayload(std::string_view payload) {
  proto::Checkpoint message;
  if (!message.ParseFromArray(payload.data(), static_cast<int>(payload.size()))) {
    return Fail(ErrorCode::kMalformed, "its contents are not a Checkpoint message");
  }
  return StateFrom(message).map([&](TrainingState&& state) {
    Checkpoint checkpoint{{}, std::move(state)};
    for (const proto::NamedText& entry : message.settings()) {
      checkpoint.settings[entry.name()] = entry.text();
    }
    return checkpoint;
  });
}

}  // namespace

Result<void> WriteCheckpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  return WriteFile(path, Frame(kCheckpoint, BytesOf(ToMessage(checkpoint))));
}

Result<Checkpoint> ReadCheckpoint(const std::filesystem::path& path) {
  const auto bytes = ReadFile(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return Unframe(kCheckpoint, *bytes).and_then(FromPayload).map_error([&](const Error& error) {
    return Error{error.code, fmt::format("{}: {}", path.string(), error.text)};
  });
}

std::string DifferenceText(const std::map<std::string, std::string>& there,
                           const std::map<std::string, std::string>& now) {
  const auto value = [](const std::map<std::string, std::string>& settings,
                        const std::string& name) {
    const auto found = settings.find(name);
    return found == settings.end() ? "(nothing)" : found->second;
  };
  std::map<std::string, std::string> names = there;
  names.insert(now.begin(), now.end());
  std::string text;
  for (const auto& [name, unused] : names) {
    if (value(there, name) == value(now, name)) continue;
    text += fmt::format("{}{} {} there, {} now", text.empty() ? "" : "; ", name, value(there, name),
                        value(now, name));
  }
  return text;
}

}  // namespace conav::nhpm
