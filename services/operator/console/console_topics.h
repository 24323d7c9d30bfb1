#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/changes.h"
#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/planning.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "common/service/diagnostics.h"
#include "operator/belief/alert.h"
#include "operator/belief/belief_store.h"
#include "operator/config.h"
#include "operator/console/console_state.h"
#include "operator/console/layout_topics.h"
#include "operator/console/task_topics.h"
#include "operator/gateway/gateway.h"
#include "operator/gateway/page_feed.h"
#include "operator/supervision/control.h"
#include "operator/supervision/supervision_topics.h"

// One user: the service; apart because it knows the bus.

namespace conav::operators {

/// How the perception service expects the operator to edit the map after a picture.
struct Prediction {
  std::string robot;
  std::string world;
  std::uint64_t snapshot = 0;
  std::string model;
  PerceptionAnswer answer;
};

/// Asks the perception service, as planners do, about the newest picture of each robot, for the
/// console. A question without an answer is asked again, three times in all; then the page shows
/// none. Threads: one.
class PredictionClient {
 public:
  static constexpr int kTries = 3;
  static constexpr std::chrono::seconds kRepeat{1};

  /// `clock` outlives it.
  PredictionClient(bus::Participant& participant, const Clock& clock);

  /// `picture` came while the operator's map was `belief`. Pictures that show what lies beyond the
  /// map are left out.
  void Ask(const Snapshot& snapshot, const Belief& belief);
  /// The answers that came since the last call, to each robot's newest question only.
  std::vector<Prediction> Step();

 private:
  struct Question {
    Prediction of;  // without the answer
    PerceptionRequest request;
    int rows = 0;
    int columns = 0;
    int tries = 0;
    Clock::TimePoint repeat_at{};
  };

  void Send(Question& question);

  const Clock& clock_;
  std::string client_;
  std::uint64_t last_id_ = 0;
  std::map<std::string, Question> open_;  // by robot
  bus::Publisher<conav_msgs::msg::PerceptionRequest> requests_;
  bus::Subscriber<conav_msgs::msg::PerceptionReply> replies_;
};

/// The operator service's console: shows pages the service's decisions and what robots and planners
/// publish (maps, pictures, plans, searches, health), and hands over pages' requests.
///
/// A page is one client of the service among others: its requests are those of DDS
/// (OperatorRequest), and answered by the same code. In the mapping task and in studies pages get
/// nothing that gives the true maze away (idl/console.proto, Task).
/// Threads: one, the service's; the gateway has its own.
class ConsoleTopics {
 public:
  /// All but `config` outlive it. Throws StartupError as Gateway does.
  ConsoleTopics(bus::Participant& participant, const OperatorConfig& config,
                const ServiceMonitor& services, const Clock& clock);
  ~ConsoleTopics();

  void Receive(const bus::Stamped<RobotState>& state);
  /// Shows the picture and serves its pixels, which are moved; unless it is streamed.
  void Receive(bus::Stamped<Snapshot>&& snapshot);
  void ReceiveGeometry(const std::string& world, const MapUpdate& map);
  void Receive(const Belief& belief, const BeliefGrid& initial);
  void Receive(const Guidance& guidance);
  void Receive(const AttentionQueueState& queue);
  void Receive(const ControlRegistry& control);
  void Receive(const Alert& alert);
  /// Hands over what pages ask about the step itself, and shows how it stands.
  void Serve(TaskTopics& task);
  /// The health of the processes, as it is now.
  void ReceiveServices();
  /// "Nothing new here", by `client`; before the guidance that it made of it.
  void Receive(const AnswerRequest& answer, const std::string& client);
  void Receive(const OperatorEvent& event);

  struct Asked {
    std::function<void(const OperatorReply&)> reply;
    OperatorRequest request;
    double valid_until_s = 0.0;  // wall time, s since 1970
    std::string refusal;         // why the page may not ask that now; empty = it may
  };
  /// Receives what arrived. Returns pages' requests in order of arrival; malformed ones are
  /// answered here.
  std::vector<Asked> Step();
  /// Clients whose page has been gone for a while.
  std::vector<std::string> TakeGone() { return presence_.TakeGone(clock_.Now()); }
  /// Clients who used their page since the call before.
  std::set<std::string> TakeActive() { return std::exchange(used_by_, {}); }
  /// After everything that one step brought.
  void Publish() { gateway_->Notify(); }
  /// For /readyz.
  void SetReadiness(const Health& health);

  std::string url() const { return gateway_->url(); }

 private:
  struct RobotLink;
  struct StudyAsked {
    std::uint64_t page = 0;
    StudyRequest request;
  };

  void Reply(std::uint64_t page, const OperatorReply& reply);
  void TakeFrom(RobotLink& robot);
  /// What the robot knows and plans.
  void TakeKnowledge(RobotLink& robot);
  void TakeFrames(RobotLink& robot);
  /// Subscribes to the cameras that pages attend, and to no others: a camera sends while somebody
  /// subscribes. Over a link likewise to search reports, else to all of them.
  void FollowPages();
  void TakePredictions();
  void Take(PageEvent& event, std::vector<Asked>& asked);
  std::optional<Asked> Read(const PageEvent& event, const PageAsked& body);

  bus::Participant& participant_;
  const ServiceMonitor& services_;
  const Clock& clock_;
  bool keeps_secrets_;  // pages must not learn the true maze: a participant sits there
  std::unique_ptr<LayoutTopics> layouts_;  // likewise; null elsewhere
  UpdateLog updates_;
  FrameSlots frames_;
  SnapshotStore snapshots_;
  ConsoleState state_;
  std::vector<std::unique_ptr<RobotLink>> robots_;
  std::map<std::string, Belief> beliefs_;  // by world
  PredictionClient predictions_;
  PagePresence presence_;
  std::vector<StudyAsked> study_;
  std::set<std::string> used_by_;                  // clients
  std::map<std::uint64_t, PageAttends> attended_;  // by page
  std::unique_ptr<Gateway> gateway_;
};

}  // namespace conav::operators
