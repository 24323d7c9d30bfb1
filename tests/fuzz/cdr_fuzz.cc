#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "common/bus/changes.h"
#include "common/bus/topics.h"
#include "common/bus/type_support.h"
#include "common/msg/convert.h"
#include "common/runtime/file.h"
#include "unit/common/msg/samples.h"

/// Whatever arrives on a topic: a message is read from CDR, written again, and converted as services
/// do.
///
/// Input: a byte, which topic; then the payload. With CONAV_FUZZ_SEEDS=FOLDER the program writes seeds
/// into it and ends.
namespace conav {
namespace {

using Payload = std::span<const std::uint8_t>;

/// To a message of 100 bytes, whatever base it names.
void Apply(conav_msgs::msg::MessageChange change) {
  const std::vector<std::uint8_t> base(100);
  bus::ChangeEncoder encoder;
  bus::ChangeDecoder decoder;
  DEMAND(decoder.Decode(encoder.Encode(base)).has_value());
  change.base(encoder.Encode(base).base());
  const auto decoded = decoder.Decode(change);
  DEMAND(!decoded || (*decoded && (*decoded)->size() == change.size()));
}

template <class T>
void Read(Payload payload) {
  const bus::TypeSupport& type = bus::TypeSupportOf<T>();
  T message;
  if (!type.deserialize(payload, &message)) return;
  std::vector<std::uint8_t> written(type.serialized_size(&message));
  const std::size_t size = type.serialize(&message, written);
  DEMAND(size > 0 && size <= written.size(), type.name);  // a text is written up to a zero in it
  written.resize(size);
  T again;
  DEMAND(type.deserialize(written, &again), type.name);
  if constexpr (std::is_same_v<T, conav_msgs::msg::MessageChange>) Apply(message);
  if constexpr (requires { ToDomain(std::move(message)); }) {
    static_cast<void>(ToDomain(std::move(message)));
  } else if constexpr (requires { ToDomain(message, 3, 4); }) {
    static_cast<void>(ToDomain(message, 3, 4));
  }
}

template <class Visit>
void ForEachTopic(Visit&& visit) {
  bus::ForEachRobotTopic(visit);
  bus::ForEachWorldTopic(visit);
  bus::ForEachSystemTopic(visit);
}

void ReadTopic(std::uint8_t number, Payload payload) {
  std::uint8_t topic = 0;
  ForEachTopic([&]<class T>(const bus::Topic<T>&) {
    if (topic++ == number) Read<T>(payload);
  });
}

template <class T>
std::string Written(const T& message) {
  const bus::TypeSupport& type = bus::TypeSupportOf<T>();
  std::vector<std::uint8_t> bytes(type.serialized_size(&message));
  DEMAND(type.serialize(&message, bytes) == bytes.size(), type.name);
  return {bytes.begin(), bytes.end()};
}

/// An empty message of each topic, and `samples` of the topics of their type.
template <class... Samples>
void WriteSeeds(const std::filesystem::path& folder, const Samples&... samples) {
  std::uint8_t topic = 0;
  ForEachTopic([&]<class T>(const bus::Topic<T>&) {
    const auto write = [&](const std::string& kind, const T& message) {
      const std::string bytes = static_cast<char>(topic) + Written(message);
      DEMAND(WriteFile(folder / (std::to_string(topic) + kind), bytes).has_value());
    };
    write("-empty", T());
    const auto write_sample = [&](const auto& sample) {
      if constexpr (std::is_same_v<std::decay_t<decltype(sample)>, T>) write("-sample", sample);
    };
    (write_sample(samples), ...);
    ++topic;
  });
}

}  // namespace
}  // namespace conav

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* seeds = std::getenv("CONAV_FUZZ_SEEDS");
  if (seeds == nullptr) return 0;
  using namespace conav;
  using namespace conav::samples;
  WriteSeeds(seeds, ToMessage(SampleMap()), ToMessage(SampleCommand()), ToMessage(SampleState()),
             ToMessage(SampleGoals()), ToMessage(SampleSnapshot()), ToMessage(SampleBelief()),
             ToMessage(SampleGuidance()), ToMessage(SampleEdit()), ToMessage(SampleDriveOrder()),
             ToMessage(SampleReply()), ToMessage(SampleAttention()), ToMessage(SampleStop()),
             ToMessage(SampleEvent()), ToMessage(SampleQueue()), ToMessage(SampleReport()),
             ToMessage(SampleRequest()), ToMessage(SamplePerceptionReply()));
  std::exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 0) conav::ReadTopic(data[0], {data + 1, size - 1});
  return 0;
}
