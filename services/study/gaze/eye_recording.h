#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "common/runtime/result.h"

/// Eye tracking with Pupil Core: its data, and what the study measures of it.
namespace conav::gaze {

/// Times are s of the recording's clock ("Pupil time": monotonic, from any epoch). Positions are shares
/// of a picture or surface in [0, 1], x to the right and y UP from the lower left corner.
struct PupilSample {
  double time_s = 0.0;
  int eye = 0;  // 0 right, 1 left
  double confidence = 0.0;
  double diameter = 0.0;  // mm of the 3d model, else pixels of the eye camera
};

struct GazeSample {
  double time_s = 0.0;
  double confidence = 0.0;
  double x = 0.0;
  double y = 0.0;
};

struct Fixation {
  std::int64_t id = 0;
  double begin_s = 0.0;
  double duration_s = 0.0;
  double x = 0.0;
  double y = 0.0;
};

struct Blink {
  double begin_s = 0.0;
  double end_s = 0.0;
};

/// What fell on one surface. Samples next to it are left out.
struct SurfaceGaze {
  std::vector<GazeSample> gaze;
  std::vector<Fixation> fixations;
};

/// An annotation: "trial begin" with the keys method, layout, ...
struct Mark {
  double time_s = 0.0;
  std::string label;
  std::map<std::string, std::string> keys;
};

/// All vectors are ordered by time.
struct EyeRecording {
  std::string name;
  std::vector<PupilSample> pupils;
  bool in_mm = false;  // the pupils' diameters
  std::vector<GazeSample> gaze;
  std::vector<Fixation> fixations;  // of the world camera's picture
  std::vector<Blink> blinks;
  std::map<std::string, SurfaceGaze> surfaces;  // by name
  std::vector<Mark> marks;
  /// s since 1970 (UTC) less the recording's clock, where its info file tells both.
  std::optional<double> utc_offset_s;
};

/// One detector's pupil in one frame of an eye camera.
struct PupilDatum {
  double time_s = 0.0;
  int eye = 0;
  std::string method;
  double confidence = 0.0;
  double x = 0.0;  // of the eye camera's picture
  double y = 0.0;
  double diameter_px = 0.0;
  std::optional<double> diameter_mm;  // of the 3d detector
};

/// `surface` empty: the world camera's picture. On surfaces also what is next to them.
struct GazeDatum {
  std::string surface;
  GazeSample sample;
};
struct FixationDatum {
  std::string surface;
  double confidence = 0.0;
  Fixation fixation;
};

struct BlinkDatum {
  double time_s = 0.0;
  bool onset = false;  // otherwise the offset
  double confidence = 0.0;
};

using EyeDatum = std::variant<PupilDatum, GazeDatum, FixationDatum, BlinkDatum, Mark>;

/// Largest message of Pupil that is taken, and how deep its lists may be nested.
inline constexpr std::size_t kMessageLimit = std::size_t{4} << 20;
inline constexpr int kMessageDepth = 32;

/// MessagePack of a map. Errors: kMalformed: anything else, or beyond the limits above.
[[nodiscard]] Result<nlohmann::json> ParseMessage(std::span<const std::uint8_t> bytes);

/// What a message of Pupil says, live or stored. Nothing for topics that are not needed; fields that are
/// not known are ignored. Errors: kMalformed names the topic and the field that is missing or of another
/// type.
[[nodiscard]] Result<std::vector<EyeDatum>> DecodeMessage(const std::string& topic,
                                                          const nlohmann::json& message);

/// Makes a recording of what Pupil's messages say.
///
/// - Each frame of an eye has a pupil of the 2d and of the 3d detector: those of the 3d one count where
///   there are any.
/// - Blink messages repeat with every frame of the world camera: an onset and the offsets that follow
///   it are one blink.
/// - Messages of one fixation share its id, until Pupil is started again: the last one counts. Those of a
///   surface repeat with every frame.
/// - A mark that its sender repeated, after a restart, counts once.
class EyeCollector {
 public:
  /// Errors: those of DecodeMessage.
  [[nodiscard]] Result<void> Add(const std::string& topic, const nlohmann::json& message);
  void Add(const EyeDatum& datum);
  /// Everything so far.
  EyeRecording Finish() &&;

  void AddPupil(const PupilSample& sample, bool is_3d);
  void AddFixation(std::vector<Fixation>& fixations, const Fixation& fixation);
  EyeRecording& recording() { return recording_; }

 private:
  void AddBlink(double time_s, bool is_onset);
  void CloseBlink();

  EyeRecording recording_;
  std::optional<Blink> blink_;
  bool has_offset_ = false;
};

/// Reads a recording of Pupil Capture, format 2.0: info.player.json and the *.pldata (MessagePack
/// [topic, MessagePack bytes], one after the other), or a folder that Pupil Player exported
/// (pupil_positions.csv, gaze_positions.csv, blinks.csv, fixations.csv, annotations.csv, surfaces/). Of a
/// recording with exports the newest export counts, and for what it lacks the messages. Files that are missing
/// leave their part empty; without pupils there is no recording.
/// Errors: kNotFound, kIo; kMalformed names file, line and column (or byte).
[[nodiscard]] Result<EyeRecording> ReadEyeRecording(const std::filesystem::path& folder);

}  // namespace conav::gaze
