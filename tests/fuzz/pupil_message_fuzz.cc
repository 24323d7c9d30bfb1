#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "study/gaze/eye_recording.h"

/// What an eye tracker sends: a byte that names the topic, and its message.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace conav::gaze;
  static const std::array<std::string, 7> kTopics{"pupil.0.3d",  "gaze.3d.01.", "fixations",
                                                  "blinks",      "surfaces.a",  "annotation",
                                                  "fixationless"};
  if (size == 0) return 0;
  const auto message = ParseMessage({data + 1, size - 1});
  if (!message) return 0;
  EyeCollector collector;
  for (int i = 0; i < 2; ++i) {
    static_cast<void>(collector.Add(kTopics[data[0] % kTopics.size()], *message));
  }
  static_cast<void>(std::move(collector).Finish());
  return 0;
}
