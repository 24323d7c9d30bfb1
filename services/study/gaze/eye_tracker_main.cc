#include "common/service/service_main.h"
#include "study/gaze/eye_tracker_service.h"

/// conav-eye-tracker: what a Pupil Core sees, on the bus.
int main(int argc, char** argv) {
  return conav::RunServiceMain<conav::gaze::EyeTrackerConfig, conav::gaze::EyeTrackerService>(
      "eye_tracker",
      "Connects to Pupil Capture (Pupil Core) by its network interface and publishes pupils, "
      "gaze,\n"
      "fixations, blinks and its clock; sends a study's marks and the command log back as "
      "annotations.\n"
      "Waits for Pupil Capture, and connects again when it is started again. docs/gaze.md says how "
      "to set\n"
      "up Pupil Capture.",
      argc, argv);
}
