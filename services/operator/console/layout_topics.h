#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/publisher.h"
#include "common/runtime/log.h"
#include "console.pb.h"
#include "operator/console/participant_task.h"

// One user: the console; apart because eye tracking is not its concern.
namespace conav::operators {

/// Tags around a participant's page, by which an eye tracker finds it.
inline constexpr int kPageTags = 6;

/// The tags of the family tag36h11 with the numbers 0 to kPageTags - 1: their 6 x 6 inner cells by rows,
/// 1 = white, the first one in the highest of 36 bits. Around them are a black frame of one cell and a
/// white one.
std::vector<std::uint64_t> TagPatterns();

/// Publishes where participants' pages show what. Threads: one, the service's.
class LayoutTopics {
 public:
  LayoutTopics(bus::Participant& participant, const TaskOptions& task);

  /// Adds the tags that pages draw, if the task has them.
  void AddTags(console::Task& task) const;

  /// A layout with too many areas, or with numbers or names that cannot be, is left out and logged.
  void Publish(const std::string& client, const console::PageLayout& layout);

 private:
  bus::Publisher<conav_msgs::msg::PageLayout> publisher_;
  std::vector<std::uint64_t> tags_;
  LogLimit refusals_logged_;
};

}  // namespace conav::operators
