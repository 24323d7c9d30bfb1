#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/grid/grid.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "common/runtime/config.h"
#include "common/runtime/result.h"
#include "common/runtime/text.h"
#include "common/segments/segment.h"

namespace conav::operators {

/// Section `operator: recording:`: how the operator edits their map after each picture, kept for
/// those who train perception models (docs/segments.md).
struct SegmentOptions {
  /// Segment file to append to, for example segments.pb.zst; empty = nothing is recorded. Made when
  /// it does not exist, its folder must.
  std::string file;
  /// Who makes the edits: person, or simulated.
  std::string origin = "person";
  /// A pseudonym. It and the session are UTF-8 without slashes and control characters.
  std::string participant;
  /// Pictures' files begin with it. Empty = the time of the start, UTC.
  std::string session;
  /// "world=preset@seed" or "world=map file", where known.
  std::vector<std::string> mazes;
  /// Keep the pictures, too, in a folder pictures/ next to the file.
  bool pictures = false;

  void Visit(ConfigReader& reader) {
    reader.Field("file", file);
    reader.Choice("origin", origin, {"person", "simulated"});
    PlainName(reader, "participant", participant);
    PlainName(reader, "session", session);
    reader.Field("mazes", mazes);
    reader.Field("pictures", pictures);
  }

 private:
  static void PlainName(ConfigReader& reader, const char* key, std::string& name) {
    reader.Field(key, name);
    if (!IsPlainName(name)) reader.Refuse(key, kNoPlainName);
  }
};

/// Whose session it is.
struct SessionFacts {
  SegmentOrigin origin = SegmentOrigin::kPerson;
  std::string participant;  // a pseudonym
  std::string session;
};

/// What a world was made from, where it is known.
struct MazeFacts {
  std::string name;  // maze preset or map file
  std::uint64_t world_seed = 0;
  std::uint64_t corruption_seed = 0;
};

/// A segment that is complete.
struct RecordedSegment {
  std::string world;
  Trajectory trajectory;  // what is known by now; without segments
  Segment segment;
  std::string robot;
  std::uint64_t sequence_number = 0;  // of the picture
  std::vector<std::uint8_t> jpeg;
};

/// Turns what the operator service receives and decides into segments, one trajectory for each
/// world.
///
/// A picture that asks for an answer (Snapshot::streamed is false) opens a segment; the guidance
/// that answers it closes it: x' is the operator's map then. x is the map when the picture arrived,
/// or when another picture was answered, whichever came later: with several robots an edit belongs
/// to the picture that is answered next. Picture, edit and guidance come over different topics, so
///   - an edit that came up to kGrace before its picture counts as made after it, unless guidance
///     came in between;
///   - guidance that came before its picture waits for it.
/// A picture without an answer is closed when this robot's next one arrives; at the end of the
/// session it is left out, unless edits followed it: it is not known whether it was looked at.
/// Walls are what has probability 0.5 or more.
///
/// Deterministic but for the times.
/// Threads: not synchronised.
class SegmentCollector {
 public:
  static constexpr std::chrono::milliseconds kGrace{500};

  SegmentCollector(SessionFacts session, std::map<std::string, MazeFacts> mazes);

  /// The operator's map of a world as it is served from now on; it keeps its size (demanded). A
  /// second time is ignored.
  void Begin(const Belief& belief, Clock::TimePoint now);
  /// What the world is like, for the accuracies; ignored where it has another size than the map.
  void SetTruth(const std::string& world, const OccupancyGrid& truth);
  /// Pictures of `robot` up to this one were answered before; later ones were not.
  void Skip(const std::string& robot, std::uint64_t answered);

  void Receive(const RobotState& state);
  void Receive(Snapshot snapshot, Clock::TimePoint now);
  /// The belief of a world after an accepted edit.
  void Edited(const Belief& belief, Clock::TimePoint now);
  /// Guidance that was accepted.
  void Guided(const Guidance& guidance, Clock::TimePoint now);
  /// The person is done: they have looked at every picture that came.
  void Finish(Clock::TimePoint now);
  void End();

  /// The segments that were completed since the last call, in that order.
  std::vector<RecordedSegment> Take();

 private:
  struct World {
    Trajectory facts;
    BeliefGrid initial;
    BeliefGrid belief;                           // now, 0 or 1
    BeliefGrid settled;                          // when guidance was last given
    std::optional<Clock::TimePoint> first_edit;  // since then
    Clock::TimePoint began;
    std::uint32_t next_step = 0;
  };
  struct OpenSegment {
    Snapshot snapshot;
    BeliefGrid belief;                           // x
    std::optional<Clock::TimePoint> first_edit;  // since x
    Clock::TimePoint sent;
    std::uint32_t goals_reached = 0;
  };
  /// Guidance whose picture did not come yet.
  struct EarlyAnswer {
    std::uint64_t sequence_number = 0;
    BeliefGrid before;
    BeliefGrid after;
    std::optional<Clock::TimePoint> first_edit;
    Clock::TimePoint confirmed;
  };
  struct Robot {
    std::string world;
    std::optional<SimTime> stamp;
    std::uint32_t goals_total = 0;
    std::uint64_t newest = 0;  // picture
    std::optional<OpenSegment> open;
    std::optional<EarlyAnswer> early;
  };

  void Close(World& world, const std::string& robot, OpenSegment open, const BeliefGrid& after,
             std::optional<Clock::TimePoint> confirmed);
  /// Edits made until now do not belong to pictures that come from now on.
  static void ForgetGrace(World& world);
  /// Neither do they belong to those that are open.
  void Settle(const std::string& world);
  std::vector<OpenSegment*> OpenIn(const std::string& world);
  static void Measure(Trajectory& trajectory, const BeliefGrid& initial, const BeliefGrid& final);

  SessionFacts session_;
  std::map<std::string, MazeFacts> mazes_;
  std::map<std::string, OccupancyGrid> truths_;
  std::map<std::string, World> worlds_;
  std::map<std::string, Robot> robots_;
  std::vector<RecordedSegment> completed_;
};

/// Entries "w1=conav13@7": world, preset or map file, seed ("@7" may be left out: 0).
/// Errors: kInvalidArgument names the entry.
[[nodiscard]] Result<std::map<std::string, MazeFacts>> ParseMazeFacts(
    const std::vector<std::string>& entries);

}  // namespace conav::operators
