#include "study/gaze/participant_eye.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/bus/topics.h"
#include "common/runtime/file.h"
#include "support/temporary_folder.h"
#include "unit/operator/replay/recorded_file.h"

namespace conav::gaze {
namespace {

namespace fs = std::filesystem;

/// recording.mcap of a step, message by message.
class Recorded {
 public:
  explicit Recorded(const fs::path& folder) : file_(Made(folder) / "recording.mcap") {}
  ~Recorded() { file_.Finish(); }

  template <class T>
  void Add(const bus::Topic<T>& topic, const T& message) {
    file_.Write(topic, "w1", ++time_s_, message);
  }

  void AddClock(double utc, double pupil_time) {
    conav_msgs::msg::EyeClock clock;
    clock.utc(utc);
    clock.pupil_time(pupil_time);
    clock.round_trip(0.0002);
    Add(bus::kEyeClock, clock);
  }
  void AddPupil(double utc, double pupil_time, float mm) {
    conav_msgs::msg::EyePupil pupil;
    pupil.utc(utc);
    pupil.pupil_time(pupil_time);
    pupil.confidence(1.0F);
    pupil.diameter(40.0F);
    pupil.diameter_3d(mm);
    Add(bus::kEyePupil, pupil);
  }
  void AddMark(double utc, const std::string& label, const std::string& step) {
    conav_msgs::msg::StudyMark mark;
    mark.utc(utc);
    mark.label(label);
    mark.keys({"step"});
    mark.values({step});
    Add(bus::kStudyMark, mark);
  }

 private:
  static fs::path Made(const fs::path& folder) {
    fs::create_directories(folder);
    return folder;
  }

  operators::RecordedFile file_;
  double time_s_ = 0.0;
};

constexpr double kUtc = 1.7e9;

TEST_CASE("the steps of a participant are one recording on the tracker's first clock",
          "[study][gaze]") {
  const test::TemporaryFolder folder;
  {
    Recorded first(folder / "P07" / "01-rest");
    first.AddMark(kUtc + 1.0, "baseline begin", "rest");  // before the tracker came
    first.AddPupil(kUtc + 5.0, 105.0, 3.5F);
    first.AddClock(kUtc + 4.0, 104.0);
    first.AddClock(kUtc + 14.0, 114.004);  // it runs fast
    first.AddMark(kUtc + 9.0, "baseline end", "rest");
    first.AddMark(kUtc + 9.0, "baseline end", "rest");  // its recorder was restarted
  }
  {
    Recorded second(folder / "P07" / "02-trial");  // Pupil was started again before it
    second.AddClock(kUtc + 60.0, 1.0);
    second.AddClock(kUtc + 80.0, 5000.0);  // and in the middle of it
    second.AddPupil(kUtc + 61.0, 2.0, 3.6F);
    second.AddPupil(kUtc + 81.0, 5001.0, 3.7F);
    second.AddMark(kUtc + 62.0, "trial begin", "trial");
    second.AddMark(kUtc + 82.0, "trial end", "trial");
  }
  fs::create_directories(folder / "P07" / "03-form");  // without a recording
  REQUIRE(WriteFile(folder / "P07" / "participant.json",
                    R"({"parts": [{"step": "trial", "method": "ig-mcts", "rotation": 90}]})"));
  CHECK(HasBusRecordings(folder / "P07"));
  const auto eyes = ReadParticipantEyes(folder / "P07");
  REQUIRE(eyes);
  CHECK(eyes->recording.name == "P07");
  CHECK(eyes->recording.in_mm);
  REQUIRE(eyes->recording.pupils.size() == 3);
  const std::vector<double> pupils{105.0, 161.0, 181.0};
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(eyes->recording.pupils[i].time_s == Approx(pupils[i]).margin(1e-6));
  }
  const auto& marks = eyes->recording.marks;
  REQUIRE(marks.size() == 4);
  CHECK(marks[0].time_s == Approx(101.0).margin(1e-6));
  CHECK(marks[1].time_s == Approx(109.002).margin(1e-6));  // half way between the probes
  CHECK(marks[2].time_s == Approx(162.0).margin(1e-6));
  CHECK(marks[3].time_s == Approx(182.0).margin(1e-6));
  CHECK(marks[2].keys.at("method") == "ig-mcts");
  CHECK(marks[2].keys.at("rotation") == "90");
  CHECK(marks[0].keys.size() == 1);
}

TEST_CASE("a page's pixels become shares of the surface that its tags span", "[study][gaze]") {
  const test::TemporaryFolder folder;
  const auto area = [](const char* name, double x, double y, double width, double height) {
    conav_msgs::msg::PageArea made;
    made.name(name);
    made.x(x);
    made.y(y);
    made.width(width);
    made.height(height);
    return made;
  };
  {
    Recorded step(folder / "P07");
    step.AddClock(kUtc, 0.0);
    nav_msgs::msg::OccupancyGrid map;
    map.info().height(4);
    map.info().width(6);
    step.Add(bus::kInitialMap, map);
    conav_msgs::msg::PageLayout layout;
    layout.utc(kUtc + 1.0);
    layout.width(1200.0);
    layout.height(800.0);
    layout.areas({area("map", 200.0, 100.0, 500.0, 300.0)});
    layout.world("w1");
    layout.map_x(250.0);
    layout.map_y(150.0);
    layout.map_dx(50.0);
    layout.map_dy(40.0);
    step.Add(bus::kPageLayout, layout);
    layout.utc(kUtc + 2.0);
    layout.tags({area("tag0", 100.0, 0.0, 96.0, 96.0), area("tag1", 1004.0, 404.0, 96.0, 96.0)});
    step.Add(bus::kPageLayout, layout);
  }
  const auto eyes = ReadParticipantEyes(folder / "P07");
  REQUIRE(eyes);
  REQUIRE(eyes->areas.layouts.size() == 2);
  const AreaLayout& whole = eyes->areas.layouts[0];
  CHECK(whole.time_s == Approx(1.0).margin(1e-6));
  CHECK(whole.areas.at(0).x == Approx(200.0 / 1200.0));
  CHECK(whole.areas.at(0).height == Approx(300.0 / 800.0));
  const AreaLayout& tagged = eyes->areas.layouts[1];
  CHECK(tagged.areas.at(0).x == Approx(0.1));
  CHECK(tagged.areas.at(0).y == Approx(0.2));
  CHECK(tagged.areas.at(0).width == Approx(0.5));
  REQUIRE(tagged.map);
  CHECK(tagged.map->rows == 4);
  CHECK(tagged.map->columns == 6);
  CHECK(tagged.map->x == Approx(0.15));
  CHECK(tagged.map->y == Approx(0.3));
  CHECK(tagged.map->dx == Approx(0.05));
  CHECK(tagged.map->dy == Approx(0.08));

  // Cell (1, 2) has its centre at (350, 190).
  EyeRecording recording;
  const auto look = [&](double x, double y) {
    recording.surfaces["page"].gaze.push_back({3.0, 1.0, (x - 100.0) / 1000.0, 1.0 - y / 500.0});
  };
  look(350.0, 190.0);
  look(330.0, 205.0);
  look(210.0, 190.0);  // on the canvas, left of the map
  look(900.0, 190.0);  // elsewhere on the page
  const MapGaze seen = MapGazeOf(recording, {"trial", 2.5, 9.0, {}}, eyes->areas, 0.6);
  REQUIRE(seen.counts.size() == 24);
  CHECK(seen.counts[1 * 6 + 2] == 2.0);
  CHECK(std::accumulate(seen.counts.begin(), seen.counts.end(), 0.0) == 2.0);
}

TEST_CASE("without eye data nothing is measured, and a recording with other messages is refused",
          "[study][gaze]") {
  const test::TemporaryFolder folder;
  CHECK_FALSE(HasBusRecordings(folder.path()));
  { Recorded(folder / "P07" / "01-a").AddMark(kUtc, "trial begin", "a"); }
  const auto none = MeasureParticipant(folder / "P07");
  REQUIRE(none);
  CHECK(none->trials.empty());
  CHECK(none->problems.empty());
  {
    Recorded recorded(folder / "P09" / "01-a");
    recorded.AddClock(kUtc, 1.0);
    recorded.AddPupil(kUtc, 1.0, 3.0F);
    recorded.AddMark(kUtc, "trial begin", "a");
  }
  const auto open = MeasureParticipant(folder / "P09");
  REQUIRE(open);
  CHECK(open->trials.empty());
  CHECK(open->problems == std::vector<std::string>{"trial does not end"});
  { Recorded(folder / "P08").AddPupil(kUtc, std::numeric_limits<double>::quiet_NaN(), 3.0F); }
  const auto broken = MeasureParticipant(folder / "P08");
  REQUIRE_FALSE(broken);
  CHECK(broken.error().code == ErrorCode::kMalformed);
  CHECK_THAT(broken.error().text, Catch::Contains("/conav/eye/pupil"));
}

}  // namespace
}  // namespace conav::gaze
