#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "study/gaze/eye_measures.h"
#include "study/gaze/eye_recording.h"

// Apart because it knows the recordings of the bus.
namespace conav::gaze {

/// A participant's eye data with the marks and page layouts of the same time, from recordings of the bus.
struct ParticipantEyes {
  EyeRecording recording;
  AreasOfInterest areas;
};

/// Whether `folder` is a run folder with recording.mcap, or has such folders (a participant's).
bool HasBusRecordings(const std::filesystem::path& folder);

/// Reads /conav/eye/*, /conav/study/mark and /conav/operator/page_layout of all recordings in `folder`
/// (recording.mcap and those that follow it, here and one folder below) as one recording, whose clock is
/// the tracker's at the first one. Each later start of the tracker is moved to that clock by UTC, and marks
/// by the clocks around them.
///
/// Areas are shares of the surface `page`, which spans the outer corners of the page's tags; without
/// tags the whole page. Keys of a mark that participant.json says of its step (method, layout, rotation,
/// ...) are added where the mark lacks them.
/// Without eye data the recording is empty. Errors: those of bag::McapReader; kMalformed: a message that
/// is not of its topic's type, data of more than a day.
[[nodiscard]] Result<ParticipantEyes> ReadParticipantEyes(const std::filesystem::path& folder,
                                                          const std::string& page = "page");

/// What one trial of a study measures; `step` as its marks say.
struct StepEyeMeasures {
  std::string step;
  TrialMeasures measures;
};

struct MeasuredParticipant {
  std::vector<StepEyeMeasures> trials;
  std::vector<std::string> problems;  // of its marks: a trial that does not end is not measured
};

/// All trials of a participant (runs/study-NAME/P07); nothing when no eye data was recorded. Errors: those
/// of ReadParticipantEyes.
[[nodiscard]] Result<MeasuredParticipant> MeasureParticipant(const std::filesystem::path& folder,
                                                             const PupilRules& rules = {},
                                                             const ExclusionRules& exclusion = {});

}  // namespace conav::gaze
